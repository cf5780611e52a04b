#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include "scenes/document.h"
#include "scenes/names.h"
#include "scenes/schema.h"
#include "scenes/text.h"
#include "studies/quantities.h"
#include "studies/study.h"
#include "studies/toml_table.h"

namespace flowrest::studies {

namespace {

namespace fs = std::filesystem;
using scenes::Faults;
using scenes::joined;
using scenes::Location;
using scenes::SceneError;

std::string unknown(const std::string& what, const std::string& given,
                    const std::vector<std::string>& allowed) {
  const std::string near = scenes::nearest(given, allowed);
  return fmt::format("unknown {} {}{}; allowed: {}", what, scenes::quoted(given),
                     near.empty() ? "" : ", nearest is " + near, joined(allowed));
}

/// A TOML value on one line, as --set takes it.
std::string value_text(const toml::node& node) {
  if (const auto* string = node.as_string()) return scenes::toml_string(string->get());
  if (const auto* number = node.as_floating_point()) return scenes::exact_text(number->get());
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* boolean = node.as_boolean()) return boolean->get() ? "true" : "false";
  std::string text;
  if (const auto* array = node.as_array())
    for (const toml::node& item : *array) text += (text.empty() ? "" : ", ") + value_text(item);
  return "[" + text + "]";
}

bool is_plain_value(const toml::node& node, int depth = 0) {
  if (const auto* array = node.as_array())
    return depth < 2 && std::all_of(array->begin(), array->end(),
                                    [&](const toml::node& item) { return is_plain_value(item, depth + 1); });
  return node.is_string() || node.is_number() || node.is_boolean();
}

bool is_scene_key(const std::string& path, const Location& where, Faults& faults) {
  if (scenes::find_key(path) && path != "extends" && path != "kind") return true;
  std::vector<std::string> paths;
  for (const scenes::Key& key : scenes::keys()) paths.push_back(key.path());
  const std::string near = scenes::nearest(path, paths);
  faults.add(where, fmt::format("{} is no key that a study may set{}; allowed: every key of `flowrest scenes "
                                "--keys` but extends and kind",
                                scenes::quoted(path), near.empty() ? "" : ", nearest is " + near));
  return false;
}

/// Calls `use` with the dotted path and the value of every setting of a table: "mpm.cell" = ... and
/// mpm.cell = ... are the same.
void for_each_setting(
    const toml::table& table, const std::string& prefix, Table& reader,
    const std::function<void(const std::string&, const toml::node&, const Location&)>& use) {
  for (auto&& [name, node] : table) {
    const std::string path = prefix + std::string(name.str());
    if (const auto* inner = node.as_table()) {
      for_each_setting(*inner, path + ".", reader, use);
      continue;
    }
    const Location where = reader.place(name.source().begin);
    if (is_scene_key(path, where, reader.faults())) use(path, node, where);
  }
}

void add_setting(Settings& settings, const std::string& path, const toml::node& node, const Location& where,
                 Faults& faults) {
  if (is_plain_value(node))
    settings.push_back({path, value_text(node), where});
  else
    faults.add(where, fmt::format("{} must be a value of the scene, not {}", path, kind_of(node)));
}

Settings settings_of(const toml::table& table, Table& reader) {
  Settings settings;
  for_each_setting(table, "", reader, [&](const auto& path, const auto& node, const auto& where) {
    add_setting(settings, path, node, where, reader.faults());
  });
  return settings;
}

Settings read_settings(Table& table, const std::string& key) {
  const toml::table* settings = table.table(key);
  return settings ? settings_of(*settings, table) : Settings{};
}

constexpr std::size_t most_alternatives = 1000;

/// An axis for every key; its values in the order of the file.
void read_axes(Table& table, std::vector<Axis>& axes) {
  const toml::table* given = table.table("axes");
  if (!given) return;
  std::vector<std::pair<Location, Axis>> found;
  for_each_setting(*given, "", table, [&](const auto& path, const auto& node, const auto& where) {
    Axis axis{path, {}};
    if (const auto* values = node.as_array(); values && values->size() <= most_alternatives)
      for (const toml::node& value : *values) {
        axis.alternatives.emplace_back();
        add_setting(axis.alternatives.back(), path, value, table.place(value.source().begin), table.faults());
      }
    if (axis.alternatives.empty())
      table.faults().add(
          where, fmt::format("the axis {} must be an array of 1 to {} values", path, most_alternatives));
    found.emplace_back(where, std::move(axis));
  });
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.line, a.first.column) < std::pair(b.first.line, b.first.column);
  });
  for (auto& [where, axis] : found) axes.push_back(std::move(axis));
}

