#include "foamCases/sampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foamCases/case_filler.h"
#include "foamCases/plug_in.h"
#include "foamCases/step_rules.h"

namespace flowrest::foam {

RowClock::RowClock(const scenes::Scene& scene, double interval)
    : interval_(interval), early_(0.51 * std::min(grown_step(*case_of(scene)), sample_interval(scene))) {}

bool RowClock::is_due(double time, bool at_end) {
  if (time + early_ < next_ && !at_end) return false;
  continue_from(time);
  return true;
}

void RowClock::continue_from(double time) {
  next_ = (std::floor((time + early_) / interval_) + 1.0) * interval_;
}

double last_regular_row(const scenes::Scene& scene, double interval, const std::vector<double>& times) {
  RowClock clock(scene, interval);
  double last = -1.0;
  for (const double time : times)
    if (clock.is_due(time)) last = time;
  return last;
}

Sampler::Sampler(const scenes::Scene& scene, CaseFields fields, runs::RunWriter& writer, bool plug_in)
    : scene_(scene),
      rest_(scene),
      fields_(std::move(fields)),
      writer_(writer),
      plug_in_(plug_in),
      history_clock_(scene, scene.output.history_interval),
      profile_clock_(scene, scene.output.profile_interval) {}

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

runs::Row Sampler::steps_until(double time) {
  const SolverStep steps = since_last_row(time);
  runs::Row row;
  row.add(runs::column::residual, steps.initial_residual_u);
  if (plug_in_) row.add(runs::column::chatter, steps.chatter.value_or(0.0));
  return row.add(runs::column::courant, steps.courant).add(runs::column::time_step, steps.time_step);
}

runs::Row Sampler::resolution_until(double time, const runs::ShearedLayer& layer) {
  return resolution_.add(time, layer);
}

void Sampler::sample_before(double complete_before, const std::function<void()>& after_each) {
  for (const auto& [time, name] : fields_.times()) {
    if (time >= complete_before) return;
    if (last_sampled_ && time <= *last_sampled_) continue;
    last_sampled_ = time;
    sample(time, [this, &name = name](const std::string& field, int components) {
      return fields_.read(name, field, cells(), components);
    });
    if (time > 0.0 && !fields_.holds(name, "p_rgh")) fields_.remove(name);
    after_each();
  }
}

void Sampler::continue_from(const runs::Table& history) {
  if (history.rows() == 0) return;
  last_sampled_ = history.at("time_s").back();
  resolution_.continue_from(history);
  history_clock_.continue_from(*last_sampled_);
  if (const auto profile = writer_.last_profile()) profile_clock_.continue_from(*profile);
}

bool Sampler::thixotropic() const { return carries_flocculation(scene_); }

std::vector<double> Sampler::flocculation(double time, const ReadField& read) const {
  return time > 0.0 ? read("flocculation", 1)
                    : std::vector<double>(cells(), scene_.thixotropy->initial_flocculation);
}

std::vector<double> Sampler::structure(double time, std::vector<double> flocculation) const {
  if (!thixotropic()) return flocculation;
  const double grown = scene_.grown_over_yield_stress(time);
  for (double& state : flocculation) state += grown;
  return flocculation;
}

runs::Row Sampler::structure_columns(double time, double flocculation) const {
  runs::Row row;
  return row.add(runs::column::flocculation, flocculation)
      .add(runs::column::yield_stress, scene_.local_yield_stress(flocculation, time));
}

bool Sampler::history_is_due(double time) { return history_clock_.is_due(time, is_at_end(time)); }

bool Sampler::profile_is_due(double time) { return profile_clock_.is_due(time, is_at_end(time)); }

bool Sampler::is_at_end(double time) const { return time > scene_.time.end - grown_step(*case_of(scene_)); }

}  // namespace flowrest::foam
