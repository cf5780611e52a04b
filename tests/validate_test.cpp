// `flowrest validate` from end to end: runs are made once, an interrupted validation says so and leaves a
// page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "runs/command.h"
#include "runs/process.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

constexpr double longest_wait = 300.0;  // s; only what hangs takes as long

class ValidateTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!runs::find_program("snakemake"))
      GTEST_SKIP() << "Snakemake is not installed (apt-get install snakemake)";
  }

  std::unique_ptr<runs::Process> start(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "validate", "mix-a-slump-sf0",         "--solver", "mpm", "--model", "elasto-viscoplastic",
        "-o",       (folder / "out").string(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<runs::Process>(FLOWREST_PROGRAM, arguments, folder, folder / "log",
                                           std::map<std::string, std::string>{});
  }

  std::string log() const {
    std::ifstream file(folder / "log");
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  /// When each run's record was last written.
  std::map<std::string, fs::file_time_type> written() const {
    std::map<std::string, fs::file_time_type> times;
    std::error_code error;
    for (const auto& run : fs::directory_iterator(folder / "out" / "runs", error))
      if (fs::exists(run.path() / "history.csv"))
        times[run.path().filename()] = fs::last_write_time(run.path() / "history.csv");
    return times;
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

}  // namespace

TEST_F(ValidateTest, MakesEveryRunOnce) {
  for (int round = 0; round < 2; ++round) {
    const auto before = written();
    const auto process = start({"--set", "mpm.cell=0.02"});
    const auto end = process->wait(longest_wait);
    ASSERT_TRUE(end && end->good()) << log();
    EXPECT_THAT(log(), HasSubstr("mix-a-slump-sf0      MPM solid                  535 mm"));
    EXPECT_EQ(written().size(), 2u) << "two resolutions";
    if (round > 0) {
      EXPECT_EQ(written(), before) << "a whole run was made again";
    }
  }
  const auto json = nlohmann::json::parse(std::ifstream(folder / "out" / "validation.json"));
  EXPECT_TRUE(json["scenes"][0]["numbers"][0]["uncertainty"].is_number());
  EXPECT_TRUE(fs::exists(folder / "out" / "index.html"));
  EXPECT_TRUE(fs::exists(folder / "out" / "validation.csv"));
}

TEST_F(ValidateTest, InterruptedItSaysHowToGoOnAndLeavesAPage) {
  const auto process = start({"--set", "mpm.cell=0.004"});
  const auto begin = std::chrono::steady_clock::now();
  while (written().empty() &&
         std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(longest_wait))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_FALSE(written().empty()) << log();
  process->signal(SIGINT);
  const auto end = process->wait(longest_wait);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 130) << log();
  EXPECT_THAT(log(), HasSubstr("the same command goes on with it"));
  std::ifstream page(folder / "out" / "index.html");
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  // With the path of the program, which is not the one that a shell finds by its name.
  EXPECT_THAT(html, HasSubstr("Make what is missing: <code>" + runs::shell_word(FLOWREST_PROGRAM) +
                              " validate mix-a-slump-sf0 -o "));
}
