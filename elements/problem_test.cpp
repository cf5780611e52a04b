#include "elements/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "elements/run.h"
#include "runs/errors.h"
#include "runs/temporary_folder.h"
#include "scenes/test_scenes.h"

using namespace flowrest;
using scenes::test::replaced;
using scenes::test::slump_text;
using testing::AllOf;
using testing::HasSubstr;

namespace {

/// What is said against a scene; nothing may be written then.
std::string complaint(const std::string& text) {
  const runs::TemporaryFolder folder;
  const scenes::Scene scene = scenes::parse_scene(text, "wrong.toml");
  elements::RunOptions options;
  options.directory = folder.path() / "run";
  try {
    elements::run(scene, options);
  } catch (const runs::RunError& error) {
    EXPECT_FALSE(std::filesystem::exists(options.directory));
    return error.what();
  }
  return {};
}

}  // namespace

TEST(Problem, IsReadOffTheScene) {
  const elements::Problem problem = elements::problem_of(scenes::parse_scene(slump_text, "slump.toml"));
  EXPECT_EQ(problem.symmetry, elements::Symmetry::about_axis);
  EXPECT_EQ(problem.floor, elements::Floor::no_slip);
  EXPECT_EQ(problem.height, 0.3);
  EXPECT_EQ(problem.flow.parameters.yield_stress, 50.0);
  EXPECT_EQ(problem.spread_depth, 0.003);
  EXPECT_TRUE(problem.is_rounded());
}

TEST(Problem, TakesStructureThatStaysAsItIs) {
  const auto scene = scenes::parse_scene(
      slump_text +
          "[thixotropy]\nflocculation_rate = 0\ndeflocculation_coefficient = 0\ninitial_flocculation = 0.5\n",
      "slump.toml");
  EXPECT_EQ(elements::problem_of(scene).flow.parameters.yield_stress, 75.0);
}

/// The rate at which flow resists as much as the local yield stress holds: K rate^n = (1 + lambda) tau0, from
/// which the rounding at rest follows.
TEST(Problem, RoundsByTheRootOfTheLocalYieldStress) {
  const std::string structure =
      "[thixotropy]\nflocculation_rate = 0\ndeflocculation_coefficient = 0\ninitial_flocculation = 3\n";
  for (const double n : {0.5, 1.0, 1.5}) {
    auto scene = scenes::parse_scene(slump_text + structure, "slump.toml");
    scene.material.flow_index = n;
    scene.material.plastic_viscosity = 100.0;
    scene.time.end = 1e-3;
    EXPECT_NEAR(elements::resolution_of(elements::problem_of(scene), 60).rounding,
                1e-3 * std::pow(4.0 * 50.0 / 100.0, 1.0 / n), 1e-12)
        << n;
  }
}

TEST(Problem, RefusesWhatTheElementsDoNotServe) {
  const auto says = [](const std::string& what, const std::string& allowed) {
    return AllOf(HasSubstr("wrong.toml: the finite elements do not compute " + what),
                 HasSubstr("allowed: " + allowed));
  };
  EXPECT_THAT(complaint(scenes::test::duct_text), says("kind = \"duct\"", "\"slump\""));
  EXPECT_THAT(complaint(replaced(slump_text, "\"axisymmetric\"", "\"quarter\"")),
              says("geometry.dimension = \"quarter\"", "\"axisymmetric\" or \"plane\""));
  EXPECT_THAT(complaint(replaced(slump_text, "domain_height = 0.35",
                                 "domain_height = 0.7\nmould_lift_velocity = 0.1")),
              says("a mould that is lifted", "a cone released at once"));
  EXPECT_THAT(complaint(replaced(slump_text, "base = \"no-slip\"", "base = { friction = 0.4 }")),
              says("a floor of friction 0.4", "\"no-slip\" or \"slip\""));
  EXPECT_THAT(
      complaint(slump_text + "[thixotropy]\nflocculation_rate = 0.1\ndeflocculation_coefficient = 0.01\n"
                             "initial_flocculation = 0.5\n"),
      says("structure that grows or breaks down", "no [thixotropy]"));
  EXPECT_THAT(complaint(slump_text + "[thixotropy]\nflocculation_rate = 0\ndeflocculation_coefficient = 0\n"
                                     "initial_flocculation = 0.5\nageing_rate = 0.01\n"),
              says("structure that grows or breaks down", "no [thixotropy]"));
}
