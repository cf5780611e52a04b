#include "compare/exact/funnel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "compare/exact/exact_run.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"
#include "scenes/scene.h"

namespace flowrest::compare::exact {
namespace {

constexpr double gravity = 9.81, density = 2400.0;

/// EN 12350-9.
Funnel standard() {
  return {0.6, 0.15, 0.075,
          [](double at) { return 0.065 + 0.45 * std::clamp((at - 0.15) / 0.45, 0.0, 1.0); }};
}

std::vector<FunnelFlow::State> run(const Funnel& funnel, double friction, Neck neck) {
  return FunnelFlow(funnel, density, gravity, friction, neck).run(4.0, 0.01);
}

double time_of(const std::vector<FunnelFlow::State>& states, double discharged) {
  for (const auto& state : states)
    if (state.discharged >= discharged) return state.time;
  return -1.0;
}

TEST(FunnelFlow, AWideTankRunsOutAsTorricelliSays) {
  // 0.1 m of a tank 1 m wide over a slot of 10 mm: v = sqrt(2 g h), so that sqrt(h) falls evenly.
  const Funnel tank{0.2, 0.0, 0.1,
                    [](double at) { return at < 1e-9 ? 0.01 : 0.01 + 0.99 * std::min(1.0, at / 0.01); }};
  const auto states = FunnelFlow(tank, density, gravity, 0.0, Neck::seals).run(6.0, 0.05);
  const auto at = [&](double time) {
    return states.at(static_cast<std::size_t>(std::lround(time / 0.05))).surface;
  };
  const double fall = (std::sqrt(at(1.0)) - std::sqrt(at(4.0))) / 3.0;
  EXPECT_NEAR(fall, 0.5 * std::sqrt(2.0 * gravity) * 0.01 / 1.0, 0.03 * fall);
}

TEST(FunnelFlow, WithoutFrictionAStraightPipeFallsFreely) {
  const Funnel pipe{0.6, 0.0, 0.075, [](double) { return 0.065; }};
  for (const auto& state : run(pipe, 0.0, Neck::seals)) {
    if (state.surface > 0.01) {
      EXPECT_NEAR(state.surface, 0.6 - 0.5 * gravity * state.time * state.time, 2e-3);
    }
  }
}

TEST(FunnelFlow, AllOfItRunsOut) {
  for (const Neck neck : {Neck::lets_go, Neck::seals})
    for (const double friction : {0.0, 0.3}) {
      const auto states = run(standard(), friction, neck);
      EXPECT_NEAR(states.back().discharged, 1.0, 1e-6);
      for (std::size_t i = 1; i < states.size(); ++i)
        EXPECT_GE(states[i].discharged, states[i - 1].discharged);
    }
}

TEST(FunnelFlow, ANeckThatSealsDrawsItDownAndFrictionHoldsItBack) {
  const auto free = run(standard(), 0.3, Neck::lets_go), sealed = run(standard(), 0.3, Neck::seals);
  EXPECT_LT(time_of(sealed, 0.9), 0.8 * time_of(free, 0.9));
  EXPECT_GT(time_of(free, 0.9), 1.3 * time_of(run(standard(), 0.0, Neck::lets_go), 0.9));
  const auto suction = [](const auto& states) {
    double most = 0.0;
    for (const auto& state : states) most = std::max(most, state.suction);
    return most;
  };
  EXPECT_NEAR(suction(free), 0.0, 1e-3);
  // At most the weight of the neck and what the head above it draws down.
  EXPECT_GT(suction(sealed), 0.7e3);
  EXPECT_LT(suction(sealed), density * gravity * 0.6);
}

TEST(FunnelFlow, LeavesARunOfEitherNeck) {
  const runs::TemporaryFolder folder;
  const auto scene = scenes::load_scene("mix-a-vfunnel-sf0");
  const auto runs_made = write_exact_runs(scene, folder.path() / "exact");
  ASSERT_EQ(runs_made.size(), 2u);
  for (const ExactRun& made : runs_made) {
    const auto run = runs::read_run(made.directory);
    EXPECT_NEAR(run.history.at("discharged_fraction").back(), 1.0, 1e-6);
    EXPECT_TRUE(run.history.has("suction_max_Pa"));
  }
  EXPECT_THROW(write_exact_runs(scenes::load_scene("mix-a-vfunnel-sf0", {{"walls.base=no-slip"}, {}}),
                                folder.path() / "held"),
               runs::RunError);
}

}  // namespace
}  // namespace flowrest::compare::exact
