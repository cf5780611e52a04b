#include "compare/exact/solutions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "compare/exact/creep.h"

using namespace flowrest::compare::exact;
using flowrest::laws::Law;

namespace {

const double cone_volume = std::numbers::pi * 0.3 / 3.0 * (0.1 * 0.1 + 0.1 * 0.05 + 0.05 * 0.05);

Bingham concrete(double yield_stress) { return {2300.0, yield_stress, 50.0}; }

/// 2 pi int r h dr by the midpoint rule.
double integrated_volume(const ArrestedSlump& slump) {
  const int rings = 200000;
  double sum = 0.0;
  for (int i = 0; i < rings; ++i) {
    const double r = slump.radius * (i + 0.5) / rings;
    sum += 2.0 * std::numbers::pi * r * slump.depth(r) * slump.radius / rings;
  }
  return sum;
}

}  // namespace

TEST(ArrestedSlump, LeadingOrderOfTheRousselScene) {
  const ArrestedSlump slump = leading_order_slump(concrete(50.0), 9.81, cone_volume);
  EXPECT_NEAR(2000.0 * slump.radius, 600.0, 0.05);
  EXPECT_NEAR(1000.0 * slump.depth(0.0), 36.5, 0.05);
  EXPECT_NEAR(slump.volume() / cone_volume, 1.0, 1e-12);
  EXPECT_NEAR(integrated_volume(slump) / cone_volume, 1.0, 1e-6);
}

TEST(ArrestedSlump, LeadingOrderOfOtherYieldStresses) {
  const std::pair<double, double> known[] = {{25.0, 689.2}, {100.0, 522.3}, {200.0, 454.7}};
  for (const auto& [yield_stress, spread_mm] : known)
    EXPECT_NEAR(2000.0 * leading_order_slump(concrete(yield_stress), 9.81, cone_volume).radius, spread_mm,
                0.06)
        << "yield stress " << yield_stress;
}

TEST(ArrestedSlump, SecondOrderOfTheRousselScene) {
  const ArrestedSlump slump = second_order_slump(concrete(50.0), 9.81, cone_volume);
  EXPECT_NEAR(2000.0 * slump.radius, 562.0, 0.5);
  EXPECT_NEAR(1000.0 * slump.depth(0.0), 38.4, 0.05);
  EXPECT_NEAR(1000.0 * slump.depth(slump.radius), 6.0, 0.1) << "a blunt nose";
  EXPECT_NEAR(slump.volume() / cone_volume, 1.0, 1e-12);
  EXPECT_NEAR(integrated_volume(slump) / cone_volume, 1.0, 1e-6);
  EXPECT_EQ(slump.depth(1.001 * slump.radius), 0.0);
}

TEST(ArrestedSlump, TheBaseCarriesTheYieldStress) {
  const ArrestedSlump slump = leading_order_slump(concrete(50.0), 9.81, cone_volume);
  for (const double r : {0.05, 0.15, 0.25}) {
    const double slope = (slump.depth(r + 1e-6) - slump.depth(r - 1e-6)) / 2e-6;
    EXPECT_NEAR(-2300.0 * 9.81 * slump.depth(r) * slope, 50.0, 1e-4) << "r " << r;
  }
}

TEST(ArrestedSlump, SpreadAtAThresholdInvertsTheProfile) {
  for (const auto& slump : {leading_order_slump(concrete(50.0), 9.81, cone_volume),
                            second_order_slump(concrete(50.0), 9.81, cone_volume)}) {
    EXPECT_NEAR(slump.depth(0.5 * slump.spread(0.02)), 0.02, 1e-12);
    EXPECT_TRUE(std::isnan(slump.spread(0.05)));
  }
  EXPECT_NEAR(1000.0 * leading_order_slump(concrete(50.0), 9.81, cone_volume).spread(0.003), 595.9, 0.1);
  const ArrestedSlump blunt = second_order_slump(concrete(50.0), 9.81, cone_volume);
  EXPECT_EQ(blunt.spread(0.003), 2.0 * blunt.radius) << "the nose is deeper than 3 mm";
  EXPECT_TRUE(std::isnan(blunt.spread(1.0))) << "nowhere so deep: nothing is read";
}

TEST(ArrestedPlaneSlump, HoldsItsAreaAndFollowsTheKnownLength) {
  const ArrestedPlaneSlump slump = plane_slump({1000.0, 40.0, 1.0}, 10.0, 0.02);
  EXPECT_NEAR(slump.half_area(), 0.02, 1e-15);
  // Lengths over H0, of a rectangle X0 by 1: X = (9 X0^2/(8 B))^(1/3), B = tau0/(rho g H0).
  const double height = 0.1, x0 = 0.02 / height / height, b = 40.0 / (1000.0 * 10.0 * height);
  EXPECT_NEAR(slump.half_width / height, std::cbrt(9.0 * x0 * x0 / (8.0 * b)), 1e-12);
  EXPECT_NEAR(slump.depth(0.5 * slump.spread(0.003)), 0.003, 1e-12);
}

