#include "scenes/commands.h"

#include <nlohmann/json.hpp>

#include "scenes/schema.h"
#include "scenes/summary.h"
#include "scenes/test_scenes.h"

namespace flowrest::scenes::test {
namespace {

using testing::HasSubstr;

/// What a command line prints. Exceptions of the command pass through.
std::string output_of(std::vector<std::string> arguments) {
  CLI::App app;
  app.require_subcommand(1);
  add_commands(app);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  testing::internal::CaptureStdout();
  try {
    app.parse(arguments);
  } catch (...) {
    testing::internal::GetCapturedStdout();
    throw;
  }
  return testing::internal::GetCapturedStdout();
}

TEST(ScenesCommand, ListsEverySceneWithItsTitle) {
  const std::string output = output_of({"scenes"});
  EXPECT_THAT(output, HasSubstr("roussel-slump          Roussel slump flow\n"));
  EXPECT_THAT(output, HasSubstr("poiseuille-step-down   Poiseuille flow stepped down below yield\n"));
}

TEST(ScenesCommand, PrintsEveryKey) {
  const std::string output = output_of({"scenes", "--keys"});
  EXPECT_EQ(output, key_reference());
  for (const Key& key : keys()) EXPECT_THAT(output, HasSubstr("| `" + key.name + "` | " + key.takes + " |"));
  EXPECT_THAT(output,
              HasSubstr("| `cfl` | number, greater than 0, at most 100 |  | `0.75` | Courant number"));
}

TEST(CheckCommand, ShowsResolvedSettingsAndLimits) {
  const std::string output = output_of({"check", "roussel-slump"});
  EXPECT_THAT(output, HasSubstr("Roussel slump flow"));
  EXPECT_THAT(output, HasSubstr("  critical_shear_rate         0.01                  1/s\n"));
  EXPECT_THAT(output,
              HasSubstr("  acoustic step limit         1.2 ms                1.15 cell / wave speed\n"));
  EXPECT_THAT(output, HasSubstr("  particles                   2025\n"));
}

TEST(CheckCommand, SaysOfSolversWhatTheyTell) {
  const Scene scene = load_scene("roussel-slump", {});
  const Estimates estimates{.mpm =
                                [](const Scene&) {
                                  return Cost{2e9, 7200.0};
                                },
                            .foam =
                                [](const Scene&) {
                                  return FoamEstimate{1710.0, 3430.0, 0.0046, {1e8, 100.0}};
                                }};
  const std::string text = check_text(scene, estimates);
  EXPECT_THAT(text, HasSubstr("  occupied cells              225                   at the start\n"
                              "  memory                      about 2 GB\n"
                              "  cost                        about 2 h "));
  EXPECT_THAT(text, HasSubstr("\nOpenFOAM run\n  mesh cells                  1710\n"));
  const auto json = nlohmann::json::parse(check_json(scene, estimates));
  EXPECT_EQ(json["mpm"]["cpu_s"], 7200.0);
  EXPECT_EQ(json["foam"]["steps"], 3430.0);
  // Where no solver tells anything, the scene is checked all the same.
  EXPECT_THAT(check_text(scene, {}), testing::Not(HasSubstr("OpenFOAM run")));
  EXPECT_FALSE(nlohmann::json::parse(check_json(scene, {})).contains("foam"));
}

TEST(CheckCommand, TakesSettingsBeforeAndAfterTheSceneAndAModel) {
  const std::string output =
      output_of({"check", "--set", "mpm.cell=0.02", "roussel-slump", "--set", "mpm.cfl=0.5", "--set",
                 "mpm.scheme=linear-flip", "--model", "papanastasiou"});
  EXPECT_THAT(output, HasSubstr("  cell                        0.02                  m\n"));
  EXPECT_THAT(output, HasSubstr("  cfl                         0.5\n"));
  EXPECT_THAT(output, HasSubstr("  scheme                      linear-flip\n"));
  EXPECT_THAT(output, HasSubstr("Material point run, papanastasiou\n"));
}

TEST(CheckCommand, EndsWithALineOfJson) {
  const std::string output = output_of({"check", "roussel-slump", "--json"});
  const auto end = output.find_last_not_of('\n');
  const auto json = nlohmann::json::parse(output.substr(output.rfind('\n', end) + 1));
  EXPECT_EQ(json["scene"], "roussel-slump");
  EXPECT_EQ(json["settings"]["material"]["density"], 2300.0);
  EXPECT_EQ(json["mpm"]["particles"], 2025.0);
  EXPECT_TRUE(json["step_limits"]["viscous_s"].is_null());
}

TEST(CheckCommand, NotesWhatIsImplausibleOnStderrAndInItsJson) {
  testing::internal::CaptureStderr();
  const std::string output = output_of({"check", "roussel-slump", "--json", "--set", "material.density=2.3"});
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("Note: material.density is 2.3 kg/m3"));
  EXPECT_EQ(output.find("Note: "), std::string::npos);
  const auto end = output.find_last_not_of('\n');
  const auto json = nlohmann::json::parse(output.substr(output.rfind('\n', end) + 1));
  EXPECT_THAT(json["notes"].get<std::vector<std::string>>(),
              testing::Contains(HasSubstr("in t/m3 or g/cm3 that would be 2300 kg/m3")));
}

TEST(CheckCommand, RefusesWhatTheReaderRefuses) {
  EXPECT_THROW(output_of({"check", "no-such-scene"}), SceneError);
  EXPECT_THROW(output_of({"check", "roussel-slump", "--model", "water"}), SceneError);
  EXPECT_THROW(output_of({"check", "roussel-slump", "--set", "mpm.cel=1"}), SceneError);
  EXPECT_THROW(output_of({"check"}), CLI::RequiredError);
}

}  // namespace
}  // namespace flowrest::scenes::test
