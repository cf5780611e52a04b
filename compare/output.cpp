#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/comparison.h"
#include "compare/comparison_page.h"
#include "compare/fields/section.h"
#include "compare/measures/gauges.h"
#include "compare/report/figures.h"
#include "runs/folder.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;

namespace {

Json measures_json(const RunView& view, const ApparatusReport& apparatus) {
  const Measures& m = view.measures;
  Json json = {{"end_s", scaled(m.end)}};
  json.update(apparatus.measures_json(m));
  json["residual_cause"] = to_string(m.cause);
  json["volume_drift"] = scaled(m.volume_drift);
  json["mass_drift"] = scaled(m.mass_drift);
  json["cpu_s"] = scaled(m.cpu);
  json["wall_s"] = scaled(m.wall);
  json["cpu_s_per_simulated_s"] = scaled(m.cpu_per_simulated_second);
  return json;
}

/// The difference between the fluid in OpenFOAM and the material in MPM, split at each time.
Json square_json(const Comparison& comparison) {
  if (!comparison.square) return nullptr;
  const Square& square = *comparison.square;
  const double scale = comparison.apparatus->gauge().shown;
  const std::string unit = comparison.apparatus->gauge().suffix();
  const auto label = [&](const std::optional<std::size_t>& run) {
    return run ? Json(comparison.runs[*run].label) : Json();
  };
  Json json = {{"mpm_solid", label(square.mpm_solid)},
               {"mpm_fluid", label(square.mpm_fluid)},
               {"foam_solid", label(square.foam_solid)},
               {"foam_fluid", label(square.foam_fluid)},
               {"missing", square.missing},
               {"at", Json::array()}};
  for (const Square::At& at : square.at)
    json["at"].push_back({{"time_s", at.time},
                          {"total" + unit, scale * at.total},
                          {"law" + unit, scale * at.law},
                          {"discretisation" + unit, scale * at.discretisation},
                          {"interaction" + unit, scale * at.interaction},
                          {"noise" + unit, scale * at.noise}});
  return json;
}

/// What run.json says beyond what the comparison shows elsewhere, without the bulk.
Json provenance_json(const RunView& view) {
  static const std::set<std::string> elsewhere = {
      "format", "format_version", "title",   "kind",  "solver",   "model",        "label",
      "status", "reason",         "verdict", "scene", "settings", "resolved_toml"};
  Json json = Json::object();
  for (const auto& [key, value] : view.run.info.items())
    if (!elsewhere.contains(key)) json[key] = value;
  return json;
}

std::string quoted(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + escaped + '"';
}

std::string csv_cell(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.17g}", *value) : "";
}

std::string header(const Comparison& comparison, const std::string& first) {
  std::string line = first;
  for (const RunView& view : comparison.runs) line += ',' + quoted(view.label);
  return line + '\n';
}

/// One column a run: its gauge at the common times, in the unit of its figure.
std::string gauge_csv(const Comparison& comparison) {
  std::string text = header(comparison, "time_s");
  const double step = round_step(comparison.end / 1200.0);
  for (int i = 0; i * step <= comparison.end * (1.0 + 1e-9); ++i) {
    text += fmt::format("{:.17g}", i * step);
    for (const RunView& view : comparison.runs) {
      auto value = view.gauge_at(i * step);
      if (value) *value *= comparison.apparatus->gauge().shown;
      text += ',' + csv_cell(value);
    }
    text += '\n';
  }
  return text;
}

std::string profiles_csv(const Comparison& comparison) {
  std::string text = header(comparison, comparison.radial                   ? "time_s,r_m"
                                        : comparison.apparatus->has_depth() ? "time_s,x_m"
                                                                            : "time_s,y_m");
  for (const double time : comparison.frames) {
    std::vector<std::optional<std::vector<double>>> columns;
    for (const RunView& view : comparison.runs) columns.push_back(view.profile(time, comparison.grid));
    for (std::size_t i = 0; i < comparison.grid.size(); ++i) {
      text += fmt::format("{:.17g},{:.17g}", time, comparison.grid[i]);
      for (const auto& column : columns)
        text += ',' + csv_cell(column ? std::optional((*column)[i]) : std::nullopt);
      text += '\n';
    }
  }
  return text;
}

/// The name of the depth at which a gauge finds its edge; none where it has no edge.
const char* depth_key(scenes::MainGauge judged_by) {
  switch (judged_by) {
    case scenes::MainGauge::spread:
      return "spread_depth_mm";
    case scenes::MainGauge::front:
      return "front_depth_mm";
    case scenes::MainGauge::discharge:
      return "light_depth_mm";
    case scenes::MainGauge::velocity:
    case scenes::MainGauge::section:
      break;
  }
  return nullptr;
}

std::string measures_csv(const Json& json) {
  std::string text;
  for (const Json& run : json["runs"]) {
    if (text.empty()) {
      text = "run,solver,model,status,verdict";
      for (const Json& column : json["measure_columns"]) text += ',' + column.get<std::string>();
      text += '\n';
    }
    text += quoted(run["label"]) + ',' + quoted(run["solver"]) + ',' + quoted(run["model"]) + ',' +
            quoted(run["status"]) + ',' + quoted(run["verdict"]);
    for (const Json& column : json["measure_columns"]) {
      text += ',';
      const Json value = run["measures"].value(column.get<std::string>(), Json());
      if (value.is_number()) text += csv_cell(value.get<double>());
      if (value.is_string()) text += quoted(value.get<std::string>());
    }
    text += '\n';
  }
  return text;
}

}  // namespace