TEST(DuctFlow, PlugAndMeanVelocities) {
  const double known[][3] = {{10.0, 2.000833, 1.347228},
                             {50.0, 1.687500, 1.181250},
                             {100.0, 1.333333, 0.977778},
                             {200.0, 0.750000, 0.600000}};
  for (const auto& [yield_stress, plug, mean] : known) {
    const DuctFlow flow{{2000.0, yield_stress, 30.0}, 0.5, 2000.0};
    EXPECT_NEAR(flow.plug_velocity(), plug, 1e-6) << "yield stress " << yield_stress;
    EXPECT_NEAR(flow.mean_velocity(), mean, 1e-6) << "yield stress " << yield_stress;
    double sum = 0.0, squares = 0.0;
    const int layers = 100000;
    for (int i = 0; i < layers; ++i) {
      const double v = flow.velocity(-0.25 + 0.5 * (i + 0.5) / layers);
      sum += v / layers;
      squares += v * v * 0.5 / layers;
    }
    EXPECT_NEAR(sum, flow.mean_velocity(), 1e-8);
    EXPECT_NEAR(std::sqrt(squares), flow.l2_norm(), 1e-8);
    EXPECT_EQ(flow.velocity(0.25), 0.0);
  }
}

/// The flow curve integrated from the wall, by the midpoint rule.
TEST(DuctFlow, WithAFlowIndexIsTheIntegralOfItsLaw) {
  for (const double n : {0.3, 0.5, 1.0, 1.3, 1.5}) {
    const DuctFlow flow{{2000.0, 100.0, 30.0, n}, 0.5, 2000.0};
    constexpr int layers = 200000;
    const double dy = 0.25 / layers;
    double velocity = 0.0, sum = 0.0, squares = 0.0;
    for (int i = 0; i < layers; ++i) {
      const double y = 0.25 - (i + 0.5) * dy;
      const double step = std::pow(std::max(2000.0 * y - 100.0, 0.0) / 30.0, 1.0 / n) * dy;
      velocity += 0.5 * step;
      sum += velocity / layers;
      squares += 2.0 * velocity * velocity * dy;
      velocity += 0.5 * step;
    }
    EXPECT_NEAR(flow.plug_velocity() / velocity, 1.0, 1e-8) << n;
    EXPECT_NEAR(flow.mean_velocity() / sum, 1.0, 1e-8) << n;
    EXPECT_NEAR(flow.l2_norm() / std::sqrt(squares), 1.0, 1e-8) << n;
  }
}

TEST(Creep, OfAHerschelBulkleyFluidIsThatOfItsLaw) {
  // Without a yield stress and far past the regularisation it is the power law's duct.
  for (const double n : {0.5, 1.3}) {
    const auto fluid = regularised_fluid(Law::herschel_bulkley, 0.0, 30.0, 1e6, n);
    const DuctFlow flow{{2000.0, 0.0, 30.0, n}, 0.5, 360.0};
    EXPECT_NEAR(duct_creep(fluid, 0.5, 360.0) / flow.plug_velocity(), 1.0, 1e-5) << n;
  }
}

TEST(DuctFlow, IsAtRestBelowYield) {
  const DuctFlow flow{{2000.0, 100.0, 30.0}, 0.5, 360.0};  // yields from 400 N/m3
  EXPECT_EQ(flow.plug_velocity(), 0.0);
  EXPECT_EQ(flow.mean_velocity(), 0.0);
  EXPECT_GT((DuctFlow{{2000.0, 100.0, 30.0}, 0.5, 401.0}.plug_velocity()), 0.0);
}

TEST(DuctFlow, StoppingTimeBound) {
  const Bingham material{2000.0, 100.0, 30.0};
  const double start = DuctFlow{material, 0.5, 2000.0}.l2_norm();
  EXPECT_NEAR(stopping_time_bound(material, 0.5, 360.0, start), 5.87, 0.005);
  EXPECT_TRUE(std::isinf(stopping_time_bound(material, 0.5, 400.0, start)));
  // With the force removed the flow stops at 2.071 s: the bound must not be shorter.
  EXPECT_GT(stopping_time_bound(material, 0.5, 0.0, start), 2.071);
  const Bingham inviscid{2000.0, 100.0, 0.0};
  EXPECT_NEAR(stopping_time_bound(inviscid, 0.5, 360.0, start),
              stopping_time_bound({2000.0, 100.0, 1e-9}, 0.5, 360.0, start), 1e-6);
}

