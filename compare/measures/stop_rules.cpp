#include "compare/measures/stop_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/run_view.h"

namespace flowrest::compare {

namespace {

/// The first time after the largest value at which the series is below a bound.
std::optional<double> falls_below(const Series& series, double bound) {
  if (series.empty()) return std::nullopt;
  const auto largest = std::max_element(series.value.begin(), series.value.end());
  const auto below = std::find_if(largest, series.value.end(), [&](double v) { return v < bound; });
  if (below == series.value.end()) return std::nullopt;
  return series.time[static_cast<std::size_t>(below - series.value.begin())];
}

/// Root mean square of the speed, of energy and volume. m/s
Series mean_speed(const RunView& view) {
  const auto density = setting(view, "/material/density");
  Series energy = column(view.run, "kinetic_energy_J");
  const Series volume = column(view.run, "volume_m3");
  if (!density || volume.empty()) return {};
  for (std::size_t i = 0; i < energy.time.size(); ++i)
    energy.value[i] =
        std::sqrt(2.0 * std::max(0.0, energy.value[i]) / (*density * volume.at(energy.time[i])));
  return energy;
}

}  // namespace

std::vector<RuleStop> stops_by_rules(const RunView& view, const Thresholds& thresholds) {
  const double second = thresholds.time_unit;
  // The speed below which a body of the standard size counts as still is 1e-4 m/s.
  const double length = thresholds.still_speed * second / 1e-4;
  std::vector<RuleStop> stops;
  const auto add = [&](std::string rule, std::optional<double> time) {
    RuleStop stop{std::move(rule), time};
    if (time) stop.gauge = view.gauge_at(*time);
    if (!stop.gauge) stop.time = std::nullopt;
    stops.push_back(std::move(stop));
  };
  for (const double time : {10.0, 20.0, 25.0, 60.0})
    add(fmt::format("cut at {:g} s", time * second), time * second);
  const Series speed = mean_speed(view), rate = column(view.run, "shear_rate_p99_1_s");
  for (const double bound : {1e-3, 1e-4})
    add(fmt::format("mean speed below {:g} mm/s", 1e3 * bound * length / second),
        falls_below(speed, bound * length / second));
  for (const double bound : {0.1, 0.01})
    add(fmt::format("shear rate below {:g} 1/s", bound / second), falls_below(rate, bound / second));
  const Series growth = view.gauge.empty() ? Series{} : rate_of_change(view.gauge, thresholds.rate_window);
  for (const double bound : {1e-3, 1e-4})
    add(fmt::format("growth below {:g} mm/s", 1e3 * bound * length / second),
        falls_below(growth, bound * length / second));
  return stops;
}

}  // namespace flowrest::compare
