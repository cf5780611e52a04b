#include "foamCases/slump_sampler.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "runs/depth.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

std::vector<std::pair<double, fs::path>> time_directories(const fs::path& case_directory) {
  std::vector<std::pair<double, fs::path>> found;
  for (const auto& entry : fs::directory_iterator(case_directory)) {
    const std::string name = entry.path().filename().string();
    double time = 0.0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), time);
    if (error == std::errc{} && end == name.data() + name.size() && entry.is_directory())
      found.emplace_back(time, entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

SlumpSampler::SlumpSampler(const scenes::Scene& scene, fs::path case_directory, runs::RunWriter& writer)
    : scene_(scene), grid_(wedge_grid(scene)), case_directory_(std::move(case_directory)), writer_(writer) {
  std::vector<std::string> columns{
      "time_s",      "spread_mm",   "spread_1p5_mm",    "spread_6_mm",        "front_mm",
      "height_mm",   "volume_m3",   "kinetic_energy_J", "shear_rate_p99_1_s", "initial_residual_U",
      "courant_max", "time_step_s", "trapped_air_m3"};
  if (scene_.thixotropy) columns.push_back("flocculation_mean");
  writer_.history_columns(columns);
}

void SlumpSampler::note(const SolverStep& step) { steps_.push_back(step); }

/// The largest residual and Courant number, and the last step, since the last row.
SolverStep SlumpSampler::since_last_row(double time) {
  SolverStep all;
  // A directory's name is its time to 8 digits only; half a step tells it from its neighbours.
  while (!steps_.empty() && steps_.front().time < time + 0.5 * steps_.front().time_step) {
    const SolverStep& step = steps_.front();
    all.initial_residual_u = std::max(all.initial_residual_u, step.initial_residual_u);
    all.courant = std::max(all.courant, step.courant);
    all.time_step = step.time_step;
    steps_.pop_front();
  }
  return all;
}

void SlumpSampler::sample_before(double complete_before) {
  for (const auto& [time, directory] : time_directories(case_directory_)) {
    if (time >= complete_before) return;
    if (last_sampled_ && time <= *last_sampled_) continue;
    last_sampled_ = time;
    sample(time, directory);
    if (time > 0.0 && !fs::exists(directory / "p_rgh")) fs::remove_all(directory);
  }
}

void SlumpSampler::sample(double time, const fs::path& directory) {
  const SlumpFields fields{read_internal_field(directory / "alpha.concrete", grid_.cells(), 1),
                           read_internal_field(directory / "U", grid_.cells(), 3)};
  if (scene_.thixotropy) {
    // At the start the solver has not yet written the field: it is what the scene says.
    const auto flocculation =
        time > 0.0 ? read_internal_field(directory / "flocculation", grid_.cells(), 1)
                   : std::vector<double>(grid_.cells(), scene_.thixotropy->initial_flocculation);
    state_.flocculation = mean_over_concrete(grid_, fields.fraction, flocculation);
  }
  const auto gauges = gauge_slump(grid_, fields, scene_.material.density, scene_.base == scenes::Wall::slip);
  if (time == 0.0) state_.first_volume = gauges.volume;
  state_.time = time;
  state_.spread = runs::spread(gauges.radius, gauges.depth);
  state_.front = gauges.front;
  state_.height = runs::centre_depth(gauges.radius, gauges.depth);
  state_.volume = gauges.volume;
  state_.rim_depth = gauges.rim_depth;
  state_.volume_error = std::max(state_.volume_error, std::abs(gauges.volume / state_.first_volume - 1.0));
  const bool at_end = time > scene_.time.end - largest_time_step(scene_);
  if (is_due(time, scene_.output.history_interval, next_history_) || at_end) write_history(time, gauges);
  if (is_due(time, scene_.output.profile_interval, next_profile_) || at_end)
    writer_.profile(time, gauges.radius, gauges.depth);
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
  if (scene_.thixotropy) row.push_back(state_.flocculation);
  writer_.history(row);
}

/// interFoam samples at the first step past half a step before each multiple, so a sample may come a little
/// early.
bool SlumpSampler::is_due(double time, double interval, double& next) const {
  const double early = 0.51 * std::min(largest_time_step(scene_), sample_interval(scene_));
  if (time + early < next) return false;
  next = (std::floor((time + early) / interval) + 1.0) * interval;
  return true;
}

}  // namespace flowrest::foam
