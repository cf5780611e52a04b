#include "studies/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "studies/quantities.h"

using namespace flowrest;
using namespace flowrest::studies;
using testing::HasSubstr;

namespace {

const std::string text = R"(title = "Cells"
scene = "roussel-slump"
quantities = ["spread_mm", "rest_time_s"]
[settings]
time.end = 1.0
[reference]
kind = "richardson"
model = "elasto-viscoplastic"
refine = "mpm.cell"
values = [0.02, 0.0125, 0.01]
[[sweep]]
name = "MPM"
model = ["elasto-viscoplastic", "papanastasiou"]
axes = { "mpm.precision" = ["double", "float"], mpm.cell = [0.02, 0.01] }
[[sweep]]
name = "choices"
choices = [{}, { mpm.cell = 0.02, mpm.cfl = 0.5 }]
[cuts.quick]
sweeps = ["MPM"]
reference_values = [0.03, 0.02, 0.0125]
[cuts.quick.only]
"mpm.cell" = [0.02]
)";

std::string replaced(std::string from, const std::string& what, const std::string& with) {
  const auto place = from.find(what);
  EXPECT_NE(place, std::string::npos) << what;
  return from.replace(place, what.size(), with);
}

/// What is said against a study; empty where it is taken.
std::string complaint(const std::string& of, const std::string& cut = "") {
  try {
    expand(parse_study(of, "wrong.toml"), cut);
  } catch (const scenes::SceneError& error) {
    return error.what();
  }
  return {};
}

std::vector<Point> points_of(const std::vector<Point>& all, const std::string& sweep) {
  std::vector<Point> points;
  for (const Point& p : all)
    if (p.sweep == sweep) points.push_back(p);
  return points;
}

}  // namespace

TEST(Study, IsEveryCombinationOfItsAxesOnceAndItsReference) {
  const auto points = expand(parse_study(text, "cells.toml"));
  EXPECT_EQ(points_of(points, "reference").size(), 3u);
  const auto mpm = points_of(points, "MPM");
  ASSERT_EQ(mpm.size(), 8u);
  std::set<std::string> folders;
  for (const Point& p : mpm) {
    ASSERT_TRUE(p.scene) << p.refused;
    EXPECT_EQ(p.scene->time.end, 1.0);
    EXPECT_EQ(p.scene->mpm.threads, 1) << "runs share the cores between them";
    folders.insert(p.id);
  }
  EXPECT_EQ(folders.size(), 8u);
  EXPECT_EQ(mpm[0].scene->material.model, scenes::Model::elasto_viscoplastic);
  EXPECT_EQ(mpm[0].scene->mpm.cell, 0.02);
  EXPECT_EQ(mpm[1].scene->mpm.cell, 0.01);
  EXPECT_EQ(mpm[2].scene->mpm.precision, scenes::Precision::single_precision);
  const auto choices = points_of(points, "choices");
  ASSERT_EQ(choices.size(), 2u);
  EXPECT_EQ(choices[1].scene->mpm.cfl, 0.5);
  EXPECT_EQ(choices[1].scene->mpm.cell, 0.02);
}

TEST(Study, RunsThatResolveToTheSameShareAFolder) {
  const auto points = expand(parse_study(text, "cells.toml"));
  // The reference at 20 mm, the sweep's at 20 mm in double, and (at 10 mm) the scene as it is.
  EXPECT_EQ(points_of(points, "reference")[0].id, points_of(points, "MPM")[0].id);
  EXPECT_EQ(points_of(points, "choices")[0].id, points_of(points, "MPM")[1].id);
  EXPECT_NE(points_of(points, "MPM")[0].id, points_of(points, "MPM")[1].id);
}

TEST(Study, AFolderKeepsItsNameFromCallToCallAndChangesWithAnySetting) {
  const auto first = expand(parse_study(text, "cells.toml"));
  const auto again = expand(parse_study(text, "elsewhere/cells.toml"));
  const auto other = expand(parse_study(replaced(text, "time.end = 1.0", "time.end = 1.5"), "cells.toml"));
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].id, again[i].id);
    EXPECT_NE(first[i].id, other[i].id);
  }
}

