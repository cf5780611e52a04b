#include "mpm/solver/team.h"

#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <numeric>
#include <stdexcept>

using namespace flowrest::mpm;
using namespace std::chrono_literals;

namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

TEST(Team, EveryLoopIsDoneBeforeTheNextOneBegins) {
  for (const int threads : {1, 2, 3, 17, 64}) {
    Team team(threads);
    EXPECT_EQ(team.threads(), threads);
    // Plain numbers: whoever does a block sees what others did of the loop before.
    std::vector<int> one(500, 0), other(500, 0);
    for (int loop = 1; loop <= 300; ++loop) {
      team.run(one.size(), [&](std::uint32_t i, int) { one[i] = other[other.size() - 1 - i] + 1; });
      team.run(one.size(), [&](std::uint32_t i, int) { other[i] = one[one.size() - 1 - i]; });
      ASSERT_EQ(other, std::vector<int>(500, loop)) << threads << " threads";
    }
  }
}

TEST(Team, ThreadsHaveNumbersOfTheirOwn) {
  Team team(3);
  std::vector<int> at_work(3, 0);
  for (int loop = 0; loop < 100; ++loop)
    team.run(200, [&](std::uint32_t, int thread) {
      auto& mine = at_work.at(static_cast<std::size_t>(thread));
      EXPECT_EQ(++mine, 1);
      --mine;
    });
}

TEST(Team, ALoopMayHaveNoBlockOrFewerThanThreads) {
  Team team(4);
  int runs = 0;
  team.run(0, [&](std::uint32_t, int) { ++runs; });
  EXPECT_EQ(runs, 0);
  std::vector<int> each(2, 0);
  team.run(each.size(), [&](std::uint32_t i, int) { ++each[i]; });
  EXPECT_EQ(each, std::vector<int>({1, 1}));
}

TEST(Team, OthersComeToHelp) {
  Team team(2);
  // The caller's block ends once somebody else has begun the other one.
  std::atomic<bool> helped{false};
  std::vector<std::thread::id> by(2);
  team.run(2, [&](std::uint32_t i, int) {
    by[i] = std::this_thread::get_id();
    if (i == 0)
      while (!helped) std::this_thread::yield();
    else
      helped = true;
  });
  EXPECT_EQ(by[0], std::this_thread::get_id());
  EXPECT_NE(by[1], by[0]);
}

TEST(Team, WhatABodyThrowsReachesTheCallerOnWhicheverThreadItIs) {
  for (const int threads : {1, 2, 5}) {
    Team team(threads);
    for (std::uint32_t bad = 0; bad < 20; ++bad) {
      const auto failing = [&](std::uint32_t i, int) {
        if (i == bad) throw std::runtime_error("block " + std::to_string(i));
      };
      try {
        team.run(20, failing);
        FAIL() << "nothing was thrown";
      } catch (const std::runtime_error& error) {
        EXPECT_EQ(error.what(), "block " + std::to_string(bad));
      }
      // And the team is as good as before.
      std::atomic<int> runs{0};
      team.run(20, [&](std::uint32_t, int) { ++runs; });
      EXPECT_EQ(runs, 20);
    }
    EXPECT_THROW(team.run(20, [](std::uint32_t, int) { throw std::runtime_error("all"); }),
                 std::runtime_error);
  }
}

TEST(Team, ThreadsThatWaitCostNoProcessorTime) {
  Team team(8);
  const auto slow = [](std::uint32_t, int) { std::this_thread::sleep_for(40ms); };
  team.run(8, [](std::uint32_t, int) {});
  const double begin = cpu_seconds();
  for (int loop = 0; loop < 5; ++loop) {
    team.run(1, slow);                  // one has something to do
    std::this_thread::sleep_for(20ms);  // none has
  }
  EXPECT_LT(cpu_seconds() - begin, 0.05) << "in 0.3 s, with eight threads";
}

TEST(Team, MayGoWithoutHavingWorked) {
  for (int i = 0; i < 200; ++i) Team(1 + i % 7);
}
