// Printed strands: what comes out of the nozzle is there, and where it should be.
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "mpm/output/checkpoint.h"
#include "mpm/output/test_runs.h"
#include "runs/csv.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

constexpr double bore_area = std::numbers::pi * 0.0125 * 0.0125;  // m2
constexpr double printing = 0.03, extrusion = 0.0336;             // m/s

/// Case 1 on cells of 5 mm, 30 mm of strand and a moment to stand.
scenes::Scene short_strand(const std::vector<std::string>& more = {}) {
  return scenes::load_scene(
      "printing-1",
      {with({"mpm.cell=0.005", "mpm.precision=double", "mpm.threads=1", "geometry.layer_length=0.03",
             "time.end=1.1", "output.history_interval=0.1", "output.checkpoint_interval=0.3"},
            more),
       {}});
}

class Print : public RunTest {};

}  // namespace

TEST_F(Print, AllThatIsExtrudedIsThereAndNoMore) {
  const auto run = run_and_read(short_strand());
  const double fed = bore_area * extrusion * 0.03 / printing;
  EXPECT_NEAR(run.history.at("volume_at_rest_m3").back(), fed, 1e-9 * fed);
  EXPECT_EQ(run.info["verdict"].get<std::string>().find("noisy"), std::string::npos) << run.info["verdict"];
  for (const double made : run.history.at("numerical_energy_J"))
    EXPECT_GT(made, -0.02 * run.history.at("dissipated_energy_J").back());
}

TEST_F(Print, HalfAStrandIsHalfOfTheWhole) {
  const auto half = run_and_read(short_strand({"time.end=0.5"}), "half");
  const auto whole = run_and_read(short_strand({"time.end=0.5", "geometry.dimension=full"}), "whole");
  for (const char* column : {"volume_m3", "volume_at_rest_m3", "kinetic_energy_J", "potential_energy_J",
                             "dissipated_energy_J", "nozzle_drag_N", "nozzle_push_N"}) {
    const double a = half.history.at(column).back(), b = whole.history.at(column).back();
    EXPECT_NEAR(a, b, 1e-6 * std::abs(b)) << column;
  }
}

TEST_F(Print, GoesOnBitForBitAndWithAnyNumberOfThreads) {
  const auto scene = short_strand({"time.end=0.6"});
  run(scene, options("whole"));
  auto stopped = options("stopped");
  stopped.interrupted = [asked = 0]() mutable { return asked++ == 777; };
  EXPECT_EQ(run(scene, stopped).status, runs::Status::interrupted);
  EXPECT_EQ(resume(options("stopped"), {"mpm.threads=2"}).status, runs::Status::end_time);
  EXPECT_EQ(text_of(folder / "whole/history.csv"), text_of(folder / "stopped/history.csv"));
  EXPECT_EQ(text_of(folder / "whole/sections.csv"), text_of(folder / "stopped/sections.csv"));
  const auto a = read_checkpoint(folder / "whole"), b = read_checkpoint(folder / "stopped");
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->solver.cells, b->solver.cells);
  for (int k = 0; k < a->solver.array_count; ++k) ASSERT_EQ(a->solver.array(k), b->solver.array(k));
}

