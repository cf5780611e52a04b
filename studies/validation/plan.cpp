#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runs/run_directory.h"
#include "scenes/pieces.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

/// What a run's folder is named after besides its settings, so that a run of another version never stands for
/// this one's.
std::string version() { return runs::version_in(runs::provenance()); }

/// Cells of the second resolution. Plates lie on grid lines, with a whole number of cells between them.
double coarse_cell(const scenes::Scene& scene, double cell, double coarsening) {
  const auto height = scenes::pieces_of(scene).whole_cells_over;
  return height ? *height / std::max(1.0, std::round(*height / (cell * coarsening))) : cell * coarsening;
}

Wanted wanted_run(const std::string& name, const scenes::Scene& scene, Solver solver, scenes::Model model,
                  bool coarse, const Options& options) {
  Wanted wanted{solver, model, coarse};
  const bool mpm = solver == Solver::mpm;
  wanted.cell = mpm ? scene.mpm.cell : scene.foam.cell;
  if (coarse) wanted.cell = coarse_cell(scene, wanted.cell, options.coarsening);
  scenes::Overrides overrides;
  // Runs share the cores between them; one thread each wastes none. What the user sets comes last and counts.
  overrides.set = {"mpm.threads=1"};
  overrides.set.insert(overrides.set.end(), options.set.begin(), options.set.end());
  overrides.model = model;
  if (coarse) {
    overrides.set.push_back(fmt::format("{}.cell={:.17g}", to_string(solver), wanted.cell));
    // Its history is read, its states are not.
    if (!scenes::gives_key(options.set, "output.snapshot_interval"))
      overrides.set.push_back(fmt::format("output.snapshot_interval={:.17g}", scene.time.end));
  }
  Point& point = wanted.point;
  point.solver = solver;
  point.scene = scenes::load_scene(name, overrides);
  point.label = fmt::format("{} {} {} {:.4g} mm", scene.name, to_string(solver), scenes::to_string(model),
                            1e3 * wanted.cell);
  const std::string prefix = fmt::format("{}-{}-{}-{:.4g}mm", scene.name, to_string(solver),
                                         scenes::to_string(model), 1e3 * wanted.cell);
  const std::string resolved = to_string(solver) + scenes::resolved_toml(*point.scene);
  point.id = fmt::format("{}-{}", prefix, name_mark(resolved + version()));
  if (!options.any_version) return wanted;
  // The same run of another version, where it has come to its end.
  std::error_code error;
  const Folder folder{std::filesystem::absolute(options.folder)};
  for (const auto& entry : std::filesystem::directory_iterator(folder.root / "runs", error)) {
    Point other = point;
    other.id = entry.path().filename().string();
    if (!other.id.starts_with(prefix + "-") || outcome_of(folder, point).ending == Ending::finished) continue;
    if (outcome_of(folder, other).ending == Ending::finished) point.id = other.id;
  }
  return wanted;
}

}  // namespace

std::string Wanted::label() const {
  return fmt::format("{} {}", solver == Solver::mpm ? "MPM" : "OpenFOAM", scenes::to_string(model));
}

std::vector<SceneWanted> plan(const Options& options) {
  const auto published = read_published();
  std::vector<std::string> names = options.scenes;
  if (names.empty())
    for (const PaperItem& item : read_paper_items())
      if (std::find(names.begin(), names.end(), item.scene) == names.end()) names.push_back(item.scene);
  std::vector<SceneWanted> all;
  for (const std::string& name : names) {
    SceneWanted wanted{
        name, scenes::load_scene(name, scenes::overrides_of_command_line(options.set)), {}, {}, ""};
    scenes::check_model_has_effect(wanted.scene, options.set);
    for (const Published& p : published)
      if (p.scene == wanted.scene.name) wanted.published.push_back(p);
    if (wanted.published.empty()) wanted.published = exact_numbers(wanted.scene.name, wanted.scene);
    const auto add = [&](Solver solver, const std::vector<scenes::Model>& models) {
      if (options.solver && *options.solver != solver) return;
      for (const auto model : models) {
        if (options.model && *options.model != model) continue;
#ifndef FLOWREST_HAS_FOAM
        if (solver == Solver::foam) {
          wanted.left_out = "Runs in OpenFOAM are left out: this build of flowrest has none.";
          continue;
        }
#endif
        for (const bool coarse : {false, true})
          wanted.runs.push_back(wanted_run(name, wanted.scene, solver, model, coarse, options));
      }
    };
    add(Solver::mpm, wanted.scene.runs.mpm);
    add(Solver::foam, wanted.scene.runs.foam);
    all.push_back(std::move(wanted));
  }
  if (std::all_of(all.begin(), all.end(), [](const SceneWanted& s) { return s.runs.empty(); }))
    throw scenes::SceneError(
        "no scene names a run of this solver and law; allowed: what `runs` of the scenes names");
  return all;
}

std::vector<Point> points_of(const std::vector<SceneWanted>& all) {
  std::vector<Point> points;
  for (const SceneWanted& scene : all)
    for (const Wanted& run : scene.runs) points.push_back(run.point);
  return points;
}

}  // namespace flowrest::studies::validation
