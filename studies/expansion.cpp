#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "mpm/cost.h"
#include "scenes/text.h"
#include "studies/study.h"
#ifdef FLOWREST_HAS_FOAM
#include "foamCases/cost.h"
#endif

namespace flowrest::studies {

namespace {

using scenes::SceneError;

/// More runs than anybody will wait for.
constexpr std::size_t most_points = 20000;

std::string without_quotes(const std::string& toml) {
  const bool quoted = toml.size() >= 2 && toml.front() == '"' && toml.back() == '"';
  return quoted ? toml.substr(1, toml.size() - 2) : toml;
}

/// Text as a part of a file's name.
std::string slug(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.';
    if (plain)
      result += c;
    else if (!result.empty() && result.back() != '-')
      result += '-';
  }
  while (!result.empty() && (result.back() == '-' || result.back() == '.')) result.pop_back();
  return result;
}

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

std::string id_of(const Point& point) {
  constexpr std::size_t longest = 72;
  std::string name = to_string(point.solver);
  for (const Setting& s : point.varied)
    name += fmt::format("-{}", slug(fmt::format("{}-{}", last_part(s.key), without_quotes(s.value))));
  name = name.substr(0, longest);
  std::string resolved = to_string(point.solver);
  if (point.scene) {
    resolved += scenes::resolved_toml(*point.scene);
  } else {
    for (const Setting& s : point.varied) resolved += s.text() + ";";
    resolved += point.refused;
  }
  return fmt::format("{}-{}", name, name_mark(resolved));
}

std::string label_of(const Point& point) {
  std::string label = point.sweep;
  for (const Setting& s : point.varied)
    label += fmt::format(", {} {}", last_part(s.key), without_quotes(s.value));
  return label;
}

/// A later setting of the same key takes the place of an earlier one.
void lay(Settings& settings, const Settings& more) {
  for (const Setting& s : more) {
    std::erase_if(settings, [&](const Setting& earlier) { return earlier.key == s.key; });
    settings.push_back(s);
  }
}

/// The scene named from the study's folder, or by name.
std::string scene_of(const Study& study) {
  const bool is_path = study.scene.ends_with(".toml") || study.scene.find('/') != std::string::npos;
  if (!is_path || std::filesystem::path(study.scene).is_absolute()) return study.scene;
  return (study.path.parent_path() / study.scene).lexically_normal().string();
}

std::string place_of(const Point& point, const scenes::Location& otherwise) {
  return point.varied.empty() || point.varied.back().where.line == 0 ? otherwise.text()
                                                                     : point.varied.back().where.text();
}

/// The point with its scene resolved, or why there is none.
Point resolved(const Study& study, Point point, Settings settings) {
  scenes::Overrides overrides;
  // Runs of a study share the cores between them; one thread each wastes none.
  Settings all = {{"mpm.threads", "1", {}}};
  lay(all, study.settings);
  lay(all, settings);
  for (const Setting& s : all) overrides.set.push_back(s.text());
  try {
    point.scene = scenes::load_scene(scene_of(study), overrides);
  } catch (const SceneError& error) {
    point.refused = error.what();
  }
  point.id = id_of(point);
  point.label = label_of(point);
  return point;
}

bool is_kept(const Cut* cut, const Settings& settings) {
  if (!cut) return true;
  return std::all_of(settings.begin(), settings.end(), [&](const Setting& s) {
    const auto only = cut->only.find(s.key);
    return only == cut->only.end() ||
           std::find(only->second.begin(), only->second.end(), s.value) != only->second.end();
  });
}

/// Every combination of an alternative of each axis.
void combine(const std::vector<Axis>& axes, std::size_t depth, Settings& so_far, const Cut* cut,
             std::vector<Settings>& combinations) {
  if (combinations.size() > most_points) return;
  if (depth == axes.size()) {
    if (is_kept(cut, so_far)) combinations.push_back(so_far);
    return;
  }
  for (const Settings& alternative : axes[depth].alternatives) {
    Settings next = so_far;
    lay(next, alternative);
    combine(axes, depth + 1, next, cut, combinations);
  }
}

std::vector<Axis> axes_with_models(const Sweep& sweep) {
  std::vector<Axis> axes;
  if (!sweep.models.empty()) {
    Axis models{"material.model", {}};
    for (const auto model : sweep.models)
      models.alternatives.push_back(
          {{"material.model", scenes::toml_string(scenes::to_string(model)), sweep.where}});
    axes.push_back(std::move(models));
  }
  axes.insert(axes.end(), sweep.axes.begin(), sweep.axes.end());
  return axes;
}

/// Runs that resolve to the same share the folder of the first of them.
void share_folders(std::vector<Point>& points) {
  std::map<std::string, std::string> first;
  for (Point& point : points)
    point.id = first.emplace(point.id.substr(point.id.rfind('-')), point.id).first->second;
}

void add_sweep(const Study& study, const Sweep& sweep, const Cut* cut, std::vector<Point>& points) {
  std::set<std::string> made;
  std::vector<Settings> combinations;
  Settings none;
  combine(axes_with_models(sweep), 0, none, cut, combinations);
  if (points.size() + combinations.size() > most_points)
    throw SceneError(fmt::format("{}: the sweep {} makes the study larger than {} runs", sweep.where.text(),
                                 scenes::quoted(sweep.name), most_points));
  for (const Settings& varied : combinations) {
    Point point;
    point.sweep = sweep.name;
    point.solver = sweep.solver;
    point.varied = varied;
    Settings settings = sweep.settings;
    lay(settings, varied);
    point = resolved(study, std::move(point), settings);
    if (!point.refused.empty() && study.purpose == Purpose::trade)
      throw SceneError(fmt::format("{}: the run {} cannot be made:\n{}", place_of(point, sweep.where),
                                   scenes::quoted(point.label), point.refused));
    if (made.insert(point.id).second) points.push_back(std::move(point));
  }
}

Point reference_point(const Study& study, Point::Role role, const Settings& varied) {
  const Reference& r = study.reference;
  Point point;
  point.role = role;
  point.sweep = role == Point::Role::reference ? "reference" : "twin of the reference";
  point.solver = r.solver;
  point.varied = varied;
  Settings settings = r.settings;
  if (r.model) lay(settings, {{"material.model", scenes::toml_string(scenes::to_string(*r.model)), r.where}});
  lay(settings, varied);
  point = resolved(study, std::move(point), settings);
  if (!point.refused.empty())
    throw SceneError(fmt::format("{}: the reference cannot be computed:\n{}", r.where.text(), point.refused));
  return point;
}

void add_references(const Study& study, const Cut* cut, std::vector<Point>& points) {
  const Reference& r = study.reference;
  if (r.kind == Reference::Kind::run) {
    points.push_back(reference_point(study, Point::Role::reference, {}));
    if (!r.twin.empty()) points.push_back(reference_point(study, Point::Role::reference_twin, r.twin));
  }
  if (r.kind != Reference::Kind::richardson) return;
  const auto& refinements = cut && !cut->refinements.empty() ? cut->refinements : r.refinements;
  for (const double value : refinements)
    points.push_back(
        reference_point(study, Point::Role::reference, {{r.refine, scenes::exact_text(value), r.where}}));
}

const Cut* find_cut(const Study& study, const std::string& name) {
  if (name.empty()) return nullptr;
  std::vector<std::string> names;
  for (const Cut& cut : study.cuts) {
    if (cut.name == name) return &cut;
    names.push_back(cut.name);
  }
  const std::string near = scenes::nearest(name, names);
  throw SceneError(fmt::format("{}: has no cut {}{}; allowed: {}", study.path.string(), scenes::quoted(name),
                               near.empty() ? "" : ", nearest is " + near,
                               names.empty() ? "none, the study is made as a whole" : scenes::joined(names)));
}

/// One exact solution stands for every run: what it depends on may not vary.
void check_exact(const Study& study) {
  if (study.reference.kind != Reference::Kind::exact) return;
  const auto matters = [&](const std::string& key) {
    return key == "material.yield_stress" || key == "material.density" || key.starts_with("forces.") ||
           (key.starts_with("geometry.") && key != "geometry.dimension") ||
           (key == "material.plastic_viscosity" && study.reference.solution == "steady");
  };
  for (const Sweep& sweep : study.sweeps)
    for (const Axis& axis : sweep.axes)
      for (const Settings& alternative : axis.alternatives)
        for (const Setting& s : alternative)
          if (matters(s.key))
            throw SceneError(
                fmt::format("{}: {} varies, but the exact reference is one for all runs; allowed: "
                            "keys that it does not depend on",
                            s.where.text(), s.key));
}

}  // namespace