TEST(Study, ACutIsAPartOfTheWholeWithTheSameFolders) {
  const Study study = parse_study(text, "cells.toml");
  const auto whole = expand(study), quick = expand(study, "quick");
  EXPECT_EQ(points_of(quick, "MPM").size(), 4u);
  EXPECT_TRUE(points_of(quick, "choices").empty());
  EXPECT_EQ(points_of(quick, "reference")[0].scene->mpm.cell, 0.03);
  std::set<std::string> folders;
  for (const Point& p : whole) folders.insert(p.id);
  for (const Point& p : points_of(quick, "MPM")) EXPECT_TRUE(folders.contains(p.id)) << p.id;
  EXPECT_THAT(complaint(text, "quik"), HasSubstr("has no cut \"quik\", nearest is quick"));
}

TEST(Study, NamesEveryFaultWithItsPlaceAndTheNearestName) {
  EXPECT_EQ(complaint(text), "");
  EXPECT_THAT(complaint(replaced(text, "title =", "titel =")),
              HasSubstr("wrong.toml:1:1: unknown key \"titel\", nearest is title"));
  EXPECT_THAT(
      complaint(replaced(text, "\"spread_mm\"", "\"spread_m\"")),
      HasSubstr("wrong.toml:3:14: quantities names the unknown quantity \"spread_m\", nearest is spread_mm"));
  EXPECT_THAT(complaint(replaced(text, "time.end", "time.ent")),
              HasSubstr("wrong.toml:5:6: \"time.ent\" is no key that a study may set, nearest is time.end"));
  EXPECT_THAT(complaint(replaced(text, "mpm.cell = [0.02, 0.01]", "mpm.cell = 0.02")),
              HasSubstr("the axis mpm.cell must be an array"));
  EXPECT_THAT(complaint(replaced(text, "\"papanastasiou\"]", "\"papanastasio\"]")),
              HasSubstr("nearest is papanastasiou"));
  EXPECT_THAT(complaint(replaced(text, "sweeps = [\"MPM\"]", "sweeps = [\"MMP\"]")),
              HasSubstr("cuts quick names an unknown sweep \"MMP\", nearest is MPM"));
  EXPECT_THAT(complaint(replaced(text, "values = [0.02, 0.0125, 0.01]", "values = [0.02]")),
              HasSubstr("reference.values must hold three"));
  EXPECT_THAT(complaint(replaced(text, "kind = \"richardson\"", "kind = \"richardsen\"")),
              HasSubstr("nearest is richardson"));
  EXPECT_THAT(complaint(replaced(text, "[[sweep]]", "[[swep]]")), HasSubstr("nearest is sweep"));
  EXPECT_THAT(complaint("title = \"a"), HasSubstr("wrong.toml:1:"));
  EXPECT_THAT(complaint(""), HasSubstr("scene is missing"));
}

TEST(Study, ARunThatTheSceneRefusesIsNamedWithTheValueThatDoesIt) {
  const std::string wrong = complaint(replaced(text, "[0.02, 0.01] }", "[0.02, -1.0] }"));
  EXPECT_THAT(wrong, HasSubstr("wrong.toml:14:"));
  EXPECT_THAT(wrong, HasSubstr("mpm.cell is -1; allowed: greater than 0"));
  // A map of extremes takes refusals for what they are: results.
  const auto points = expand(
      parse_study("purpose = \"map\"\n" + replaced(text, "[0.02, 0.01] }", "[0.02, -1.0] }"), "map.toml"));
  int refused = 0;
  for (const Point& p : points) refused += !p.refused.empty();
  EXPECT_EQ(refused, 4);
}