/// A power of the rate only adds to what stops: its bound leaves the viscosity out, and holds for every flow of
/// that law. A plug that slows with no viscosity at all needs exactly norm / b.
TEST(DuctFlow, StoppingTimeBoundOfAPowerIsThatWithoutViscosity) {
  for (const double n : {0.5, 1.4}) {
    const Bingham power{2000.0, 100.0, 30.0, n}, inviscid{2000.0, 100.0, 0.0};
    const double start = DuctFlow{power, 0.5, 2000.0}.l2_norm();
    EXPECT_GT(start, 0.0);
    EXPECT_DOUBLE_EQ(stopping_time_bound(power, 0.5, 360.0, start),
                     start * 2000.0 * std::sqrt(0.5) / (2.0 * (100.0 - 0.5 * 360.0 * 0.5)))
        << n;
    EXPECT_NEAR(stopping_time_bound(power, 0.5, 360.0, start),
                stopping_time_bound(inviscid, 0.5, 360.0, start), 1e-12);
    EXPECT_GT(stopping_time_bound(power, 0.5, 360.0, start),
              stopping_time_bound({2000.0, 100.0, 30.0}, 0.5, 360.0, start));
  }
}

TEST(Creep, TheFlowCurveInverts) {
  for (const auto law : {Law::papanastasiou, Law::bi_viscous})
    for (const double m : {0.0, 10.0, 1e4})
      for (const double stress : {1e-6, 25.0, 50.0, 50.1, 500.0}) {
        const RegularisedFluid fluid = regularised_fluid(law, 50.0, 50.0, m);
        EXPECT_NEAR(fluid.stress(fluid.rate(stress)), stress, 1e-10 * stress) << "m " << m;
      }
}

TEST(Creep, BiViscousFilmIsClosed) {
  const RegularisedFluid fluid = regularised_fluid(Law::bi_viscous, 50.0, 50.0, 100.0);
  EXPECT_NEAR(film_velocity(fluid, 0.026, 50.0), 50.0 * 0.026 / (3.0 * 5050.0), 1e-12);
  EXPECT_EQ(film_velocity(fluid, 0.026, 0.0), 0.0);
}

TEST(Creep, OfTheArrestedRousselSlump) {
  const ArrestedSlump slump = leading_order_slump(concrete(50.0), 9.81, cone_volume);
  const double depth = slump.depth(0.5 * slump.radius);
  const auto velocity = [&](double m) {
    return film_velocity(regularised_fluid(Law::papanastasiou, 50.0, 50.0, m), depth, 50.0);
  };
  EXPECT_NEAR(velocity(10.0), 1.2e-3, 5e-5);
  EXPECT_NEAR(velocity(1e4), 1.9e-6, 5e-8);
  // For large m the plastic viscosity drops out: int_0^1 s (-ln(1 - s)) ds = 3/4.
  EXPECT_NEAR(velocity(1e9) * 1e9 / depth, 0.75, 1e-4);
}

TEST(Creep, OfASpreadSlowsPastTheArrestedRadius) {
  const RegularisedFluid fluid = regularised_fluid(Law::bi_viscous, 50.0, 50.0, 100.0);
  const double at_arrest = 4.0 * 50.0 * 0.026 / (3.0 * 5050.0);
  EXPECT_NEAR(spread_creep(fluid, 0.3, 0.026, 0.3), at_arrest, 1e-12);
  EXPECT_EQ(spread_creep(fluid, 0.3, 0.026, 0.28), spread_creep(fluid, 0.3, 0.026, 0.3));
  // Below yield the bi-viscous film is Newtonian: u ~ stress depth ~ R^-7.
  EXPECT_NEAR(spread_creep(fluid, 0.3, 0.026, 0.33), at_arrest * std::pow(0.3 / 0.33, 7), 1e-12);
}

TEST(Creep, OfTheSteppedDownDuct) {
  const std::pair<double, double> known[] = {
      {10.0, 1.69e-2}, {100.0, 1.84e-3}, {1e3, 1.86e-4}, {1e4, 1.86e-5}};
  for (const auto& [m, velocity] : known)
    EXPECT_NEAR(duct_creep(regularised_fluid(Law::papanastasiou, 100.0, 30.0, m), 0.5, 360.0) / velocity, 1.0,
                4e-3)
        << "m " << m;
  // A Newtonian duct: F H^2/(8 eta).
  EXPECT_NEAR(duct_creep(regularised_fluid(Law::papanastasiou, 0.0, 30.0, 0.0), 0.5, 360.0), 0.375, 1e-9);
}