Json to_json(const Comparison& comparison) {
  const Gauge& gauge = comparison.apparatus->gauge();
  const Thresholds& o = comparison.thresholds;
  Json json = {{"format", "flowrest comparison"},
               {"format_version", 1},
               {"title", comparison.title},
               {"kind", comparison.apparatus->name()},
               {"findings", Json::array()},
               {"missing", comparison.missing},
               {"notes", comparison.notes},
               {"fair", comparison.fair},
               {"thresholds",
                {{"rest_shear_rate_p99_1_s", o.rest_shear_rate},
                 {"rest_spread_rate_mm_s", 1e3 * o.rest_spread_rate},
                 {"rest_velocity_fraction", o.rest_velocity_fraction},
                 {"rate_window_s", o.rate_window},
                 {"residual_window_s", o.residual_window},
                 {"creep_factor", o.creep_factor}}}};
  if (const char* depth = depth_key(comparison.apparatus->judged_by()))
    json["thresholds"][depth] = 1e3 * comparison.apparatus->edge_depth(comparison.gauges);
  const char* topics[] = {"opening", "stop", "apart", "cause", "cost", "context"};
  for (const Finding& finding : comparison.findings)
    json["findings"].push_back({{"topic", topics[static_cast<int>(finding.topic)]}, {"text", finding.text}});
  Json columns = Json::array();
  for (const RunView& view : comparison.runs) {
    const Json& info = view.run.info;
    Json run = {{"label", view.label},
                {"directory", view.run.directory.string()},
                {"solver", view.solver},
                {"model", view.model},
                {"status", info.value("status", "")},
                {"reason", info.value("reason", "")},
                {"verdict", info.value("verdict", "")},
                {"noisy", view.doubt.noisy},
                {"under_resolved", view.doubt.under_resolved},
                {"trouble", view.trouble},
                {"walls_differ", view.walls_differ},
                {"measures", measures_json(view, *comparison.apparatus)},
                {"made_by", provenance_json(view)}};
    for (const auto& [name, value] : run["measures"].items())
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
    json["runs"].push_back(run);
  }
  json["measure_columns"] = columns;
  const double scale = gauge.shown;
  const std::string difference = gauge.json_name() + "_difference" + gauge.suffix();
  // Norms are of depths, or of velocities.
  const double norm = comparison.apparatus->has_depth() ? 1e3 : 1.0;
  const std::string unit = comparison.apparatus->has_depth() ? "_mm" : "_m_s";
  json["pairs"] = Json::array();
  for (const Pair& pair : comparison.pairs) {
    Json entry = {{"run", comparison.runs[pair.run].label},
                  {"reference", comparison.runs[pair.reference].label},
                  {"differs_in", pair.kind},
                  {"at", Json::array()}};
    for (const auto& at : pair.at)
      entry["at"].push_back({{"time_s", at.time},
                             {"l1" + unit, norm * at.error.l1},
                             {"l2" + unit, norm * at.error.l2},
                             {"linf" + unit, norm * at.error.linf},
                             {"l1_relative", at.error.l1_relative},
                             {"l2_relative", at.error.l2_relative},
                             {difference, scaled(at.gauge_difference, scale)}});
    json["pairs"].push_back(entry);
  }
  json["square"] = square_json(comparison);
  json["arbitrary_stops"] = {{"time_s", comparison.stops}, {"runs", Json::array()}};
  for (const RunView& view : comparison.runs) {
    if (view.exact) continue;
    Json values = Json::array();
    for (const double stop : comparison.stops) values.push_back(scaled(view.gauge_at(stop), scale));
    json["arbitrary_stops"]["runs"].push_back(
        {{"label", view.label}, {gauge.json_name() + gauge.suffix(), values}});
  }
  json["provenance"] = runs::provenance();
  return json;
}

void write_comparison(const Comparison& comparison, const std::filesystem::path& report) {
  runs::make_folder(report);
  if (std::filesystem::exists(report / "run.json"))
    throw runs::RunError(fmt::format("{}: is a run; name another folder for the report", report.string()));
  const Json json = to_json(comparison);
  // The page first: it is the one that may lack what it is made of.
  const std::string page = report::render(page_of(comparison, json));
  runs::write_atomically(report / "comparison.json",
                         json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
  runs::write_atomically(report / "measures.csv", measures_csv(json));
  runs::write_atomically(report / (comparison.apparatus->gauge().key + ".csv"), gauge_csv(comparison));
  runs::write_atomically(report / "profiles.csv", profiles_csv(comparison));
  runs::write_atomically(report / "index.html", page);
}

std::size_t write_figures(const Comparison& comparison, const std::filesystem::path& report) {
  return report::write_figures(page_of(comparison, to_json(comparison)), report / "figures").size();
}

void write_clip(const Comparison& comparison, const std::filesystem::path& clip) {
  constexpr std::size_t most_times = 120, most_bytes = 200'000'000;
  const auto sections = fields::sections_of(comparison, most_times, most_bytes);
  if (sections.empty())
    throw runs::RunError(
        "no run of this comparison left particles or a case: there is nothing to make a clip of");
  report::write_clip(page_of(comparison, to_json(comparison)), sections.front(), clip);
}

}  // namespace flowrest::compare
