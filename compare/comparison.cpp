#include "compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/exact/creep.h"
#include "compare/exact/solutions.h"
#include "runs/depth.h"

namespace flowrest::compare {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using runs::RunError;

namespace {

constexpr double spread_threshold = 0.003;  // m

std::optional<double> number(const Json& json, const char* pointer) {
  const Json::json_pointer at(pointer);
  if (!json.contains(at) || !json.at(at).is_number()) return std::nullopt;
  return json.at(at).get<double>();
}

std::string word(const Json& json, const char* pointer) {
  const Json::json_pointer at(pointer);
  return json.contains(at) && json.at(at).is_string() ? json.at(at).get<std::string>() : "";
}

std::optional<double> setting(const RunView& view, const std::string& key) {
  return number(view.run.info, ("/settings" + key).c_str());
}

/// (from time, force) in ascending time; empty where the run does not say.
std::vector<std::pair<double, double>> body_force(const RunView& view) {
  std::vector<std::pair<double, double>> stages;
  const Json::json_pointer at("/settings/forces/body_force");
  if (!view.run.info.contains(at)) return stages;
  for (const Json& stage : view.run.info.at(at))
    if (stage.is_array() && stage.size() == 2 && stage[0].is_number() && stage[1].is_number())
      stages.emplace_back(stage[0].get<double>(), stage[1].get<double>());
  return stages;
}

/// A history column as a series, without samples that are not numbers.
Series column(const runs::Run& run, const std::string& name, double scale = 1.0) {
  Series series;
  if (!run.history.has(name)) return series;
  const auto& time = run.history.at("time_s");
  const auto& value = run.history.at(name);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(value[i]) || (!series.empty() && time[i] <= series.end())) continue;
    series.time.push_back(time[i]);
    series.value.push_back(scale * value[i]);
  }
  return series;
}

/// The scene's gauge: from the history, or made of the profiles where the history lacks it.
Series gauge_of(const runs::Run& run, scenes::Kind kind) {
  Series series =
      kind == scenes::Kind::slump ? column(run, "spread_mm", 1e-3) : column(run, "plug_velocity_m_s");
  if (!series.empty()) return series;
  for (const auto& profile : run.profiles) {
    series.time.push_back(profile.time);
    series.value.push_back(kind == scenes::Kind::slump
                               ? runs::spread(profile.coordinate, profile.value, spread_threshold)
                               : *std::max_element(profile.value.begin(), profile.value.end()));
  }
  return series;
}

/// Duct profiles are compared about the mid-plane; solvers may count y from the lower plate.
void centre_duct_profiles(runs::Run& run) {
  const auto height = number(run.info, "/settings/geometry/height");
  for (auto& profile : run.profiles) {
    if (!height || profile.coordinate.empty() || profile.coordinate.back() <= 0.51 * *height) continue;
    for (double& y : profile.coordinate) y -= 0.5 * *height;
  }
}

std::vector<double> on_grid(const runs::Profile& profile, const std::vector<double>& grid, bool radial) {
  std::vector<double> values;
  values.reserve(grid.size());
  const auto& x = profile.coordinate;
  for (const double g : grid) {
    double value = 0.0;
    if (x.empty() || g > x.back()) {
      value = 0.0;
    } else if (g >= x.front()) {
      value = interpolate(x, profile.value, g);
    } else if (radial && x.size() > 1) {
      // Flat on the axis: the parabola in r^2 through the innermost two points.
      value = profile.value[0] +
              (profile.value[0] - profile.value[1]) * (x[0] * x[0] - g * g) / (x[1] * x[1] - x[0] * x[0]);
    } else {
      value = radial ? profile.value[0] : 0.0;
    }
    values.push_back(value);
  }
  return values;
}

/// The regularised fluid a run computed, where it is one and says enough.
std::optional<exact::RegularisedFluid> regularised_fluid(const RunView& view) {
  const auto yield_stress = setting(view, "/material/yield_stress");
  const auto viscosity = setting(view, "/material/plastic_viscosity");
  auto time = setting(view, "/material/regularisation_time");
  exact::RegularisedFluid fluid;
  if (view.model == "bi-viscous") {
    fluid.law = exact::RegularisedFluid::Law::bi_viscous;
    if (const auto rate = setting(view, "/material/critical_shear_rate"); rate && *rate > 0.0)
      time = 1.0 / *rate;
  } else if (view.model != "papanastasiou") {
    return std::nullopt;
  }
  if (!yield_stress || !viscosity || !time) return std::nullopt;
  fluid.yield_stress = *yield_stress;
  fluid.plastic_viscosity = *viscosity;
  fluid.regularisation_time = *time;
  return fluid;
}

