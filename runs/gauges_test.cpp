#include "runs/gauges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "runs/depth.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::runs;

namespace {

class ReadGauges : public testing::Test {
 protected:
  runs::Run written(const std::vector<std::string>& set) const {
    RunWriter writer(folder, scenes::load_scene("roussel-slump", {set, {}}), "mpm");
    writer.history_columns({"time_s", "spread_mm", "height_mm"});
    writer.history(std::vector{0.0, 200.0, 300.0});
    writer.history(std::vector{1.0, nothing, nothing});
    writer.history(std::vector{2.0, 210.0, nothing});
    writer.finish(Status::end_time, "", "sound");
    return read_run(folder);
  }
  TemporaryFolder temporary;
  std::filesystem::path folder = temporary.path() / "run";
};

}  // namespace

TEST_F(ReadGauges, AreDefinedByTheRunsOwnSettings) {
  const runs::Run run = written({"gauges.spread_depth=0.004"});
  EXPECT_EQ(gauges_of(run).spread_depth, 0.004);
  EXPECT_EQ(run.info["gauges"]["spread_mm"]["depth_m"], 0.004);
  EXPECT_EQ(run.info["gauges"]["spread_1p5_mm"]["depth_m"], 0.002);
  EXPECT_EQ(run.info["gauges"]["spread_6_mm"]["depth_m"], 0.008);
}

TEST_F(ReadGauges, AreThoseOfTheStandardApparatusInRunsThatDoNotSay) {
  runs::Run run = written({"geometry.cone_height=0.15"});
  EXPECT_EQ(gauges_of(run).spread_depth, 0.0015);
  run.info["settings"].erase("gauges");
  EXPECT_EQ(gauges_of(run), scenes::Gauges{});
  run.info.erase("settings");
  EXPECT_EQ(gauges_of(run), scenes::Gauges{});
}

TEST_F(ReadGauges, WhatReadsNothingIsAnEmptyCellAndReadsBackAsNothing) {
  const runs::Run run = written({});
  std::ifstream file(folder / "history.csv");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_EQ(text, "time_s,spread_mm,height_mm\n0,200,300\n1,,\n2,210,\n");
  ASSERT_EQ(run.history.rows(), 3u);
  EXPECT_TRUE(std::isnan(run.history.at("spread_mm")[1]));
  EXPECT_EQ(run.history.at("spread_mm")[2], 210.0);
  EXPECT_TRUE(std::isnan(run.history.at("height_mm")[2]));
}

TEST_F(ReadGauges, AResumedRunKeepsRowsThatReadNothing) {
  written({});
  RunWriter::resume(folder, scenes::load_scene("roussel-slump"), 1.0).finish(Status::end_time, "", "sound");
  const runs::Run run = read_run(folder);
  ASSERT_EQ(run.history.rows(), 2u);
  EXPECT_TRUE(std::isnan(run.history.at("spread_mm")[1]));
}

TEST(ShownLength, HasDigitsThatSuitTheBodyAndSaysWhereNothingIsRead) {
  EXPECT_EQ(shown_length("spread", 0.54321, 0.003), "spread 543.2 mm");
  EXPECT_EQ(shown_length("spread", 0.00541912, 3e-5), "spread 5.419 mm");
  EXPECT_EQ(shown_length("front", nothing, 0.003), "no front: nowhere 3 mm deep");
}
