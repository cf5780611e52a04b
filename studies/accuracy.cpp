#include "studies/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "compare/words.h"
#include "mpm/cost.h"
#include "runs/command.h"
#include "runs/run_directory.h"
#include "scenes/names.h"
#include "scenes/pieces.h"
#include "scenes/text.h"

namespace flowrest::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double twin_is_coarser = 1.6;

std::string percent(double fraction) { return compare::words::percent(fraction); }

bool is_cell(const std::string& key) { return key == "mpm.cell" || key == "foam.cell"; }

Json point_json(const Result& r, const std::string& quantity) {
  Json settings = Json::object();
  for (const Setting& s : r.point.varied)
    if (!is_cell(s.key) && s.key != "material.model") settings[s.key] = s.value;
  return {{"model", scenes::to_string(r.point.scene->material.model)},
          {"settings", settings},
          {"cell_m", r.point.scene->mpm.cell},
          {"relative_error", r.errors.at(quantity)},
          {"cpu_s", r.cpu},
          {"expected_cpu_s", mpm::cost(*r.point.scene).cpu_seconds}};
}

/// Settings of the material or the geometry change what is simulated: they are no means to an accuracy.
bool is_means(const Result& r) {
  return std::all_of(r.point.varied.begin(), r.point.varied.end(), [](const Setting& s) {
    return s.key.starts_with("mpm.") || s.key == "material.model" || s.key == "time.rest_bound";
  });
}

template <class T>
T named(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) throw runs::RunError(fmt::format("'{}' is missing", key));
  return found->get<T>();
}

template <class Choice>
Choice choice_from(const std::string& name, const char* what) {
  if (const auto choice = scenes::choice_named<Choice>(name)) return *choice;
  throw runs::RunError(fmt::format("the {} '{}' is unknown; allowed: {}", what, name,
                                   scenes::joined(scenes::all_names<Choice>())));
}

/// A cell that suits the scene: between plates lies a whole number of them.
double suited_cell(const scenes::Scene& scene, double cell) {
  const auto height = scenes::pieces_of(scene).whole_cells_over;
  return height ? *height / std::ceil(*height / cell * (1.0 - 1e-9)) : cell;
}

std::vector<std::string> settings_with(const KnownPoint& point, double cell) {
  std::vector<std::string> set;
  for (const auto& [key, value] : point.settings) set.push_back(fmt::format("{}={}", key, value));
  set.push_back(fmt::format("mpm.cell={}", scenes::exact_text(cell)));
  return set;
}

struct Candidate {
  const Knowledge* knowledge = nullptr;
  const KnownPoint* point = nullptr;
  double error() const { return point->error + knowledge->uncertainty; }
};

std::vector<Candidate> candidates_for(const std::vector<Knowledge>& all, const scenes::Scene& scene) {
  std::vector<Candidate> candidates;
  for (const Knowledge& k : all)
    for (const KnownPoint& p : k.points)
      if (k.apparatus == scenes::name_of(scene.geometry.apparatus) &&
          k.dimension == scene.geometry.dimension && p.model == scene.material.model)
        candidates.push_back({&k, &p});
  return candidates;
}

/// The command that runs a scene without an accuracy, its cell to be changed.
std::string with_own_cell(const scenes::Scene& scene) {
  std::vector<std::string> arguments =
      runs::scene_arguments(runs::without_setting(scene.request, "mpm.cell"));
  arguments.insert(arguments.begin(), "mpm");
  arguments.insert(arguments.end(),
                   {"--set", fmt::format("mpm.cell={}", scenes::exact_text(scene.mpm.cell))});
  return runs::command_line(arguments);
}