std::string name_mark(const std::string& text) {
  // FNV-1a, 64 bits.
  std::uint64_t mark = 14695981039346656037ull;
  for (const char c : text) mark = (mark ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return fmt::format("{:012x}", mark & 0xffffffffffffull);
}

std::string to_string(Solver solver) { return solver == Solver::mpm ? "mpm" : "foam"; }

std::string to_string(Purpose purpose) { return purpose == Purpose::trade ? "trade" : "map"; }

std::string to_string(Reference::Kind kind) {
  switch (kind) {
    case Reference::Kind::none:
      return "none";
    case Reference::Kind::run:
      return "run";
    case Reference::Kind::exact:
      return "exact";
    case Reference::Kind::richardson:
      return "richardson";
    case Reference::Kind::stated:
      return "stated";
  }
  throw std::logic_error("a reference without a name");
}

scenes::Cost expected_cost(const Point& point) {
  if (point.solver == Solver::mpm) return mpm::cost(*point.scene);
#ifdef FLOWREST_HAS_FOAM
  return foam::estimate(*point.scene).cost;
#else
  return {};  // it is not made here
#endif
}

std::string to_string(Point::Role role) {
  switch (role) {
    case Point::Role::point:
      return "point";
    case Point::Role::reference:
      return "reference";
    case Point::Role::reference_twin:
      return "reference-twin";
  }
  throw std::logic_error("a role without a name");
}

std::vector<Point> expand(const Study& study, const std::string& name) {
  const Cut* cut = find_cut(study, name);
  check_exact(study);
  std::vector<Point> points;
  add_references(study, cut, points);
  const std::size_t references = points.size();
  for (const Sweep& sweep : study.sweeps) {
    const bool wanted = !cut || cut->sweeps.empty() ||
                        std::find(cut->sweeps.begin(), cut->sweeps.end(), sweep.name) != cut->sweeps.end();
    if (wanted) add_sweep(study, sweep, cut, points);
  }
  if (points.size() == references)
    throw SceneError(fmt::format("{}: nothing is left of the study{}", study.path.string(),
                                 cut ? " in the cut " + cut->name : ""));
  share_folders(points);
  return points;
}

}  // namespace flowrest::studies
