#include "mpm/commands.h"

#include <algorithm>

#include "mpm/output/test_runs.h"

using namespace flowrest;
using namespace flowrest::mpm::test;
using testing::AllOf;
using testing::HasSubstr;

namespace {

/// What a command line is refused for.
std::string refusal_of(std::vector<std::string> arguments) {
  CLI::App app;
  app.require_subcommand(1);
  mpm::add_commands(app);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app.parse(arguments);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

class MpmCommand : public RunTest {};

}  // namespace

TEST_F(MpmCommand, NoOptionIsTakenAndDropped) {
  run(tiny_slump(), options("run"));
  const std::string folder_of_run = (folder / "run").string(), before = text_of(folder / "run" / "run.json");
  const auto resumed = [&](const std::vector<std::string>& more) {
    return refusal_of(with({"mpm", "--resume", folder_of_run}, more));
  };
  EXPECT_THAT(resumed({"--set", "time.end=2", "--model", "nonsense", "-o", "x"}), HasSubstr("unknown model"));
  EXPECT_THAT(
      resumed({"--set", "time.end=2", "--model", "papanastasiou", "-o", "x"}),
      AllOf(HasSubstr("--model and --output given with --resume"), HasSubstr("allowed with --resume")));
  EXPECT_THAT(resumed({"roussel-slump"}), HasSubstr("excludes"));
  EXPECT_THAT(resumed({"--set", "mpm.cell=0.01"}), HasSubstr("mpm.cell"));
  EXPECT_THAT(resumed({}), HasSubstr("is finished"));
  EXPECT_THAT(
      refusal_of({"mpm", "roussel-slump", "--model", "newtonian", "--set", "material.model=nonsense"}),
      HasSubstr("one of them"));
  EXPECT_THAT(refusal_of({"mpm"}), HasSubstr("a scene, or --resume RUN"));
  EXPECT_EQ(text_of(folder / "run" / "run.json"), before);
}

TEST_F(MpmCommand, ProlongsAFinishedRun) {
  run(tiny_slump({"time.end=0.1"}), options("run"));
  EXPECT_EQ(refusal_of({"mpm", "--resume", (folder / "run").string(), "--set", "time.end=0.15", "--quiet"}),
            "accepted");
  EXPECT_EQ(runs::read_run(folder / "run").history.rows(), 4u);
}