std::optional<double> predicted_creep(const RunView& view, scenes::Kind kind) {
  if (!view.fluid) return 0.0;
  const auto fluid = regularised_fluid(view);
  if (!fluid) return std::nullopt;
  if (kind == scenes::Kind::duct) {
    const auto height = setting(view, "/geometry/height");
    const auto stages = body_force(view);
    if (!height || stages.empty() || stages.back().second * *height > 2.0 * fluid->yield_stress)
      return std::nullopt;
    return exact::duct_creep(*fluid, *height, stages.back().second);
  }
  const auto density = setting(view, "/material/density");
  const auto gravity = setting(view, "/forces/gravity");
  const auto top = setting(view, "/geometry/cone_radius_top");
  const auto bottom = setting(view, "/geometry/cone_radius_bottom");
  const auto height = setting(view, "/geometry/cone_height");
  if (!density || !gravity || !top || !bottom || !height || !(fluid->yield_stress > 0.0) || !(*gravity > 0.0))
    return std::nullopt;
  if (word(view.run.info, "/settings/geometry/dimension") == "plane") return std::nullopt;
  const scenes::SlumpGeometry cone{*height, *top, *bottom, 0.0, 0.0};
  const auto slump = exact::leading_order_slump({*density, fluid->yield_stress, fluid->plastic_viscosity},
                                                *gravity, cone.volume());
  return exact::spread_creep(*fluid, slump.radius, slump.depth(0.5 * slump.radius),
                             view.gauge.empty() ? slump.radius : 0.5 * view.gauge.value.back());
}

std::optional<double> drift(const Series& series) {
  if (series.empty() || series.value.front() == 0.0) return std::nullopt;
  return series.value.back() / series.value.front() - 1.0;
}

Cause cause_of(const RunView& view, const Options& options, double rest_speed) {
  const Measures& m = view.measures;
  // A record that was cut off may have been cut off while it still flowed.
  if (!m.residual || !view.trouble.empty()) return Cause::unknown;
  const double speed = std::abs(*m.residual);
  if (!view.fluid)
    return speed <= rest_speed ? Cause::at_rest : view.held ? Cause::within_bound : Cause::approaching_rest;
  const bool explained = m.predicted_creep && speed <= options.creep_factor * *m.predicted_creep;
  if (explained) return view.noisy ? Cause::creep_or_noise : Cause::creep;
  if (view.noisy) return Cause::noise;
  return m.predicted_creep ? Cause::unexplained : Cause::unknown;
}

