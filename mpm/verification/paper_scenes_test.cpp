// The papers' scenes on cells so coarse that each takes a second, held to what the solver gave when the full
// scenes were measured (docs/measured): they notice that an answer changes, not that it is right.
#include <algorithm>
#include <cmath>

#include "mpm/output/test_runs.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

std::vector<std::string> coarse(const std::vector<std::string>& more) {
  return with({"mpm.threads=1", "output.snapshot_interval=100", "output.checkpoint_interval=100"}, more);
}

class PaperScenes : public RunTest {
 protected:
  runs::Run made(const std::string& name, const std::vector<std::string>& more) const {
    return run_and_read(scenes::load_scene(name, {coarse(more), {}}), name);
  }
};

double last(const runs::Run& run, const std::string& column) { return run.history.at(column).back(); }

/// Time at which a column first reaches a value, s; -1 where it never does.
double time_of(const runs::Run& run, const std::string& column, double value, bool upwards) {
  const auto& series = run.history.at(column);
  for (std::size_t i = 0; i < series.size(); ++i)
    if (upwards ? series[i] >= value : series[i] <= value) return run.history.at("time_s")[i];
  return -1.0;
}

}  // namespace

TEST_F(PaperScenes, ALiftedMouldLeavesItsConcreteToSpreadAsItRested) {
  // Reference: 15 mm cells, double precision, AVX-512.
  const struct {
    const char* scene;
    double spread;  // mm
  } references[] = {{"mix-a-slump-sf0", 557.3},
                    {"mix-a-slump-sf600", 474.3},
                    {"mix-b-slump-sf600", 390.1},
                    {"luo-mix4-sf30", 235.2}};
  double before = 1e3;
  for (const auto& reference : references) {
    const auto run = made(reference.scene, {"mpm.cell=0.015"});
    const double spread = last(run, "spread_mm");
    std::printf("    %s: %.1f mm, at rest after %.2f s\n", reference.scene, spread, last(run, "time_s"));
    EXPECT_EQ(run.status(), runs::Status::at_rest);
    EXPECT_NEAR(spread, reference.spread, 0.01 * reference.spread);
    EXPECT_LT(spread, before);
    before = spread;
    EXPECT_NEAR(last(run, "volume_at_rest_m3"), run.history.at("volume_at_rest_m3").front(), 1e-12);
    // Flocs break while it flows and grow again at rest.
    const auto& lambda = run.history.at("flocculation_mean");
    if (lambda.front() > 0.0) {
      const double least = *std::min_element(lambda.begin(), lambda.end());
      EXPECT_LT(least, 0.9 * lambda.front());
      EXPECT_GT(lambda.back(), least);
    }
  }
}

TEST_F(PaperScenes, FlocsGrowAgainInTheSolidAndGoOnBreakingInTheFluid) {
  // Yu et al., Fig. 15: both break flocs alike while they flow; at rest the solid's grow by A_thix / tau0.
  const std::vector<std::string> settings = {"mpm.cell=0.015", "time.end=3", "time.stop_at_rest=false"};
  const auto solid = made("mix-a-slump-sf600", settings);
  const auto fluid = run_and_read(
      scenes::load_scene("mix-a-slump-sf600", {coarse(settings), scenes::Model::papanastasiou}), "fluid");
  const auto at = [](const runs::Run& run, double time) {
    const auto& times = run.history.at("time_s");
    const auto i = std::lower_bound(times.begin(), times.end(), time - 1e-9) - times.begin();
    return run.history.at("flocculation_mean")[static_cast<std::size_t>(i)];
  };
  std::printf("    lambda at 0.5, 1 and 3 s: solid %.4f, %.4f, %.4f; fluid %.4f, %.4f, %.4f\n",
              at(solid, 0.5), at(solid, 1.0), last(solid, "flocculation_mean"), at(fluid, 0.5),
              at(fluid, 1.0), last(fluid, "flocculation_mean"));
  EXPECT_LT(at(solid, 0.5), 0.75 * at(solid, 0.0));
  EXPECT_NEAR(at(fluid, 0.5), at(solid, 0.5), 2e-3 * at(solid, 0.5));
  const double growth = (last(solid, "flocculation_mean") - at(solid, 1.0)) / 2.0;
  EXPECT_NEAR(growth, 0.39 / 92.0, 0.02 * 0.39 / 92.0);
  EXPECT_LT(last(fluid, "flocculation_mean"), at(fluid, 1.0));
}

