#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "compare/apparatus/apparatus.h"
#include "compare/measures/gauges.h"
#include "runs/run_directory.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

using Json = nlohmann::ordered_json;

Json value(const std::optional<double>& v) { return v && std::isfinite(*v) ? Json(*v) : Json(); }

Json number_json(const Number& n) {
  return {{"scene", n.published.scene},
          {"quantity", n.published.quantity},
          {"unit", compare::reading_named(n.published.quantity).unit},
          {"measured", value(n.published.measured)},
          {"paper", value(n.published.paper)},
          {"allowed", n.published.allowed},
          {"mark", to_string(n.published.mark)},
          {"source", n.published.source},
          {"solver", to_string(n.solver)},
          {"model", scenes::to_string(n.model)},
          {"ours", value(n.ours)},
          {"coarse", value(n.coarse)},
          {"uncertainty", value(n.uncertainty)},
          {"difference", value(n.difference())},
          {"verdict", to_string(n.verdict)},
          {"within_allowed", n.within ? Json(*n.within) : Json()},
          {"words", n.words},
          {"doubt", n.doubt.word()},
          {"noise", n.doubt.why},
          {"walls_differ", n.walls_differ}};
}

Json perpetual_json(const SceneFound& scene, const Perpetual& p) {
  Json times = Json::array();
  for (const auto& [time, gauge] : p.fluid_at) times.push_back({{"time_s", time}, {"gauge", gauge}});
  return {{"solver", to_string(p.solver)},
          {"fluid", scenes::to_string(p.fluid)},
          {"gauge", scene.apparatus->gauge().name},
          {"unit", scene.apparatus->gauge().unit},
          {"solid_rests_s", value(p.rest)},
          {"solid", value(p.solid)},
          {"read_from_s", p.from},
          {"fluid_at", times},
          {"change", value(p.change())}};
}

Json run_json(const Found& run) {
  return {{"run", run.wanted.point.id},
          {"solver", to_string(run.wanted.solver)},
          {"model", scenes::to_string(run.wanted.model)},
          {"cell_m", run.wanted.cell},
          {"second_resolution", run.wanted.coarse},
          {"ending", to_string(run.outcome.ending)},
          {"reason", run.outcome.reason},
          {"trouble", run.trouble},
          {"doubt", run.doubt.word()},
          {"noise", run.doubt.why},
          {"walls_differ", run.walls_differ},
          {"rest_s", value(run.rest)},
          {"arrival_s", value(run.arrival)},
          {"end_s", value(run.end)},
          {"moves_at_end_mm_s", value(run.creep)},
          {"cpu_s", run.cpu},
          {"made_by", run.version}};
}

std::string csv_cell(const Json& json) {
  if (json.is_number()) return fmt::format("{:.17g}", json.get<double>());
  if (json.is_boolean()) return json.get<bool>() ? "yes" : "no";
  return json.is_string() ? runs::csv_field(json.get<std::string>()) : "";
}

}  // namespace

Json to_json(const Validation& validation) {
  Json json = {{"format", "flowrest validation"},
               {"format_version", 2},
               {"provenance", runs::provenance()},
               {"findings", Json::array()},
               {"scenes", Json::array()}};
  for (const Finding& f : validation.findings)
    json["findings"].push_back({{"claim", f.claim},
                                {"source", f.source},
                                {"scene", f.scene},
                                {"solver", to_string(f.solver)},
                                {"law", f.law},
                                {"holds", to_string(f.holds)},
                                {"seen", f.seen}});
  for (const SceneFound& scene : validation.scenes) {
    Json entry = {{"scene", scene.name},
                  {"title", scene.title},
                  {"kind", scene.apparatus->name()},
                  {"notes", scene.notes},
                  {"how_to_make_what_is_missing", scene.how_to_make},
                  {"runs", Json::array()},
                  {"numbers", Json::array()},
                  {"perpetual_flow", Json::array()},
                  {"flocculation", Json::array()}};
    for (const Found& run : scene.runs) entry["runs"].push_back(run_json(run));
    for (const Number& n : scene.numbers) entry["numbers"].push_back(number_json(n));
    for (const Perpetual& p : scene.perpetual) entry["perpetual_flow"].push_back(perpetual_json(scene, p));
    for (const Flocculation& f : scene.flocculation)
      entry["flocculation"].push_back({{"solver", to_string(f.solver)},
                                       {"model", scenes::to_string(f.model)},
                                       {"start", f.start},
                                       {"least", f.least},
                                       {"least_at_s", f.least_at},
                                       {"end", f.end},
                                       {"end_at_s", f.end_at},
                                       {"rate_at_end_1_s", f.rate_end},
                                       {"growth_at_rest_1_s", f.growth_at_rest}});
    json["scenes"].push_back(std::move(entry));
  }
  return json;
}

std::string to_csv(const Validation& validation) {
  std::string text;
  for (const SceneFound& scene : validation.scenes)
    for (const Number& n : scene.numbers) {
      const Json json = number_json(n);
      std::vector<std::string> names, cells;
      for (const auto& [key, cell] : json.items()) {
        names.push_back(key);
        cells.push_back(csv_cell(cell));
      }
      if (text.empty()) text = fmt::format("{}\n", fmt::join(names, ","));
      text += fmt::format("{}\n", fmt::join(cells, ","));
    }
  return text;
}

void write(const Validation& validation, const std::filesystem::path& folder) {
  runs::write_atomically(folder / "validation.json",
                         to_json(validation).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  runs::write_atomically(folder / "validation.csv", to_csv(validation));
  runs::write_atomically(folder / "index.html", report::render(page_of(validation)));
}

}  // namespace flowrest::studies::validation
