#include "compare/measures/gauges.h"

#include <gtest/gtest.h>

#include "compare/apparatus/apparatus.h"
#include "runs/depth.h"

using namespace flowrest;
using namespace flowrest::compare;

namespace {

/// A finished run that holds nothing but these columns.
runs::Run run_of(const std::vector<std::string>& names, const std::vector<std::vector<double>>& columns,
                 const std::string& status = "end-time") {
  runs::Run run;
  run.info = {{"status", status}, {"settings", {{"geometry", {{"channel_length", 0.6}}}}}};
  run.history.names = names;
  run.history.columns = columns;
  return run;
}

}  // namespace

TEST(Gauges, TheFrontArrivesBetweenTwoRows) {
  const auto run = run_of({"time_s", "front_mm"}, {{0.0, 1.0, 2.0}, {0.0, 500.0, 600.0}});
  EXPECT_NEAR(*read(run, "arrival_s"), 2.0, 1e-7);
  const auto past = run_of({"time_s", "front_mm"}, {{0.0, 1.0, 2.0}, {0.0, 500.0, 700.0}});
  EXPECT_NEAR(*read(past, "arrival_s"), 1.5, 1e-7);
  const auto never = run_of({"time_s", "front_mm"}, {{0.0, 1.0, 2.0}, {0.0, 500.0, 599.0}});
  EXPECT_FALSE(read(never, "arrival_s"));
  EXPECT_EQ(read(never, "front_mm"), 599.0);
}

TEST(Gauges, LightIsSeenWhereTheThinnestLineFallsThroughThreeMillimetres) {
  const auto run = run_of({"time_s", "thinnest_sight_mm"}, {{0.0, 1.0, 2.0}, {600.0, 13.0, 0.0}});
  EXPECT_NEAR(*read(run, "light_s"), 1.0 + 10.0 / 13.0, 1e-12);
}

TEST(Gauges, LightIsSeenAtTheDepthThatTheRunNames) {
  auto run = run_of({"time_s", "thinnest_sight_mm"}, {{0.0, 1.0, 2.0}, {600.0, 13.0, 0.0}});
  run.info["settings"]["gauges"]["light_depth"] = 0.0065;
  EXPECT_NEAR(*read(run, "light_s"), 1.5, 1e-12);
}

TEST(Gauges, WhatReadsNothingIsNeitherAnEventNorAnEnd) {
  constexpr double nothing = runs::nothing;
  const auto front = run_of({"time_s", "front_mm"}, {{0.0, 1.0, 2.0}, {nothing, nothing, nothing}});
  EXPECT_FALSE(read(front, "arrival_s"));
  EXPECT_FALSE(read(front, "front_mm"));
  const auto late = run_of({"time_s", "front_mm"}, {{0.0, 1.0, 2.0}, {nothing, 500.0, 600.0}});
  EXPECT_NEAR(*read(late, "arrival_s"), 2.0, 1e-6);
  const auto sight = run_of({"time_s", "thinnest_sight_mm"}, {{0.0, 1.0, 2.0}, {nothing, 13.0, 0.0}});
  EXPECT_NEAR(*read(sight, "light_s"), 1.0 + 10.0 / 13.0, 1e-12);
}

TEST(Gauges, CaptionsSayWhatTheyAreReadAt) {
  EXPECT_NE(report_of(scenes::Apparatus(scenes::Slump{}))
                .gauge()
                .caption_for({}, scenes::MainGauge::spread)
                .find("falls through 3 mm"),
            std::string::npos);
  EXPECT_NE(report_of(scenes::Apparatus(scenes::LBox{}))
                .further_gauges()[0]
                .caption_for({.end_length = 0.005}, scenes::MainGauge::front)
                .find("last 5 mm"),
            std::string::npos);
}

TEST(Gauges, WhatIsCutOffHasNoEndButItsEventsStand) {
  auto run = run_of({"time_s", "front_mm"}, {{0.0, 1.0}, {0.0, 600.0}}, "interrupted");
  EXPECT_FALSE(read(run, "front_mm"));
  EXPECT_TRUE(read(run, "arrival_s"));
  EXPECT_FALSE(read(run, "rest_s"));
  run.info["rest_time_s"] = 4.5;
  EXPECT_EQ(read(run, "rest_s"), 4.5);
  EXPECT_FALSE(read(run, "no_such_mm"));
}

TEST(Gauges, AGridsErrorIsTakenOnToZeroCellSizeAtFirstOrder) {
  // v(h) = 500 + 2 h: at 10 mm the error is 20.
  EXPECT_NEAR(grid_uncertainty(520.0, 10.0, 530.0, 15.0), 20.0, 1e-12);
  EXPECT_NEAR(grid_uncertainty(530.0, 15.0, 520.0, 10.0), 30.0, 1e-12);
}

TEST(Gauges, EveryApparatusHasThem) {
  scenes::for_each_apparatus([](const auto& one) {
    const ApparatusReport& report = report_of(scenes::Apparatus(one));
    EXPECT_EQ(report.name(), one.name);
    EXPECT_FALSE(report.gauge().name.empty());
    EXPECT_FALSE(report.further_gauges().empty());
    EXPECT_FALSE(report.readings().empty());
  });
  EXPECT_EQ(report_of(scenes::Apparatus(scenes::LBox{})).gauge().suffix(), "_mm");
  EXPECT_EQ(report_of(scenes::Apparatus(scenes::VFunnel{})).gauge().suffix(), "_percent");
}
