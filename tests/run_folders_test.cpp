// `flowrest mpm`, `foam` and `run` in folders and under circumstances that others make: who else writes
// there, what stands there, a full disk, no memory, closed streams, and whatever asks a process to stop.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "runs/command.h"
#include "runs/process.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

namespace {

constexpr double longest_wait = 200.0;  // s; only what hangs takes as long

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class RunFolders : public testing::Test {
 protected:
  /// A shell's command in the folder; "flowrest" is the program, "$short" a run of a tenth of a second,
  /// "$endless" one that only an interrupt ends, "$base" what they share.
  std::string script(const std::string& command) const {
    return "flowrest() { '" + std::string(FLOWREST_PROGRAM) +
           "' \"$@\"; }\nsettings='--set mpm.cell=0.02 --set mpm.threads=1 --set time.stop_at_rest=false'\n"
           "base=\"mpm roussel-slump $settings\"\n"
           "short=\"$base --set time.end=0.3\"\n"
           "endless=\"$base --set time.end=500 --set output.history_interval=0.01\"\n" +
           command;
  }

  std::unique_ptr<runs::Process> start(const std::string& command) const {
    return std::make_unique<runs::Process>("/bin/bash", std::vector<std::string>{"-c", script(command)},
                                           folder, folder / "log", std::map<std::string, std::string>{});
  }

  int call(const std::string& command) const {
    const auto process = start(command);
    const auto end = process->wait(longest_wait);
    EXPECT_TRUE(end) << "it does not come to an end: " << command;
    EXPECT_EQ(end.value_or(runs::ProcessEnd{}).signal, 0) << command;
    return end.value_or(runs::ProcessEnd{1, 0, 0.0}).exit_code;
  }

  std::string log() const { return text_of(folder / "log"); }
  runs::Run run(const std::string& name = "run") const { return runs::read_run(folder / name); }

  /// Waits until a run has written some rows.
  void wait_for_rows(const std::string& name = "run") const {
    const auto begin = std::chrono::steady_clock::now();
    while (text_of(folder / name / "history.csv").size() < 2000 &&
           std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(longest_wait))
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

}  // namespace

TEST_F(RunFolders, ASecondWriterIsRefusedAndTouchesNothing) {
  const auto first = start("exec '" FLOWREST_PROGRAM "' $endless --quiet -o run");
  wait_for_rows();
  const std::string info = text_of(folder / "run" / "run.json");
  for (const std::string command : {"flowrest $endless -o run", "flowrest $short -o run",
                                    "flowrest $short --force -o run", "flowrest mpm --resume run"}) {
    const std::string output = (folder / "second").string();
    EXPECT_EQ(call("{ " + command + "; } 2>'" + output + "'"), 2) << command;
    EXPECT_THAT(text_of(output), HasSubstr("run: process ")) << command;
    EXPECT_THAT(text_of(output), HasSubstr(" is writing here")) << command;
  }
  EXPECT_EQ(text_of(folder / "run" / "run.json"), info);
  first->signal(SIGINT);
  ASSERT_TRUE(first->wait(longest_wait));
  EXPECT_EQ(first->poll()->exit_code, 130);
  EXPECT_EQ(run().status(), runs::Status::interrupted);
  EXPECT_EQ(run().info["settings"]["time"]["end"], 500.0);
}

TEST_F(RunFolders, OfManyThatStartAtOnceOneWrites) {
  // As the tasks of an array that was sent off without a folder for each.
  const std::string tasks =
      "for end in 0.1 0.2 0.3 0.4; do (flowrest $base --set output.history_interval=0.01 --set time.end=$end "
      "--quiet; echo $? > code-$end) & "
      "done; wait";
  EXPECT_EQ(call(tasks), 0);
  int done = 0;
  for (const char* end : {"0.1", "0.2", "0.3", "0.4"}) {
    const std::string code = text_of(folder / (std::string("code-") + end));
    EXPECT_TRUE(code == "0\n" || code == "2\n") << code << log();
    done += code == "0\n" ? 1 : 0;
  }
  EXPECT_EQ(done, 1) << "the others either came while it wrote or found its run\n" << log();
  const auto left = run("out/roussel-slump/mpm-elasto-viscoplastic");
  EXPECT_EQ(left.status(), runs::Status::end_time);
  EXPECT_EQ(left.history.at("time_s").back(), left.info["settings"]["time"]["end"].get<double>());
}

TEST_F(RunFolders, AFinishedRunIsTakenAsItIsAndAnotherIsNotReplacedWithoutAWord) {
  ASSERT_EQ(call("flowrest $short -o run --json"), 0) << log();
  const std::string info = text_of(folder / "run" / "run.json"), first = log();
  ASSERT_EQ(call("flowrest $short -o run --json"), 0) << log();
  EXPECT_THAT(log(), HasSubstr("run: this run is there already (end-time)"));
  EXPECT_EQ(log().substr(log().find('{')), first.substr(first.find("{\"status"))) << "the same last line";
  EXPECT_EQ(call("flowrest $base --set time.end=0.4 -o run"), 2);
  EXPECT_THAT(log(), HasSubstr("time.end is 0.3 there and 0.4 here"));
  EXPECT_THAT(log(), HasSubstr("--force"));
  EXPECT_EQ(text_of(folder / "run" / "run.json"), info);
  EXPECT_EQ(call("flowrest $base --set time.end=0.4 --force -o run"), 0) << log();
  EXPECT_EQ(run().history.at("time_s").back(), 0.4);
}

TEST_F(RunFolders, AFullDiskEndsARunWithAReasonAndAnExitCodeOfItsOwn) {
  // A limit on the size of files stands in for the disk: a row, a snapshot or a checkpoint passes it.
  for (const int kibibytes : {20, 40, 64}) {
    const std::string name = "run-" + std::to_string(kibibytes);
    EXPECT_EQ(call("ulimit -f " + std::to_string(kibibytes) + "; flowrest $endless --quiet -o " + name), 5)
        << log();
    EXPECT_THAT(log(), ::testing::AnyOf(HasSubstr("File too large"), HasSubstr("is the disk full?")));
    const auto left = run(name);
    EXPECT_EQ(left.status(), runs::Status::failed) << kibibytes;
    EXPECT_EQ(left.info["failure"], "machine");
    EXPECT_THAT(left.info["verdict"].get<std::string>(), Not(HasSubstr("sound")));
    EXPECT_THAT(log(), HasSubstr(left.info["reason"].get<std::string>().substr(15)));
  }
}

TEST_F(RunFolders, WhatTheMachineEndedIsGoneOnWith) {
  ASSERT_EQ(call("flowrest $short --set output.checkpoint_interval=0.1 --quiet -o whole"), 0) << log();
  const auto written = fs::file_size(folder / "whole" / "checkpoint.h5");
  ASSERT_EQ(call("ulimit -f " + std::to_string(written / 1024) +
                 "; flowrest $short --set output.checkpoint_interval=0.1 --quiet -o run"),
            5)
      << log();
  EXPECT_EQ(call("flowrest $short --set output.checkpoint_interval=0.1 --quiet -o run"), 2);
  EXPECT_THAT(log(), HasSubstr(runs::shell_word(FLOWREST_PROGRAM) + " mpm --resume run"));
  ASSERT_EQ(call("flowrest mpm --quiet --resume run"), 0) << log();
  EXPECT_EQ(text_of(folder / "run" / "history.csv"), text_of(folder / "whole" / "history.csv"));
  EXPECT_EQ(run().info["verdict"], run("whole").info["verdict"]);
  EXPECT_FALSE(run().info.contains("failure"));
}

TEST_F(RunFolders, WithoutMemoryItSaysSoAndWhatARunTakes) {
  EXPECT_EQ(call("ulimit -v 1000000; flowrest mpm roussel-slump --set mpm.threads=1 --set "
                 "geometry.dimension=full --set mpm.cell=0.002 --quiet -o run"),
            5)
      << log();
  EXPECT_THAT(log(), HasSubstr("out of memory: a run like this takes about "));
  EXPECT_FALSE(fs::exists(folder / "run")) << "it had not begun";
}

TEST_F(RunFolders, ClosedStreamsAreNoPlaceForData) {
  ASSERT_EQ(call("flowrest $short -o whole"), 0) << log();
  ASSERT_EQ(call("flowrest $short --json -o run <&- >&- 2>&-"), 0);
  for (const char* file : {"history.csv", "profiles.csv", "particles/particles.hdf.series"})
    EXPECT_EQ(text_of(folder / "run" / file), text_of(folder / "whole" / file)) << file;
  EXPECT_EQ(run().info["gauge"], run("whole").info["gauge"]);
}

TEST_F(RunFolders, WordsThatFindNoRoomAreLostAndTheRunIsNot) {
  EXPECT_EQ(call("flowrest $short -o run 2>/dev/full"), 0);
  EXPECT_EQ(call("flowrest $short --set material.plastic_viscosity=600 -o noted 2>/dev/full"), 0);
  EXPECT_EQ(run().status(), runs::Status::end_time);
  EXPECT_EQ(call("flowrest $short --json -o run >/dev/full"), 5);
  EXPECT_THAT(log(), HasSubstr("standard output: cannot be written: No space left on device"));
}

TEST_F(RunFolders, WhateverAsksItToStopLeavesARunThatIsGoneOnWith) {
  for (const int number : {SIGTERM, SIGHUP, SIGUSR1, SIGXCPU}) {
    const std::string name = "run-" + std::to_string(number);
    const auto process = start("exec '" FLOWREST_PROGRAM "' $endless --quiet -o " + name);
    wait_for_rows(name);
    process->signal(number);
    const auto end = process->wait(longest_wait);
    ASSERT_TRUE(end);
    EXPECT_EQ(end->exit_code, 130) << strsignal(number);
    EXPECT_EQ(run(name).status(), runs::Status::interrupted) << strsignal(number);
    EXPECT_TRUE(fs::exists(folder / name / "checkpoint.h5"));
  }
}

TEST_F(RunFolders, WhereNobodyReadsItStopsAsWhenInterrupted) {
  // Progress comes every five seconds where there is no terminal.
  EXPECT_EQ(call("flowrest $endless -o run 2>&1 | true; exit ${PIPESTATUS[0]}"), 130);
  EXPECT_EQ(run().status(), runs::Status::interrupted);
  EXPECT_TRUE(fs::exists(folder / "run" / "checkpoint.h5"));
}

TEST_F(RunFolders, ALimitOnTheTimeOfComputingIsAnInterrupt) {
  EXPECT_EQ(call("ulimit -S -t 2; flowrest $endless --quiet -o run"), 130) << log();
  EXPECT_EQ(run().status(), runs::Status::interrupted);
}

TEST_F(RunFolders, UnderNohupAClosedTerminalEndsNothing) {
  const auto process = start("trap '' HUP; exec '" FLOWREST_PROGRAM "' $endless --quiet -o run");
  wait_for_rows();
  process->signal(SIGHUP);
  EXPECT_FALSE(process->wait(1.0));
  process->signal(SIGTERM);
  ASSERT_TRUE(process->wait(longest_wait));
  EXPECT_EQ(process->poll()->exit_code, 130);
}

TEST_F(RunFolders, AllRunsOfASceneAreMadeOnceAndGoneOnWith) {
  std::string scene = text_of(fs::path(FLOWREST_SCENES) / "roussel-slump.toml");
  const auto runs_named = scene.find("runs = {");
  ASSERT_NE(runs_named, std::string::npos);
  scene.replace(runs_named, scene.find('\n', runs_named) - runs_named,
                "runs = { mpm = [\"elasto-viscoplastic\"] }");
  std::ofstream(folder / "small.toml") << scene;
  const std::string settings =
      " --set mpm.cell=0.02 --set time.stop_at_rest=false --set output.history_interval=0.01 -j 1";
  const std::string made = "out/small/mpm-elasto-viscoplastic";
  const auto process = start("exec '" FLOWREST_PROGRAM "' run small.toml" + settings + " --set time.end=20");
  wait_for_rows(made);
  process->signal(SIGTERM);
  ASSERT_TRUE(process->wait(longest_wait));
  EXPECT_EQ(process->poll()->exit_code, 130) << log();
  EXPECT_EQ(run(made).status(), runs::Status::interrupted);
  // With other settings the part that was made is somebody's work.
  EXPECT_EQ(call("flowrest run small.toml" + settings + " --set time.end=19"), 2) << log();
  EXPECT_EQ(call("flowrest run small.toml" + settings + " --set time.end=20"), 0) << log();
  EXPECT_TRUE(run(made).info.contains("resumed_at_s"));
  const std::string info = text_of(folder / made / "run.json");
  EXPECT_EQ(call("flowrest run small.toml" + settings + " --set time.end=20"), 0) << log();
  EXPECT_EQ(text_of(folder / made / "run.json"), info) << "it was made again";
  EXPECT_THAT(log(), HasSubstr("is there already"));
}
