// How the program speaks with whoever runs it: every command that it advises runs as printed, notes keep out
// of the way of programs that read it, and what one command does for a kind of scene, all do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "runs/command.h"
#include "runs/process.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

constexpr double longest_wait = 300.0;  // s; only what hangs takes as long

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class Manners : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder);
    std::ofstream(folder / "my scene.toml")
        << "extends = \"roussel-slump\"\n"
           "runs = { mpm = [\"elasto-viscoplastic\", \"papanastasiou\"], foam = [], elements = false }\n";
  }

  std::unique_ptr<runs::Process> start(const std::vector<std::string>& arguments) {
    return std::make_unique<runs::Process>(FLOWREST_PROGRAM, arguments, folder, temporary.path() / "log",
                                           std::map<std::string, std::string>{});
  }

  int run(const std::vector<std::string>& arguments) { return exit_code(*start(arguments)); }

  /// A command line as a user pastes it.
  int paste(const std::string& command) {
    runs::Process shell("/bin/sh", {"-c", command}, folder, temporary.path() / "log", {});
    return exit_code(shell);
  }

  int exit_code(runs::Process& process) {
    const auto end = process.wait(longest_wait);
    return end && end->signal == 0 ? end->exit_code : -1;
  }

  std::string said() const { return text_of(temporary.path() / "log"); }

  /// The commands in a text: to the closing mark where they stand between two, else to the end of their line.
  static std::vector<std::string> commands_in(const std::string& text) {
    std::vector<std::string> commands;
    const std::string program = runs::shell_word(FLOWREST_PROGRAM) + " ";
    for (auto at = text.find(program); at != std::string::npos; at = text.find(program, at + 1)) {
      const bool marked = at > 0 && text[at - 1] == '`';
      commands.push_back(text.substr(at, text.find_first_of(marked ? "`\n" : "\n", at) - at));
    }
    return commands;
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path() / "it's my folder";
  const std::vector<std::string> quick = {"--set",         "mpm.cell=0.025", "--set",
                                          "time.end=0.05", "--set",          "title=quick and \"rough\""};
  std::vector<std::string> with_quick(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), quick.begin(), quick.end());
    return arguments;
  }
};

}  // namespace

