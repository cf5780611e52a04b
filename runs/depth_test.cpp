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
RadialDepth sampled_paraboloid(double spacing, double centre, double radius, int samples) {
  RadialDepthAccumulator rings(spacing, 2.0 * radius);
  for (int i = 0; i < samples; ++i) {
    const double width = radius / samples;
    const double r = (i + 0.5) * width;
    rings.add(r, 2.0 * std::numbers::pi * r * width * centre * (1.0 - r * r / (radius * radius)));
  }
  return rings.depth();
}

}  // namespace

TEST(RadialDepth, KeepsTheVolumeWhateverTheSampling) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> radius(0.0, 0.5), volume(0.0, 1e-6);
  RadialDepthAccumulator rings(0.01, 0.3);  // a part of the volumes lies beyond the last ring
  double total = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double v = volume(random);
    rings.add(radius(random), v);
    total += v;
  }
  EXPECT_NEAR(rings.depth().volume(), total, 1e-12 * total);
}

TEST(RadialDepth, AUniformLayerIsUniformUpToTheAxis) {
  const double spacing = 0.01, height = 0.04, radius = 0.2;
  RadialDepthAccumulator rings(spacing, 0.3);
  const int samples = 200000;
  for (int i = 0; i < samples; ++i) {
    const double width = radius / samples;
    const double r = (i + 0.5) * width;
    rings.add(r, 2.0 * std::numbers::pi * r * width * height);
  }
  const auto depth = rings.depth().depth;
  for (std::size_t ring = 0; ring < 19; ++ring)
    EXPECT_NEAR(depth[ring], height, 1e-6 * height) << "ring " << ring;
}

TEST(RadialDepth, RefusesWhatIsNotARadius) {
  RadialDepthAccumulator rings(0.01, 0.3);
  EXPECT_THROW(rings.add(-0.1, 1.0), std::invalid_argument);
  EXPECT_THROW(rings.add(std::numeric_limits<double>::quiet_NaN(), 1.0), std::invalid_argument);
  EXPECT_THROW(RadialDepthAccumulator(0.0, 0.3), std::invalid_argument);
  EXPECT_THROW(RadialDepthAccumulator(0.01, std::numeric_limits<double>::infinity()), std::invalid_argument);
}

TEST(Spread, OfAnAnalyticProfileAtThreeThresholds) {
  // h = 0.036 sqrt(1 - r/0.3): falls through t at r = 0.3 (1 - (t/0.036)^2).
  const double spacing = 1e-4;
  std::vector<double> radius, depth;
  for (double r = spacing / 2; r < 0.4; r += spacing) {
    radius.push_back(r);
    depth.push_back(r < 0.3 ? 0.036 * std::sqrt(1.0 - r / 0.3) : 0.0);
  }
  for (const double threshold : {0.0015, 0.003, 0.006}) {
    const double exact = 0.6 * (1.0 - std::pow(threshold / 0.036, 2));
    EXPECT_NEAR(spread(radius, depth, threshold), exact, 1e-4) << "threshold " << threshold;
  }
}

TEST(Spread, IsLinearBetweenCentresAndTakesTheLastFall) {
  const std::vector<double> radius = {0.5, 1.5, 2.5, 3.5};
  EXPECT_DOUBLE_EQ(spread(radius, std::vector{0.010, 0.010, 0.004, 0.002}, 0.003), 6.0);
  EXPECT_DOUBLE_EQ(spread(radius, std::vector{0.010, 0.001, 0.005, 0.001}, 0.003),
                   6.0);  // a detached ring counts
  EXPECT_DOUBLE_EQ(spread(radius, std::vector{0.001, 0.001, 0.001, 0.001}, 0.0005), 7.0);
  EXPECT_DOUBLE_EQ(spread(radius, std::vector{0.010, 0.010, 0.010, 0.010}, 0.003), 7.0);
}

TEST(Gauges, ThatHaveNothingToReadGiveNothingAndNeverZero) {
  const std::vector<double> place = {0.5, 1.5, 2.5}, thin = {0.002, 0.002, 0.001};
  EXPECT_TRUE(std::isnan(spread(place, thin, 0.003)));
  EXPECT_TRUE(std::isnan(spread({}, {}, 0.003)));
  EXPECT_TRUE(std::isnan(front(place, thin, 3.0, 0.003)));
  EXPECT_TRUE(std::isnan(front({}, {}, 3.0, 0.003)));
  EXPECT_TRUE(std::isnan(centre_depth({}, {}, 0.003)));
  EXPECT_TRUE(std::isnan(depth_at_end({}, 1.0, ChannelEnd::last, 1.0)));
  // Where it is dry the depth is known: that is a reading.
  EXPECT_EQ(depth_at_end(std::vector{1.0, 0.0}, 1.0, ChannelEnd::last, 1.0), 0.0);
}

TEST(Front, IsReadAtTheDepthItIsGiven) {
  const std::vector<double> place = {0.5, 1.5, 2.5}, depth = {0.010, 0.004, 0.0};
  EXPECT_DOUBLE_EQ(front(place, depth, 3.0, 0.003), 1.75);
  EXPECT_DOUBLE_EQ(front(place, depth, 3.0, 0.001), 2.25);
  EXPECT_DOUBLE_EQ(front(place, depth, 3.0, 0.007), 1.0);
  EXPECT_DOUBLE_EQ(front(place, std::vector{0.0, 0.0, 0.01}, 3.0, 0.003), 3.0);
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
  EXPECT_NEAR(centre_depth(radius, line, 0.003), 0.04, 1e-15);
  EXPECT_NEAR(centre_depth(radius, plateau, 0.003), 0.3, 1e-15);
  EXPECT_NEAR(centre_depth(std::vector{0.1, 0.3}, std::vector{0.04, 0.02}, 0.003), 0.05, 1e-15);
  EXPECT_DOUBLE_EQ(centre_depth(std::vector{0.005}, std::vector{0.04}, 0.003), 0.04);
}

TEST(CentreDepth, HardlyMindsTheInnermostRing) {
  std::vector<double> radius, depth;
  for (double r = 0.005; r < 0.4; r += 0.01) {
    radius.push_back(r);
    depth.push_back(r < 0.28 ? 0.04 - 0.1 * r : 0.0);
  }
  depth.front() += 0.004;
  EXPECT_NEAR(centre_depth(radius, depth, 0.003), 0.04, 0.002);
}

TEST(CentreDepth, OfASampledParaboloidIsTakenForALineOverAQuarterOfItsRadius) {
  // By least squares over the area a line's value at 0 is 0.3 of the parabola's fall over the window too
  // high.
  for (const double spacing : {0.02, 0.01, 0.005}) {
    const auto depth = sampled_paraboloid(spacing, 0.04, 0.3, 60000);
    EXPECT_NEAR(centre_depth(depth.centres(), depth.depth, 0.003), 0.04 * (1.0 + 0.3 / 16.0), 4e-4)
        << "spacing " << spacing;
  }
}
