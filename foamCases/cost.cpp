#include "foamCases/cost.h"

#include <algorithm>
#include <cmath>

#include "foamCases/step_rules.h"

namespace flowrest::foam {

namespace {

/// Cell-steps per CPU second of interFoam with the plug-in: 16,407 steps of 1,710 cells took 361 s.
constexpr double cell_steps_per_cpu_second = 7e4;
/// Memory held for one cell of a mesh, and by a program that has nothing to do yet; bytes.
constexpr double bytes_per_cell = 2000.0;
constexpr double bytes_of_interfoam = 1e8;

/// Steps but for those that the Courant number shortens.
double unhurried_steps(const ApparatusCase& apparatus) {
  const double first = largest_step(apparatus), most = grown_step(apparatus);
  const double end = apparatus.scene().time.end;
  const double grows = first / step_of_time, grown = most / step_of_time;
  if (most <= first || end <= grows) return end / first;
  return grows / first + std::log(std::min(end, grown) / grows) / step_of_time +
         std::max(end - grown, 0.0) / most;
}

/// Steps of a run.
double steps_of(const ApparatusCase& apparatus) {
  const scenes::Scene& scene = apparatus.scene();
  const double unhurried = unhurried_steps(apparatus);
  const auto speed = apparatus.lasting_speed();
  if (!speed) return unhurried;
  return std::max(unhurried, scene.time.end * *speed / (scene.foam.max_courant * apparatus.smallest_cell()));
}

}  // namespace

scenes::FoamEstimate estimate(const scenes::Scene& scene) {
  const auto apparatus = case_of(scene);
  scenes::FoamEstimate estimate;
  estimate.cells = apparatus->estimated_cells();
  estimate.step = grown_step(*apparatus);
  estimate.steps = std::max(1.0, std::ceil(steps_of(*apparatus)));
  estimate.cost.memory = bytes_of_interfoam + bytes_per_cell * estimate.cells;
  estimate.cost.cpu_seconds =
      scene.foam.outer_correctors * estimate.cells * estimate.steps / cell_steps_per_cpu_second;
  return estimate;
}

}  // namespace flowrest::foam