/// Alternatives of several settings each.
void read_choices(Table& table, std::vector<Axis>& axes) {
  const toml::node* node = table.get("choices");
  if (!node) return;
  const auto* array = node->as_array();
  Axis axis{"choice", {}};
  if (array)
    for (const toml::node& item : *array) {
      if (const auto* settings = item.as_table())
        axis.alternatives.push_back(settings_of(*settings, table));
      else
        table.faults().add(table.place(item.source().begin),
                           "a choice must be a table of settings, not " + kind_of(item));
    }
  if (axis.alternatives.empty()) {
    table.fault("choices", "must be an array of tables of settings");
    return;
  }
  axes.push_back(std::move(axis));
}

Solver read_solver(Table& table) {
  const std::string name = table.text("solver", "mpm");
  if (name == "foam") return Solver::foam;
  if (name != "mpm") table.fault("solver", "names an " + unknown("solver", name, {"mpm", "foam"}));
  return Solver::mpm;
}

std::vector<scenes::Model> read_models(Table& table) {
  std::vector<scenes::Model> models;
  for (const std::string& name : table.texts("model")) {
    if (const auto model = scenes::choice_named<scenes::Model>(name))
      models.push_back(*model);
    else
      table.fault("model", "names an " + unknown("model", name, scenes::all_names<scenes::Model>()));
  }
  return models;
}

Sweep read_sweep(Table table, const std::string& otherwise) {
  Sweep sweep;
  sweep.where = table.where();
  sweep.name = table.text("name", otherwise);
  sweep.solver = read_solver(table);
  sweep.models = read_models(table);
  sweep.settings = read_settings(table, "settings");
  read_axes(table, sweep.axes);
  read_choices(table, sweep.axes);
  table.refuse_others();
  return sweep;
}

std::vector<Sweep> read_sweeps(Table& table) {
  std::vector<Sweep> sweeps;
  const toml::node* node = table.get("sweep");
  const toml::array* array = node ? node->as_array() : nullptr;
  if (!array || array->empty()) {
    table.fault("sweep", "is missing; needed: [[sweep]] tables with solver, model, settings and axes");
    return sweeps;
  }
  for (const toml::node& item : *array) {
    const auto* inner = item.as_table();
    if (!inner) {
      table.fault("sweep", "must hold tables, not " + kind_of(item));
      continue;
    }
    sweeps.push_back(read_sweep(Table(*inner, "sweep", table.source(), table.faults()),
                                fmt::format("sweep {}", sweeps.size() + 1)));
    const auto same = [&](const Sweep& s) { return s.name == sweeps.back().name; };
    if (std::count_if(sweeps.begin(), sweeps.end(), same) > 1)
      table.faults().add(sweeps.back().where,
                         fmt::format("a second sweep is named {}; allowed: names that differ",
                                     scenes::quoted(sweeps.back().name)));
  }
  return sweeps;
}

std::map<std::string, double> read_values(Table& table, const std::string& key, const std::string& name) {
  std::map<std::string, double> values;
  const toml::table* given = table.table(key);
  if (!given) return values;
  Table inner(*given, name + "." + key, table.source(), table.faults());
  for (auto&& [quantity, node] : *given)
    values[std::string(quantity.str())] = inner.number(std::string(quantity.str()), 0.0, -1e300, 1e300);
  return values;
}

