// Whole slumps against what is known of them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elements/run.h"
#include "elements/test_problems.h"

using namespace flowrest::elements;
using namespace flowrest::elements::test;

TEST(ElementsVerification, RousselsSlumpIsThatOfAnIndependentProgram) {
  // Sharp values at 3 mm of another finite element program, each known to 1 mm.
  Slump slump(roussel(), resolution_of(roussel(), 60));
  for (const auto& [time, spread] : {std::pair{0.5, 402.5},
                                     {1.0, 442.1},
                                     {2.0, 476.5},
                                     {5.0, 513.0},
                                     {10.0, 532.5},
                                     {20.0, 545.3},
                                     {30.0, 550.2},
                                     {60.0, 555.9}}) {
    advance(slump, time);
    EXPECT_NEAR(spread_mm(slump) / spread, 1.0, 3e-3) << time;
  }
  EXPECT_NEAR(1e3 * slump.surface().markers().front().y(), 38.3, 0.3);
}

TEST(ElementsVerification, ANewtonianSlumpBecomesHuppertsCurrent) {
  // R = 0.894 (g V^3 / (3 nu))^(1/8) t^(1/8) (Huppert 1982), which a cone reaches late: what its fall delays
  // it by is a second or less of ten.
  Slump slump(newtonian(), coarse(36, 6, 0.03));
  advance(slump, 10.0);
  EXPECT_NEAR(spread_mm(slump) / 633.9, 1.0, 5e-3);
}

TEST(ElementsVerification, APlaneSlumpComesToTheParabolaThatItsYieldStressHolds) {
  // (h - a)^2 = 2 tau0 (X - x) / (rho g) + const, away from nose and middle: the base carries tau0 against
  // the weight, less the pull of the plug above it. In a plane it is 2 tau0 pi / 4 in the mean over the
  // depth, so a = (pi / 2) tau0 / (rho g). The slump comes to it from above.
  Problem plane = roussel();
  plane.symmetry = Symmetry::plane;
  plane.domain_radius = 3.0;
  plane.height = 0.1;
  Slump slump(plane, coarse(36, 6, 0.03));
  const double volume = slump.surface().volume(Symmetry::plane);
  advance(slump, 60.0);
  EXPECT_NEAR(slump.surface().volume(Symmetry::plane) / volume, 1.0, 1e-6);
  const double foot = slump.surface().radius();
  const double length = 50.0 / (2300.0 * 9.81), pull = 0.5 * std::numbers::pi * length;
  const auto square = [&](double x) { return std::pow(slump.surface().depth(x) - pull, 2); };
  const double slope = (square(0.4 * foot) - square(0.8 * foot)) / (0.4 * foot);
  EXPECT_NEAR(slope / (2.0 * length), 1.0, 0.08);
}