void measure(RunView& view, const Comparison& comparison) {
  const Options& options = comparison.options;
  const bool slump = comparison.kind == scenes::Kind::slump;
  Measures& m = view.measures;
  const Json& info = view.run.info;
  if (!view.gauge.empty()) {
    m.end = view.gauge.end();
    m.gauge_end = view.gauge.value.back();
  }
  if (!view.run.profiles.empty()) {
    const auto& last = view.run.profiles.back();
    if (slump) {
      m.spread_1_5mm = runs::spread(last.coordinate, last.value, 0.0015);
      m.spread_6mm = runs::spread(last.coordinate, last.value, 0.006);
      m.centre_depth = runs::centre_depth(last.coordinate, last.value);
    }
    m.end = std::max(m.end.value_or(last.time), last.time);
  }
  if (view.exact) {
    m.predicted_creep = 0.0;
    m.residual = 0.0;
    m.cause = Cause::at_rest;
    if (!slump) m.stopping_bound = number(info, "/stopping_time_bound_s");
    return;
  }
  m.rest_declared = number(info, "/rest_time_s");
  if (const auto growth = number(info, "/growth_to_come"); slump && !view.fluid && growth && m.gauge_end)
    m.growth_to_come = *growth * *m.gauge_end;
  m.cpu = number(info, "/cpu_s");
  m.wall = number(info, "/wall_s");
  if (m.cpu && m.end && *m.end > 0.0) m.cpu_per_simulated_second = *m.cpu / *m.end;
  m.volume_drift = drift(column(view.run, "volume_m3"));
  m.mass_drift = drift(column(view.run, "mass_kg"));
  m.rest_by_shear_rate = settles_below(view.shear_rate, options.rest_shear_rate);
  m.predicted_creep = predicted_creep(view, comparison.kind);
  if (view.gauge.empty()) return;
  const double end = view.gauge.end();
  const auto last = trend(view.gauge, end - options.residual_window, end);
  if (last) m.residual_scatter = last->scatter;
  if (slump) {
    const Series rate = rate_of_change(view.gauge, options.rate_window);
    m.rest_by_spread_rate = settles_below(rate, options.rest_spread_rate);
    // A cone takes a moment to start: rest before it has moved is not rest.
    if (m.rest_by_spread_rate && *m.rest_by_spread_rate <= view.gauge.time.front())
      m.rest_by_spread_rate.reset();
    if (last) m.residual = last->slope;
    m.cause = cause_of(view, options, options.still_speed);
  } else {
    const double largest = *std::max_element(view.gauge.value.begin(), view.gauge.value.end());
    const double threshold = options.rest_velocity_fraction * largest;
    double step = 0.0;
    for (const auto& [from, force] : body_force(view))
      if (from < end) step = from;
    if (const auto settled = settles_below(view.gauge, threshold);
        settled && *settled >= step && largest > 0.0)
      m.stop_after_step = *settled - step;
    Series window;
    for (std::size_t i = 0; i < view.gauge.time.size(); ++i)
      if (view.gauge.time[i] >= end - options.residual_window) window.value.push_back(view.gauge.value[i]);
    std::nth_element(window.value.begin(),
                     window.value.begin() + static_cast<std::ptrdiff_t>(window.value.size() / 2),
                     window.value.end());
    m.residual = window.value[window.value.size() / 2];
    m.cause = cause_of(view, options, threshold);
  }
  for (const double stop : comparison.stops) {
    const auto value = view.gauge_at(stop);
    if (!value) continue;
    m.stop_lowest = std::min(m.stop_lowest.value_or(*value), *value);
    m.stop_highest = std::max(m.stop_highest.value_or(*value), *value);
  }
}

/// The run whose arrested spread overshoots are counted from: elasto-viscoplastic, the same solver if it can
/// be, one that came to rest if there is one.
const RunView* arrested_reference(const Comparison& comparison, const RunView& view) {
  const RunView* best = nullptr;
  int best_score = -1;
  for (const RunView& other : comparison.runs) {
    if (other.model != "elasto-viscoplastic" || other.exact || other.gauge.empty() || !other.trouble.empty())
      continue;
    const int score = 4 * (other.held || other.measures.cause == Cause::at_rest) +
                      2 * (other.solver == view.solver) + !other.noisy;
    if (score > best_score) {
      best = &other;
      best_score = score;
    }
  }
  return best;
}

void measure_overshoot(Comparison& comparison) {
  if (comparison.kind != scenes::Kind::slump) return;
  for (RunView& view : comparison.runs) {
    if (view.exact) continue;
    const RunView* reference = arrested_reference(comparison, view);
    if (!reference) continue;
    view.measures.overshoot_reference = reference->measures.gauge_end;
    view.measures.overshoot_reference_run = reference->label;
    for (const double time : comparison.options.overshoot_times)
      if (const auto value = view.gauge_at(time))
        view.measures.overshoot[time] = *value - *reference->measures.gauge_end;
  }
}

std::string pair_kind(const RunView& run, const RunView& reference) {
  if (reference.exact || run.exact) return "exact";
  const bool same_solver = run.solver == reference.solver, same_model = run.model == reference.model;
  if (same_solver) return same_model ? "settings" : "law";
  return same_model ? "solver" : "both";
}

