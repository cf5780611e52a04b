#include "compare/measures/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runs/gauges.h"

namespace flowrest::compare {

namespace {

/// Where the front can go no further, mm from the gate or from the back wall, as the front itself is counted.
std::optional<double> end_wall(const runs::Run& run) {
  const nlohmann::ordered_json::json_pointer at("/settings/geometry");
  if (!run.info.contains(at)) return std::nullopt;
  const auto& geometry = run.info.at(at);
  for (const char* key : {"channel_length", "tank_length"})
    if (geometry.contains(key) && geometry[key].is_number()) return 1e3 * geometry[key].get<double>();
  return std::nullopt;
}

/// When a column first passes a threshold, s, interpolated between rows.
std::optional<double> first_passing(const runs::Run& run, const std::string& column, double threshold,
                                    bool upwards) {
  if (!run.history.has(column)) return std::nullopt;
  const auto& time = run.history.at("time_s");
  const auto& value = run.history.at(column);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (std::isnan(value[i]) || (upwards ? value[i] < threshold : value[i] > threshold)) continue;
    if (i == 0 || std::isnan(value[i - 1]) || value[i] == value[i - 1]) return time[i];
    return std::lerp(time[i - 1], time[i], (threshold - value[i - 1]) / (value[i] - value[i - 1]));
  }
  return std::nullopt;
}

}  // namespace

Gauge millimetres(const std::string& name, const std::string& column, const std::string& more,
                  const std::string& less, const std::string& caption) {
  const std::string key = column.substr(0, column.size() - 3);
  return {name, key, column, "mm", 1e-3, 1e3, more, less, caption};
}

const Gauge& flocculation() {
  static const Gauge gauge = {
      "mean flocculation state λ",
      "flocculation",
      "flocculation_mean",
      "",
      1.0,
      1.0,
      "higher",
      "lower",
      "λ of Roussel's law, the mean over the mass: it falls while flow breaks the flocs and "
      "grows while they rest. A run that has come to rest goes on by the law: the dotted tail."};
  return gauge;
}

const std::vector<Gauge>& channel_gauges() {
  static const Gauge end = millimetres("height at the end wall", "end_height_mm", "higher", "lower",
                                       "The mean depth over the last {length:g} mm before the end wall.");
  static const Gauge start = millimetres("height at the back wall", "start_height_mm", "higher", "lower",
                                         "The mean depth over the first {length:g} mm.");
  static const std::vector<Gauge> all = {end, start, flocculation()};
  return all;
}

std::string Gauge::suffix() const {
  return unit == "mm" ? "_mm" : unit == "m/s" ? "_m_s" : unit == "%" ? "_percent" : "";
}

std::string Gauge::json_name() const {
  return column.ends_with(suffix()) ? column.substr(0, column.size() - suffix().size()) : key;
}

std::string Gauge::caption_for(const scenes::Gauges& gauges, scenes::MainGauge judged_by) const {
  return fmt::format(fmt::runtime(caption), fmt::arg("depth", 1e3 * gauges.edge_depth(judged_by)),
                     fmt::arg("length", 1e3 * gauges.end_length));
}

Reading reading_named(const std::string& quantity) {
  static const std::vector<Reading> known = {
      {"spread_mm", "spread at the end", "mm"},
      {"front_mm", "front at the end", "mm"},
      {"height_mm", "height in the middle at the end", "mm"},
      {"end_height_mm", "height at the end wall, at the end", "mm"},
      {"arrival_s", "arrival at the end wall", "s"},
      {"light_s", "light is seen through the funnel", "s"},
      {"rest_s", "rest", "s"},
      {"discharged_fraction", "discharged fraction at the end", ""},
      {"strand_width_mm", "width of the strand", "mm"},
      {"strand_height_mm", "height of the strand", "mm"},
      {"section_area_mm2", "area of its section", "mm2"},
      {"area_over_balance", "area over balance", ""},
      {"plug_velocity_m_s", "plug velocity at the end", "m/s"},
      {"flocculation_mean", "mean flocculation state λ at the end", ""}};
  for (const Reading& reading : known)
    if (reading.quantity == quantity) return reading;
  const std::string unit = quantity.ends_with("_mm")    ? "mm"
                           : quantity.ends_with("_m_s") ? "m/s"
                           : quantity.ends_with("_s")   ? "s"
                                                        : "";
  return {quantity, quantity, unit};
}

std::optional<double> read(const runs::Run& run, const std::string& quantity) {
  if (quantity == "rest_s") {
    const auto rest = run.info.find("rest_time_s");
    return rest != run.info.end() && rest->is_number() ? std::optional(rest->get<double>()) : std::nullopt;
  }
  if (quantity == "light_s")
    return first_passing(run, "thinnest_sight_mm", 1e3 * runs::gauges_of(run).light_depth, false);
  if (quantity == "arrival_s") {
    const auto wall = end_wall(run);
    // The front is read on a grid and stops a rounding error short of the wall.
    constexpr double short_of_it = 1e-9;
    return wall ? first_passing(run, "front_mm", (1.0 - short_of_it) * *wall, true) : std::nullopt;
  }
  const bool ended = run.status() == runs::Status::at_rest || run.status() == runs::Status::end_time;
  if (!ended || !run.history.has(quantity) || run.history.rows() == 0) return std::nullopt;
  const double value = run.history.at(quantity).back();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

double grid_uncertainty(double value, double cell, double other_value, double other_cell) {
  return std::abs(value - other_value) / std::abs(1.0 - other_cell / cell);
}

}  // namespace flowrest::compare