[[noreturn]] void nothing_known(const std::vector<Knowledge>& all, const scenes::Scene& scene) {
  std::string known;
  for (const Knowledge& k : all)
    known += fmt::format("{}{} ({}, by the study {})", known.empty() ? "" : "; ", k.apparatus,
                         scenes::to_string(k.dimension), k.study);
  throw scenes::SceneError(fmt::format(
      "{}: no study has measured what accuracy a {} ({}, {}) costs, so no settings can be chosen for one; "
      "known: "
      "{}. Write a study of such scenes and run it with --keep, or give the cell yourself: `{}`",
      scene.path.string(), scenes::name_of(scene.geometry.apparatus),
      scenes::to_string(scene.geometry.dimension), scenes::to_string(scene.material.model),
      known.empty() ? "nothing" : known, with_own_cell(scene)));
}

scenes::Scene with_settings(const scenes::Scene& scene, const std::vector<std::string>& set) {
  return scenes::parse_scene(scenes::resolved_toml(scene), scene.path, {set, std::nullopt});
}

}  // namespace

Json knowledge_json(const Results& results) {
  const std::string quantity = results.study.quantities.front();
  const auto reference = results.reference.find(quantity);
  if (reference == results.reference.end() || !reference->second.uncertainty ||
      reference->second.value == 0.0)
    throw runs::RunError(fmt::format(
        "the study has no reference with an uncertainty for {}: there is nothing to keep", quantity));
  Json points = Json::array();
  const scenes::Scene* scene = nullptr;
  std::string made_by;
  for (const Result& r : results.results) {
    if (r.point.role != Point::Role::point || r.point.solver != Solver::mpm ||
        !is_worth_its_error(r.verdict) || !r.errors.contains(quantity) || !is_means(r))
      continue;
    if (scene && scene->geometry.dimension != r.point.scene->geometry.dimension) continue;
    // Held against a reference of another law, an error is the law's and no setting mends it.
    const auto law = results.study.reference.model;
    if (law && *law != r.point.scene->material.model) continue;
    scene = &*r.point.scene;
    made_by = fmt::format("flowrest {} on {}", r.version, r.machine);
    points.push_back(point_json(r, quantity));
  }
  if (!scene) throw runs::RunError("the study has no sound run of MPM: there is nothing to keep");
  return {{"format", "flowrest knowledge"},
          {"format_version", 1},
          {"study", results.study.name},
          {"cut", results.cut},
          {"scene", results.study.scene},
          {"kind", scenes::name_of(scene->geometry.apparatus)},
          {"dimension", scenes::to_string(scene->geometry.dimension)},
          {"length_m", scene->body_size()},
          {"quantity", quantity},
          {"reference", reference->second.words},
          {"relative_uncertainty", *reference->second.uncertainty / std::abs(reference->second.value)},
          {"made_by", made_by},
          {"made", runs::provenance().value("written", "")},
          {"points", points}};
}

Knowledge parse_knowledge(const Json& json) {
  Knowledge k;
  k.study = named<std::string>(json, "study");
  k.cut = named<std::string>(json, "cut");
  k.scene = named<std::string>(json, "scene");
  k.quantity = named<std::string>(json, "quantity");
  k.apparatus = named<std::string>(json, "kind");
  if (!scenes::apparatus_named(k.apparatus))
    throw runs::RunError(fmt::format("the kind of scene '{}' is unknown; allowed: {}", k.apparatus,
                                     scenes::joined(scenes::apparatus_names())));
  k.dimension = choice_from<scenes::Dimension>(named<std::string>(json, "dimension"), "dimension");
  k.length = named<double>(json, "length_m");
  k.uncertainty = named<double>(json, "relative_uncertainty");
  k.reference = named<std::string>(json, "reference");
  k.made_by = named<std::string>(json, "made_by") + ", " + named<std::string>(json, "made");
  const Json points = named<Json>(json, "points");
  for (const Json& point : points) {
    KnownPoint p;
    p.model = scenes::model_from_name(named<std::string>(point, "model"));
    const Json settings = named<Json>(point, "settings");
    for (const auto& [key, value] : settings.items()) p.settings.emplace_back(key, value.get<std::string>());
    p.cell = named<double>(point, "cell_m");
    p.error = named<double>(point, "relative_error");
    p.cpu = named<double>(point, "cpu_s");
    p.work = named<double>(point, "expected_cpu_s");
    k.points.push_back(std::move(p));
  }
  return k;
}