void compare_pairs(Comparison& comparison) {
  const double floor = comparison.kind == scenes::Kind::slump ? 1e-5 : 0.0;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i)
    for (std::size_t j = 0; j < comparison.runs.size(); ++j) {
      const RunView& run = comparison.runs[i];
      const RunView& reference = comparison.runs[j];
      // Every computed run against every exact one, and each two computed runs once, the earlier as the
      // reference.
      if (run.exact || (!reference.exact && j >= i)) continue;
      Pair pair{i, j, pair_kind(run, reference), {}};
      std::vector<double> times = comparison.times;
      if (reference.exact && comparison.kind == scenes::Kind::duct) {
        times.clear();
        for (const auto& profile : reference.run.profiles) times.push_back(profile.time);
      }
      for (const double time : times) {
        const auto value = run.profile(time, comparison.grid);
        const auto other = reference.profile(time, comparison.grid);
        if (!value || !other) continue;
        Pair::At at{time, profile_error(comparison.grid, *value, *other, comparison.radial, floor),
                    std::nullopt};
        const auto gauge = run.gauge_at(time), other_gauge = reference.gauge_at(time);
        if (gauge && other_gauge) at.gauge_difference = *gauge - *other_gauge;
        pair.at.push_back(at);
      }
      if (!pair.at.empty()) comparison.pairs.push_back(std::move(pair));
    }
}

/// Tells runs of the same solver and model apart by the settings in which they differ, else by their folders.
void make_labels_unique(std::vector<RunView>& views) {
  const auto group_of = [&](const std::string& label) {
    std::vector<RunView*> group;
    for (RunView& view : views)
      if (view.label == label) group.push_back(&view);
    return group;
  };
  std::set<std::string> labels;
  for (const RunView& view : views) labels.insert(view.label);
  for (const std::string& label : labels) {
    const auto group = group_of(label);
    if (group.size() < 2) continue;
    const auto distinguish = [&](auto text) {
      std::set<std::string> texts;
      for (const RunView* view : group) texts.insert(text(*view));
      if (texts.size() < 2) return;
      for (RunView* view : group)
        if (const std::string part = text(*view); !part.empty()) view->label += ", " + part;
    };
    distinguish(
        [](const RunView& v) { return v.solver == "mpm" ? word(v.run.info, "/settings/mpm/scheme") : ""; });
    distinguish([](const RunView& v) { return word(v.run.info, "/settings/geometry/dimension"); });
    distinguish([](const RunView& v) {
      const auto m = setting(v, "/material/regularisation_time");
      return m && v.fluid ? fmt::format("m = {:g} s", *m) : std::string();
    });
    distinguish([](const RunView& v) {
      const auto cell = setting(v, "/" + v.solver + "/cell");
      return cell ? fmt::format("{:g} mm cells", 1000.0 * *cell) : std::string();
    });
    std::set<std::string> seen;
    for (RunView* view : group)
      if (!seen.insert(view->label).second) {
        view->label += ", " + view->run.directory.filename().string();
        for (int i = 2; !seen.insert(view->label).second; ++i) view->label += fmt::format(" ({})", i);
      }
  }
}

/// Notes the physical settings in which the runs differ: a comparison of two scenes is not one of two
/// solvers.
void check_same_scene(Comparison& comparison) {
  static const std::set<std::string> allowed = {
      "/material/model",     "/material/regularisation_time", "/material/critical_shear_rate",
      "/geometry/dimension", "/geometry/domain_radius",       "/geometry/domain_height"};
  std::set<std::string> different;
  const RunView& first = comparison.runs.front();
  for (const RunView& view : comparison.runs) {
    if (view.run.info["title"] != first.run.info["title"])
      comparison.notes.push_back(fmt::format("{} is a run of the scene \"{}\".", view.label,
                                             view.run.info["title"].get<std::string>()));
    for (const char* section : {"geometry", "material", "walls", "forces", "thixotropy"}) {
      const auto flat = [&](const RunView& v) {
        const Json::json_pointer at(std::string("/settings/") + section);
        return v.run.info.contains(at) ? v.run.info.at(at).flatten() : Json::object();
      };
      const Json a = flat(first), b = flat(view);
      for (const auto* json : {&a, &b})
        for (const auto& [key, value] : json->items()) {
          const std::string name = std::string("/") + section + key;
          if (allowed.contains(name)) continue;
          if (!a.contains(key) || !b.contains(key) || a[key] != b[key]) different.insert(name.substr(1));
        }
    }
  }
  if (different.empty()) return;
  std::string keys;
  for (std::string key : different) {
    std::replace(key.begin(), key.end(), '/', '.');
    keys += (keys.empty() ? "" : ", ") + key;
  }
  comparison.notes.push_back("These runs are not of the same physical scene: they differ in " + keys + ".");
}

