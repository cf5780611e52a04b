// `flowrest study` from end to end: a small study is made, killed at random moments, gone on with, and gives
// what it gives undisturbed.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
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

constexpr double longest_wait = 400.0;  // s; only what hangs takes as long

/// What a process starts, and what those start, found by a mark in their environment: whoever is orphaned
/// keeps it.
class MarkedProcesses {
 public:
  explicit MarkedProcesses(std::string mark) : mark_(std::move(mark)) {}

  std::map<std::string, std::string> environment() const { return {{name, mark_}}; }

  /// Kills them until none is left, those included that were just being started.
  void kill() const {
    for (auto pids = running(); !pids.empty(); pids = running()) {
      for (const pid_t pid : pids) ::kill(pid, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  /// Lets them come to an end of their own.
  void wait_for_end() const {
    const auto begin = std::chrono::steady_clock::now();
    while (!running().empty()) {
      if (std::chrono::steady_clock::now() - begin > std::chrono::duration<double>(longest_wait)) {
        ADD_FAILURE() << "processes of a study that was ended do not end";
        return kill();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

 private:
  static constexpr const char* name = "FLOWREST_STUDY_TEST";

  std::vector<pid_t> running() const {
    const std::string entry = std::string(name) + "=" + mark_;
    std::vector<pid_t> pids;
    std::error_code error;
    for (const auto& process : fs::directory_iterator("/proc", error)) {
      const std::string pid = process.path().filename();
      if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
      std::ifstream file(process.path() / "environ",
                         std::ios::binary);  // empty for the dead that wait for their parent
      for (std::string variable; std::getline(file, variable, '\0');)
        if (variable == entry) pids.push_back(static_cast<pid_t>(std::stol(pid)));
    }
    return pids;
  }

  std::string mark_;
};

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
    const auto end = process.wait(longest_wait);
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

  /// How many files the runs of a study have written so far.
  std::size_t files_of(const std::string& output) const {
    std::size_t files = 0;
    for (const char* part : {"runs", "ended"}) {
      std::error_code error;
      fs::recursive_directory_iterator entry(folder / output / part, error);
      for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) ++files;
    }
    return files;
  }

  /// The marks of runs that have ended. What was killed while it wrote one leaves its part under another
  /// name.
  std::vector<fs::path> marks(const std::string& output) const {
    std::vector<fs::path> marks;
    std::error_code error;
    for (const auto& file : fs::directory_iterator(folder / output / "ended", error))
      if (file.path().extension() == ".json") marks.push_back(file.path());
    return marks;
  }

  /// What says that a run has ended is whole, and so is the run.
  void expect_only_whole_marks(const std::string& output) const {
    for (const auto& mark : marks(output)) {
      std::ifstream file(mark);
      const auto json = nlohmann::json::parse(file, nullptr, false);
      ASSERT_TRUE(json.is_object()) << mark;
      EXPECT_EQ(json.value("ending", ""), "finished") << json.value("reason", "");
      EXPECT_EQ(runs::read_run(folder / output / "runs" / mark.stem()).status(), runs::Status::end_time);
    }
  }

  fs::path folder;
};

}  // namespace

TEST_F(StudyCommand, KilledAtAnyMomentGoesOnAndFindsTheSame) {
  ASSERT_TRUE(study("undisturbed").good()) << log();
  const auto expected = found("undisturbed");
  ASSERT_EQ(expected.size(), 6u);
  for (const auto& point : expected) EXPECT_TRUE(point[2].contains("spread_mm")) << point;
  const std::size_t files_in_all = files_of("undisturbed");

  // The moment of a kill follows from how much has been written, so it comes on a fast machine as on a busy
  // one. A study that ends before its moment is held against the undisturbed one, and the next starts in a
  // new folder.
  std::mt19937 random(7);
  constexpr int numbers[] = {SIGKILL, SIGINT, SIGKILL, SIGTERM, SIGKILL, SIGKILL};
  constexpr int kills_wanted = 6, most_starts = 200;
  int kills = 0, folders = 1;
  const auto output = [&] { return "killed-" + std::to_string(folders); };
  for (int start = 0; start < most_starts && kills < kills_wanted; ++start) {
    MarkedProcesses marked(folder.string());
    runs::Process process(program, arguments(output()), folder, folder / "log", marked.environment());
    const std::size_t moment = files_of(output()) + random() % (files_in_all / 3);
    while (!process.poll() && files_of(output()) < moment)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!process.poll()) {
      const int number = numbers[kills];
      process.signal(number);
      if (number == SIGKILL) marked.kill();  // as when the machine goes down: nobody is left to tidy up
      process.wait(longest_wait);
    }
    marked.wait_for_end();
    expect_only_whole_marks(output());
    if (marks(output()).size() < expected.size()) {
      ++kills;
      continue;
    }
    ASSERT_TRUE(study(output()).good()) << log();
    EXPECT_EQ(found(output()), expected) << "bit for bit";
    ++folders;
  }
  ASSERT_EQ(kills, kills_wanted) << "the study is too fast to be interrupted";
  ASSERT_TRUE(study(output()).good()) << log();
  EXPECT_EQ(found(output()), expected) << "bit for bit";
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
  runs::Process process(program, arguments("out"), folder, folder / "log", {{"PATH", "/dev/null/none"}});
  const auto end = process.wait(longest_wait);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 4);
  EXPECT_NE(log().find("apt-get install snakemake"), std::string::npos) << log();
}

TEST_F(StudyCommand, NeedsNoHomeAndNoFolderOfAPlainName) {
  const std::string nasty = "a b'c\"d$HOME#f;g{h}(i)ü*[j]";
  fs::create_directories(folder / nasty);
  // Settings that would end it, were they read.
  for (const std::map<std::string, std::string>& told :
       {std::map<std::string, std::string>{{"HOME", "/dev/null/home"}, {"SNAKEMAKE_PROFILE", "none"}},
        {{"HOME", ""}, {"XDG_CACHE_HOME", "/dev/null/cache"}, {"PYTHONHOME", "/dev/null/none"}}}) {
    const fs::path output = folder / nasty / std::to_string(told.size());
    runs::Process process(program, arguments(output.string()), folder, folder / "log", told);
    const auto end = process.wait(longest_wait);
    ASSERT_TRUE(end && end->good()) << log();
    EXPECT_FALSE(process.any_left());
  }
}

TEST_F(StudyCommand, AFolderInWhichAClustersJobsWouldNotBeFoundIsRefused) {
  for (const std::string name : {"a$HOME", "a`b", "a\"b", "a\\b"}) {
    std::vector<std::string> more = {"study",     (folder / "small.toml").string(),
                                     "-o",        (folder / name).string(),
                                     "--profile", (folder / "profile").string()};
    runs::Process process(program, more, folder, folder / "log", {});
    const auto end = process.wait(longest_wait);
    ASSERT_TRUE(end);
    EXPECT_EQ(end->exit_code, 2) << log();
    EXPECT_NE(log().find("allowed: a folder (-o) without them"), std::string::npos) << log();
    EXPECT_FALSE(fs::exists(folder / name));
  }
}

TEST_F(StudyCommand, InterruptedTwiceNothingIsLeft) {
  std::ofstream(folder / "small.toml") << text.substr(0, text.find("[settings]"))
                                       << "[settings]\nmpm.cell = 0.0025\n[[sweep]]\nname = \"MPM\"\n";
  MarkedProcesses marked(folder.string());
  runs::Process process(program, arguments("out"), folder, folder / "log", marked.environment());
  const auto begun = [&] {
    for (const auto& run : fs::recursive_directory_iterator(folder / "out"))
      if (run.path().filename() == "history.csv") return true;
    return false;
  };
  const auto latest = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_wait);
  while (!fs::exists(folder / "out") || !begun()) {
    ASSERT_LT(std::chrono::steady_clock::now(), latest) << log();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  process.signal(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  process.signal(SIGINT);
  const auto end = process.wait(longest_wait);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 130) << log();
  EXPECT_FALSE(process.any_left());
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
    const auto end = process.wait(longest_wait);
    ASSERT_TRUE(end);
    EXPECT_FALSE(end->good()) << blocks;
    EXPECT_EQ(end->signal, 0) << end->how();
    if (!fs::exists(run / "run.json")) continue;
    const auto status = runs::read_run(run).status();
    EXPECT_NE(status, runs::Status::end_time) << blocks;
    EXPECT_NE(status, runs::Status::at_rest) << blocks;
  }
}