/// Coarse and short, so not yet quite what is fed; the section has the shape of two independent prototypes on
/// finer cells: 48 mm wide and 12.6 mm high.
TEST_F(Print, AStrandHasTheSectionThatIsFed) {
  const auto run = run_and_read(
      short_strand({"geometry.layer_length=0.13", "time.end=4.4", "mpm.precision=float", "mpm.threads=0"}));
  EXPECT_NEAR(run.history.at("area_over_balance").back(), 1.0, 0.06);
  EXPECT_NEAR(run.history.at("strand_width_mm").back(), 48.0, 4.0);
  EXPECT_NEAR(run.history.at("strand_height_mm").back(), 12.6, 1.0);
  EXPECT_LT(run.history.at("base_width_mm").back(), run.history.at("strand_width_mm").back() + 0.1);
  EXPECT_TRUE(std::isnan(run.history.at("strand_width_mm").front()));
  EXPECT_EQ(run.history.at("nozzle_push_N").back(), 0.0) << "it has gone";
  // sections.csv: stretches of one section's length from where the nozzle began, whose rows sum to what is fed, and are
  // as wide as the gauge says.
  const runs::Table sections = runs::read_csv(folder / "run/sections.csv");
  std::map<double, double> area, widest;  // by place, at the last time
  for (std::size_t i = 0; i < sections.rows(); ++i) {
    if (sections.at("time_s")[i] != sections.at("time_s").back()) continue;
    const double x = sections.at("x_m")[i], half = sections.at("half_width_m")[i];
    area[x] += 2.0 * half * run.info["cell_m"].get<double>();
    widest[x] = std::max(widest[x], 2.0 * half);
    EXPECT_EQ(sections.at("layer")[i], sections.at("z_m")[i] < 0.0125 ? 1.0 : sections.at("layer")[i]);
  }
  ASSERT_GE(area.size(), 4U);
  EXPECT_NEAR(area.rbegin()->first - area.begin()->first, 0.025 * static_cast<double>(area.size() - 1),
              1e-12);
  const double fed = bore_area * extrusion / printing;
  for (const auto& [x, own] : area)
    if (x > area.begin()->first && x < area.rbegin()->first) {
      EXPECT_NEAR(own, fed, 0.1 * fed) << x;
    }
  EXPECT_NEAR(1e3 * std::prev(widest.end(), 2)->second, run.history.at("strand_width_mm").back(), 2.0);
}

/// Along both legs of the corner lies what was fed for them, and all of it is there.
TEST_F(Print, ACornerIsPrintedAlongBothItsLegs) {
  const auto run = run_and_read(scenes::load_scene(
      "printing-corner",
      {{"mpm.cell=0.005", "mpm.precision=double", "output.history_interval=0.1", "time.end=2.6",
        "process.path=[[0,0.05,0,0.0125],[1.2,0.086,0,0.0125],[2.4,0.086,0.036,0.0125]]"},
       {}}));
  const double fed = bore_area * extrusion * 2.4;
  EXPECT_NEAR(run.history.at("volume_at_rest_m3").back(), fed, 1e-9 * fed);
  EXPECT_TRUE(std::isnan(run.history.at("strand_width_mm").back()));
  // Beyond the corner's own square there is a good part of it on either leg, the more on the later one: what
  // fills the gap under the nozzle goes along with it.
  std::array<double, 2> beyond{};
  const auto checkpoint = read_checkpoint(folder / "run");
  ASSERT_TRUE(checkpoint);
  for (const auto& cell : checkpoint->solver.cells) {
    const double x = 0.005 * cell[0], y = 0.005 * cell[1];
    if (x < 0.086 - 0.018) beyond[0] += 1.0;
    if (y > 0.018) beyond[1] += 1.0;
  }
  const auto all = static_cast<double>(checkpoint->solver.cells.size());
  EXPECT_GT(beyond[0], 0.15 * all);
  EXPECT_GT(beyond[1], beyond[0]);
  EXPECT_LT(beyond[0] + beyond[1], all);
}

TEST_F(Print, ASecondLayerLiesOnTheFirst) {
  const auto run = run_and_read(
      short_strand({"geometry.layers=2", "geometry.layer_length=0.075", "geometry.direction=alternating",
                    "process.pause=0.1", "time.end=5.3", "mpm.precision=float", "mpm.threads=0"}));
  const double fed = 2.0 * bore_area * extrusion * 0.075 / printing;
  EXPECT_NEAR(run.history.at("volume_at_rest_m3").back(), fed, 1e-5 * fed);
  EXPECT_NEAR(run.history.at("strand_height_mm").back(), 25.0, 2.5);
  EXPECT_NEAR(run.history.at("area_over_balance").back(), 1.0, 0.2);
}
