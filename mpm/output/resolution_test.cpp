// Whether a run's cells resolve the layer that is sheared, against what is known of it.
#include <fmt/format.h>

#include <functional>

#include "mpm/output/test_runs.h"

namespace flowrest::mpm {

using namespace test;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace {

/// 1000 Pa and 10 Pa s under 30 kN/m3 between plates 0.1 m apart: a plug over layers of h/2 - tau0/F = 16.67
/// mm that moves at 0.41667 m/s.
scenes::Scene channel(const std::string& cell, const std::vector<std::string>& more = {}) {
  return scenes::load_scene(
      "poiseuille-100", {with({"geometry.height=0.1", "material.density=1000", "material.yield_stress=1000",
                               "material.plastic_viscosity=10", "forces.body_force=30000",
                               "mpm.particles_per_cell=4", "mpm.threads=1", "output.history_interval=0.02",
                               "time.end=0.16", "mpm.cell=" + cell, "foam.cell=" + cell},
                              more),
                         {}});
}

std::function<bool()> stop_after(int steps) {
  return [steps, made = 0]() mutable { return ++made > steps; };
}

}  // namespace

class MpmResolution : public RunTest {};

TEST_F(MpmResolution, AChannelIsUnderResolvedWhereItsShearedLayerHasTooFewCells) {
  for (const auto& [cell, cells] :
       {std::pair{"0.01", 1.67}, std::pair{"0.005", 3.33}, std::pair{"0.0025", 6.67}}) {
    const auto run = run_and_read(channel(cell), cell);
    const auto& resolution = run.info["resolution"];
    std::printf("    %s m: %.2f cells (exactly %.2f), plug %.4f m/s (exactly 0.4167)\n", cell,
                resolution["cells"].get<double>(), cells, run.history.at("plug_velocity_m_s").back());
    // A cell smears the layer over its neighbour: a coarse grid sees it thicker than it is.
    EXPECT_NEAR(resolution["cells"].get<double>(), cells, 0.5) << cell;
    EXPECT_NEAR(resolution["sheared_layer_m"].get<double>(),
                resolution["cells"].get<double>() * std::stod(cell), 1e-9);
    EXPECT_EQ(resolution["wanted"], 5.0);
    EXPECT_GT(resolution["at_s"], 0.0);
    const std::string verdict = run.info["verdict"];
    if (cells < 5.0) {
      EXPECT_THAT(verdict, StartsWith("under-resolved: "));
      EXPECT_THAT(verdict, HasSubstr(fmt::format("{:.1f} cells over the sheared layer",
                                                 resolution["cells"].get<double>())));
    } else {
      EXPECT_EQ(verdict, "sound");
    }
  }
}

TEST_F(MpmResolution, NothingIsHeldBySlipWallsNorSheared) {
  const auto run = run_and_read(channel("0.01", {"walls.base=slip"}));
  EXPECT_TRUE(run.info["resolution"].is_null());
  EXPECT_EQ(run.info["verdict"], "sound");
}

TEST_F(MpmResolution, AResumedRunIsJudgedByAllOfItsRows) {
  const auto scene = tiny_slump({"time.end=0.4"});
  const auto whole = run_and_read(scene, "whole");
  auto stopped = options("stopped");
  stopped.interrupted = stop_after(150);
  ASSERT_EQ(run(scene, stopped).status, runs::Status::interrupted);
  ASSERT_EQ(resume(options("stopped")).status, runs::Status::end_time);
  const auto resumed = runs::read_run(folder / "stopped");
  ASSERT_FALSE(whole.info["resolution"].is_null());
  EXPECT_EQ(resumed.info["resolution"], whole.info["resolution"]);
  EXPECT_EQ(resumed.info["verdict"], whole.info["verdict"]);
}

TEST_F(MpmResolution, ASlumpsLayerThinsAsItComesToRest) {
  const auto run = run_and_read(tiny_slump({"time.end=2", "mpm.cell=0.0125"}));
  const auto& layer = run.history.at("sheared_layer_mm");
  const auto& time = run.history.at("time_s");
  for (std::size_t i = 1; i < time.size(); ++i)
    if (time[i] > 0.5) {
      EXPECT_LT(layer[i], 70.0) << time[i];
      EXPECT_GT(layer[i], 10.0) << time[i];
    }
  EXPECT_LT(layer.back(), 0.8 * layer[10]);
}

}  // namespace flowrest::mpm