TEST_F(Manners, AnInterruptedRunIsGoneOnWithByTheCommandItPrints) {
  const std::vector<std::string> arguments = {"mpm",   "my scene.toml",   "-o",    "a run",
                                              "--set", "mpm.cell=0.0125", "--set", "time.end=6"};
  const auto process = start(arguments);
  const fs::path history = folder / "a run" / "history.csv";
  for (int i = 0; i < 1000 && (!fs::exists(history) || fs::file_size(history) < 1000); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  process->signal(SIGINT);
  ASSERT_EQ(exit_code(*process), 130) << said();
  const auto commands = commands_in(said());
  ASSERT_THAT(commands, Not(IsEmpty())) << said();
  ASSERT_EQ(run(arguments), 2) << "it has begun there and is not made anew without a word";
  EXPECT_THAT(commands_in(said()), testing::ElementsAre(commands.back())) << said();
  EXPECT_EQ(paste(commands.back()), 0) << commands.back() << "\n" << said();
  EXPECT_EQ(Json::parse(text_of(folder / "a run" / "run.json"))["status"], "end-time");
}

TEST_F(Manners, AReportsCommandsMakeTheMissingRunsWithTheSameSettings) {
  ASSERT_EQ(run(with_quick({"mpm", "my scene.toml", "--model", "elasto-viscoplastic", "-o", "a run"})), 0)
      << said();
  ASSERT_EQ(run({"compare", "a run", "-o", "a report", "--no-figures"}), 0) << said();
  const Json report = Json::parse(text_of(folder / "a report" / "comparison.json"));
  ASSERT_THAT(report["missing"], SizeIs(1));
  const auto commands = commands_in(report["missing"][0].get<std::string>());
  ASSERT_THAT(commands, SizeIs(1)) << report["missing"];
  ASSERT_EQ(paste(commands.front()), 0) << commands.front() << "\n" << said();
  const Json made = Json::parse(text_of(folder / "out" / "my scene" / "mpm-papanastasiou" / "run.json"));
  EXPECT_EQ(made["model"], "papanastasiou");
  EXPECT_EQ(made["settings"]["time"]["end"], 0.05);
  EXPECT_EQ(made["settings"]["mpm"]["cell"], 0.025);
  EXPECT_EQ(made["title"], "quick and \"rough\"");
}

TEST_F(Manners, AMadeRunSaysWhatMakesItAgain) {
  ASSERT_EQ(run(with_quick({"mpm", "my scene.toml", "--model", "papanastasiou", "-o", "a run"})), 0)
      << said();
  const Json info = Json::parse(text_of(folder / "a run" / "run.json"));
  const auto request = runs::request_of(info);
  ASSERT_TRUE(request);
  auto arguments = runs::scene_arguments(*request);
  arguments.insert(arguments.begin(), "mpm");
  arguments.insert(arguments.end(), {"-o", "again"});
  ASSERT_EQ(run(arguments), 0) << said();
  EXPECT_EQ(text_of(folder / "again" / "history.csv"), text_of(folder / "a run" / "history.csv"));
}

TEST_F(Manners, WhatAValidationLacksIsMadeByTheCommandItPrints) {
  if (!runs::find_program("snakemake"))
    GTEST_SKIP() << "Snakemake is not installed (apt-get install snakemake)";
  ASSERT_EQ(run(with_quick({"validate", "my scene.toml", "-o", "a validation", "--report-only", "--solver",
                            "mpm", "--model", "elasto-viscoplastic"})),
            0)
      << said();
  const auto commands = commands_in(said());
  ASSERT_THAT(commands, SizeIs(1)) << said();
  EXPECT_EQ(paste(commands.front()), 0) << commands.front() << "\n" << said();
  EXPECT_THAT(commands_in(said()), IsEmpty()) << "nothing is missing any more";
}

TEST_F(Manners, AnAccuracyThatNobodyKnowsIsAnsweredWithACommandThatRuns) {
  EXPECT_EQ(run({"run", "mix-a-lbox-sf0", "--accuracy", "2%", "--set", "geometry.dimension=plane", "--set",
                 "time.end=0.02", "--set", "mpm.cell=0.02"}),
            2);
  EXPECT_THAT(said(), HasSubstr("no study has measured what accuracy a l-box"));
  EXPECT_THAT(fs::exists(folder / "out"), false) << "nothing is written";
  const auto commands = commands_in(said());
  ASSERT_THAT(commands, SizeIs(1)) << said();
  EXPECT_EQ(paste(commands.front()), 0) << commands.front() << "\n" << said();
}

TEST_F(Manners, EveryKindOfSceneHasItsReport) {
  for (const std::string scene :
       {"mix-a-lbox-sf0", "mix-a-vfunnel-sf0", "dam-break", "poiseuille-step-down"}) {
    ASSERT_EQ(run({"run", scene, "--set", "geometry.dimension=plane", "--set", "time.end=0.04", "--set",
                   "mpm.cell=0.02", "--set", "output.history_interval=0.01", "--set", "runs.foam=[]"}),
              0)
        << scene << "\n"
        << said();
    EXPECT_TRUE(fs::exists(folder / "out" / scene / "report" / "index.html")) << scene;
    EXPECT_THAT(said(), HasSubstr("The report: ")) << scene;
  }
}

TEST_F(Manners, NotesKeepOutOfWhatProgramsRead) {
  const std::string program = runs::shell_word(FLOWREST_PROGRAM);
  const std::string settings = " --set material.density=2.3 --set time.end=0.01 --set mpm.cell=0.025 --json";
  for (const std::string command : {" check roussel-slump", " mpm roussel-slump --quiet -o noted",
                                    " exact roussel-slump -o 'noted exactly'"}) {
    const bool has_json_settings = command.find("exact") == std::string::npos;
    paste(program + command + settings + " 2>notes >answer");
    EXPECT_THAT(text_of(folder / "notes"), HasSubstr("Note: material.density is 2.3 kg/m3")) << command;
    const std::string answer = text_of(folder / "answer");
    EXPECT_THAT(answer, Not(HasSubstr("Note: "))) << command;
    if (has_json_settings) {
      const auto end = answer.find_last_not_of('\n');
      EXPECT_FALSE(Json::parse(answer.substr(answer.rfind('\n', end) + 1), nullptr, false).is_discarded())
          << answer;
    }
  }
  const auto noted = [](const Json& json) { return json["notes"].get<std::vector<std::string>>(); };
  EXPECT_THAT(noted(Json::parse(text_of(folder / "noted" / "run.json"))),
              Contains(HasSubstr("in t/m3 or g/cm3 that would be 2300 kg/m3")));
  // A report says it of its runs, and the run of a whole scene says it once.
  paste(program + " compare noted --no-figures -o report 2>notes >answer");
  EXPECT_THAT(text_of(folder / "notes"), HasSubstr("Note: In the scene material.density is 2.3 kg/m3"));
  paste(program + " run 'my scene.toml'" + settings.substr(0, settings.find(" --json")) + " 2>notes >answer");
  const std::string notes = text_of(folder / "notes");
  const std::string first = "Note: material.density is 2.3 kg/m3";
  EXPECT_THAT(notes, HasSubstr(first));
  EXPECT_EQ(notes.find(first), notes.rfind(first)) << notes;
}
