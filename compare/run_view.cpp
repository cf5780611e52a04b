#include "compare/run_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/measures/gauges.h"
#include "compare/words.h"
#include "runs/command.h"
#include "runs/depth.h"
#include "runs/gauges.h"
#include "runs/material_state.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;

namespace {

/// The scene's gauge: from the history, or made of the profiles where the history lacks it.
Series gauge_series(const runs::Run& run, const ApparatusReport& apparatus) {
  const Gauge& gauge = apparatus.gauge();
  Series series = column(run, gauge.column, gauge.si);
  const double spread_depth = runs::gauges_of(run).spread_depth;
  const bool in_profiles = apparatus.spreads() || !apparatus.has_depth();
  if (!series.empty() || run.history.has(gauge.column) || !in_profiles) return series;
  for (const auto& profile : run.profiles) {
    const double value = apparatus.spreads() ? runs::spread(depth_of(profile, run), spread_depth)
                                             : *std::max_element(profile.value.begin(), profile.value.end());
    if (!std::isfinite(value)) continue;
    series.time.push_back(profile.time);
    series.value.push_back(value);
  }
  return series;
}

/// Whether the last row of the history has the gauge, and it reads nothing.
bool ends_unread(const runs::Run& run, const Gauge& gauge) {
  const std::string& name = gauge.column;
  return run.history.has(name) && run.history.rows() > 0 && std::isnan(run.history.at(name).back());
}

/// Profiles of velocity are compared about the mid-plane; solvers may count y from the lower plate.
void centre_profiles(runs::Run& run) {
  const auto height = number(run.info, "/settings/geometry/height");
  for (auto& profile : run.profiles) {
    if (!height || profile.coordinate.empty() || profile.coordinate.back() <= 0.51 * *height) continue;
    for (double& y : profile.coordinate) y -= 0.5 * *height;
  }
}

std::vector<double> on_grid(const runs::Profile& profile, const std::vector<double>& grid,
                            const ApparatusReport& apparatus) {
  std::vector<double> values;
  values.reserve(grid.size());
  const auto& x = profile.coordinate;
  for (const double g : grid) {
    double value = 0.0;
    // A profile's last value stands up to the end of its ring or strip: where there is a wall, depth does not
    // fall to it.
    const double beyond = apparatus.has_depth() && x.size() > 1 ? 0.5 * (x.back() - x[x.size() - 2]) : 0.0;
    if (x.empty() || g > x.back() + beyond) {
      value = 0.0;
    } else if (g > x.back()) {
      value = profile.value.back();
    } else if (g >= x.front()) {
      value = interpolate(x, profile.value, g);
    } else if (apparatus.spreads() && x.size() > 1) {
      // Flat on the axis: the parabola in r^2 through the innermost two points.
      value = profile.value[0] +
              (profile.value[0] - profile.value[1]) * (x[0] * x[0] - g * g) / (x[1] * x[1] - x[0] * x[0]);
    } else {
      value = apparatus.has_depth() ? profile.value[0] : 0.0;
    }
    values.push_back(value);
  }
  return values;
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
      return reason.starts_with("interrupted") ? reason : "interrupted " + at + why;
    case runs::Status::failed:
      return "failed " + at + why;
    case runs::Status::at_rest:
    case runs::Status::end_time:
      return "";
  }
  return "";
}

}  // namespace

bool radial(const runs::Run& run, const ApparatusReport& apparatus) {
  return apparatus.spreads() && word(run.info, "/settings/geometry/dimension") != "plane";
}

runs::DepthView depth_of(const runs::Profile& profile, const runs::Run& run) {
  const bool plane = word(run.info, "/settings/geometry/dimension") == "plane";
  return {profile.coordinate, profile.value, plane ? runs::About::plane : runs::About::axis};
}

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

