#include "mpm/sampling/feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

using namespace flowrest::mpm;

namespace {

constexpr double cell = 0.002, bore = 0.0125, printing = 0.03, extrusion = 0.0336;

/// It stands until the time is 0.
Nozzle nozzle() {
  Nozzle n;
  n.bore = bore;
  n.wall = 0.003;
  n.mouth = [](double time) -> Vector { return {0.1 + printing * std::max(time, 0.0), 0.0, 0.013}; };
  n.extruded = [](double time) { return extrusion * std::max(time, 0.0); };
  n.column = 0.0501;
  return n;
}

Vector place_of(const Seed& s) {
  Vector x{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = (s.cell[a] + s.position[a]) * cell;
  return x;
}

double volume_of(const std::vector<Seed>& seeds) {
  double sum = 0.0;
  for (const Seed& s : seeds) sum += s.volume;
  return sum;
}

}  // namespace

TEST(Feed, FillsTheBoreAtTheStart) {
  Feed feed(nozzle(), cell, 2, false, 0.25);
  const auto seeds = feed.due(0.0, 1e-4);
  EXPECT_EQ(feed.discs(), 4U);
  const double area = std::numbers::pi * bore * bore;
  EXPECT_NEAR(volume_of(seeds), area * 2.0 * cell, 1e-12 * area);
  EXPECT_NEAR(feed.volume(), area * 2.0 * cell, 1e-12 * area);
  for (const Seed& s : seeds) {
    const Vector x = place_of(s);
    EXPECT_LT(std::hypot(x[0] - 0.1, x[1]), bore);
    EXPECT_GT(x[2], 0.013);
    EXPECT_LT(x[2], 0.013 + 2.0 * cell);
    EXPECT_NEAR(s.velocity[0], printing, 1e-12);
    EXPECT_NEAR(s.velocity[2], -extrusion, 1e-12);
    EXPECT_EQ(s.flocculation, 0.25);
  }
  EXPECT_TRUE(feed.due(0.0, 1e-4).empty());
}

/// Whatever the steps, discs stand one thickness apart in the column.
TEST(Feed, DiscsFollowEachOtherWithoutGapOrOverlap) {
  Feed feed(nozzle(), cell, 2, true, 0.0);
  std::map<long, double> discs;  // heights in the column, in tenths of a micrometre, and volumes
  double time = 0.0, volume = 0.0;
  for (int i = 0; time < 1.2; ++i) {
    for (const Seed& s : feed.due(time, 1e-3)) {
      EXPECT_GT(place_of(s)[1], 0.0);
      discs[std::lround(1e7 * (place_of(s)[2] - 0.013 + extrusion * time))] += s.volume;
      volume += s.volume;
    }
    time += 1e-3 * (1 + i % 7);
  }
  const double area = 0.5 * std::numbers::pi * bore * bore;
  EXPECT_NEAR(volume, feed.volume(), 1e-12 * area);
  double height = 0.5 * cell / 2.0;
  for (const auto& [at, of_disc] : discs) {
    if (at == discs.rbegin()->first) break;
    EXPECT_NEAR(1e-7 * static_cast<double>(at), height, 1.1e-7);
    EXPECT_NEAR(of_disc, area * cell / 2.0, 1e-12 * area);
    height += cell / 2.0;
  }
}

TEST(Feed, TheLastDiscIsCutWhereTheColumnEnds) {
  Feed feed(nozzle(), cell, 3, false, 0.0);
  double volume = 0.0;
  for (double time = 0.0; time < 3.0; time += 0.013) volume += volume_of(feed.due(time, 1e-3));
  const double all = std::numbers::pi * bore * bore * 0.0501;
  EXPECT_NEAR(volume / all, 1.0, 1e-12);
  EXPECT_NEAR(feed.volume() / all, 1.0, 1e-12);
}

TEST(Feed, GoesOnFromTheDiscsThatHaveCome) {
  Feed whole(nozzle(), cell, 2, false, 0.0), first(nozzle(), cell, 2, false, 0.0);
  whole.due(0.4, 1e-3);
  first.due(0.4, 1e-3);
  Feed second(nozzle(), cell, 2, false, 0.0);
  second.skip_to(0.4);
  EXPECT_EQ(second.discs(), first.discs());
  const auto a = whole.due(0.7, 1e-3), b = second.due(0.7, 1e-3);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].position, b[i].position);
}
