#include "compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/measures/run_measures.h"
#include "compare/pairs.h"
#include "compare/run_view.h"
#include "compare/square.h"
#include "runs/gauges.h"
#include "scenes/text.h"

namespace flowrest::compare {

namespace fs = std::filesystem;
using runs::RunError;

namespace {

std::vector<double> common_grid(const Comparison& comparison) {
  constexpr int points = 200;
  double extent = 0.0;
  for (const RunView& view : comparison.runs) {
    for (const auto& profile : view.run.profiles)
      for (std::size_t i = 0; i < profile.coordinate.size(); ++i)
        if (!comparison.radial || profile.value[i] > 0.01 * comparison.grain.length)
          extent = std::max(extent, std::abs(profile.coordinate[i]));
    if (const auto height = setting(view, "/geometry/height"); !comparison.radial && height)
      extent = std::max(extent, 0.5 * *height);
  }
  std::vector<double> grid;
  if (!(extent > 0.0)) return grid;
  if (!comparison.apparatus->has_depth()) {
    constexpr int half = points / 2;
    for (int i = -half; i <= half; ++i) grid.push_back(extent * i / half);
  } else {
    const double step = round_step(1.05 * extent / points);
    for (int i = 0; i * step <= 1.05 * extent; ++i) grid.push_back(i * step);
  }
  return grid;
}

/// Denser early, round, and with the end.
std::vector<double> frame_times(double end) {
  std::vector<double> frames = {0.0};
  const double step = round_step(end / 240.0);
  for (int i = 1; i * step < end * (1.0 - 1e-9); ++i) {
    const double t = i * step;
    if (t <= end / 24.0 || (i % 2 == 0 && t <= end / 4.0) || i % 4 == 0) frames.push_back(t);
  }
  frames.push_back(end);
  return frames;
}

std::vector<double> pair_times(double end, double unit) {
  std::vector<double> times;
  for (const double t : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 40.0, 60.0, 120.0, 300.0})
    if (t * unit < end * (1.0 - 1e-9)) times.push_back(t * unit);
  times.push_back(end);
  return times;
}

/// The one apparatus that all the runs are of.
const ApparatusReport& common_apparatus(const std::vector<runs::Run>& runs) {
  const auto kind_of = [](const runs::Run& run) { return run.info["kind"].get<std::string>(); };
  const std::string kind = kind_of(runs.front());
  for (const runs::Run& run : runs)
    if (kind_of(run) != kind)
      throw RunError(fmt::format("{}: a {} cannot be compared with a {} ({})", run.directory.string(),
                                 kind_of(run), kind, runs.front().directory.string()));
  if (const auto* known = scenes::apparatus_named(kind)) return report_of(*known);
  throw RunError(fmt::format("{}: kind '{}' is unknown; allowed: {}", runs.front().directory.string(), kind,
                             scenes::joined(scenes::apparatus_names())));
}

/// MPM before OpenFOAM before others, exact solutions last; within a solver the law that stops first; else as
/// named.
void sort_runs(std::vector<RunView>& views) {
  const auto rank = [](const RunView& v) {
    const int solver = v.exact ? 3 : v.solver == "mpm" ? 0 : v.solver == "foam" ? 1 : 2;
    return std::pair(solver, laws::order_of(v.model));
  };
  std::stable_sort(views.begin(), views.end(),
                   [&](const RunView& a, const RunView& b) { return rank(a) < rank(b); });
}

/// The time to which the runs are compared: solvers pass their end time by up to a step, so it is the one
/// that all who came to the longest have reached.
double common_end(const std::vector<RunView>& views) {
  double longest = 0.0;
  for (const RunView& view : views) {
    if (view.exact) continue;
    if (!view.gauge.empty()) longest = std::max(longest, view.gauge.end());
    if (!view.run.profiles.empty()) longest = std::max(longest, view.run.profiles.back().time);
  }
  double end = longest;
  for (const RunView& view : views)
    if (!view.exact && !view.held && !view.gauge.empty() && view.gauge.end() > 0.99 * longest)
      end = std::min(end, view.gauge.end());
  if (end > 0.0) return end;
  for (const RunView& view : views)
    if (!view.gauge.empty()) end = std::max(end, view.gauge.end());
  return end;
}

/// The arbitrary stops at which the gauge is read.
std::vector<double> stop_times(const Thresholds& thresholds, double end) {
  std::vector<double> stops;
  const double step = round_step(thresholds.stop_to / 120.0);
  for (int i = 0; thresholds.stop_from + i * step <= std::min(thresholds.stop_to, end) * (1.0 + 1e-9); ++i)
    stops.push_back(thresholds.stop_from + i * step);
  return stops;
}

}  // namespace

