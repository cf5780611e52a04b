#include "compare/measures/series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

using namespace flowrest::compare;

namespace {

Series sampled(double interval, double end, double (*function)(double)) {
  Series series;
  for (int i = 0; i * interval <= end + 1e-12; ++i) {
    series.time.push_back(i * interval);
    series.value.push_back(function(i * interval));
  }
  return series;
}

}  // namespace

TEST(Interpolate, IsLinearInsideAndConstantOutside) {
  const Series series{{0.0, 1.0, 3.0}, {2.0, 4.0, 0.0}};
  EXPECT_DOUBLE_EQ(series.at(-1.0), 2.0);
  EXPECT_DOUBLE_EQ(series.at(0.5), 3.0);
  EXPECT_DOUBLE_EQ(series.at(1.0), 4.0);
  EXPECT_DOUBLE_EQ(series.at(2.5), 1.0);
  EXPECT_DOUBLE_EQ(series.at(9.0), 0.0);
}

TEST(Trend, IgnoresOutliersAndReportsTheScatter) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  Series series = sampled(0.05, 60.0, [](double t) { return 500.0 + 0.25 * t; });
  for (double& v : series.value) v += noise(random);
  for (std::size_t i = 0; i < series.value.size(); i += 7) series.value[i] += 30.0;
  const auto line = trend(series, 55.0, 60.0);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->slope, 0.25, 0.01);
  EXPECT_NEAR(line->scatter, 0.02, 0.01);
  EXPECT_FALSE(trend(series, 70.0, 80.0));
  EXPECT_FALSE(trend({{1.0, 1.0, 1.0}, {1.0, 2.0, 3.0}}, 0.0, 2.0));
}

TEST(RateOfChange, OfAStraightLineAndOfAnExponential) {
  const Series line = rate_of_change(sampled(0.05, 10.0, [](double t) { return 3.0 - 0.5 * t; }), 2.0);
  ASSERT_EQ(line.time.size(), 201u);
  for (const double v : line.value) EXPECT_NEAR(v, -0.5, 1e-12);
  const Series decay = rate_of_change(sampled(0.05, 20.0, [](double t) { return -std::exp(-t / 4.0); }), 0.5);
  EXPECT_NEAR(decay.at(8.0), std::exp(-2.0) / 4.0, 1e-4);
}

TEST(SettlesBelow, TakesTheLastCrossing) {
  const Series series{{0.0, 1.0, 2.0, 3.0, 4.0}, {0.0, 5.0, 0.5, 2.0, -0.5}};
  EXPECT_EQ(settles_below(series, 1.0), 4.0);  // back above at 3 s
  EXPECT_EQ(settles_below(series, 2.0), 2.0);
  EXPECT_EQ(settles_below(series, 10.0), 0.0);
  EXPECT_FALSE(settles_below(series, 0.1));
  EXPECT_FALSE(settles_below({}, 1.0));
}

TEST(ProfileError, OfAKnownDifference) {
  // Reference 2 over a disc of radius 1, profile 3 inside radius 1/2: the inner quarter of the area differs
  // by 1.
  std::vector<double> r, value, reference;
  const int n = 20000;
  for (int i = 0; i <= n; ++i) {
    r.push_back(1.2 * i / n);
    reference.push_back(r.back() <= 1.0 ? 2.0 : 0.0);
    value.push_back(r.back() <= 0.5 ? 3.0 : reference.back());
  }
  const ProfileError radial = profile_error(r, value, reference, true, 1e-12);
  EXPECT_NEAR(radial.l1, 0.25, 1e-3);
  EXPECT_NEAR(radial.l2, 0.5, 1e-3);
  EXPECT_EQ(radial.linf, 1.0);
  EXPECT_NEAR(radial.l1_relative, 0.125, 1e-3);
  EXPECT_NEAR(radial.l2_relative, 0.25, 1e-3);
  const ProfileError plane = profile_error(r, value, reference, false, 1e-12);
  EXPECT_NEAR(plane.l1, 0.5, 1e-3);
  EXPECT_NEAR(plane.l2, std::sqrt(0.5), 1e-3);
  const ProfileError none = profile_error(r, reference, reference, true, 1e-12);
  EXPECT_EQ(none.l1, 0.0);
  EXPECT_EQ(none.l2_relative, 0.0);
}

TEST(RoundStep, IsOneTwoTwoAndAHalfOrFive) {
  EXPECT_DOUBLE_EQ(round_step(0.25), 0.25);
  EXPECT_DOUBLE_EQ(round_step(0.0833), 0.1);
  EXPECT_DOUBLE_EQ(round_step(37.0), 50.0);
  EXPECT_DOUBLE_EQ(round_step(1.9), 2.0);
  EXPECT_DOUBLE_EQ(round_step(0.0), 1.0);
}
