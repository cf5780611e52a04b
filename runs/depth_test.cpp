#include "runs/depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

using namespace flowrest::runs;

namespace {

/// Depth of a paraboloid h0 (1 - r^2/R^2), spread into rings by `samples` thin shells of equal width.
DepthAccumulator sampled_paraboloid(double spacing, double centre, double radius, int samples) {
  DepthAccumulator rings(About::axis, spacing, 2.0 * radius, radius / samples);
  for (int i = 0; i < samples; ++i) {
    const double width = radius / samples;
    const double r = (i + 0.5) * width;
    rings.add(r, 2.0 * std::numbers::pi * r * width * centre * (1.0 - r * r / (radius * radius)));
  }
  return rings;
}

}  // namespace

TEST(DepthAccumulator, KeepsTheVolumeWhateverTheSampling) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(0.0, 0.5), volume(0.0, 1e-6);
  // A part of the volumes lies beyond the last ring.
  DepthAccumulator rings(About::axis, 0.01, 0.3, 0.004), strips(About::plane, 0.01, 0.3, 0.004);
  double total = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double v = volume(random), p = place(random);
    rings.add(p, v);
    strips.add(p, v);
    total += v;
  }
  double sum = 0.0;
  for (const double depth : strips.depth()) sum += 0.01 * depth;
  EXPECT_NEAR(sum, total, 1e-12 * total);
  EXPECT_NEAR((RadialDepth{0.01, rings.depth()}.volume()), total, 1e-12 * total);
}

TEST(DepthAccumulator, AUniformLayerIsUniformUpToTheAxis) {
  const double spacing = 0.01, height = 0.04, radius = 0.2;
  for (const double grain : {0.002, 0.005, 0.01}) {
    DepthAccumulator rings(About::axis, spacing, 0.3, grain), strips(About::plane, spacing, 0.3, grain);
    const int samples = 200000;
    for (int i = 0; i < samples; ++i) {
      const double width = radius / samples;
      const double r = (i + 0.5) * width;
      rings.add(r, 2.0 * std::numbers::pi * r * width * height);
      strips.add(r, width * height);
    }
    const auto round = rings.depth(), plane = strips.depth();
    for (std::size_t ring = 0; ring < 19; ++ring) {
      EXPECT_NEAR(round[ring], height, 1e-6 * height) << "ring " << ring << ", grain " << grain;
      EXPECT_NEAR(plane[ring], height, 1e-6 * height) << "strip " << ring << ", grain " << grain;
    }
  }
}

TEST(DepthAccumulator, RefusesWhatIsNoPlaceAndNoRing) {
  DepthAccumulator rings(About::axis, 0.01, 0.3, 0.005);
  EXPECT_THROW(rings.add(-0.1, 1.0), std::invalid_argument);
  EXPECT_THROW(rings.add(std::numeric_limits<double>::quiet_NaN(), 1.0), std::invalid_argument);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(DepthAccumulator(About::axis, 0.0, 0.3, 0.005), std::invalid_argument);
  EXPECT_THROW(DepthAccumulator(About::axis, 0.01, infinite, 0.005), std::invalid_argument);
  EXPECT_THROW(DepthAccumulator(About::axis, 0.01, 0.3, 0.011), std::invalid_argument);
  EXPECT_THROW(DepthAccumulator(About::axis, 0.01, 0.3, 0.0), std::invalid_argument);
}

TEST(Gauges, ThatHaveNothingToReadGiveNothingAndNeverZero) {
  const std::vector<double> place = {0.5, 1.5, 2.5}, thin = {0.002, 0.002, 0.001};
  EXPECT_TRUE(std::isnan(spread({place, thin}, 0.003)));
  EXPECT_TRUE(std::isnan(spread({}, 0.003)));
  EXPECT_TRUE(std::isnan(front(place, thin, 3.0, 0.003)));
  EXPECT_TRUE(std::isnan(front({}, {}, 3.0, 0.003)));
  EXPECT_TRUE(std::isnan(centre_depth({}, 0.003)));
  EXPECT_TRUE(std::isnan(depth_at_end({}, 1.0, ChannelEnd::last, 1.0)));
  // Where it is dry the depth is known: that is a reading.
  EXPECT_EQ(depth_at_end(std::vector{1.0, 0.0}, 1.0, ChannelEnd::last, 1.0), 0.0);
}

