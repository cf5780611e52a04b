#include "scenes/apparatus/printing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/pieces.h"
#include "scenes/scene.h"

namespace flowrest::scenes {
namespace {

Printing print() {
  Printing p;
  p.printing_velocity = {{0.0, 0.03}};
  p.extrusion_velocity = {{0.0, 0.0336}};
  return p;
}

TEST(Printing, SpeedsHoldFromTheirTimesOn) {
  Printing p = print();
  p.printing_velocity = {{0.0, 0.02}, {2.0, 0.0}, {3.0, 0.04}};
  EXPECT_DOUBLE_EQ(p.moved(0.0, 1.0), 0.02);
  EXPECT_DOUBLE_EQ(p.moved(1.0, 2.5), 0.02);
  EXPECT_DOUBLE_EQ(p.moved(0.0, 3.5), 0.06);
  const auto strands = p.strands(100.0, 0.0025);
  ASSERT_EQ(strands.size(), 1U);
  EXPECT_DOUBLE_EQ(strands[0].ends_at, 3.0 + (0.2 - 0.04) / 0.04);
  EXPECT_DOUBLE_EQ(strands[0].extruded, 0.0336 * strands[0].ends_at);
}

TEST(Printing, ANozzleThatComesToAStandNeverEndsItsLayer) {
  Printing p = print();
  p.printing_velocity = {{0.0, 0.03}, {1.0, 0.0}};
  p.layers = 2;
  const auto strands = p.strands(10.0, 0.0025);
  ASSERT_EQ(strands.size(), 1U);
  EXPECT_TRUE(std::isinf(strands[0].ends_at));
}

TEST(Printing, LayersFollowEachOtherAfterAPause) {
  Printing p = print();
  p.layers = 3;
  p.pause = 0.5;
  p.direction = PrintDirection::alternating;
  const double cell = 0.0125 / 3.5, time = 0.2 / 0.03;
  const auto strands = p.strands(100.0, cell);
  ASSERT_EQ(strands.size(), 3U);
  EXPECT_NEAR(strands[1].begins_at, time + 0.5, 1e-12);
  EXPECT_NEAR(strands[2].begins_at, 2.0 * (time + 0.5), 1e-12);
  EXPECT_EQ(strands[1].way, -1.0);
  EXPECT_NEAR(strands[1].from, strands[0].from + 0.2, 1e-12);
  for (const auto& strand : strands) {
    const double rows = strand.mouth / cell - 0.5;
    EXPECT_NEAR(rows, std::round(rows), 1e-9) << "nodes are in the middle of cells";
  }
  EXPECT_NEAR(strands[0].mouth, 0.0125, 1e-12);
  EXPECT_NEAR(strands[1].mouth, 0.025, 0.5001 * cell);
  EXPECT_EQ(p.strands(time, cell).size(), 1U) << "of layers that begin before the end";
}

TEST(Printing, ACellHasTheMouthOnARowOfNodes) {
  for (const double wanted : {0.0025, 0.002, 0.00357, 0.008, 1.0}) {
    const double cells = 0.0125 / cell_with_half(0.0125, wanted);
    EXPECT_NEAR(cells - 0.5, std::round(cells - 0.5), 1e-12);
    EXPECT_GE(cells, 1.5 - 1e-12);
  }
}

TEST(Printing, ItsPiecesFeedWhatItExtrudes) {
  const Scene scene = load_scene("printing-three-layers");
  const Pieces pieces = pieces_of(scene);
  ASSERT_EQ(pieces.feeds.size(), 3U);
  for (const Feed& feed : pieces.feeds) {
    EXPECT_NEAR(feed.mouth(feed.gone_at)[0] - feed.mouth(feed.begins_at)[0], 0.2, 1e-12);
    EXPECT_NEAR(feed.extruded(feed.gone_at), feed.column, 1e-12);
    EXPECT_EQ(feed.extruded(feed.begins_at), 0.0);
  }
  EXPECT_EQ(pieces.whole_over_computed, 2.0);
  EXPECT_EQ(pieces.mirrored, std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace flowrest::scenes
