#include "compare/measures/run_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/apparatus/apparatus.h"
#include "compare/measures/gauges.h"
#include "compare/run_view.h"
#include "runs/depth.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;

namespace {

/// The regularised fluid a run computed, where it is one and says enough.
std::optional<exact::RegularisedFluid> regularised_fluid(const RunView& view) {
  const auto law = laws::law_named(view.model);
  if (!law || !laws::creeps(*law)) return std::nullopt;
  exact::RegularisedFluid fluid{*law, {}};
  for (const laws::Parameter parameter : laws::every_parameter) {
    if (!laws::needs(*law, parameter)) continue;
    auto value = setting(view, fmt::format("/material/{}", laws::key_of(parameter)));
    if (parameter == laws::Parameter::critical_shear_rate && !(value && *value > 0.0)) {
      const auto time = setting(view, "/material/regularisation_time");
      value = time ? std::optional(1.0 / *time) : std::nullopt;
    }
    if (!value) return std::nullopt;
    fluid.parameters.*laws::member_of<double>(parameter) = *value;
  }
  return fluid;
}

std::optional<double> predicted_creep(const RunView& view, const ApparatusReport& apparatus) {
  if (!view.fluid) return 0.0;
  const auto fluid = regularised_fluid(view);
  return fluid ? apparatus.predicted_creep(view, *fluid) : std::nullopt;
}

/// What a gauge reads; empty where it reads nothing.
std::optional<double> read_value(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<double> drift(const Series& series) {
  if (series.empty() || series.value.front() == 0.0) return std::nullopt;
  return series.value.back() / series.value.front() - 1.0;
}

Cause cause_of(const RunView& view, const Thresholds& thresholds, double rest_speed) {
  const Measures& m = view.measures;
  // A record that was cut off may have been cut off while it still flowed.
  if (!m.residual || !view.trouble.empty()) return Cause::unknown;
  const double speed = std::abs(*m.residual);
  if (!view.fluid)
    return speed <= rest_speed ? Cause::at_rest : view.held ? Cause::within_bound : Cause::approaching_rest;
  const bool explained = m.predicted_creep && speed <= thresholds.creep_factor * *m.predicted_creep;
  if (explained) return view.doubt.noisy ? Cause::creep_or_noise : Cause::creep;
  if (view.doubt.noisy) return Cause::noise;
  return m.predicted_creep ? Cause::unexplained : Cause::unknown;
}

std::optional<double> cell_of(const RunView& view) { return setting(view, "/" + view.solver + "/cell"); }

/// The run of the same law and solver on the nearest other grid.
RunView* other_grid(Comparison& comparison, const RunView& view) {
  const auto own = cell_of(view);
  RunView* found = nullptr;
  double closest = std::numeric_limits<double>::infinity();
  for (RunView& other : comparison.runs) {
    const auto cell = cell_of(other);
    if (!own || !cell || other.unread || other.solver != view.solver || other.model != view.model ||
        !other.trouble.empty())
      continue;
    const double away = std::abs(std::log(*own / *cell));
    if (away < 0.1 || away >= closest) continue;
    closest = away;
    found = &other;
  }
  return found;
}

/// By how much the gauge at the end still changes with the grid, taken on to zero cell size at first order.
std::optional<double> grid_difference(Comparison& comparison, const RunView& view) {
  const RunView* other = other_grid(comparison, view);
  if (!other || view.gauge.empty() || view.unread || other->gauge.empty()) return std::nullopt;
  // At the last time that both have reached; what is at rest stays as it is.
  const double last = view.held     ? other->gauge.end()
                      : other->held ? view.gauge.end()
                                    : std::min(view.gauge.end(), other->gauge.end());
  const double time = view.held && other->held ? std::max(view.gauge.end(), other->gauge.end()) : last;
  const auto own = view.gauge_at(time), theirs = other->gauge_at(time);
  if (!own || !theirs) return std::nullopt;
  return grid_uncertainty(*own, *cell_of(view), *theirs, *cell_of(*other));
}

/// The run whose arrested spread overshoots are counted from: elasto-viscoplastic, the same solver if it can
/// be, one that came to rest if there is one.
const RunView* arrested_reference(const Comparison& comparison, const RunView& view) {
  const RunView* best = nullptr;
  int best_score = -1;
  for (const RunView& other : comparison.runs) {
    if (!other.law || !laws::can_rest(*other.law) || other.exact || other.gauge.empty() || other.unread ||
        !other.trouble.empty())
      continue;
    // A front in a box that still runs is no measure of rest.
    const bool rests = other.held || other.measures.cause == Cause::at_rest;
    if (!comparison.apparatus->spreads() && !rests) continue;
    const int score = 4 * (other.held || other.measures.cause == Cause::at_rest) +
                      2 * (other.solver == view.solver) + !other.doubt.any();
    if (score > best_score) {
      best = &other;
      best_score = score;
    }
  }
  return best;
}

}  // namespace

std::vector<std::pair<double, double>> body_forces(const RunView& view) {
  std::vector<std::pair<double, double>> stages;
  const Json::json_pointer at("/settings/forces/body_force");
  if (!view.run.info.contains(at)) return stages;
  for (const Json& stage : view.run.info.at(at))
    if (stage.is_array() && stage.size() == 2 && stage[0].is_number() && stage[1].is_number())
      stages.emplace_back(stage[0].get<double>(), stage[1].get<double>());
  return stages;
}

void measure(RunView& view, const Comparison& comparison) {
  const Thresholds& thresholds = comparison.thresholds;
  const ApparatusReport& apparatus = *comparison.apparatus;
  const bool spreads = apparatus.spreads();
  Measures& m = view.measures;
  const Json& info = view.run.info;
  if (!view.gauge.empty()) {
    m.end = view.gauge.end();
    if (!view.unread) m.gauge_end = view.gauge.value.back();
  }
  if (!view.run.profiles.empty()) {
    const auto& last = view.run.profiles.back();
    if (spreads) {
      const double depth = view.gauges.spread_depth;
      const runs::DepthView profile = depth_of(last, view.run);
      m.spread_at_half = read_value(runs::spread(profile, 0.5 * depth));
      m.spread_at_twice = read_value(runs::spread(profile, 2.0 * depth));
      m.centre_depth = read_value(runs::centre_depth(profile, depth));
    }
    m.end = std::max(m.end.value_or(last.time), last.time);
  }
  if (view.exact) {
    m.predicted_creep = 0.0;
    m.residual = 0.0;
    m.cause = Cause::at_rest;
    if (!spreads) m.stopping_bound = number(info, "/stopping_time_bound_s");
    return;
  }
  m.rest_declared = number(info, "/rest_time_s");
  for (const Reading& reading : apparatus.readings())
    m.readings[reading.quantity].value = read(view.run, reading.quantity);
  if (const auto growth = number(info, "/growth_to_come"); spreads && !view.fluid && growth && m.gauge_end)
    m.growth_to_come = *growth * *m.gauge_end;
  m.cpu = number(info, "/cpu_s");
  m.wall = number(info, "/wall_s");
  if (m.cpu && m.end && *m.end > 0.0) m.cpu_per_simulated_second = *m.cpu / *m.end;
  m.volume_drift = drift(column(view.run, "volume_m3"));
  m.mass_drift = drift(column(view.run, "mass_kg"));
  m.rest_by_shear_rate = settles_below(view.shear_rate, thresholds.rest_shear_rate);
  m.predicted_creep = predicted_creep(view, apparatus);
  if (view.gauge.empty() || view.unread || apparatus.judged_by() == scenes::MainGauge::discharge) return;
  const double end = view.gauge.end();
  // Of a short record the last fifth, so that how the flow began is not taken for how it ends.
  const double window = std::min(thresholds.residual_window, 0.2 * (end - view.gauge.time.front()));
  const auto last = trend(view.gauge, end - window, end);
  if (last) m.residual_scatter = last->scatter;
  if (apparatus.grows()) {
    const Series rate = rate_of_change(view.gauge, thresholds.rate_window);
    m.rest_by_spread_rate = settles_below(rate, thresholds.rest_spread_rate);
    // A cone takes a moment to start: rest before it has moved is not rest.
    if (m.rest_by_spread_rate && *m.rest_by_spread_rate <= view.gauge.time.front())
      m.rest_by_spread_rate.reset();
    if (last) m.residual = last->slope;
    m.cause = cause_of(view, thresholds, thresholds.still_speed);
  } else {
    const double largest = *std::max_element(view.gauge.value.begin(), view.gauge.value.end());
    const double threshold = thresholds.rest_velocity_fraction * largest;
    double step = 0.0;
    for (const auto& [from, force] : body_forces(view))
      if (from < end) step = from;
    if (const auto settled = settles_below(view.gauge, threshold);
        settled && *settled >= step && largest > 0.0)
      m.stop_after_step = *settled - step;
    Series last_values;
    for (std::size_t i = 0; i < view.gauge.time.size(); ++i)
      if (view.gauge.time[i] >= end - window) last_values.value.push_back(view.gauge.value[i]);
    std::nth_element(last_values.value.begin(),
                     last_values.value.begin() + static_cast<std::ptrdiff_t>(last_values.value.size() / 2),
                     last_values.value.end());
    m.residual = last_values.value[last_values.value.size() / 2];
    m.cause = cause_of(view, thresholds, threshold);
  }
  for (const double stop : comparison.stops) {
    const auto value = view.gauge_at(stop);
    if (!value) continue;
    m.stop_lowest = std::min(m.stop_lowest.value_or(*value), *value);
    m.stop_highest = std::max(m.stop_highest.value_or(*value), *value);
  }
}

void measure_overshoot(Comparison& comparison) {
  if (!comparison.apparatus->grows()) return;
  for (RunView& view : comparison.runs) {
    if (view.exact) continue;
    const RunView* reference = arrested_reference(comparison, view);
    if (!reference) continue;
    view.measures.overshoot_reference = reference->measures.gauge_end;
    view.measures.overshoot_reference_run = reference->label;
    for (const double time : comparison.thresholds.overshoot_times)
      if (const auto value = view.gauge_at(time))
        view.measures.overshoot[time] = *value - *reference->measures.gauge_end;
  }
}

bool ends_in_film(const Comparison& comparison, double sensitivity) {
  return comparison.cell > 0.0 && sensitivity >= 3.0 * comparison.cell;
}

void measure_uncertainty(Comparison& comparison) {
  for (RunView& view : comparison.runs)
    if (RunView* other = other_grid(comparison, view))
      for (auto& [quantity, reading] : view.measures.readings)
        if (const auto& value = other->measures.readings[quantity].value; reading.value && value)
          reading.uncertainty = grid_uncertainty(*reading.value, *cell_of(view), *value, *cell_of(*other));
  if (!comparison.apparatus->has_depth()) return;
  for (RunView& view : comparison.runs) {
    Measures& m = view.measures;
    if (view.exact || !m.gauge_end) continue;
    const auto raise = [&](double value, const std::string& source) {
      if (value <= m.uncertainty.value_or(0.0)) return;
      m.uncertainty = value;
      m.uncertainty_source = source;
    };
    if (const auto grid = grid_difference(comparison, view))
      raise(*grid, "the difference between its grids");
    else if (const auto cell = cell_of(view); cell && comparison.apparatus->grows())
      raise(*cell, "its cell (there is no second grid)");
    if (m.residual_scatter) raise(2.0 * *m.residual_scatter, "the scatter of its record");
    if (m.spread_at_half && m.spread_at_twice &&
        ends_in_film(comparison, *m.spread_at_half - *m.spread_at_twice))
      raise(0.5 * (*m.spread_at_half - *m.spread_at_twice),
            fmt::format("how its edge is read (at {:g} or at {:g} mm of depth)",
                        500.0 * view.gauges.spread_depth, 2000.0 * view.gauges.spread_depth));
  }
}

std::string to_string(Cause cause) {
  switch (cause) {
    case Cause::at_rest:
      return "at rest";
    case Cause::within_bound:
      return "little: at rest by the run's own bound on what is to come";
    case Cause::approaching_rest:
      return "still approaching rest";
    case Cause::creep:
      return "creep of the regularisation";
    case Cause::creep_or_noise:
      return "creep of the regularisation or noise, not told apart";
    case Cause::noise:
      return "noise";
    case Cause::unexplained:
      return "unexplained: more than the regularisation's creep";
    case Cause::unknown:
      return "unknown";
  }
  return "";
}

}  // namespace flowrest::compare