TEST_F(StudyCommand, AFolderThatMayOnlyBeReadIsSaidByEveryCommandAndNothingIsWritten) {
  // The administrator may write anywhere, unless he gives up that right.
  const std::string as_anybody = ::geteuid() == 0 ? "setpriv --bounding-set=-dac_override " : "";
  const auto call = [&](const std::string& arguments, const std::string& prefix) {
    runs::Process process("/bin/bash", {"-c", "exec " + prefix + "'" + program.string() + "' " + arguments},
                          folder, folder / "log", {});
    const auto end = process.wait(longest_wait);
    EXPECT_TRUE(end) << "it does not come to an end";
    return end.value_or(runs::ProcessEnd{1, 0, 0.0}).exit_code;
  };
  const std::string run = (folder / "whole").string(),
                    settings = " --set mpm.cell=0.02 --set time.end=0.2 --quiet";
  ASSERT_EQ(call("mpm roussel-slump" + settings + " -o '" + run + "'", ""), 0) << log();
  const auto text_of = [&](const fs::path& path) {
    std::ifstream file(path);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string before = text_of(fs::path(run) / "run.json");
  fs::create_directories(folder / "locked");
  const auto read_only = fs::perms::owner_read | fs::perms::owner_exec;
  fs::permissions(folder / "locked", read_only);
  fs::permissions(run, read_only);
  for (const std::string command :
       {"mpm roussel-slump --quiet", "exact roussel-slump", "run roussel-slump", "verify --quick --quiet",
        "study stability --cut quick --quiet", "validate mix-a-slump-sf0 --quiet"}) {
    EXPECT_EQ(call(command + " -o '" + (folder / "locked" / "out").string() + "'", as_anybody), 2)
        << command << '\n'
        << log();
    EXPECT_NE(log().find("cannot be made a folder: Permission denied"), std::string::npos) << command << '\n'
                                                                                           << log();
  }
  EXPECT_EQ(call("compare '" + run + "' -o '" + (folder / "locked" / "out").string() + "'", as_anybody), 2)
      << log();
  EXPECT_TRUE(fs::is_empty(folder / "locked"));
  // A run that is there stays what it is.
  EXPECT_NE(call("mpm roussel-slump" + settings + " -o '" + run + "'", as_anybody), 0) << log();
  EXPECT_EQ(text_of(fs::path(run) / "run.json"), before);
  EXPECT_EQ(runs::read_run(run).status(), runs::Status::end_time);
  for (const fs::path& locked : {folder / "locked", fs::path(run)})
    fs::permissions(locked, fs::perms::owner_all);
}

TEST_F(StudyCommand, AFolderThatCannotBeWrittenIsSaidAndNothingIsRun) {
  std::ofstream(folder / "out") << "a file in the way";
  EXPECT_EQ(study("out").exit_code, 2);
  EXPECT_NE(log().find("cannot be made a folder: "), std::string::npos) << log();
}
