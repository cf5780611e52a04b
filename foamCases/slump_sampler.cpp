#include "foamCases/slump_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "foamCases/field_file.h"
#include "runs/depth.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

namespace {

constexpr double rim_depth_bound = 3e-3;  // m, the depth at which the spread is read
constexpr double volume_bound = 0.1;      // relative; a bounded phase fraction keeps the volume to 1e-6

}  // namespace

SlumpSampler::SlumpSampler(const scenes::Scene& scene, fs::path case_directory, runs::RunWriter& writer)
    : Sampler(scene, std::move(case_directory), writer), grid_(wedge_grid(scene)) {
  std::vector<std::string> columns{
      "time_s",      "spread_mm",   "spread_1p5_mm",    "spread_6_mm",        "front_mm",
      "height_mm",   "volume_m3",   "kinetic_energy_J", "shear_rate_p99_1_s", "initial_residual_U",
      "courant_max", "time_step_s", "trapped_air_m3"};
  if (scene.thixotropy) columns.push_back("flocculation_mean");
  writer.history_columns(columns);
}

void SlumpSampler::sample(double time, const fs::path& directory) {
  const SlumpFields fields{read_internal_field(directory / "alpha.concrete", grid_.cells(), 1),
                           read_internal_field(directory / "U", grid_.cells(), 3)};
  if (scene().thixotropy) {
    // At the start the solver has not yet written the field: it is what the scene says.
    const auto flocculation =
        time > 0.0 ? read_internal_field(directory / "flocculation", grid_.cells(), 1)
                   : std::vector<double>(grid_.cells(), scene().thixotropy->initial_flocculation);
    state_.flocculation = mean_over_concrete(grid_, fields.fraction, flocculation);
  }
  const auto gauges =
      gauge_slump(grid_, fields, scene().material.density, scene().base.law == scenes::Wall::slip);
  if (time == 0.0) state_.first_volume = gauges.volume;
  state_.time = time;
  state_.spread = runs::spread(gauges.radius, gauges.depth);
  state_.front = gauges.front;
  state_.height = runs::centre_depth(gauges.radius, gauges.depth);
  state_.volume = gauges.volume;
  state_.rim_depth = gauges.rim_depth;
  state_.volume_error = std::max(state_.volume_error, std::abs(gauges.volume / state_.first_volume - 1.0));
  if (history_is_due(time)) write_history(time, gauges);
  if (profile_is_due(time)) writer().profile(time, gauges.radius, gauges.depth);
}

void SlumpSampler::write_history(double time, const SlumpGauges& gauges) {
  const auto spread_mm = [&](double threshold) {
    return 1e3 * runs::spread(gauges.radius, gauges.depth, threshold);
  };
  const SolverStep steps = since_last_row(time);
  std::vector<double> row{time,
                          spread_mm(0.003),
                          spread_mm(0.0015),
                          spread_mm(0.006),
                          1e3 * gauges.front,
                          1e3 * state_.height,
                          gauges.volume,
                          gauges.kinetic_energy,
                          gauges.shear_rate_p99,
                          steps.initial_residual_u,
                          steps.courant,
                          steps.time_step,
                          gauges.trapped_air};
  if (scene().thixotropy) row.push_back(state_.flocculation);
  writer().history(row);
}

std::string SlumpSampler::progress() const { return fmt::format("spread {:.1f} mm", 1e3 * state_.spread); }

std::string SlumpSampler::fault() const {
  if (state_.rim_depth > rim_depth_bound)
    return fmt::format(
        "the concrete reached the rim of the mesh at {:.4g} s: geometry.domain_radius = {:g} m must be "
        "larger",
        state_.time, scene().slump().domain_radius);
  if (!(state_.volume_error < volume_bound))
    return fmt::format("the volume of concrete is off by {:.0f} % at {:.4g} s: the flow diverges",
                       100.0 * state_.volume_error, state_.time);
  return "";
}

nlohmann::ordered_json SlumpSampler::summary() const {
  return {{"spread_mm", 1e3 * state_.spread},
          {"front_mm", 1e3 * state_.front},
          {"height_mm", 1e3 * state_.height},
          {"initial_volume_error", state_.first_volume / scene().slump().volume() - 1.0},
          {"volume_error", state_.volume_error}};
}

}  // namespace flowrest::foam
