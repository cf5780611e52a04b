#include "foamCases/sampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foamCases/case_filler.h"
#include "foamCases/plug_in.h"
#include "scenes/step_limits.h"

namespace flowrest::foam {

Sampler::Sampler(const scenes::Scene& scene, CaseFields fields, runs::RunWriter& writer, bool plug_in)
    : scene_(scene), fields_(std::move(fields)), writer_(writer), plug_in_(plug_in) {}

void Sampler::note(const SolverStep& step) { steps_.push_back(step); }

SolverStep Sampler::since_last_row(double time) {
  SolverStep all;
  // A directory's name is its time to 8 digits only; half a step tells it from its neighbours.
  while (!steps_.empty() && steps_.front().time < time + 0.5 * steps_.front().time_step) {
    const SolverStep& step = steps_.front();
    all.initial_residual_u = std::max(all.initial_residual_u, step.initial_residual_u);
    all.courant = std::max(all.courant, step.courant);
    if (step.chatter) all.chatter = std::max(all.chatter.value_or(0.0), *step.chatter);
    all.time_step = step.time_step;
    steps_.pop_front();
  }
  return all;
}

void Sampler::name_steps(std::vector<std::string>& columns) const {
  columns.emplace_back("initial_residual_U");
  if (plug_in_) columns.emplace_back("velocity_chatter");
  columns.insert(columns.end(), {"courant_max", "time_step_s"});
}

void Sampler::add_steps(double time, std::vector<double>& row) {
  const SolverStep steps = since_last_row(time);
  row.push_back(steps.initial_residual_u);
  if (plug_in_) row.push_back(steps.chatter.value_or(0.0));
  row.insert(row.end(), {steps.courant, steps.time_step});
}

void Sampler::sample_before(double complete_before) {
  for (const auto& [time, name] : fields_.times()) {
    if (time >= complete_before) return;
    if (last_sampled_ && time <= *last_sampled_) continue;
    last_sampled_ = time;
    sample(time, [this, &name = name](const std::string& field, int components) {
      return fields_.read(name, field, cells(), components);
    });
    if (time > 0.0 && !fields_.holds(name, "p_rgh")) fields_.remove(name);
  }
}

void Sampler::continue_from(const runs::Table& history) {
  if (history.rows() == 0) return;
  last_sampled_ = history.at("time_s").back();
  const auto next = [&](double interval) {
    return (std::floor(*last_sampled_ / interval + 0.5) + 1.0) * interval;
  };
  next_history_ = next(scene_.output.history_interval);
  next_profile_ = next(scene_.output.profile_interval);
}

bool Sampler::thixotropic() const { return carries_flocculation(scene_); }

std::vector<double> Sampler::flocculation(double time, const ReadField& read) const {
  return time > 0.0 ? read("flocculation", 1)
                    : std::vector<double>(cells(), scene_.thixotropy->initial_flocculation);
}

bool Sampler::history_is_due(double time) {
  return is_due(time, scene_.output.history_interval, next_history_);
}

bool Sampler::profile_is_due(double time) {
  return is_due(time, scene_.output.profile_interval, next_profile_);
}

/// interFoam samples at the first step past half a step before each multiple, so a sample may come a little
/// early. The end is always due.
bool Sampler::is_due(double time, double interval, double& next) const {
  const double early = 0.51 * std::min(scenes::grown_foam_step(scene_), sample_interval(scene_));
  const bool at_end = time > scene_.time.end - scenes::grown_foam_step(scene_);
  if (time + early < next && !at_end) return false;
  next = (std::floor((time + early) / interval) + 1.0) * interval;
  return true;
}

}  // namespace flowrest::foam