TEST(Study, AnExactReferenceForbidsToVaryWhatItDependsOn) {
  const std::string exact = R"(scene = "roussel-slump"
quantities = ["spread_mm"]
reference = { kind = "exact", solution = "second-order" }
[[sweep]]
axes = { "material.yield_stress" = [50.0, 100.0] }
)";
  EXPECT_THAT(complaint(exact), HasSubstr("wrong.toml:5:37: material.yield_stress varies"));
  EXPECT_EQ(complaint(replaced(exact, "material.yield_stress", "material.plastic_viscosity")), "");
}

TEST(Study, TheStudiesThatComeWithFlowrestCanBeUsed) {
  const auto names = list_studies();
  EXPECT_GE(names.size(), 2u);
  for (const std::string& name : names) {
    const Study study = load_study(name);
    EXPECT_FALSE(expand(study).empty()) << name;
    for (const Cut& cut : study.cuts)
      EXPECT_FALSE(expand(study, cut.name).empty()) << name << ' ' << cut.name;
  }
}

TEST(Quantities, KnowTheirUnitsAndTheirTimes) {
  EXPECT_EQ(unit_of("spread_mm@1.5"), "mm");
  EXPECT_EQ(unit_of("plug_velocity_m_s"), "m/s");
  EXPECT_EQ(unit_of("rest_time_s"), "s");
  EXPECT_EQ(unit_of("shear_rate_p99_1_s"), "1/s");
  EXPECT_EQ(unit_of("profile_l1"), "1");
  EXPECT_EQ(complaint_about("spread_mm@0.5"), "");
  EXPECT_THAT(complaint_about("spread_mm@soon"), HasSubstr("no number of seconds"));
  EXPECT_THAT(complaint_about("rest_time_s@3"), HasSubstr("rest_time_s alone"));
  EXPECT_EQ(complaint_about("derivative(spread_mm, material.yield_stress)"), "");
  EXPECT_EQ(derivative_named("elasticity(spread_mm,material.yield_stress)")->by, "material.yield_stress");
  EXPECT_EQ(unit_of("elasticity(spread_mm, material.yield_stress)"), "% per %");
  EXPECT_THAT(complaint_about("derivative(spread_mm)"), HasSubstr("names no quantity and key"));
}

TEST(Study, AByteOrderMarkAndCarriageReturnsChangeNothingAndUtf16IsNamed) {
  std::string windows = "\xEF\xBB\xBF";
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(parse_study(windows, "cells.toml").quantities, parse_study(text, "cells.toml").quantities);
  std::string utf_16 = "\xFF\xFE";
  for (const char c : text) utf_16 += {c, '\0'};
  try {
    parse_study(utf_16, "cells.toml");
    FAIL() << "it was taken";
  } catch (const scenes::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cells.toml:1:1: is text in UTF-16; allowed: text in UTF-8"));
  }
}

TEST(Quantities, MomentsOfVesselsAreThoseThatReportsState) {
  for (const char* moment : {"arrival_s", "light_s", "rest_time_s"}) {
    EXPECT_EQ(complaint_about(moment), "");
    EXPECT_EQ(unit_of(moment), "s");
    EXPECT_THAT(complaint_about(std::string(moment) + "@1"), HasSubstr(std::string(moment) + " at a time"));
  }
  runs::Run run;
  run.info = {{"status", "end-time"}, {"settings", {{"geometry", {{"channel_length", 0.6}}}}}};
  run.history.names = {"time_s", "front_mm", "thinnest_sight_mm", "end_height_mm"};
  run.history.columns = {{0.0, 1.0, 2.0}, {0.0, 500.0, 700.0}, {60.0, 5.0, 1.0}, {0.0, 0.0, 40.0}};
  EXPECT_NEAR(*measure(run, "arrival_s"), 1.5, 1e-6);
  EXPECT_NEAR(*measure(run, "light_s"), 1.5, 1e-6);
  EXPECT_EQ(measure(run, "end_height_mm"), 40.0);
  EXPECT_FALSE(measure(run, "rest_time_s"));
}