std::vector<Knowledge> stored_knowledge() {
  std::vector<Knowledge> all;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(scenes::scenes_folder() / "studies", error)) {
    if (!entry.path().string().ends_with(".known.json")) continue;
    std::ifstream file(entry.path());
    try {
      all.push_back(parse_knowledge(Json::parse(file)));
    } catch (const std::exception& wrong) {
      throw runs::RunError(
          fmt::format("{}: is not what a study keeps: {}", entry.path().string(), wrong.what()));
    }
  }
  return all;
}

double accuracy_from(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  auto [rest, error] = std::from_chars(text.data(), end, value);
  while (rest != end && *rest == ' ') ++rest;
  const bool in_percent = rest != end && *rest == '%';
  if (in_percent) {
    value /= 100.0;
    ++rest;
  }
  if (error != std::errc{} || rest != end || !(value > 0.0) || !(value < 1.0))
    throw scenes::SceneError(
        fmt::format("--accuracy {}: must be a share such as 2% or 0.02, greater than 0 and less than 1",
                    scenes::quoted(text)));
  return value;
}

double error_by_twin(double value, double twin_value, double coarser) {
  return std::abs(value - twin_value) / (coarser - 1.0) / std::abs(value);
}

Choice choose(const std::vector<Knowledge>& all, const scenes::Scene& scene, double accuracy) {
  const auto candidates = candidates_for(all, scene);
  if (candidates.empty()) nothing_known(all, scene);
  const Candidate *cheapest = nullptr, *best = nullptr;
  for (const Candidate& c : candidates) {
    if (!best || c.error() < best->error()) best = &c;
    if (c.error() <= accuracy && (!cheapest || c.point->cpu < cheapest->point->cpu)) cheapest = &c;
  }
  if (!cheapest)
    throw scenes::SceneError(fmt::format(
        "{}: no settings are known to reach {}: the best that the study {} knows, cells of {:g} m in its "
        "scene, come "
        "within {} ({} off a reference that is itself uncertain by {})",
        scene.path.string(), percent(accuracy), best->knowledge->study, best->point->cell,
        // One digit more than elsewhere: what was asked for may be missed by a hair.
        fmt::format("{:.3g} %", 100.0 * best->error()), percent(best->point->error),
        percent(best->knowledge->uncertainty)));
  const Knowledge& k = *cheapest->knowledge;
  const KnownPoint& p = *cheapest->point;
  Choice choice;
  choice.quantity = k.quantity;
  choice.cell = suited_cell(scene, p.cell * scene.body_size() / k.length);
  choice.twin_cell = suited_cell(scene, twin_is_coarser * choice.cell);
  choice.set = settings_with(p, choice.cell);
  choice.twin_set = settings_with(p, choice.twin_cell);
  choice.expected_error = cheapest->error();
  // As much dearer than the known run as the estimates of both say.
  const double known_over_estimated = p.work > 0.0 ? p.cpu / p.work : 1.0;
  choice.expected_cpu = known_over_estimated * (mpm::cost(with_settings(scene, choice.set)).cpu_seconds +
                                                mpm::cost(with_settings(scene, choice.twin_set)).cpu_seconds);
  std::string settings;
  for (const std::string& s : choice.set) settings += (settings.empty() ? "" : ", ") + std::string(s);
  choice.why = fmt::format(
      "{}: in {} (study {}{}, {}) cells of {:g} m came within {} of the reference's {} for {} of CPU, and "
      "the reference "
      "is uncertain by {}; nothing cheaper is known to reach {}",
      settings, k.scene, k.study, k.cut.empty() ? "" : ", cut " + k.cut, k.made_by, p.cell, percent(p.error),
      k.quantity, compare::words::duration(p.cpu), percent(k.uncertainty), percent(accuracy));
  return choice;
}

}  // namespace flowrest::studies
