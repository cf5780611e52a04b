#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/words.h"
#include "runs/csv.h"
#include "runs/run_directory.h"
#include "studies/page.h"
#include "studies/quantities.h"
#include "studies/results.h"

namespace flowrest::studies {

namespace {

using Json = nlohmann::ordered_json;

std::string plain(const std::string& toml) {
  const bool quoted = toml.size() >= 2 && toml.front() == '"';
  return quoted ? toml.substr(1, toml.size() - 2) : toml;
}

template <class T>
Json map_json(const std::map<std::string, T>& map) {
  Json json = Json::object();
  for (const auto& [key, value] : map) json[key] = value;
  return json;
}

Json result_json(const Result& r) {
  Json settings = Json::object();
  for (const Setting& s : r.point.varied) settings[s.key] = plain(s.value);
  Json json = {{"id", r.point.id},
               {"label", r.point.label},
               {"role", to_string(r.point.role)},
               {"sweep", r.point.sweep},
               {"solver", to_string(r.point.solver)},
               {"settings", settings},
               {"verdict", to_string(r.verdict)},
               {"reason", r.reason},
               {"values", map_json(r.values)},
               {"relative_errors", map_json(r.errors)},
               {"pareto", map_json(r.pareto)},
               {"cpu_s", r.cpu},
               {"wall_s", r.wall},
               {"peak_memory_bytes", r.memory},
               {"git_hash", r.version},
               {"cpu", r.machine}};
  if (r.point.scene) json["run"] = "runs/" + r.point.id;
  return json;
}

Json price_json(const Price& p) {
  return {{"sweep", p.sweep},
          {"setting", p.key},
          {"from", p.from},
          {"to", p.to},
          {"pairs", p.pairs},
          {"cpu_ratio", p.cpu_ratio},
          {"memory_ratio", p.memory_ratio > 0.0 ? Json(p.memory_ratio) : Json()},
          {"relative_change", map_json(p.change)},
          {"relative_error_change", map_json(p.error_change)}};
}

/// A field of a CSV file, quoted where it has to be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string number(double value) { return fmt::format("{:.17g}", value); }

template <class Map>
std::string cell(const Map& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? "" : number(found->second);
}

/// Every key that differs between points, in the order of their first appearance.
std::vector<std::string> varied_keys(const Results& results) {
  std::vector<std::string> keys;
  for (const Result& r : results.results)
    for (const Setting& s : r.point.varied)
      if (std::find(keys.begin(), keys.end(), s.key) == keys.end()) keys.push_back(s.key);
  return keys;
}

std::string row(const Results& results, const Result& r, const std::vector<std::string>& keys) {
  std::vector<std::string> cells = {r.point.id, to_string(r.point.role), r.point.sweep,
                                    to_string(r.point.solver)};
  for (const std::string& key : keys) {
    std::string value;
    for (const Setting& s : r.point.varied)
      if (s.key == key) value = plain(s.value);
    cells.push_back(value);
  }
  cells.insert(cells.end(), {to_string(r.verdict), r.reason, r.cpu > 0.0 ? number(r.cpu) : "",
                             r.wall > 0.0 ? number(r.wall) : "", r.memory > 0.0 ? number(r.memory) : ""});
  for (const std::string& quantity : results.study.quantities) {
    cells.push_back(cell(r.values, quantity));
    cells.push_back(cell(r.errors, quantity));
    const auto reference = results.reference.find(quantity);
    const bool known = reference != results.reference.end() && reference->second.uncertainty;
    const double scale = known && !is_difference(quantity) ? std::abs(reference->second.value) : 1.0;
    cells.push_back(known && scale > 0.0 ? number(*reference->second.uncertainty / scale) : "");
    const auto pareto = r.pareto.find(quantity);
    cells.push_back(pareto == r.pareto.end() ? "" : pareto->second ? "1" : "0");
  }
  std::string line;
  for (const std::string& c : cells) {
    if (&c != &cells.front()) line += ',';
    line += field(c);
  }
  return line + "\n";
}

}  // namespace

Json to_json(const Results& results) {
  Json reference = Json::object();
  for (const auto& [quantity, v] : results.reference)
    reference[quantity] = {{"value", v.value},
                           {"unit", unit_of(quantity)},
                           {"uncertainty", v.uncertainty ? Json(*v.uncertainty) : Json()},
                           {"how", v.words}};
  Json json = {{"format", "flowrest study"},
               {"format_version", 1},
               {"name", results.study.name},
               {"title", results.study.title},
               {"purpose", to_string(results.study.purpose)},
               {"scene", results.study.scene},
               {"cut", results.cut},
               {"quantities", results.study.quantities},
               {"reference_kind", to_string(results.study.reference.kind)},
               {"reference", reference},
               {"findings", results.findings},
               {"notes", results.notes},
               {"limit", nullptr},
               {"points", Json::array()},
               {"prices", Json::array()},
               {"provenance", runs::provenance()},
               {"study", results.study.source}};
  if (results.limit)
    json["limit"] = {{"quantity", results.study.limit->quantity},
                     {"growing", results.study.limit->key},
                     {"value", results.limit->value},
                     {"uncertainty", results.limit->uncertainty},
                     {"exponent", results.limit->exponent},
                     {"words", results.limit_words}};
  for (const Result& r : results.results) json["points"].push_back(result_json(r));
  for (const Price& p : results.prices) json["prices"].push_back(price_json(p));
  return json;
}

std::string to_csv(const Results& results) {
  const auto keys = varied_keys(results);
  std::string text = "id,role,sweep,solver";
  for (const std::string& key : keys) text += fmt::format(",{}", key);
  text += ",verdict,reason,cpu_s,wall_s,peak_memory_bytes";
  for (const std::string& q : results.study.quantities)
    for (const char* more : {"", "_relative_error", "_relative_uncertainty", "_pareto"})
      text += fmt::format(",{}", runs::csv_field(q + more));
  text += "\n";
  for (const Result& r : results.results) text += row(results, r, keys);
  return text;
}

void write_results(const Folder& folder, const Results& results) {
  const Json json = to_json(results);
  runs::write_atomically(folder.root / "study.json",
                         json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  runs::write_atomically(folder.root / "points.csv", to_csv(results));
  runs::write_atomically(folder.root / "index.html", report::render(study_page(results, json)));
}

}  // namespace flowrest::studies