Series column(const runs::Run& run, const std::string& name, double scale) {
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

double flocculation_at_rest(const RunView& view) {
  const auto rate = setting(view, "/thixotropy/flocculation_rate"),
             yield_stress = setting(view, "/material/yield_stress");
  return rate && yield_stress && *yield_stress > 0.0 ? *rate / *yield_stress : 0.0;
}

RunView view_of(runs::Run run, const ApparatusReport& apparatus) {
  RunView view;
  view.apparatus = &apparatus;
  view.run = std::move(run);
  const Json& info = view.run.info;
  view.label = view.run.label();
  view.solver = word(info, "/solver");
  view.model = word(info, "/model");
  view.exact = view.solver == "exact";
  view.held = view.run.status() == runs::Status::at_rest;
  view.law = laws::law_named(view.model);
  view.fluid = view.law && !laws::can_rest(*view.law);
  view.doubt = runs::doubt_of(word(info, "/verdict"));
  if (!apparatus.has_depth()) centre_profiles(view.run);
  view.gauges = runs::gauges_of(view.run);
  view.gauge = gauge_series(view.run, apparatus);
  view.unread = ends_unread(view.run, apparatus.gauge());
  view.walls_differ = word(info, "/walls_differ");
  view.shear_rate = column(view.run, "shear_rate_p99_1_s");
  view.trouble = trouble_of(view);
  return view;
}

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

void note_gauges(Comparison& comparison) {
  if (!comparison.apparatus->has_depth()) return;
  const auto depth_of = [&](const RunView& view) { return comparison.apparatus->edge_depth(view.gauges); };
  std::map<double, std::vector<std::string>> by_depth;
  std::vector<std::string> unread;
  for (const RunView& view : comparison.runs) {
    by_depth[depth_of(view)].push_back(view.label);
    if (view.unread)
      unread.push_back(fmt::format("{} (nowhere {:g} mm deep)", view.label, 1e3 * depth_of(view)));
  }
  if (by_depth.size() > 1) {
    std::vector<std::string> depths;
    for (const auto& [depth, labels] : by_depth)
      depths.push_back(fmt::format("{:g} mm in {}", 1e3 * depth, words::listed(labels)));
    comparison.notes.push_back(fmt::format("The gauges of these runs are not read at the same depth: {}.",
                                           words::listed(depths, "; ")));
  }
  if (!unread.empty())
    comparison.notes.push_back(fmt::format("Nothing is read of the {} at the end of {}.",
                                           comparison.apparatus->gauge().name, words::listed(unread)));
}

std::optional<std::string> command_for(const Comparison& comparison, const std::string& solver,
                                       const std::string& model) {
  const RunView* like = &comparison.runs.front();
  for (const RunView& view : comparison.runs)
    if (view.solver == solver && like->solver != solver) like = &view;
  return runs::command_to_make(like->run.info, solver, model);
}

void note_scenes(Comparison& comparison) {
  std::set<std::string> said;
  for (const RunView& view : comparison.runs) {
    const auto notes = view.run.info.find("notes");
    if (notes == view.run.info.end() || !notes->is_array()) continue;
    for (const Json& note : *notes)
      if (note.is_string() && said.insert(note.get<std::string>()).second)
        comparison.notes.push_back(fmt::format("In the scene {}.", note.get<std::string>()));
  }
}

void note_starts(Comparison& comparison) {
  std::map<std::string, std::vector<std::string>> by_start;
  for (const RunView& view : comparison.runs) {
    const auto start = view.run.info.find(runs::started_from_key);
    if (start == view.run.info.end() || !start->is_object()) continue;
    by_start[fmt::format("{}, at {:.4g} s", start->value("run", ""), start->value("time_s", 0.0))].push_back(
        view.label);
  }
  for (const auto& [start, labels] : by_start)
    comparison.notes.push_back(fmt::format("{} {} from the state of another run: {}.", words::listed(labels),
                                           labels.size() > 1 ? "start" : "starts", start));
}

void note_missing(Comparison& comparison) {
  const Json& info = comparison.runs.front().run.info;
  const Json::json_pointer named("/settings/runs");
  if (!info.contains(named) || !info.at(named).is_object()) return;
  for (const auto& [solver, models] : info.at(named).items()) {
    if (!models.is_array()) continue;
    for (const Json& model : models) {
      if (!model.is_string()) continue;
      const bool here = std::any_of(comparison.runs.begin(), comparison.runs.end(),
                                    [&, &solver = solver](const RunView& view) {
                                      return view.solver == solver && view.model == model.get<std::string>();
                                    });
      if (here) continue;
      const auto command = command_for(comparison, solver, model.get<std::string>());
      comparison.missing.push_back(fmt::format("{} {}{}", solver == "mpm" ? "MPM" : "OpenFOAM",
                                               model.get<std::string>(),
                                               command ? fmt::format(" (make it by `{}`)", *command) : ""));
    }
  }
}

void note_walls(Comparison& comparison) {
  std::map<std::string, std::vector<std::string>> by_difference;
  for (const RunView& view : comparison.runs)
    if (!view.walls_differ.empty()) by_difference[view.walls_differ].push_back(view.label);
  for (const auto& [difference, labels] : by_difference)
    comparison.notes.push_back(fmt::format("Walls of {} differ from the scene's: {}{}", words::listed(labels),
                                           difference, difference.ends_with('.') ? "" : "."));
}

std::optional<double> RunView::gauge_at(double time) const {
  if (gauge.empty()) return std::nullopt;
  if (!exact && (time < gauge.time.front() - 1e-9 || ((!held || unread) && time > gauge.end() + 1e-9)))
    return std::nullopt;
  if (exact && !apparatus->has_depth()) {
    // Each row is the steady state of the stage that ends there.
    const auto row = std::lower_bound(gauge.time.begin(), gauge.time.end(), time - 1e-9);
    return gauge.value[row == gauge.time.end() ? gauge.value.size() - 1
                                               : static_cast<std::size_t>(row - gauge.time.begin())];
  }
  return gauge.at(time);
}

std::optional<std::vector<double>> RunView::profile(double time, const std::vector<double>& grid) const {
  const auto& profiles = run.profiles;
  if (profiles.empty()) return std::nullopt;
  const auto after = std::lower_bound(profiles.begin(), profiles.end(), time - 1e-9,
                                      [](const runs::Profile& p, double t) { return p.time < t; });
  if (after == profiles.end())
    return held || exact ? std::optional(on_grid(profiles.back(), grid, *apparatus)) : std::nullopt;
  if (exact || std::abs(after->time - time) <= 1e-9) return on_grid(*after, grid, *apparatus);
  if (after == profiles.begin()) return std::nullopt;
  const auto before = after - 1;
  auto values = on_grid(*before, grid, *apparatus);
  const auto later = on_grid(*after, grid, *apparatus);
  const double weight = (time - before->time) / (after->time - before->time);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * (later[i] - values[i]);
  return values;
}

}  // namespace flowrest::compare