void check_reference(const Reference& r, Table& table) {
  using Kind = Reference::Kind;
  if (r.kind == Kind::richardson) {
    if (r.refine.empty()) table.fault("refine", "is missing; needed: the key of the cell, such as mpm.cell");
    if (r.refinements.size() < 3) table.fault("values", "must hold three values of the cell or more");
    for (const double v : r.refinements)
      if (!(v > 0.0)) table.fault("values", "must be greater than 0");
  }
  if (r.kind == Kind::stated && r.source.empty())
    table.fault("source", "is missing; needed: where the stated values come from");
  if (r.kind == Kind::stated && r.values.empty())
    table.fault("stated", "is missing; needed: a value for each quantity");
}

Reference read_reference(Table table) {
  Reference r;
  r.where = table.where();
  const std::vector<std::pair<std::string, Reference::Kind>> kinds = {
      {"run", Reference::Kind::run},
      {"exact", Reference::Kind::exact},
      {"richardson", Reference::Kind::richardson},
      {"stated", Reference::Kind::stated}};
  const std::string kind = table.text("kind");
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == kind; });
  if (found != kinds.end())
    r.kind = found->second;
  else
    table.fault("kind",
                "names an " + unknown("kind of reference", kind, {"run", "exact", "richardson", "stated"}));
  r.solver = read_solver(table);
  const auto models = read_models(table);
  if (models.size() > 1) table.fault("model", "names several models; allowed: one");
  if (!models.empty()) r.model = models.front();
  r.settings = read_settings(table, "settings");
  r.twin = read_settings(table, "twin");
  r.refine = table.text("refine");
  if (!r.refine.empty()) is_scene_key(r.refine, table.where("refine"), table.faults());
  r.refinements = table.numbers("values");
  r.solution = table.text("solution");
  r.source = table.text("source");
  r.values = read_values(table, "stated", "reference");
  r.uncertainty = read_values(table, "uncertainty", "reference");
  table.refuse_others();
  check_reference(r, table);
  return r;
}

Cut read_cut(Table table, const std::string& name) {
  Cut cut;
  cut.name = name;
  cut.meaning = table.text("meaning");
  cut.sweeps = table.texts("sweeps");
  cut.refinements = table.numbers("reference_values");
  if (const toml::table* only = table.table("only"))
    for_each_setting(*only, "", table, [&](const auto& path, const auto& node, const auto& where) {
      auto& kept = cut.only[path];
      if (const auto* array = node.as_array())
        for (const toml::node& item : *array) kept.push_back(value_text(item));
      if (kept.empty()) table.faults().add(where, fmt::format("{} must be an array of values", path));
    });
  table.refuse_others();
  return cut;
}

std::vector<Cut> read_cuts(Table& table) {
  std::vector<Cut> cuts;
  const toml::table* given = table.table("cuts");
  if (!given) return cuts;
  for (auto&& [name, node] : *given) {
    const std::string cut(name.str());
    if (const auto* inner = node.as_table())
      cuts.push_back(read_cut(Table(*inner, "cuts." + cut, table.source(), table.faults()), cut));
    else
      table.faults().add(table.place(name.source().begin), "a cut must be a table, not " + kind_of(node));
  }
  return cuts;
}

std::optional<LimitWish> read_limit(Table& outer) {
  const toml::table* given = outer.table("limit");
  if (!given) return std::nullopt;
  Table table(*given, "limit", outer.source(), outer.faults());
  LimitWish wish;
  wish.key = table.text("growing");
  wish.quantity = table.text("quantity");
  wish.compare_to = table.number("expected", 0.0, -1e300, 1e300);
  wish.compare_to_name = table.text("expected_is");
  if (wish.key.empty())
    table.fault("growing", "is missing; needed: the key whose infinite value is sought");
  else
    is_scene_key(wish.key, table.where("growing"), table.faults());
  table.refuse_others();
  return wish;
}

