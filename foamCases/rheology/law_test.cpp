// The laws at a point, without OpenFOAM.
#include "foamCases/rheology/law.h"

#include <gtest/gtest.h>

#include "foamCases/rheology/wetting.h"
#include "foamCases/viscosity.h"

namespace flowrest::rheology {
namespace {

constexpr double yield = 50.0, viscosity = 30.0, modulus = 4e4;

TEST(Law, RegularisedViscositiesHaveTheirLimits) {
  EXPECT_DOUBLE_EQ(papanastasiou_viscosity(viscosity, yield, 100.0, 0.0), viscosity + 100.0 * yield);
  EXPECT_NEAR(papanastasiou_viscosity(viscosity, yield, 100.0, 1e-12), viscosity + 100.0 * yield, 1e-6);
  EXPECT_NEAR(papanastasiou_viscosity(viscosity, yield, 100.0, 10.0), viscosity + yield / 10.0, 1e-12);
  EXPECT_DOUBLE_EQ(bi_viscous_viscosity(viscosity, yield, 0.01, 1e-6), viscosity + yield / 0.01);
  EXPECT_DOUBLE_EQ(bi_viscous_viscosity(viscosity, yield, 0.01, 2.0), viscosity + yield / 2.0);
  scenes::Material material;
  material.density = 2000.0;
  material.yield_stress = yield;
  material.plastic_viscosity = viscosity;
  material.regularisation_time = 100.0;
  for (double rate = 1e-8; rate < 1e3; rate *= 3.0)  // the two implementations of the law
    EXPECT_NEAR(papanastasiou_viscosity(viscosity, yield, 100.0, rate),
                2000.0 * foam::papanastasiou_viscosity(material, rate),
                1e-10 * viscosity + 1e-12 * yield * 100.0);
}

/// Constant shear from rest: tau = G rate t up to yield, then tau0 + eta rate (1 - exp(-G (t - t_y) / eta)).
TEST(Law, ElasticStartYieldsAndReachesTheBinghamStress) {
  const ElastoViscoplastic law{yield, viscosity, 0.0, 0.0};
  const double rate = 0.5, dt = 1e-6, yields_at = yield / (modulus * rate);
  double stress = 0.0, time = 0.0;
  while (time < 5.0 * viscosity / modulus + yields_at) {
    stress = relax(law, stress + modulus * dt * rate, modulus * dt, dt, 0.0).stress;
    time += dt;
    const double exact =
        time < yields_at
            ? modulus * rate * time
            : yield + viscosity * rate * (1.0 - std::exp(-modulus * (time - yields_at) / viscosity));
    ASSERT_NEAR(stress, exact, 0.02) << time;
  }
}

/// Left alone, stress above yield relaxes to it and no further: the material is at rest under load.
TEST(Law, AtRestTheYieldStressStays) {
  const ElastoViscoplastic law{yield, viscosity, 0.0, 0.0};
  double stress = 80.0;
  for (int i = 0; i < 100000; ++i) stress = relax(law, stress, modulus * 1e-3, 1e-3, 0.0).stress;
  EXPECT_NEAR(stress, yield, 1e-12);
  EXPECT_EQ(relax(law, 49.9, modulus * 1e-3, 1e-3, 0.0).rate, 0.0);
}

/// The closed form against what it solves (Yu et al. 2026, Eqs. 38, 39 and 45): at the returned rate the
/// stress of the law, with the flocculation of that rate, is the trial's less the elastic relaxation; for
/// alphas that cancel as printed.
TEST(Law, TheReturnMapBalancesForEveryBreakdown) {
  for (const double alpha : {0.0, 1e-12, 1e-6, 0.15, 1.0, 1e3})
    for (const double trial : {60.0, 150.0, 1e3, 1e6})
      for (const double lambda : {0.0, 0.5, 1.8}) {
        const ElastoViscoplastic law{yield, viscosity, 0.39 / yield, alpha};
        const double dt = 1e-3, shear = modulus * dt;
        const auto relaxed = relax(law, trial, shear, dt, lambda);
        if (relaxed.rate == 0.0) {
          EXPECT_LE(trial, (1.0 + lambda + law.flocculation_growth * dt) * yield);
          continue;
        }
        const double expected = (1.0 + relaxed.flocculation) * yield + viscosity * relaxed.rate;
        EXPECT_NEAR(relaxed.stress, expected, 1e-9 * trial) << alpha << " " << trial << " " << lambda;
        EXPECT_NEAR(relaxed.flocculation,
                    (lambda + law.flocculation_growth * dt) / (1.0 + dt * alpha * relaxed.rate),
                    1e-12 * (1 + lambda));
      }
}

/// Area below a straight line through the unit square that leaves the share `wetted` of the base under it, by
/// counting.
double area_below(double m1, double m2, double c) {
  const int n = 2000;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double x = (i + 0.5) / n;
    sum += std::clamp((c - m1 * x) / m2, 0.0, 1.0) / n;
  }
  return sum;
}

TEST(Wetting, IsThatOfAStraightSurface) {
  for (const double m1 : {0.1, 0.3, 0.5, 0.8, 0.95})
    for (double c = 0.02; c < 1.0; c += 0.049) {
      const double m2 = 1.0 - m1, area = area_below(m1, m2, c);
      if (area < dust) continue;
      EXPECT_NEAR(wetted_share(area, m2, m1), std::min(1.0, c / m1), 5e-3) << m1 << " " << c;
    }
}

TEST(Wetting, ALayerTouchesAllAFrontItsPart) {
  EXPECT_EQ(wetted_share(0.1, 1.0, 0.0), 1.0);
  EXPECT_EQ(wetted_share(0.3, 0.0, 1.0), 0.3);
  EXPECT_EQ(wetted_share(0.9, -1.0, 0.0), 0.9) << "a cushion of air";
  EXPECT_EQ(wetted_share(0.0, 1.0, 1.0), 0.0);
  EXPECT_EQ(wetted_share(1.0, -1.0, 1.0), 1.0);
  EXPECT_EQ(wetted_share(0.4, 0.0, 0.0), 0.4);
  EXPECT_NEAR(wetted_share(0.5 * dust, 1.0, 0.0), 0.5, 1e-12);
}

}  // namespace
}  // namespace flowrest::rheology