Thresholds thresholds_of(const scenes::Gauges& gauges, const Options& options) {
  const scenes::Gauges standard;
  Thresholds t;
  const double time = gauges.rate_window / standard.rate_window;
  t.time_unit = round_step(time);
  t.rest_shear_rate = options.rest_shear_rate.value_or(gauges.rest_shear_rate);
  t.rest_spread_rate = options.rest_spread_rate.value_or(gauges.rest_rate);
  t.still_speed = gauges.still_speed;
  t.rate_window = gauges.rate_window;
  t.residual_window = options.residual_window.value_or(t.residual_window * time);
  for (double& at : t.overshoot_times) at *= t.time_unit;
  t.stop_from *= t.time_unit;
  t.stop_to *= t.time_unit;
  return t;
}

std::vector<fs::path> find_runs(const std::vector<fs::path>& named) {
  std::vector<fs::path> found;
  const auto search = [&](auto&& self, const fs::path& folder, int depth) -> void {
    if (fs::exists(folder / "run.json")) {
      found.push_back(folder);
      return;
    }
    if (depth == 0) return;
    std::vector<fs::path> children;
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_directory()) children.push_back(entry.path());
    std::sort(children.begin(), children.end());
    for (const auto& child : children) self(self, child, depth - 1);
  };
  for (const fs::path& folder : named) {
    if (!fs::is_directory(folder))
      throw RunError(
          fmt::format("{}: there is no such folder; a run directory is expected", folder.string()));
    const std::size_t before = found.size();
    search(search, folder, 2);
    if (found.size() == before)
      throw RunError(fmt::format(
          "{}: there is no run.json in it or in its folders; a run directory is expected", folder.string()));
  }
  std::set<fs::path> seen;
  std::erase_if(found, [&](const fs::path& path) { return !seen.insert(fs::weakly_canonical(path)).second; });
  return found;
}

Comparison compare_runs(const std::vector<fs::path>& directories, const Options& options) {
  if (directories.empty()) throw RunError("no run to compare; name at least one run directory");
  std::vector<runs::Run> read;
  for (const fs::path& directory : directories) read.push_back(runs::read_run(directory));

  Comparison comparison;
  comparison.apparatus = &common_apparatus(read);
  comparison.gauges = runs::gauges_of(read.front());
  comparison.thresholds = thresholds_of(comparison.gauges, options);
  comparison.grain = words::grain_of(comparison.gauges, comparison.apparatus->judged_by());
  for (runs::Run& run : read) comparison.runs.push_back(view_of(std::move(run), *comparison.apparatus));
  make_labels_unique(comparison.runs);
  sort_runs(comparison.runs);
  comparison.title = comparison.runs.front().run.info["title"];
  comparison.radial = radial(comparison.runs.front().run, *comparison.apparatus);
  check_same_scene(comparison);
  note_gauges(comparison);

  for (const RunView& view : comparison.runs)
    if (const auto cell = setting(view, "/" + view.solver + "/cell"))
      comparison.cell = std::max(comparison.cell, *cell);
  comparison.end = common_end(comparison.runs);
  comparison.grid = common_grid(comparison);
  comparison.frames = frame_times(comparison.end);
  comparison.times = pair_times(comparison.end, comparison.thresholds.time_unit);
  comparison.stops = stop_times(comparison.thresholds, comparison.end);

  for (RunView& view : comparison.runs) measure(view, comparison);
  comparison.apparatus->measure_approach(comparison);
  measure_overshoot(comparison);
  measure_uncertainty(comparison);
  compare_pairs(comparison);
  fill_square(comparison);
  note_scenes(comparison);
  note_starts(comparison);
  note_missing(comparison);
  note_walls(comparison);
  describe(comparison);
  return comparison;
}

}  // namespace flowrest::compare
