#include "mpm/material/equation_of_state.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace flowrest::mpm;

namespace {

const EquationOfState<double> state = {83333.0, 38461.0, 7.0};

}  // namespace

TEST(EquationOfState, HoldsNoPressureNorEnergyAtRest) {
  EXPECT_EQ(state.at(1.0).pressure, 0.0);
  EXPECT_EQ(state.at(1.0).shear, state.shear_modulus);
  EXPECT_EQ(state.energy(1.0), 0.0);
}

TEST(EquationOfState, StiffnessIsMinusThePressuresSlope) {
  for (const double ratio : {0.8, 0.92, 0.99, 1.0, 1.01, 1.1}) {
    const double d = 1e-6;
    const double slope = -(state.at(ratio + d).pressure - state.at(ratio - d).pressure) / (2.0 * d);
    const double stiffness =
        state.bulk_modulus * std::exp(-state.exponent * (ratio - 1.0));  // Yu et al. 2026, Eq. 18
    EXPECT_NEAR(slope, stiffness, 1e-8 * stiffness) << "J = " << ratio;
  }
}

TEST(EquationOfState, ShearAndBulkStiffnessKeepTheirRatio) {
  for (const double ratio : {0.7, 0.95, 1.2}) {
    const double bulk = state.exponent * state.at(ratio).pressure + state.bulk_modulus;
    EXPECT_NEAR(state.at(ratio).shear / bulk, state.shear_modulus / state.bulk_modulus, 1e-15)
        << "J = " << ratio;
  }
}

TEST(EquationOfState, EnergyIsTheIntegralOfThePressure) {
  for (const double ratio : {0.8, 0.95, 1.05}) {
    // Simpson's rule over J from 1.
    const int intervals = 200;
    const double h = (ratio - 1.0) / intervals;
    double sum = 0.0;
    for (int i = 0; i <= intervals; ++i) {
      const double weight = i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
      sum -= weight * state.at(1.0 + i * h).pressure * h / 3.0;
    }
    EXPECT_NEAR(state.energy(ratio), sum, 1e-9 * sum) << "J = " << ratio;
    EXPECT_GT(state.energy(ratio), 0.0) << "J = " << ratio;
  }
}

TEST(EquationOfState, IsTheSameInSinglePrecisionToRoundOff) {
  const EquationOfState<float> single = {83333.0f, 38461.0f, 7.0f};
  for (const double ratio : {0.9, 1.05}) {
    const double pressure = state.at(ratio).pressure;
    EXPECT_NEAR(static_cast<double>(single.at(static_cast<float>(ratio)).pressure), pressure,
                3e-6 * std::abs(pressure));
  }
}