void check_quantities(const Study& study, Table& table) {
  std::vector<std::string> wanted = study.quantities;
  for (const std::string& quantity : wanted)
    if (const std::string wrong = complaint_about(quantity); !wrong.empty())
      table.fault("quantities", fmt::format("names {}", wrong));
  const auto known = [&](const std::string& q) {
    return std::find(wanted.begin(), wanted.end(), q) != wanted.end();
  };
  for (const auto* given : {&study.reference.values, &study.reference.uncertainty})
    for (const auto& [quantity, value] : *given)
      if (!known(quantity))
        table.fault("reference", fmt::format("gives {}, which the study does not measure; allowed: {}",
                                             scenes::quoted(quantity), joined(wanted)));
  if (study.limit && !known(study.limit->quantity))
    table.fault("limit", fmt::format("speaks of the quantity {}; allowed: {}",
                                     scenes::quoted(study.limit->quantity), joined(wanted)));
}

void check_cuts(const Study& study, Table& table) {
  std::vector<std::string> names;
  for (const Sweep& sweep : study.sweeps) names.push_back(sweep.name);
  for (const Cut& cut : study.cuts)
    for (const std::string& sweep : cut.sweeps)
      if (std::find(names.begin(), names.end(), sweep) == names.end())
        table.fault("cuts", fmt::format("{} names an {}", cut.name, unknown("sweep", sweep, names)));
}

void read_study(Study& study, Table& table) {
  study.title = table.text("title", study.name);
  const std::string purpose = table.text("purpose", "trade");
  if (purpose == "map")
    study.purpose = Purpose::map;
  else if (purpose != "trade")
    table.fault("purpose", "names an " + unknown("purpose", purpose, {"trade", "map"}));
  study.scene = table.text("scene");
  if (study.scene.empty()) table.fault("scene", "is missing; needed: the scene that is computed");
  study.longest_run = table.number("longest_run", study.longest_run, 1.0, 1e9);
  study.settings = read_settings(table, "settings");
  study.quantities = table.texts("quantities");
  if (study.quantities.empty() && study.purpose == Purpose::trade)
    table.fault("quantities", "is missing; needed: what is measured, such as " + joined(quantity_examples()));
  study.sweeps = read_sweeps(table);
  if (const toml::table* reference = table.table("reference"))
    study.reference = read_reference(Table(*reference, "reference", table.source(), table.faults()));
  study.cuts = read_cuts(table);
  study.limit = read_limit(table);
  table.refuse_others();
  check_quantities(study, table);
  check_cuts(study, table);
}

fs::path studies_folder() { return scenes::scenes_folder() / "studies"; }

fs::path find_study(const std::string& study) {
  if (study.ends_with(".toml") || study.find('/') != std::string::npos) return study;
  const fs::path path = studies_folder() / (study + ".toml");
  std::error_code error;
  if (fs::exists(path, error)) return path;
  throw SceneError(unknown("study", study, list_studies()) + ", or the path of a .toml file");
}

}  // namespace

std::vector<std::string> list_studies() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(studies_folder(), error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Study parse_study(const std::string& text, const fs::path& path) {
  Study study;
  study.name = path.stem().string();
  study.path = path;
  study.source = text;
  const std::string source = path.string();
  Faults faults;
  const toml::table document = parsed_toml(text, source, "a study");
  Table table(document, "", source, faults);
  read_study(study, table);
  faults.raise();
  return study;
}

Study load_study(const std::string& study) {
  const fs::path path = find_study(study);
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw SceneError(scenes::escaped(path.string()) +
                     ": no such file; allowed: a study's TOML file, or one of " + joined(list_studies()));
  return parse_study(text_of(path), path);
}

}  // namespace flowrest::studies
