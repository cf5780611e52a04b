#include "runs/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runs/depth.h"

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

namespace {

/// The columns that are an apparatus' own, by what it is judged by.
std::vector<const Column*> own_columns(scenes::MainGauge gauge) {
  switch (gauge) {
    case scenes::MainGauge::spread:
      return {&column::spread, &column::spread_at_half_depth, &column::spread_at_twice_depth};
    case scenes::MainGauge::front:
      return {&column::front, &column::start_height, &column::end_height};
    case scenes::MainGauge::discharge:
      return {&column::discharged, &column::thinnest_sight};
    case scenes::MainGauge::velocity:
      return {&column::plug_velocity, &column::mean_velocity};
    case scenes::MainGauge::section:
      return {&column::strand_width, &column::strand_height, &column::section_area, &column::base_width};
  }
  return {};
}

}  // namespace

Json gauge_definitions(const scenes::Scene& scene) {
  Json columns = Json::object();
  for (const Column* column : own_columns(scene.main_gauge()))
    if (column->threshold) columns[column->name] = {{column->read_at, column->threshold(scene.gauges)}};
  return columns;
}

bool may_read_nothing(const std::string& column) {
  const Column* known = column_named(column);
  return known && known->may_be_empty;
}

Row spread_columns(const DepthView& view, const Gauges& gauges) {
  Row row;
  for (const Column* column :
       {&column::spread, &column::spread_at_half_depth, &column::spread_at_twice_depth})
    row.add(*column, spread(view, column->threshold(gauges)));
  return row;
}

Row end_columns(std::span<const double> depth, double bin_width, const Gauges& gauges) {
  Row row;
  row.add(column::end_height, depth_at_end(depth, bin_width, ChannelEnd::last, gauges.end_length));
  row.add(column::start_height, depth_at_end(depth, bin_width, ChannelEnd::first, gauges.end_length));
  return row;
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
