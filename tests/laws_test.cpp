// The flow laws of the two rooms that never see each other: the material point solver's and the OpenFOAM
// plug-in's.
#include <gtest/gtest.h>

#include <cmath>

#include "foamCases/rheology/law.h"
#include "mpm/material/flow_law.h"
#include "mpm/test_random.h"

namespace flowrest {
namespace {

using mpm::FlowParameters;
using mpm::test::Random;

constexpr int states = 20000;

TEST(Laws, BothRoomsReturnTheTrialToTheSameStress) {
  Random random(7);
  for (int i = 0; i < states; ++i) {
    FlowParameters<double> flow{};
    flow.yield_stress = random.log_between(1e-3, 1e4);
    flow.plastic_viscosity = random.chance(0.1) ? 0.0 : random.log_between(1e-3, 1e3);
    flow.flocculation_growth = random.chance(0.2) ? 0.0 : random.log_between(1e-5, 10.0);
    flow.deflocculation = random.chance(0.1) ? 0.0 : random.log_between(1e-12, 1e6);
    const double dt = random.log_between(1e-6, 1e-2), shear = random.log_between(1e3, 1e6) * dt;
    const double lambda = random.chance(0.2) ? 0.0 : random.log_between(1e-6, 1e3);
    const double trial = (1.0 + lambda) * flow.yield_stress * random.log_between(0.5, 1e3);
    const auto ours = mpm::ElastoViscoplastic<true>::relax(flow, trial, shear, dt, lambda, 0.0);
    const rheology::ElastoViscoplastic law{flow.yield_stress, flow.plastic_viscosity,
                                           flow.flocculation_growth, flow.deflocculation};
    const auto theirs = rheology::relax(law, trial, shear, dt, lambda);
    ASSERT_NEAR(theirs.stress, ours.stress, 1e-12 * trial) << "state " << i;
    ASSERT_NEAR(theirs.rate, ours.rate, 1e-12 * trial / shear) << "state " << i;
    ASSERT_NEAR(theirs.flocculation, ours.lambda, 1e-12 * (1.0 + lambda)) << "state " << i;
  }
}

TEST(Laws, BothRoomsRegulariseAlike) {
  Random random(11);
  for (int i = 0; i < states; ++i) {
    FlowParameters<double> flow{};
    flow.plastic_viscosity = random.log_between(1e-3, 1e3);
    flow.regularisation_time = random.log_between(1e-2, 1e5);
    flow.critical_shear_rate = random.log_between(1e-5, 1e1);
    const double yield = random.log_between(1e-3, 1e4), rate = random.log_between(1e-9, 1e4);
    const double exponential = mpm::papanastasiou_stress(flow, yield, rate);
    ASSERT_NEAR(rate * rheology::papanastasiou_viscosity(flow.plastic_viscosity, yield,
                                                         flow.regularisation_time, rate),
                exponential, 1e-12 * exponential);
    flow.yield_stress = yield;
    const double broken = mpm::bi_viscous_stress(flow, yield, rate);
    ASSERT_NEAR(
        rate * rheology::bi_viscous_viscosity(flow.plastic_viscosity, yield, flow.critical_shear_rate, rate),
        broken, 1e-12 * broken);
  }
}

}  // namespace
}  // namespace flowrest