TEST_F(PaperScenes, AnLBoxRunsUnderItsFrontWallAndTheStifferMixStopsShorter) {
  // Without side walls to hold it, the softer mix surges up the end wall and stays there.
  // Reference: the plane section without bars, 20 mm cells; on 10 mm 102.0 mm at the end and a front at 581.1
  // mm.
  const auto a = made("mix-a-lbox-sf0", {"geometry.dimension=plane", "mpm.cell=0.02", "time.end=3"});
  const auto b = made("mix-b-lbox-sf600", {"geometry.dimension=plane", "mpm.cell=0.02", "time.end=3"});
  const double arrival = time_of(a, "front_mm", 600.0 - 1e-6, true);
  std::printf("    mix A: arrives after %.2f s, %.1f mm at the end; mix B: %.1f mm\n", arrival,
              last(a, "end_height_mm"), last(b, "front_mm"));
  EXPECT_NEAR(arrival, 0.82, 0.1);
  EXPECT_NEAR(last(a, "end_height_mm"), 98.4, 4.0);
  EXPECT_NEAR(last(b, "front_mm"), 584.2, 10.0);
}

TEST_F(PaperScenes, AnLBoxsGateHoldsBackWhatItHasNotLetGo) {
  // Reference: the plane section, 20 mm cells.
  const std::vector<std::string> settings = {"geometry.dimension=plane", "mpm.cell=0.02", "time.end=1.2"};
  const auto slow = made("mix-a-lbox-sf0", with(settings, {"geometry.gate_lift_velocity=0.01"}));
  const auto gone = made("mix-a-lbox-sf0", with(settings, {"geometry.gate_lift_velocity=1000"}));
  const double arrival = time_of(gone, "front_mm", 600.0 - 1e-6, true);
  std::printf("    gone at once: arrives after %.2f s; at 0.01 m/s the front is at %.1f mm after 1.2 s\n",
              arrival, last(slow, "front_mm"));
  EXPECT_NEAR(arrival, 0.44, 0.06);
  EXPECT_LT(last(slow, "front_mm"), 60.0);
  EXPECT_GT(last(slow, "start_height_mm"), 560.0);
}

TEST_F(PaperScenes, AnLBoxsBarsLetTheSofterMixPassAndHoldItBack) {
  // Reference: half of the box, 16.7 mm cells, three to the distance of the bars, which are 0.7 of a cell
  // thick.
  const std::vector<std::string> settings = {"mpm.cell=0.0166666667", "mpm.precision=float", "time.end=0.7"};
  const auto barred = made("mix-a-lbox-sf0", settings);
  const auto open = made("mix-a-lbox-sf0", with(settings, {"geometry.rebars=0"}));
  std::printf("    front at %.1f mm after 0.7 s, %.1f mm without bars\n", last(barred, "front_mm"),
              last(open, "front_mm"));
  EXPECT_NEAR(last(barred, "front_mm"), 330.6, 15.0);
  EXPECT_GT(last(open, "front_mm"), last(barred, "front_mm") + 20.0);
}

TEST_F(PaperScenes, AFunnelRunsEmptyAndLightIsSeenAtTheEnd) {
  // Reference: the plane section, 16.25 mm cells.
  const auto run = made("mix-a-vfunnel-sf0", {"geometry.dimension=plane", "mpm.cell=0.01625", "time.end=2"});
  const double light = time_of(run, "thinnest_sight_mm", 3.0, false);
  std::printf("    light after %.2f s, %.1f %% discharged at the end\n", light,
              100.0 * last(run, "discharged_fraction"));
  EXPECT_NEAR(light, 1.41, 0.05);
  EXPECT_GT(last(run, "discharged_fraction"), 0.98);
  const auto& discharged = run.history.at("discharged_fraction");
  EXPECT_TRUE(std::is_sorted(discharged.begin(), discharged.end()));
}

TEST_F(PaperScenes, ADamBreaksBetweenSlipWalls) {
  // Reference: 30 mm cells. The front is slower than Ritter's 2 sqrt(g H), which has no start to overcome.
  const auto run = made("dam-break", {"mpm.cell=0.03", "time.end=0.3"});
  std::printf("    front at %.1f mm after 0.3 s\n", last(run, "front_mm"));
  EXPECT_NEAR(last(run, "front_mm"), 1359.9, 0.02 * 1359.9);
  EXPECT_LT(last(run, "front_mm"), 600.0 + 1e3 * 2.0 * std::sqrt(9.8 * 0.6) * 0.3);
}