TEST(Front, IsReadAtTheDepthItIsGivenAndStopsAtTheWall) {
  // h = 0.02 - 0.004 x over strips of 1 m, so that x = 5 - h / 0.004.
  const std::vector<double> place = {0.5, 1.5, 2.5, 3.5, 4.5, 5.5},
                            depth = {0.018, 0.014, 0.01, 0.006, 0.002, 0.0};
  EXPECT_NEAR(front(place, depth, 6.0, 0.003), 4.25, 1e-5);
  EXPECT_NEAR(front(place, depth, 6.0, 0.001), 4.75, 1e-5);
  EXPECT_NEAR(front(place, depth, 6.0, 0.007), 3.25, 1e-5);
  EXPECT_DOUBLE_EQ(front(std::vector{0.5, 1.5, 2.5}, std::vector{0.0, 0.0, 0.01}, 3.0, 0.003), 3.0);
}

TEST(DepthAtEnd, IsTheMeanOverTheLengthItIsGiven) {
  const std::vector<double> depth = {0.4, 0.2, 0.1, 0.3};
  EXPECT_DOUBLE_EQ(depth_at_end(depth, 0.01, ChannelEnd::last, 0.02), 0.2);
  EXPECT_DOUBLE_EQ(depth_at_end(depth, 0.01, ChannelEnd::first, 0.002), 0.4);
  EXPECT_DOUBLE_EQ(depth_at_end(depth, 0.01, ChannelEnd::first, 1.0), 0.25);
}

TEST(CentreDepth, IsExactForAPlateauAndForALine) {
  std::vector<double> radius, line, plateau;
  for (double r = 0.005; r < 0.4; r += 0.01) {
    radius.push_back(r);
    line.push_back(r < 0.3 ? 0.04 - 0.1 * r : 0.0);
    plateau.push_back(r < 0.1 ? 0.3 : r < 0.2 ? 0.1 : 0.0);
  }
  EXPECT_NEAR(centre_depth({radius, line}, 0.003), 0.04, 1e-15);
  EXPECT_NEAR(centre_depth({radius, plateau}, 0.003), 0.3, 1e-15);
  const std::vector<double> two = {0.1, 0.3}, line_of_two = {0.04, 0.02}, one = {0.005},
                            depth_of_one = {0.04};
  EXPECT_NEAR(centre_depth({two, line_of_two}, 0.003), 0.05, 1e-15);
  EXPECT_DOUBLE_EQ(centre_depth({one, depth_of_one}, 0.003), 0.04);
}

TEST(CentreDepth, HardlyMindsTheInnermostRing) {
  std::vector<double> radius, depth;
  for (double r = 0.005; r < 0.4; r += 0.01) {
    radius.push_back(r);
    depth.push_back(r < 0.28 ? 0.04 - 0.1 * r : 0.0);
  }
  depth.front() += 0.004;
  EXPECT_NEAR(centre_depth({radius, depth}, 0.003), 0.04, 0.002);
}

TEST(CentreDepth, OfASampledParaboloidIsTakenForALineOverAQuarterOfItsRadius) {
  // By least squares over the area a line's value at 0 is 0.3 of the parabola's fall over the window too
  // high.
  for (const double spacing : {0.02, 0.01, 0.005}) {
    const DepthAccumulator rings = sampled_paraboloid(spacing, 0.04, 0.3, 60000);
    const auto radius = rings.centres(), depth = rings.depth();
    EXPECT_NEAR(centre_depth({radius, depth}, 0.003), 0.04 * (1.0 + 0.3 / 16.0), 4e-4)
        << "spacing " << spacing;
  }
}
