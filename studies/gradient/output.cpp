#include <fmt/format.h>

#include <cmath>

#include "runs/run_directory.h"
#include "scenes/text.h"
#include "studies/gradient/gradient.h"

namespace flowrest::studies::gradient {

namespace {

using Json = nlohmann::ordered_json;

/// The quantity's unit per the key's.
std::string unit_of(const Gradient& g, const Derivative& d) {
  const std::string above = g.quantity.unit;
  if (d.key.unit.empty()) return above;
  return fmt::format("{} / ({})", above.empty() ? "1" : above, d.key.unit);
}

Json json_of(const Check& c) {
  Json json = {{"taylor_slope", c.linear ? Json() : Json(c.taylor_slope)},
               {"central_difference", c.central_difference},
               {"relative_error", c.relative_error}};
  for (const Remainder& r : c.remainders)
    json["remainders"].push_back(
        {{"relative_step", r.relative_step}, {"without_derivative", r.without}, {"with_derivative", r.with}});
  for (const CentralDifference& d : c.differences)
    json["differences"].push_back({{"relative_step", d.relative_step}, {"value", d.value}});
  return json;
}

Json json_of(const Gradient& g, const Result& result) {
  Json json = {{"quantity", g.quantity.name},
               {"asked_for", g.asked},
               {"meaning", g.quantity.meaning},
               {"value", g.value},
               {"unit", g.quantity.unit},
               {"column", *g.quantity.column ? Json(g.quantity.column) : Json()},
               {"column_value", g.column ? Json(*g.column) : Json()},
               {"derivatives", Json::array()}};
  for (const Derivative& d : g.by) {
    Json one = {{"key", d.key.path},
                {"at", d.key.value},
                {"value", d.value},
                {"unit", unit_of(g, d)},
                {"elasticity", d.elasticity}};
    if (d.check) one["check"] = json_of(*d.check);
    json["derivatives"].push_back(one);
  }
  Json check = {{"word", g.doubt.empty() ? "agrees" : g.doubt},
                {"directional_derivative", g.directional},
                {"directional_difference", g.directional_difference}};
  // Of several keys the worst.
  double slope = 2.0, error = 0.0, difference = 0.0;
  bool any = false;
  for (const Derivative& d : g.by) {
    if (!d.check) continue;
    any = true;
    if (!d.check->linear && std::abs(d.check->taylor_slope - 2.0) >= std::abs(slope - 2.0))
      slope = d.check->taylor_slope;
    if (d.check->relative_error < error) continue;
    error = d.check->relative_error;
    difference = d.check->central_difference;
  }
  if (any) {
    check["taylor_slope"] = slope;
    check["central_difference"] = difference;
    check["relative_error"] = error;
  }
  json["check"] = check;
  const Cost& c = result.cost;
  json["cost"] = {{"forward_cpu_s", c.forward_cpu},
                  {"plain_cpu_s", c.plain_cpu},
                  {"gradient_cpu_s", c.gradient_cpu},
                  {"ratio", c.forward_cpu > 0.0 ? c.gradient_cpu / c.forward_cpu : 0.0},
                  {"memory_bytes", c.memory},
                  {"recomputed_steps", c.recomputed_steps},
                  {"steps", c.steps}};
  if (g.has_sigma()) {
    Json shares = Json::array();
    for (const Derivative& d : g.by)
      if (d.sigma) shares.push_back({{"key", d.key.path}, {"sigma", *d.sigma}, {"share", g.input_share(d)}});
    json["input_uncertainty"] = {
        {"standard", g.input_uncertainty()}, {"unit", g.quantity.unit}, {"of", shares}};
  }
  return json;
}

std::string table_of(const Result& result) {
  std::string text = "quantity,value,unit,key,at,derivative,derivative_unit,elasticity\n";
  for (const Gradient& g : result.gradients)
    for (const Derivative& d : g.by)
      text += fmt::format("{},{},{},{},{},{},{},{}\n", g.quantity.name, scenes::exact_text(g.value),
                          g.quantity.unit, d.key.path, scenes::exact_text(d.key.value),
                          scenes::exact_text(d.value), unit_of(g, d), scenes::exact_text(d.elasticity));
  return text;
}

std::string table_over_time(const Result& result) {
  std::string text = "time_s,quantity,value,key,derivative\n";
  for (const auto& row : result.over_time)
    for (std::size_t q = 0; q < result.gradients.size(); ++q)
      for (std::size_t k = 0; k < result.gradients[q].by.size(); ++k)
        text += fmt::format("{},{},{},{},{}\n", scenes::exact_text(row.time),
                            result.gradients[q].quantity.name, scenes::exact_text(row.value[q]),
                            result.gradients[q].by[k].key.path, scenes::exact_text(row.slope[q][k]));
  return text;
}

}  // namespace

nlohmann::ordered_json json_of(const Result& result) {
  Json all = Json::array();
  for (const Gradient& g : result.gradients) {
    Json one = json_of(g, result);
    one["scene"] = result.scene.name;
    one["model"] = scenes::to_string(result.scene.material.model);
    one["mode"] = result.mode;
    one["run_ended"] = result.ended;
    one["provenance"] = runs::provenance();
    all.push_back(std::move(one));
  }
  return all.size() == 1 ? all.front() : all;
}

void write(const Result& result) {
  const auto& folder = result.directory;
  runs::write_atomically(folder / "gradient.json", json_of(result).dump(2) + "\n");
  runs::write_atomically(folder / "gradient.csv", table_of(result));
  runs::write_atomically(folder / "gradient_over_time.csv", table_over_time(result));
  runs::write_atomically(folder / "gradient.html", page_of(result));
}

}  // namespace flowrest::studies::gradient
