#include "scenes/apparatus/printing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
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

TEST(Printing, APathIsFollowedFromPlaceToPlace) {
  const Scene scene = load_scene("printing-corner");
  const Pieces pieces = pieces_of(scene);
  ASSERT_EQ(pieces.feeds.size(), 1U);
  const Feed& feed = pieces.feeds.front();
  EXPECT_NEAR(feed.mouth(1.0)[0], 0.08, 1e-9);
  EXPECT_EQ(feed.mouth(1.0)[1], 0.0);
  EXPECT_NEAR(feed.mouth(4.3333333333)[1], 0.03, 1e-9);
  EXPECT_NEAR(feed.mouth(100.0)[1], 0.06, 1e-12);
  EXPECT_NEAR(feed.column, 0.0336 * 5.3333333333, 1e-12);
  EXPECT_EQ(pieces.whole_over_computed, 1.0);
  EXPECT_TRUE(std::isinf(std::get<SectionGauge>(pieces.gauged).behind))
      << "a corner has no section behind it";
}

struct PrintedCode : testing::Test {
  PrintedCode() {
    folder = std::filesystem::temp_directory_path() / ("flowrest-gcode-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
  }
  ~PrintedCode() override { std::filesystem::remove_all(folder); }
  Scene scene(const std::string& code, const std::string& more = "") const {
    std::ofstream(folder / "part.gcode") << code;
    std::ofstream(folder / "part.toml")
        << "title = \"a part\"\nkind = \"printing\"\n[geometry]\ndimension = \"full\"\n[process]\ngcode = "
           "\"part.gcode\"\n"
        << more
        << "[material]\nmodel = \"elasto-viscoplastic\"\ndensity = 2100\nyield_stress = 630\nplastic_viscosity "
           "= 7.5\nyoungs_modulus = 1e5\npoisson_ratio = 0.45\n[time]\nend = 5\n[mpm]\ncell = 0.005\n";
    return load_scene((folder / "part.toml").string());
  }
  std::filesystem::path folder;
};

TEST_F(PrintedCode, IsAPathAndAFlow) {
  const Scene read = scene("G0 X50 Y0 Z12.5 F1800\nG1 X110 E32987\nG1 Y30 E49480\n");
  const Pieces pieces = pieces_of(read);
  ASSERT_EQ(pieces.feeds.size(), 1U);
  const double area = std::numbers::pi * 0.0125 * 0.0125;
  EXPECT_NEAR(pieces.feeds[0].column * area, 49480e-9, 1e-15);
  EXPECT_NEAR(pieces.feeds[0].mouth(3.0)[1], 0.03, 1e-12);
  // What a run keeps of its settings stands without the file.
  std::filesystem::remove(folder / "part.gcode");
  const Scene again = parse_scene(resolved_toml(read), "again.toml");
  EXPECT_EQ(again.printing().path, read.printing().path);
  EXPECT_EQ(again.printing().flow, read.printing().flow);
}

TEST_F(PrintedCode, WhatIsWrongWithItIsSaidWithTheLineOfTheCode) {
  const auto message = [&](const std::string& code, const std::string& more) {
    try {
      scene(code, more);
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message("G0 X50 Y0 Z12.5 F1800\nM104 S200\nG1 X110 E3000\n", ""),
              testing::HasSubstr("line 2: M104 is not understood"));
  EXPECT_THAT(message("G0 X50 Y0 Z12.5 F1800\nG1 X110\n", ""),
              testing::HasSubstr("process.extrusion_velocity is missing; needed:"));
  EXPECT_THAT(message("G0 X50 Y0 Z12.5 F1800\nG1 X110 E3000\n", "extrusion_velocity = 0.03\n"),
              testing::HasSubstr("is given beside a flow"));
  EXPECT_THAT(message("G0 X50 Y0 Z12.5 F1800\nG1 X110 E3000\n", "printing_velocity = 0.03\n"),
              testing::HasSubstr("process.printing_velocity is given beside a path"));
}

}  // namespace
}  // namespace flowrest::scenes