std::string trouble_of(const RunView& view) {
  const std::string at =
      view.gauge.empty() ? "before the first record" : fmt::format("at {:.3g} s", view.gauge.end());
  const std::string reason = word(view.run.info, "/reason");
  const std::string why = reason.empty() ? "" : ": " + reason;
  switch (view.run.status()) {
    case runs::Status::running:
      return "still running, or killed, " + at + why;
    case runs::Status::interrupted:
      return "interrupted " + at + why;
    case runs::Status::failed:
      return "failed " + at + why;
    case runs::Status::at_rest:
    case runs::Status::end_time:
      return "";
  }
  return "";
}

RunView view_of(const fs::path& directory, scenes::Kind kind) {
  RunView view;
  view.run = runs::read_run(directory);
  const Json& info = view.run.info;
  view.label = view.run.label();
  view.solver = word(info, "/solver");
  view.model = word(info, "/model");
  view.exact = view.solver == "exact";
  view.held = view.run.status() == runs::Status::at_rest;
  view.fluid = view.model == "papanastasiou" || view.model == "bi-viscous" || view.model == "newtonian";
  if (const std::string verdict = word(info, "/verdict"); verdict.starts_with("noisy")) {
    view.noisy = true;
    const auto colon = verdict.find(": ");
    view.noise = colon == std::string::npos ? "no reason given" : verdict.substr(colon + 2);
  }
  if (kind == scenes::Kind::duct) centre_duct_profiles(view.run);
  view.gauge = gauge_of(view.run, kind);
  view.shear_rate = column(view.run, "shear_rate_p99_1_s");
  view.trouble = trouble_of(view);
  return view;
}

