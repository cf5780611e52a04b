#include "compare/input_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace flowrest::compare {

namespace {

using Json = nlohmann::json;
using namespace nlohmann::literals;

InputPart part_of(const Json& quantity) {
  const Json& uncertainty = quantity["input_uncertainty"];
  InputPart part{quantity.value("quantity", ""),
                 quantity.value("unit", ""),
                 quantity.at("value").get<double>(),
                 uncertainty.at("standard").get<double>(),
                 {}};
  for (const Json& of : uncertainty.value("of", Json::array()))
    part.shares.push_back({of.value("key", ""), of.at("share").get<double>()});
  std::stable_sort(part.shares.begin(), part.shares.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share; });
  return part;
}

}  // namespace

std::vector<Json> sound_gradients(const runs::Run& run) {
  std::ifstream file(run.directory / "gradient.json");
  const Json json = file ? Json::parse(file, nullptr, false) : Json(Json::value_t::discarded);
  std::vector<Json> sound;
  if (json.is_discarded()) return sound;
  for (const Json& quantity : json.is_array() ? json : Json::array({json}))
    if (quantity.is_object() && quantity.value("/check/word"_json_pointer, "") == "agrees")
      sound.push_back(quantity);
  return sound;
}

std::vector<InputPart> input_parts(const runs::Run& run) {
  std::vector<InputPart> parts;
  for (const Json& quantity : sound_gradients(run)) try {
      if (quantity.contains("input_uncertainty")) parts.push_back(part_of(quantity));
    } catch (const Json::exception&) {
      continue;  // not one of ours
    }
  return parts;
}

std::optional<report::Chapter> input_chapter(const Comparison& comparison) {
  report::Table table;
  table.id = "input-uncertainty";
  table.title = "What the uncertainty of inputs makes of it";
  table.caption =
      "One standard uncertainty, by derivatives of the run (flowrest gradient --sigma), keys taken as independent. It comes "
      "on top of what grid and gauge leave open.";
  const auto digits = [](int n) { return report::Format{report::Format::Kind::significant, n}; };
  table.columns = {{.name = "Run", .text = true},          {.name = "Quantity", .text = true},
                   {.name = "Value", .format = digits(4)}, {.name = "± by inputs", .format = digits(2)},
                   {.name = "Unit", .text = true},         {.name = "Of its variance", .text = true}};
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    for (const InputPart& part : input_parts(view.run)) {
      std::string shares;
      for (const auto& [key, share] : part.shares)
        shares += fmt::format("{}{:.0f} % {}", shares.empty() ? "" : ", ", 100.0 * share, key);
      table.rows.push_back(
          {{view.label, part.quantity, part.value, part.standard, part.unit, shares}, static_cast<int>(i)});
    }
  }
  if (table.rows.empty()) return std::nullopt;
  return report::Chapter{"inputs", "What the inputs leave open", {table}};
}

}  // namespace flowrest::compare
