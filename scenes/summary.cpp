#include "scenes/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenes/cost.h"
#include "scenes/plausibility.h"
#include "scenes/settings.h"
#include "scenes/step_limits.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

using Json = nlohmann::ordered_json;

/// What holds where a key is not given.
std::string default_text(const Key& key, const Json& of_empty_scene) {
  if (key.required) return "**needed**";
  return key.fallback.empty() ? fmt::format("`{}`", toml_value(of_empty_scene)) : key.fallback;
}

/// A scene with the first apparatus that a key belongs to, with everything left at its default.
Draft empty_draft(const Key& key) {
  Draft draft;
  draft.scene.thixotropy.emplace();
  if (!key.only.empty()) draft.take(*apparatus_named(apparatus_names()[key.only.front()]));
  return draft;
}

std::string reference_row(const Key& key) {
  Draft draft = empty_draft(key);
  std::vector<std::string> names;
  for (const std::size_t place : key.only) names.push_back(apparatus_names()[place]);
  const std::string kind = names.empty() ? "" : fmt::format(" ({} only)", joined(names));
  return fmt::format("| `{}` | {} | {} | {} | {}{} |\n", key.name, key.takes, key.unit,
                     default_text(key, key.write(draft)), key.meaning, kind);
}

}  // namespace

std::string key_reference() {
  std::string text;
  for (const Section& section : sections()) {
    text += section.name.empty() ? fmt::format("### {}\n\n", section.meaning)
                                 : fmt::format("\n### [{}]: {}\n\n", section.name, section.meaning);
    text += "| key | takes | unit | default | meaning |\n|---|---|---|---|---|\n";
    for (const Key& key : keys()) {
      if (key.section == section.name) text += reference_row(key);
    }
  }
  return text;
}

namespace {

/// A number as people read it.
std::string readable(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object()) return toml_value(value);
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& item : value) {
    const std::string separator = text.empty() ? "" : ", ";
    text += item.is_array() ? fmt::format("{}[{}]", separator, readable(item))
                            : fmt::format("{}{}", separator, readable(item));
  }
  return text.empty() ? "none" : text;
}

/// "1.2 us", "1.2 ms", "1.2 s", "2.3 h".
std::string duration(double seconds) {
  if (std::isinf(seconds)) return "none";
  const std::pair<double, const char*> units[] = {
      {1e-6, "us"}, {1e-3, "ms"}, {1.0, "s"}, {3600.0, "h"}, {86400.0, "days"}};
  auto unit = units[0];
  for (const auto& larger : units) {
    if (seconds >= larger.first) unit = larger;
  }
  return fmt::format("{:.3g} {}", seconds / unit.first, unit.second);
}

std::string line(const std::string& name, const std::string& value, const std::string& remark = "") {
  constexpr int name_width = 28;
  constexpr int value_width = 20;
  if (remark.empty()) return fmt::format("  {:<{}}{}\n", name, name_width, value);
  return fmt::format("  {:<{}}{:<{}}  {}\n", name, name_width, value, value_width, remark);
}

std::string settings_text(const Scene& scene) {
  std::string text;
  std::string section;
  for (const auto& [key, value] : settings_of(scene)) {
    if (key->path() == "title") continue;
    if (key->section != section) text += fmt::format("[{}]\n", section = key->section);
    text += line(key->name, readable(value), key->unit);
  }
  return text;
}

std::string mpm_text(const Scene& scene, const Estimates& estimates) {
  const StepLimits limits = step_limits(scene);
  const MpmEstimate estimate = estimate_mpm(scene);
  std::string text = fmt::format("Material point run, {}\n", to_string(scene.material.model));
  text += line("wave speed", fmt::format("{:.4g}", scene.mpm.cell / limits.acoustic),
               "m/s, under its own weight");
  text += line("volume under its weight", fmt::format("{:.1f}", 100.0 * volume_under_weight(scene)), "%");
  text += line("acoustic step limit", duration(limits.largest_cfl * limits.acoustic),
               fmt::format("{:.3g} cell / wave speed", limits.largest_cfl));
  text += line("viscous step limit", duration(limits.viscous), "explicit fluid only");
  text += line("step", duration(estimate.step));
  text += line("steps", fmt::format("{:.0f}", estimate.steps), "to time.end");
  text += line("particles", fmt::format("{:.0f}", estimate.particles));
  text += line("occupied cells", fmt::format("{:.0f}", estimate.cells), "at the start");
  if (!estimates.mpm) return text;
  const Cost cost = estimates.mpm(scene);
  text += line("memory", "about " + bytes_in_words(cost.memory));
  text += line("cost", "about " + duration(cost.cpu_seconds),
               "CPU time to time.end; less where it stops at rest");
  return text;
}

std::string foam_text(const FoamEstimate& estimate) {
  std::string text = "OpenFOAM run\n";
  text += line("mesh cells", fmt::format("{:.0f}", estimate.cells));
  text += line("step", "at most " + duration(estimate.step));
  text += line("steps", fmt::format("at least {:.0f}", estimate.steps));
  text += line("memory", "about " + bytes_in_words(estimate.cost.memory));
  text += line("cost", "about " + duration(estimate.cost.cpu_seconds), "CPU time to time.end");
  return text;
}

/// Infinity has no place in JSON.
Json finite(double number) { return std::isfinite(number) ? Json(number) : Json(); }

}  // namespace

std::string check_text(const Scene& scene, const Estimates& estimates) {
  std::string text = fmt::format("{}  ({})\n", scene.title, scene.path.string());
  text += fmt::format("{}\n{}", settings_text(scene), mpm_text(scene, estimates));
  if (!scene.runs.foam.empty() && estimates.foam)
    text += fmt::format("\n{}", foam_text(estimates.foam(scene)));
  return text;
}

std::string check_json(const Scene& scene, const Estimates& estimates) {
  const StepLimits limits = step_limits(scene);
  const MpmEstimate estimate = estimate_mpm(scene);
  Json json;
  json["scene"] = scene.name;
  json["notes"] = plausibility_notes(scene);
  json["settings"] = settings_json(scene);
  json["step_limits"] = {{"acoustic_s", limits.acoustic},
                         {"viscous_s", finite(limits.viscous)},
                         {"largest_cfl", limits.largest_cfl},
                         {"largest_s", limits.largest()}};
  json["mpm"] = {{"particles", estimate.particles},
                 {"cells", estimate.cells},
                 {"steps", estimate.steps},
                 {"step_s", estimate.step}};
  if (estimates.mpm) {
    const Cost cost = estimates.mpm(scene);
    json["mpm"]["memory_bytes"] = cost.memory;
    json["mpm"]["cpu_s"] = cost.cpu_seconds;
  }
  if (!scene.runs.foam.empty() && estimates.foam) {
    const FoamEstimate foam = estimates.foam(scene);
    json["foam"] = {{"cells", foam.cells},
                    {"steps", foam.steps},
                    {"step_s", foam.step},
                    {"memory_bytes", foam.cost.memory},
                    {"cpu_s", foam.cost.cpu_seconds}};
  }
  return json.dump();
}

}  // namespace flowrest::scenes
