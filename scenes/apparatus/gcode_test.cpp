#include "scenes/apparatus/gcode.h"

#include <gmock/gmock.h>

#include <cmath>

namespace flowrest::scenes {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double cubic_millimetre = 1e-9;

PrintedPath path_of(const std::string& text) {
  const GcodeResult result = read_gcode(text, cubic_millimetre);
  EXPECT_THAT(result.faults, testing::IsEmpty());
  return result.path.value_or(PrintedPath{});
}

std::string faults_of(const std::string& text) {
  std::string all;
  for (const std::string& fault : read_gcode(text, cubic_millimetre).faults) all += fault + "\n";
  return all;
}

TEST(Gcode, ACornerTakesTheTimeOfItsWay) {
  const auto path = path_of(
      "; a corner\nG21\nG90\nG0 X10 Y0 Z12.5 F1800\n"
      "G1 X70 E1980 (60 mm at 30 mm/s)\nG1 Y30 F900 E2970\n");
  ASSERT_EQ(path.places.size(), 3u);
  EXPECT_THAT(path.places[0], ElementsAre(0.0, 0.01, 0.0, 0.0125));
  EXPECT_NEAR(path.places[1][0], 2.0, 1e-12);
  EXPECT_NEAR(path.places[2][0], 4.0, 1e-12);
  EXPECT_NEAR(path.places[2][2], 0.03, 1e-15);
  ASSERT_EQ(path.flow.size(), 3u);
  EXPECT_NEAR(path.flow[0].second, 990e-9, 1e-18);
  EXPECT_NEAR(path.flow[1].second, 495e-9, 1e-18);
  EXPECT_NEAR(path.flow[1].first, 2.0, 1e-12);
  EXPECT_EQ(path.flow[2].second, 0.0);
}

TEST(Gcode, WhatIsFedIsWhatECounts) {
  const auto path = path_of("G1 X0 Y0 Z10 F600\nM83\nG1 X10 E100\nG1 X25 E50\nG4 P500\nG0 X30\nG1 X40 E7\n");
  double volume = 0.0;
  for (std::size_t i = 0; i + 1 < path.flow.size(); ++i)
    volume += path.flow[i].second * (path.flow[i + 1].first - path.flow[i].first);
  EXPECT_NEAR(volume, 157e-9, 1e-18);
  EXPECT_NEAR(path.places.back()[0], 4.0 + 0.5, 1e-12);
}

TEST(Gcode, RelativeMovesInchesAndLineNumbersAreUnderstood) {
  const auto path = path_of("N10 G20\nN20 G1 X1 Y1 Z1 F60\nN30 G91\nN40 G1 X1\nN50 G1 X-2 Y+0.5\n");
  ASSERT_EQ(path.places.size(), 3u);
  EXPECT_NEAR(path.places[1][1], 0.0508, 1e-12);
  EXPECT_NEAR(path.places[2][1], 0.0, 1e-12);
  EXPECT_NEAR(path.places[2][2], 0.0381, 1e-12);
  EXPECT_TRUE(path.flow.empty()) << "there is no E: the flow is said elsewhere";
}

TEST(Gcode, WhatIsNotUnderstoodIsNamedByLine) {
  EXPECT_THAT(faults_of("G1 X0 F60\nM104 S200\nG2 X1 I1\n"),
              HasSubstr("line 2: M104 is not understood; allowed: G0, G1, G4,"));
  EXPECT_THAT(faults_of("G1 X0 F60\nM104 S200\nG2 X1 I1\n"), HasSubstr("line 3: G2 is not understood"));
  EXPECT_THAT(faults_of("G1 X0 F60\nG1 X1 I3\n"),
              HasSubstr("line 2: I3 is not understood; allowed in a move:"));
  EXPECT_THAT(faults_of("G1 X0\nG1 X1\n"), HasSubstr("line 2: the nozzle moves before there is a speed"));
  EXPECT_THAT(faults_of("G1 X0 F60\nG1 X1 E5\nG1 X2 E4\n"), HasSubstr("line 3: E falls by 1"));
  EXPECT_THAT(faults_of("G1 X0 F60\nG1 E5\n"), HasSubstr("line 2: E counts while the nozzle stands"));
  EXPECT_THAT(faults_of("G1 X0 F0\n"), HasSubstr("line 1: F0 is no speed"));
  EXPECT_THAT(faults_of("hello\n"), HasSubstr("line 1: "));
  EXPECT_THAT(faults_of("G1 X0 F60\n"), HasSubstr("the nozzle moves nowhere"));
  EXPECT_THAT(faults_of(""), HasSubstr("the nozzle moves nowhere"));
  EXPECT_THAT(faults_of("G92 X0\n"), HasSubstr("line 1: G92 X would move the bed"));
}

}  // namespace
}  // namespace flowrest::scenes