std::vector<double> common_grid(const Comparison& comparison) {
  constexpr int points = 200;
  double extent = 0.0;
  for (const RunView& view : comparison.runs) {
    for (const auto& profile : view.run.profiles)
      for (std::size_t i = 0; i < profile.coordinate.size(); ++i)
        if (!comparison.radial || profile.value[i] > 1e-5)
          extent = std::max(extent, std::abs(profile.coordinate[i]));
    if (const auto height = setting(view, "/geometry/height"); !comparison.radial && height)
      extent = std::max(extent, 0.5 * *height);
  }
  std::vector<double> grid;
  if (!(extent > 0.0)) return grid;
  if (comparison.kind == scenes::Kind::duct) {
    for (int i = -points / 2; i <= points / 2; ++i) grid.push_back(extent * i / (points / 2));
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

std::vector<double> pair_times(double end) {
  std::vector<double> times;
  for (const double t : {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 40.0, 60.0, 120.0, 300.0})
    if (t < end * (1.0 - 1e-9)) times.push_back(t);
  times.push_back(end);
  return times;
}

}  // namespace

std::string to_string(Cause cause) {
  switch (cause) {
    case Cause::at_rest:
      return "at rest";
    case Cause::within_bound:
      return "little: at rest by the run's own bound on what is to come";
    case Cause::approaching_rest:
      return "still approaching rest";
    case Cause::creep:
      return "creep of the regularisation";
    case Cause::creep_or_noise:
      return "creep of the regularisation or noise, not told apart";
    case Cause::noise:
      return "noise";
    case Cause::unexplained:
      return "unexplained: more than the regularisation's creep";
    case Cause::unknown:
      return "unknown";
  }
  return "";
}

std::optional<double> RunView::gauge_at(double time) const {
  if (gauge.empty()) return std::nullopt;
  if (!exact && (time < gauge.time.front() - 1e-9 || (!held && time > gauge.end() + 1e-9)))
    return std::nullopt;
  if (exact && run.info["kind"] == "duct") {
    // Each row is the steady state of the stage that ends there.
    const auto row = std::lower_bound(gauge.time.begin(), gauge.time.end(), time - 1e-9);
    return gauge.value[row == gauge.time.end() ? gauge.value.size() - 1
                                               : static_cast<std::size_t>(row - gauge.time.begin())];
  }
  return gauge.at(time);
}

std::optional<std::vector<double>> RunView::profile(double time, const std::vector<double>& grid) const {
  const auto& profiles = run.profiles;
  const bool radial = run.info["kind"] == "slump";
  if (profiles.empty()) return std::nullopt;
  const auto after = std::lower_bound(profiles.begin(), profiles.end(), time - 1e-9,
                                      [](const runs::Profile& p, double t) { return p.time < t; });
  if (after == profiles.end())
    return held || exact ? std::optional(on_grid(profiles.back(), grid, radial)) : std::nullopt;
  if (exact || std::abs(after->time - time) <= 1e-9) return on_grid(*after, grid, radial);
  if (after == profiles.begin()) return std::nullopt;
  const auto before = after - 1;
  auto values = on_grid(*before, grid, radial);
  const auto later = on_grid(*after, grid, radial);
  const double weight = (time - before->time) / (after->time - before->time);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * (later[i] - values[i]);
  return values;
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
  Comparison comparison;
  comparison.options = options;
  if (directories.empty()) throw RunError("no run to compare; name at least one run directory");
  std::string kind;
  for (const fs::path& directory : directories) {
    const std::string own = runs::read_run(directory).info["kind"];
    if (kind.empty()) kind = own;
    if (own != kind)
      throw RunError(fmt::format("{}: a {} cannot be compared with a {} ({})", directory.string(), own, kind,
                                 directories.front().string()));
  }
  if (kind != "slump" && kind != "duct")
    throw RunError(
        fmt::format("{}: kind '{}' is unknown; allowed: slump, duct", directories.front().string(), kind));
  comparison.kind = kind == "slump" ? scenes::Kind::slump : scenes::Kind::duct;
  for (const fs::path& directory : directories)
    comparison.runs.push_back(view_of(directory, comparison.kind));
  make_labels_unique(comparison.runs);
  // MPM before OpenFOAM before others, exact solutions last; within a solver the law that stops first; else
  // as named.
  const auto rank = [](const RunView& v) {
    const int solver = v.exact ? 3 : v.solver == "mpm" ? 0 : v.solver == "foam" ? 1 : 2;
    const int model = v.model == "elasto-viscoplastic" ? 0
                      : v.model == "papanastasiou"     ? 1
                      : v.model == "bi-viscous"        ? 2
                                                       : 3;
    return std::pair(solver, model);
  };
  std::stable_sort(comparison.runs.begin(), comparison.runs.end(),
                   [&](const RunView& a, const RunView& b) { return rank(a) < rank(b); });
  comparison.title = comparison.runs.front().run.info["title"];
  comparison.radial = comparison.kind == scenes::Kind::slump &&
                      word(comparison.runs.front().run.info, "/settings/geometry/dimension") != "plane";
  check_same_scene(comparison);

  for (const RunView& view : comparison.runs) {
    if (!view.gauge.empty() && !view.exact) comparison.end = std::max(comparison.end, view.gauge.end());
    if (!view.run.profiles.empty() && !view.exact)
      comparison.end = std::max(comparison.end, view.run.profiles.back().time);
    if (const auto cell = setting(view, "/" + view.solver + "/cell"))
      comparison.cell = std::max(comparison.cell, *cell);
  }
  // Solvers pass their end time by up to a step: the common end is the one that all who came to it have
  // reached.
  const double longest = comparison.end;
  for (const RunView& view : comparison.runs)
    if (!view.exact && !view.held && !view.gauge.empty() && view.gauge.end() > 0.99 * longest)
      comparison.end = std::min(comparison.end, view.gauge.end());
  if (!(comparison.end > 0.0))
    for (const RunView& view : comparison.runs)
      if (!view.gauge.empty()) comparison.end = std::max(comparison.end, view.gauge.end());
  comparison.grid = common_grid(comparison);
  comparison.frames = frame_times(comparison.end);
  comparison.times = pair_times(comparison.end);
  const double stop_step = round_step(options.stop_to / 120.0);
  const double stop_end = std::min(options.stop_to, comparison.end);
  for (int i = 0; options.stop_from + i * stop_step <= stop_end * (1.0 + 1e-9); ++i)
    comparison.stops.push_back(options.stop_from + i * stop_step);

  for (RunView& view : comparison.runs) measure(view, comparison);
  measure_overshoot(comparison);
  compare_pairs(comparison);
  describe(comparison);
  return comparison;
}

}  // namespace flowrest::compare
