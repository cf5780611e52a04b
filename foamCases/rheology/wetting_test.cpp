// How much of a wall concrete wets, without OpenFOAM.
#include "foamCases/rheology/wetting.h"

#include <gtest/gtest.h>

namespace flowrest::rheology {
namespace {

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
