#include "foamCases/solver_log.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "foamCases/test_scene.h"

namespace flowrest::foam {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string step_text(double time, double time_step, double residual) {
  return fmt::format(
      "Courant Number mean: 0.01 max: 0.125\n"
      "Interface Courant Number mean: 0.001 max: 0.1\n"
      "deltaT = {}\n"
      "Time = {}\n\n"
      "PIMPLE: iteration 1\n"
      "DILUPBiCGStab:  Solving for Ux, Initial residual = {}, Final residual = 1e-9, No Iterations 3\n"
      "DILUPBiCGStab:  Solving for Uy, Initial residual = 0.9, Final residual = 1e-9, No Iterations 3\n"
      "DILUPBiCGStab:  Solving for Uz, Initial residual = {}, Final residual = 1e-9, No Iterations 3\n"
      "GAMG:  Solving for p_rgh, Initial residual = 0.5, Final residual = 1e-8, No Iterations 4\n"
      "ExecutionTime = 1.5 s  ClockTime = 2 s\n\n",
      time_step, time, 0.5 * residual, residual);
}

TEST(SolverLog, ReadsStepsFromPiecesOfAnyLength) {
  const std::string text = "Build  : OPENFOAM=1912 patch=200626\n" + step_text(0.5, 0.25, 0.01) +
                           step_text(0.75, 0.125, 0.02) + "End\n";
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, text.size()}) {
    SolverLog log;
    std::vector<SolverStep> steps;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      log.feed(text.substr(at, piece));
      for (const auto& step : log.take_steps()) steps.push_back(step);
    }
    ASSERT_EQ(steps.size(), 2U) << "pieces of " << piece;
    EXPECT_EQ(steps[0].time, 0.5);
    EXPECT_EQ(steps[0].time_step, 0.25);
    EXPECT_EQ(steps[0].courant, 0.125);
    EXPECT_EQ(steps[0].initial_residual_u, 0.01);  // the swirl Uy, empty in a wedge, does not count
    EXPECT_EQ(steps[1].initial_residual_u, 0.02);
    EXPECT_EQ(log.build(), "OPENFOAM=1912 patch=200626");
    EXPECT_TRUE(log.ended());
    EXPECT_EQ(log.fault(), "");
  }
}

TEST(SolverLog, CountsTheComponentsItIsTold) {
  SolverLog log("xyz");
  log.feed(step_text(0.5, 0.25, 0.01));
  EXPECT_EQ(log.take_steps().at(0).initial_residual_u, 0.9);
  EXPECT_EQ(log.execution_time(), 1.5);
}

TEST(SolverLog, AHalfWrittenLineDoesNotCountYet) {
  SolverLog log;
  log.feed(step_text(0.5, 0.25, 0.01) + "Courant Number mean: 0 max: 0.1\ndeltaT = 0.1\nTime = 1.2");
  EXPECT_EQ(log.time_begun(), 0.5);
  log.feed("5\n");
  EXPECT_EQ(log.time_begun(), 1.25);
  EXPECT_EQ(log.take_steps().size(), 1U);
  EXPECT_FALSE(log.ended());
}

TEST(SolverLog, QuotesAFatalError) {
  SolverLog log;
  log.feed(step_text(0.5, 0.25, 0.01) +
           "\n--> FOAM FATAL ERROR: \nMaximum number of iterations exceeded\n\n    From function solve()\n");
  EXPECT_THAT(log.fault(), HasSubstr("FOAM FATAL ERROR: Maximum number of iterations exceeded"));
}

TEST(SolverLog, KnowsANumberThatIsNone) {
  SolverLog log;
  std::string text = step_text(0.5, 0.25, 0.01);
  text.replace(text.find("0.005"), 5, "nan");
  log.feed(text);
  EXPECT_THAT(log.fault(), HasSubstr("Solving for Ux, Initial residual = nan"));
}

TEST(SolverLog, KnowsAFloatingPointException) {
  SolverLog log;
  log.feed("#1  Foam::sigFpe::sigHandler(int) at ??:?\n");
  EXPECT_THAT(log.fault(), HasSubstr("floating point exception"));
}

TEST(FileTail, GivesOnlyWhatIsNew) {
  const testing::TemporaryFolder folder;
  FileTail tail(folder.path() / "log");
  EXPECT_EQ(tail.read(), "");
  std::ofstream file(folder.path() / "log");
  file << "one" << std::flush;
  EXPECT_EQ(tail.read(), "one");
  EXPECT_EQ(tail.read(), "");
  file << " two" << std::flush;
  EXPECT_EQ(tail.read(), " two");
}

/// What the plug-in prints comes between the end of a step and the beginning of the next.
TEST(SolverLog, ReadsTheChatterOfAVelocityThatIsWatched) {
  SolverLog log;
  const std::string watched = "Chatter of U = 0.003\nNoise of U = 2e-5\n";
  log.feed(step_text(0.1, 0.1, 0.01) + step_text(0.2, 0.1, 0.01) + watched + step_text(0.3, 0.1, 0.01) +
           step_text(0.4, 0.1, 0.01));
  const auto steps = log.take_steps();
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_FALSE(steps[1].chatter);
  EXPECT_EQ(steps[2].chatter, 0.003);
  EXPECT_EQ(steps[2].noise, 2e-5);
  EXPECT_FALSE(steps[3].chatter);
  EXPECT_FALSE(steps[3].noise);
}

