#include "elements/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elements/test_problems.h"

using namespace flowrest::elements;
using namespace flowrest::elements::test;

TEST(Surface, OfAConeHasItsVolumeAndReads199MillimetresAtThree) {
  const Surface cone = Surface::of_cone(roussel(), 1400);
  EXPECT_NEAR(cone.volume(Symmetry::about_axis), std::numbers::pi * 0.1 * (0.01 + 0.005 + 0.0025), 1e-12);
  EXPECT_NEAR(cone.volume(Symmetry::plane), 0.3 * 0.15, 1e-12);
  EXPECT_NEAR(1e3 * cone.spread(0.003), 199.0, 1e-6);
  EXPECT_NEAR(cone.depth(0.0), 0.3, 1e-12);
  EXPECT_NEAR(cone.depth(0.075), 0.15, 1e-12);
  EXPECT_EQ(cone.depth(0.11), 0.0);
}

TEST(Surface, DepthOverThePlanIsTheVolume) {
  const Surface surface({{0.0, 0.04}, {0.1, 0.035}, {0.2, 0.02}, {0.21, 0.008}, {0.2, 0.0}});
  double sum = 0.0;
  constexpr int rings = 20000;
  for (int i = 0; i < rings; ++i) {
    const double r = 0.22 * (i + 0.5) / rings;
    sum += surface.depth(r) * 2.0 * std::numbers::pi * r * 0.22 / rings;
  }
  EXPECT_NEAR(sum, surface.volume(Symmetry::about_axis), 1e-6 * sum);
}

TEST(Surface, LeavesOutTheGapUnderAnOverhang) {
  // From the toe at 200 mm the front leans out to 210 mm at a height of 8 mm.
  const Surface surface({{0.0, 0.02}, {0.2, 0.02}, {0.21, 0.008}, {0.2, 0.0}});
  EXPECT_NEAR(surface.radius(), 0.21, 1e-15);
  EXPECT_NEAR(surface.depth(0.205), 0.014 - 0.004, 1e-12);
  // 20 mm of depth at 200 mm, none at 210 mm: it falls through 3 mm at 208.5 mm.
  EXPECT_NEAR(surface.spread(0.003), 0.417, 1e-8);
}

TEST(Surface, WhereAFrontIsUprightItsPlaceIsTheSpread) {
  const Surface surface({{0.0, 0.02}, {0.2, 0.02}, {0.2, 0.0}});
  EXPECT_NEAR(surface.spread(0.003), 0.4, 1e-8);
  EXPECT_TRUE(std::isnan(surface.spread(0.03)));
}

TEST(Surface, EndsWhereItHasComeDownToTheFloor) {
  const Surface below =
      landed({{0.0, 0.03}, {0.1, 0.02}, {0.12, -0.02}, {0.11, 0.001}, {0.1, 0.0}}, 1e-6, 0.0);
  ASSERT_EQ(below.markers().size(), 3U);
  EXPECT_NEAR(below.toe().x(), 0.11, 1e-12);
  EXPECT_EQ(below.toe().y(), 0.0);
  const Surface on_it = landed({{0.0, 0.03}, {0.1, 0.02}, {0.12, 1e-7}, {0.1, 0.0}}, 1e-6, 0.0);
  EXPECT_NEAR(on_it.toe().x(), 0.12, 1e-12);
}

TEST(Surface, ClosesASlimWedgeUnderItsFrontAndKeepsAWideOne) {
  EXPECT_NEAR(landed({{0.0, 0.03}, {0.1, 0.02}, {0.12, 0.001}, {0.1, 0.0}}, 1e-6, 0.07).toe().x(), 0.12,
              1e-12);
  EXPECT_NEAR(landed({{0.0, 0.03}, {0.1, 0.02}, {0.12, 0.002}, {0.1, 0.0}}, 1e-6, 0.07).toe().x(), 0.1,
              1e-12);
}

TEST(Surface, IsGivenAVolumeByItsHeights) {
  const Surface cone = Surface::of_cone(roussel(), 100);
  const double volume = 1.001 * cone.volume(Symmetry::about_axis);
  const Surface other = with_volume(cone, Symmetry::about_axis, volume);
  EXPECT_NEAR(other.volume(Symmetry::about_axis), volume, 1e-15);
  EXPECT_EQ(other.toe(), cone.toe());
}
