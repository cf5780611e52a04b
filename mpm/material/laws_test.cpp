// The kernels' flow laws and equation of state against those of laws/, which they know nothing of.
#define FLOWREST_KERNEL_SPACE kernels_of_test

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "laws/equation_of_state.h"
#include "laws/law.h"
#include "mpm/material/stress_update.h"
#include "mpm/test_random.h"

namespace flowrest::mpm {
namespace {

using test::Random;

constexpr int tiles = 300, particles = 64;
constexpr double allowed = 1e-12;

/// What holds beside the law's own yield stress.
enum class Structured { no, linearly, by_power };

/// A tile of particles before the return of their trial stress, anywhere that a scene may lead to.
struct Tile {
  StepParameters<double> step;
  std::vector<double> trial, shear, rate, lambda, stress;

  Tile(Random& random, laws::Law law, Structured structured) {
    const bool thixotropic = structured != Structured::no;
    step.law = law;
    step.thixotropic = thixotropic;
    step.step = random.log_between(1e-6, 1e-2);
    auto& flow = step.flow;
    flow.yield_stress = laws::has_yield_stress(law) ? random.log_between(1e-3, 1e4) : 0.0;
    flow.plastic_viscosity = random.chance(0.1) ? 0.0 : random.log_between(1e-3, 1e3);
    flow.regularisation_time = random.log_between(1e-2, 1e4);
    flow.critical_shear_rate = random.log_between(1e-4, 1e1);
    flow.flocculation_growth = random.chance(0.2) ? 0.0 : random.log_between(1e-5, 10.0);
    flow.deflocculation = random.chance(0.1) ? 0.0 : random.log_between(1e-9, 1e3);
    if (laws::needs(law, laws::Parameter::flow_index))
      flow.flow_index = random.chance(0.1) ? 1.0 : random.between(0.3, 1.5);
    const double yield = std::max(flow.yield_stress, 1e-3);
    for (int q = 0; q < particles; ++q) {
      lambda.push_back(!thixotropic || random.chance(0.2) ? 0.0 : random.log_between(1e-6, 1e3));
      trial.push_back((1.0 + lambda.back()) * yield * random.log_between(1e-3, 1e3));
      shear.push_back(random.log_between(1e3, 1e6) * step.step);
      rate.push_back(random.chance(0.2) ? 0.0 : random.log_between(1e-6, 1e2));
    }
    stress.resize(particles);
    if (structured == Structured::by_power) age(random);
  }

  /// Breakdown by a power of the rate, and growth with age. With a power above 1 breakdown stays so weak that
  /// one rate balances (laws/elasto_viscoplastic.h), lambda tau0 m broken^(1/m) <= G dt.
  void age(Random& random) {
    auto& flow = step.flow;
    flow.grown = random.chance(0.2) ? 0.0 : flow.yield_stress * random.log_between(1e-3, 1e2);
    for (double& stress_of : trial) stress_of += random.between(0.0, 1.0) * flow.grown;
    const double m = flow.breakdown_exponent = random.between(0.3, 2.0);
    if (m <= 1.0) return;
    double most = 1e3;
    for (std::size_t q = 0; q < trial.size(); ++q) {
      const double flocs = (lambda[q] + flow.flocculation_growth * step.step) * flow.yield_stress;
      if (flocs > 0.0) most = std::min(most, std::pow(shear[q] / (m * flocs), m) / step.step);
    }
    flow.deflocculation = std::min(flow.deflocculation, most);
  }