constexpr double height = 0.3;  // m

NoiseMonitor monitored(const std::vector<double>& residual_of_block) {
  NoiseMonitor monitor(height);
  double time = 0.0;
  for (const double residual : residual_of_block)
    for (std::size_t i = 0; i < NoiseMonitor::block_steps; ++i)
      monitor.add({time += 0.01, 0.01, 0.1, residual});
  monitor.finish();
  return monitor;
}

TEST(NoiseMonitor, PassesARunThatOnlyStartsRoughly) {
  const auto monitor = monitored({0.8, 0.02, 0.01, 0.015});
  EXPECT_EQ(monitor.verdict(), "sound");
  EXPECT_EQ(monitor.largest_median(), 0.02);
}

TEST(NoiseMonitor, TellsWhenARunIsNoisyEvenForAMoment) {
  const auto monitor = monitored({0.8, 0.02, 0.4, 0.01, 0.01});
  EXPECT_THAT(monitor.verdict(), StartsWith("noisy: "));
  EXPECT_THAT(monitor.verdict(), HasSubstr("in 25 % of the run, between 1.01 and 1.50 s, and reaches 0.4"));
  EXPECT_EQ(monitor.noisy_share(), 0.25);
}

TEST(NoiseMonitor, ASingleRoughStepIsNotNoise) {
  NoiseMonitor monitor(height);
  for (int i = 0; i < 200; ++i) monitor.add({0.01 * i, 0.01, 0.1, i == 120 ? 0.9 : 0.01});
  monitor.finish();
  EXPECT_EQ(monitor.verdict(), "sound");
}

TEST(NoiseMonitor, JudgesTheLastStepsOfARunToo) {
  NoiseMonitor monitor(height);
  for (int i = 0; i < 70; ++i) monitor.add({0.01 * i, 0.01, 0.1, i < 50 ? 0.01 : 0.5});
  monitor.finish();
  EXPECT_THAT(monitor.verdict(), StartsWith("noisy: "));
}

/// Blocks with a residual and a chatter each, of concrete that moves at `speed`, m/s; a block lasts half a
/// second.
NoiseMonitor watched(const std::vector<std::pair<double, double>>& blocks, double speed = 0.1) {
  NoiseMonitor monitor(height);
  double time = 0.0;
  for (const auto& [residual, chatter] : blocks)
    for (std::size_t i = 0; i < NoiseMonitor::block_steps; ++i)
      monitor.add({time += 0.01, 0.01, 0.1, residual, chatter, chatter * speed});
  monitor.finish();
  return monitor;
}

TEST(NoiseMonitor, ASmoothVelocityIsSoundWhateverItsResidual) {
  const auto monitor = watched({{0.8, 0.5}, {0.3, 1e-6}, {0.25, 2e-5}});
  EXPECT_EQ(monitor.verdict(), "sound");
  EXPECT_EQ(monitor.largest_median(), 2e-5);
  EXPECT_EQ(monitor.largest_residual_median(), 0.3);
  EXPECT_EQ(monitor.path(), 0.0);
}

TEST(NoiseMonitor, AVelocityThatChattersIsNoisyWhateverItsResidual) {
  const auto monitor = watched({{0.02, 1e-4}, {0.02, 1e-4}, {0.02, 0.4}, {0.02, 1e-4}});
  EXPECT_THAT(monitor.verdict(), StartsWith("noisy: the chatter of the velocity passes 0.05"));
  EXPECT_THAT(monitor.verdict(), HasSubstr("in 33 % of the run, between 1.01 and 1.50 s, and reaches 0.4"));
  EXPECT_THAT(monitor.verdict(), HasSubstr("moved the concrete by 20 mm, where 3 are allowed"));
}

/// What all but stands may chatter: it moves nothing.
TEST(NoiseMonitor, ChatterIsNoiseWhereItCouldHaveMovedTheBody) {
  const std::vector<std::pair<double, double>> blocks = {{0.02, 1e-4}, {0.02, 1e-4}, {0.02, 0.4}};
  const auto still = watched(blocks, 0.01);
  EXPECT_NEAR(still.path(), 0.4 * 0.01 * 0.5, 1e-12);
  EXPECT_EQ(still.verdict(), "sound");
  EXPECT_EQ(still.noisy_share(), 0.5);
  EXPECT_THAT(watched(blocks, 0.02).verdict(), StartsWith("noisy: "));
}

/// As in the log of a plug-in that told no speed, from which a run is gone on with.
TEST(NoiseMonitor, ChatterOfNoKnownSpeedIsNoise) {
  NoiseMonitor monitor(height);
  for (int i = 0; i < 100; ++i) monitor.add({0.01 * i, 0.01, 0.1, 0.02, i < 50 ? 1e-4 : 0.4});
  monitor.finish();
  EXPECT_THAT(monitor.verdict(), StartsWith("noisy: the chatter of the velocity passes 0.05"));
}

TEST(NoiseMonitor, VouchesForNothingItHasNotSeen) {
  EXPECT_THAT(monitored({0.01}).verdict(), StartsWith("unjudged: "));
}

}  // namespace
}  // namespace flowrest::foam
