#include "compare/measures/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "runs/gauges.h"

namespace flowrest::compare {

namespace {

using scenes::Kind;

Gauge millimetres(const std::string& name, const std::string& column, const std::string& more,
                  const std::string& less, const std::string& caption) {
  const std::string key = column.substr(0, column.size() - 3);
  return {name, key, column, "mm", 1e-3, 1e3, more, less, caption};
}

const Gauge flocculation = {
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

std::string Gauge::suffix() const {
  return unit == "mm" ? "_mm" : unit == "m/s" ? "_m_s" : unit == "%" ? "_percent" : "";
}

std::string Gauge::caption_for(const scenes::Gauges& gauges, Kind kind) const {
  return fmt::format(fmt::runtime(caption), fmt::arg("depth", 1e3 * gauges.edge_depth(kind)),
                     fmt::arg("length", 1e3 * gauges.end_length));
}

const Gauge& gauge_of(Kind kind) {
  static const Gauge spread = millimetres("spread", "spread_mm", "wider", "narrower",
                                          "Spread: twice the radius at which the depth falls through "
                                          "{depth:g} mm. A thin dotted tail continues a "
                                          "run that has come to rest.");
  static const Gauge velocity = {
      "plug velocity",
      "velocity",
      "plug_velocity_m_s",
      "m/s",
      1.0,
      1.0,
      "faster",
      "slower",
      "Velocity of the plug. The exact line is the steady state of each stage of the "
      "force."};
  static const Gauge front_of_box = millimetres(
      "front", "front_mm", "further", "shorter",
      "Front: the distance from the gate at which the depth falls through {depth:g} mm; it ends at the end "
      "wall. A thin dotted tail continues a run that has come to rest.");
  static const Gauge front_of_dam = millimetres("front", "front_mm", "further", "shorter",
                                                "Front: the distance from the back wall at which the depth "
                                                "falls through {depth:g} mm; it ends at the end wall.");
  static const Gauge discharged = {"discharged fraction",
                                   "discharged",
                                   "discharged_fraction",
                                   "%",
                                   1.0,
                                   100.0,
                                   "more",
                                   "less",
                                   "Discharged: the share of the mass that is below the outlet."};
  switch (kind) {
    case Kind::slump:
      return spread;
    case Kind::duct:
      return velocity;
    case Kind::l_box:
      return front_of_box;
    case Kind::dam_break:
      return front_of_dam;
    case Kind::v_funnel:
      return discharged;
  }
  throw std::logic_error("a kind of scene without a gauge");
}

const std::vector<Gauge>& further_gauges(Kind kind) {
  static const Gauge end = millimetres("height at the end wall", "end_height_mm", "higher", "lower",
                                       "The mean depth over the last {length:g} mm before the end wall.");
  static const Gauge start = millimetres("height at the back wall", "start_height_mm", "higher", "lower",
                                         "The mean depth over the first {length:g} mm.");
  static const Gauge height = millimetres("height in the middle", "height_mm", "higher", "lower",
                                          "The depth on the axis of the slump.");
  static const Gauge sight = millimetres("thinnest line of sight", "thinnest_sight_mm", "thicker", "thinner",
                                         "The least material on any line of sight through the outlet: light "
                                         "is seen once it is below {depth:g} mm.");
  static const std::vector<Gauge> of_slump = {height, flocculation}, of_duct = {flocculation},
                                  of_box = {end, start, flocculation}, of_funnel = {sight, flocculation};
  switch (kind) {
    case Kind::slump:
      return of_slump;
    case Kind::duct:
      return of_duct;
    case Kind::l_box:
    case Kind::dam_break:
      return of_box;
    case Kind::v_funnel:
      return of_funnel;
  }
  throw std::logic_error("a kind of scene without gauges");
}

bool grows_to_rest(Kind kind) {
  return kind == Kind::slump || kind == Kind::l_box || kind == Kind::dam_break;
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

const std::vector<Reading>& readings_of(Kind kind) {
  static const std::vector<Reading> slump = {reading_named("spread_mm"), reading_named("rest_s")},
                                    duct = {reading_named("plug_velocity_m_s"), reading_named("rest_s")},
                                    box = {reading_named("front_mm"), reading_named("arrival_s"),
                                           reading_named("end_height_mm"), reading_named("rest_s")},
                                    dam = {reading_named("front_mm"), reading_named("arrival_s")},
                                    funnel = {reading_named("light_s"), reading_named("discharged_fraction"),
                                              reading_named("rest_s")};
  switch (kind) {
    case Kind::slump:
      return slump;
    case Kind::duct:
      return duct;
    case Kind::l_box:
      return box;
    case Kind::dam_break:
      return dam;
    case Kind::v_funnel:
      return funnel;
  }
  throw std::logic_error("a kind of scene without readings");
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