  laws::Parameters<double> parameters() const {
    return {step.flow.yield_stress, step.flow.plastic_viscosity, step.flow.regularisation_time,
            step.flow.critical_shear_rate, step.flow.flow_index};
  }
  laws::Structure<double> structure() const {
    return {step.flow.flocculation_growth, step.flow.deflocculation, step.flow.breakdown_exponent};
  }
  void relax() {
    FLOWREST_KERNEL_SPACE::Strain<double, 2> strain{};
    strain.trial = trial.data();
    strain.shear = shear.data();
    strain.rate = rate.data();
    strain.lambda = lambda.data();
    strain.stress = stress.data();
    FLOWREST_KERNEL_SPACE::relax(step, strain, particles);
  }
};

std::string words(laws::Law law, Structured structured) {
  return std::string(laws::name_of(law)) + (structured == Structured::linearly ? ", thixotropic" : "") +
         (structured == Structured::by_power ? ", thixotropic by a power and ageing" : "");
}

/// Calls use(law, structured) for every law with and without structure.
template <class Use>
void for_every_law(const Use& use) {
  for (const laws::Law law : laws::every_law)
    for (const Structured structured : {Structured::no, Structured::linearly, Structured::by_power})
      if (laws::has_yield_stress(law) || structured == Structured::no) use(law, structured);
}

}  // namespace

TEST(Laws, KernelsReturnTheTrialAsTheLawsSay) {
  for_every_law([](laws::Law law, Structured structured) {
    const bool thixotropic = structured != Structured::no;
    Random random(31);
    double worst_stress = 0.0, worst_rate = 0.0, worst_lambda = 0.0;
    for (int t = 0; t < tiles; ++t) {
      const Tile before(random, law, structured);
      Tile after = before;
      after.relax();
      for (std::size_t q = 0; q < particles; ++q) {
        const laws::Trial<double> trial{before.trial[q], before.shear[q]};
        const auto expected = laws::visit(law, [&](auto own) {
          using Own = decltype(own);
          return thixotropic ? laws::Thixotropic<Own>::relax(before.parameters(), before.structure(), trial,
                                                             before.step.step, before.lambda[q],
                                                             before.rate[q], before.step.flow.grown)
                             : Own::relax(before.parameters(), trial, before.rate[q]);
        });
        worst_stress = std::max(worst_stress, std::abs(after.stress[q] - expected.stress) / trial.stress);
        // Near yield a rate is known as well as the stress that it relaxes.
        worst_rate =
            std::max(worst_rate, std::abs(after.rate[q] - expected.rate) * trial.shear / trial.stress);
        worst_lambda = std::max(worst_lambda,
                                std::abs(after.lambda[q] - expected.flocculation) / (1.0 + before.lambda[q]));
      }
    }
    EXPECT_LT(worst_stress, allowed) << words(law, structured);
    EXPECT_LT(worst_rate, allowed) << words(law, structured);
    EXPECT_LT(worst_lambda, allowed) << words(law, structured);
  });
}

TEST(Laws, KernelsHaveTheFluidsStressesOfTheLaws) {
  for_every_law([](laws::Law law, Structured structured) {
    if (laws::can_rest(law)) return;
    Random random(32);
    for (int t = 0; t < tiles; ++t) {
      const Tile before(random, law, structured);
      Tile after = before;
      after.step.explicit_fluid = true;  // of which the trial is the rate
      after.relax();
      for (std::size_t q = 0; q < particles; ++q) {
        laws::FlowCurve curve{law, before.parameters()};
        if (structured != Structured::no)
          curve.parameters.yield_stress =
              curve.parameters.yield_stress *
                  (1.0 + before.structure().stepped(before.lambda[q], before.rate[q], before.step.step)) +
              before.step.flow.grown;
        const double expected = curve.stress(before.trial[q]);
        ASSERT_NEAR(after.stress[q], expected, allowed * expected) << words(law, structured);
        ASSERT_EQ(after.rate[q], before.trial[q]);
      }
    }
  });
}

TEST(Laws, KernelsHaveTheirEquationOfState) {
  const laws::EquationOfState<double> law{3e5, 4e4, 7.0};
  const EquationOfState<double> kernels{3e5, 4e4, 7.0};
  for (double ratio = 0.8; ratio < 1.2; ratio += 1e-3) {
    const auto state = kernels.at(ratio);
    ASSERT_NEAR(state.pressure, law.pressure(ratio), allowed * 3e5);
    ASSERT_NEAR(state.shear, law.shear(ratio), allowed * 4e4);
    ASSERT_NEAR(kernels.energy(ratio), law.energy(ratio), allowed * 3e5);
  }
}

}  // namespace flowrest::mpm
