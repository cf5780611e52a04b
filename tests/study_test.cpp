// `flowrest study` from end to end: a small study is made, killed at random moments, gone on with, and gives
// what it gives undisturbed.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "runs/process.h"
#include "runs/run_directory.h"

using namespace flowrest;
namespace fs = std::filesystem;

namespace {

const fs::path program = FLOWREST_PROGRAM;

const std::string text = R"(title = "Small"
scene = "roussel-slump"
quantities = ["spread_mm"]
[settings]
time = { end = 0.6, stop_at_rest = false }
output.checkpoint_interval = 0.1
[reference]
kind = "run"
settings = { mpm.cell = 0.0125 }
twin = { mpm.cell = 0.015 }
[[sweep]]
name = "MPM"
axes = { "mpm.cell" = [0.02, 0.0175], "mpm.precision" = ["double", "float"] }
)";

class StudyCommand : public testing::Test {
 protected:
  void SetUp() override {
    if (!runs::find_program("snakemake")) FAIL() << "snakemake is missing: scripts/setup installs it";
    folder = fs::temp_directory_path() /
             ("flowrest-study-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
              "-" + std::to_string(::getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(folder / "small.toml") << text;
  }
  void TearDown() override { fs::remove_all(folder); }

  std::vector<std::string> arguments(const std::string& output) const {
    return {"study",  (folder / "small.toml").string(), "-o", (folder / output).string(), "-j", "2",
            "--quiet"};
  }

  runs::ProcessEnd study(const std::string& output) {
    runs::Process process(program, arguments(output), folder, folder / "log", {});
    const auto end = process.wait(240.0);
    EXPECT_TRUE(end) << "it does not come to an end";
    return end.value_or(runs::ProcessEnd{1, 0, 0.0});
  }

  std::string log() const {
    std::ifstream file(folder / "log");
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// What a study found, less what differs from machine to machine and from time to time.
  nlohmann::json found(const std::string& output) const {
    std::ifstream file(folder / output / "study.json");
    const auto study = nlohmann::json::parse(file);
    nlohmann::json result = nlohmann::json::array();
    for (const auto& p : study["points"])
      result.push_back({p["id"], p["verdict"], p["values"], p["relative_errors"]});
    return result;
  }

  fs::path folder;
};

}  // namespace

TEST_F(StudyCommand, KilledAtAnyMomentGoesOnAndFindsTheSame) {
  ASSERT_TRUE(study("undisturbed").good()) << log();
  const auto expected = found("undisturbed");
  ASSERT_EQ(expected.size(), 6u);
  for (const auto& point : expected) EXPECT_TRUE(point[2].contains("spread_mm")) << point;

  std::mt19937 random(7);
  int kills = 0;
  for (const int number : {SIGKILL, SIGINT, SIGKILL, SIGTERM, SIGKILL}) {
    runs::Process process(program, arguments("killed"), folder, folder / "log", {});
    if (process.wait(0.2 + 1e-3 * static_cast<double>(random() % 1800))) continue;
    process.signal(number);
    process.wait(60.0);
    ++kills;
  }
  EXPECT_GT(kills, 0) << "the study is too fast to be interrupted";
  runs::ProcessEnd end = study("killed");
  // The last runs of one that was killed may still hold the folder.
  for (int i = 0; i < 100 && end.exit_code == 2 && log().find("at work here") != std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    end = study("killed");
  }
  ASSERT_TRUE(end.good()) << log();
  EXPECT_EQ(found("killed"), expected) << "bit for bit";
}

TEST_F(StudyCommand, MakesNoRunTwiceAndOnlyThoseThatWereTamperedWith) {
  ASSERT_TRUE(study("out").good()) << log();
  const auto expected = found("out");
  const fs::path run = folder / "out" / "runs" / expected[0][0].get<std::string>();
  const auto written =
      fs::last_write_time(folder / "out" / "runs" / expected[1][0].get<std::string>() / "run.json");
  std::ofstream(run / "run.json", std::ios::app) << "torn";
  ASSERT_TRUE(study("out").good()) << log();
  EXPECT_EQ(found("out"), expected);
  EXPECT_EQ(fs::last_write_time(folder / "out" / "runs" / expected[1][0].get<std::string>() / "run.json"),
            written);
}

TEST_F(StudyCommand, WithoutSnakemakeSaysHowToGetIt) {
  runs::Process process(program, arguments("out"), folder, folder / "log", {{"PATH", "/nonexistent"}});
  const auto end = process.wait(60.0);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 4);
  EXPECT_NE(log().find("apt-get install snakemake"), std::string::npos) << log();
}

TEST_F(StudyCommand, ARunThatTakesTooLongIsStoppedAndSaid) {
  std::ofstream(folder / "small.toml") << "longest_run = 1\n"
                                       << text.substr(0, text.find("[settings]"))
                                       << "[settings]\nmpm.cell = 0.0025\n[[sweep]]\nname = \"MPM\"\n";
  ASSERT_TRUE(study("out").good()) << log();
  EXPECT_EQ(found("out")[0][1], "too long");
}

TEST_F(StudyCommand, AFullDiskEndsARunWithAReasonAndLeavesNoneThatCounts) {
  // A limit on the size of files stands in for the disk; writing past it fails as on a full one.
  for (const int blocks : {1, 8, 16, 64}) {
    const fs::path run = folder / ("run-" + std::to_string(blocks));
    const std::string command = "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; exec '" +
                                program.string() +
                                "' mpm roussel-slump --set mpm.cell=0.02 --set time.end=1 --set "
                                "time.stop_at_rest=false --set output.history_interval=0.001 --quiet -o '" +
                                run.string() + "'";
    runs::Process process("/bin/bash", {"-c", command}, folder, "/dev/null", {});
    const auto end = process.wait(120.0);
    ASSERT_TRUE(end);
    EXPECT_FALSE(end->good()) << blocks;
    EXPECT_EQ(end->signal, 0) << end->how();
    if (!fs::exists(run / "run.json")) continue;
    const auto status = runs::read_run(run).status();
    EXPECT_NE(status, runs::Status::end_time) << blocks;
    EXPECT_NE(status, runs::Status::at_rest) << blocks;
  }
}

TEST_F(StudyCommand, AFolderThatCannotBeWrittenIsSaidAndNothingIsRun) {
  std::ofstream(folder / "out") << "a file in the way";
  EXPECT_EQ(study("out").exit_code, 2);
  EXPECT_NE(log().find("cannot be written"), std::string::npos) << log();
}
