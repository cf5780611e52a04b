#include "compare/exact/channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace flowrest::compare::exact;

namespace {

constexpr double gravity = 9.81, infinite = std::numeric_limits<double>::infinity();
const Bingham concrete{2400.0, 139.0, 29.0};
constexpr double volume = 0.012;  // m3, an L-box

double integrated_volume(const ArrestedChannel& shape, double width) {
  const int strips = 400;
  double sum = 0.0;
  for (int i = 0; i < strips; ++i)
    sum += width * shape.depth(shape.front() * (i + 0.5) / strips) * shape.front() / strips;
  return sum;
}

/// Force of the walls on a metre of channel with the depth h, by sums, N/m.
double held(const Channel& channel, double yield_stress, double h) {
  const auto stress = [&](double pressure) { return std::min(yield_stress, channel.friction * pressure); };
  const double weight = concrete.density * gravity;
  double sides = 0.0;
  const int rows = 1000;
  for (int i = 0; i < rows; ++i) sides += 2.0 * stress(weight * h * (i + 0.5) / rows) * h / rows;
  return stress(weight * h) * channel.width + sides;
}

}  // namespace

/// Without side walls it is half a plane slump.
TEST(ArrestedChannel, WithoutSideWallsItIsThePlaneSlump) {
  const double wide = 1e9;
  const ArrestedChannel shape(concrete, gravity, {wide, 10.0, infinite}, 0.06 * wide);
  const ArrestedPlaneSlump plane = plane_slump(concrete, gravity, 0.06);
  EXPECT_NEAR(shape.front(), plane.half_width, 1e-6);
  for (const double x : {0.0, 0.2, 0.5}) EXPECT_NEAR(shape.depth(x), plane.depth(x), 1e-6) << x;
  EXPECT_NEAR(shape.reach(0.003), 0.5 * plane.spread(0.003), 1e-6);
  EXPECT_EQ(shape.end_height(), 0.0);
}

/// Held wholly by floor and sides, x(h) has a closed form: with l = tau0/(rho g),
/// x = W/2l (h - W/2 ln(1 + 2 h/W)) from the front.
TEST(ArrestedChannel, WithSideWallsItIsTheClosedForm) {
  const double width = 0.2, yields = 400.0;
  const ArrestedChannel shape({2400.0, yields, 29.0}, gravity, {width, 0.7, infinite}, volume);
  const double length = yields / (2400.0 * gravity);
  ASSERT_LT(shape.front(), 0.7);
  for (const double x : {0.0, 0.1, 0.3}) {
    const double h = shape.depth(x);
    EXPECT_NEAR(shape.front() - x, 0.5 * width / length * (h - 0.5 * width * std::log1p(2.0 * h / width)),
                1e-9)
        << x;
  }
  EXPECT_NEAR(integrated_volume(shape, width) / volume, 1.0, 1e-4);
}

TEST(ArrestedChannel, ItsSlopeIsWhatTheWallsHold) {
  for (const double friction : {0.1, 0.45, infinite})
    for (const double yields : {50.0, 139.0, 210.0}) {
      const Channel channel{0.2, 0.7, friction};
      const ArrestedChannel shape({2400.0, yields, 29.0}, gravity, channel, volume);
      for (const double x : {0.1, 0.3, 0.5}) {
        const double h = shape.depth(x), slope = (shape.depth(x + 1e-5) - shape.depth(x - 1e-5)) / 2e-5;
        EXPECT_NEAR(-2400.0 * gravity * h * channel.width * slope / held(channel, yields, h), 1.0, 1e-4)
            << friction << " " << yields << " " << x;
      }
      EXPECT_NEAR(integrated_volume(shape, channel.width) / volume, 1.0, 1e-3);
    }
}

TEST(ArrestedChannel, WhatReachesTheEndLeansOnIt) {
  const ArrestedChannel shape(concrete, gravity, {0.2, 0.7, 0.45}, volume);
  EXPECT_EQ(shape.front(), 0.7);
  EXPECT_EQ(shape.reach(0.003), 0.7);
  EXPECT_NEAR(shape.depth(0.7), shape.end_height(), 1e-9);
  EXPECT_NEAR(shape.depth(0.0), shape.start_height(), 1e-9);
  // Force balance of the whole, by sums: what the ends take is what the walls hold.
  double walls = 0.0;
  const int strips = 200;
  for (int i = 0; i < strips; ++i)
    walls += held({0.2, 0.7, 0.45}, 139.0, shape.depth(0.7 * (i + 0.5) / strips)) * 0.7 / strips;
  const double thrust =
      0.5 * 2400.0 * gravity * 0.2 * (std::pow(shape.start_height(), 2) - std::pow(shape.end_height(), 2));
  EXPECT_NEAR(walls / thrust, 1.0, 1e-4);
}

/// Walls that cannot give the yield stress hold a wedge: dh/dx = -mu where it is far narrower than wide.
TEST(ArrestedChannel, LittleFrictionGivesAWedge) {
  const ArrestedChannel shape({2400.0, 1e6, 29.0}, gravity, {1e6, 10.0, 0.2}, 0.06 * 1e6);
  EXPECT_NEAR(shape.start_height(), std::sqrt(2.0 * 0.2 * 0.06), 1e-6);
  EXPECT_NEAR(shape.depth(0.3), shape.start_height() - 0.2 * 0.3, 1e-6);
}

TEST(ArrestedChannel, StifferConcreteStandsHigherAndComesLessFar) {
  double front = 1.0, height = 0.0;
  for (const double yields : {150.0, 250.0, 400.0, 800.0}) {
    const ArrestedChannel shape({2400.0, yields, 29.0}, gravity, {0.2, 0.7, infinite}, volume);
    EXPECT_LT(shape.reach(0.003), front) << yields;
    EXPECT_GT(shape.start_height(), height) << yields;
    front = shape.reach(0.003);
    height = shape.start_height();
  }
}
