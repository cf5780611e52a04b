#include "runs/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flowrest::runs {

using Json = nlohmann::ordered_json;
using scenes::Gauges;

Gauges gauges_of(const Run& run) {
  Gauges gauges;
  const Json::json_pointer at("/settings/gauges");
  if (!run.info.contains(at) || !run.info.at(at).is_object()) return gauges;
  const Json& given = run.info.at(at);
  for (const auto& [name, gauge] : scenes::gauge_settings)
    if (const auto value = given.find(name); value != given.end() && value->is_number() && *value > 0.0)
      gauges.*gauge = value->get<double>();
  return gauges;
}

Json gauge_definitions(const scenes::Scene& scene) {
  const Gauges& gauges = scene.gauges;
  Json columns = Json::object();
  switch (scene.kind()) {
    case scenes::Kind::slump:
      columns["spread_mm"] = {{"depth_m", gauges.spread_depth}};
      columns["spread_1p5_mm"] = {{"depth_m", 0.5 * gauges.spread_depth}};
      columns["spread_6_mm"] = {{"depth_m", 2.0 * gauges.spread_depth}};
      break;
    case scenes::Kind::l_box:
    case scenes::Kind::dam_break:
      columns["front_mm"] = {{"depth_m", gauges.front_depth}};
      columns["end_height_mm"] = columns["start_height_mm"] = {{"length_m", gauges.end_length}};
      break;
    case scenes::Kind::v_funnel:
      columns["thinnest_sight_mm"] = {{"light_below_m", gauges.light_depth}};
      break;
    case scenes::Kind::duct:
      break;
  }
  return columns;
}

bool may_read_nothing(const std::string& column) {
  return (column.ends_with("_mm") && column != "spread_mm") || column.ends_with("shear_rate_p99_1_s");
}

std::string millimetres(double metres, double depth) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(1e3 * depth / 30.0) + 1e-9)));
  return fmt::format("{:.{}f} mm", 1e3 * metres, decimals);
}

std::string shown_length(const std::string& gauge, double metres, double depth) {
  if (std::isnan(metres)) return fmt::format("no {}: nowhere {:g} mm deep", gauge, 1e3 * depth);
  return gauge + " " + millimetres(metres, depth);
}

}  // namespace flowrest::runs
