#include "compare/comparison_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/fields/section.h"
#include "compare/input_part.h"
#include "compare/measures/gauges.h"
#include "compare/measures/stop_rules.h"
#include "compare/run_table.h"
#include "compare/run_view.h"
#include "compare/words.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;
using report::Axis;
using report::Bars;
using report::Block;
using report::Chapter;
using report::Column;
using report::Curve;
using report::Format;
using report::none;
using report::Plot;
using report::Table;
using report::Text;

namespace {

/// Samples of a history in the page: dense early, where most happens, and few enough to draw at once.
constexpr int history_samples = 500;

const Gauge& gauge_of(const Comparison& comparison) { return comparison.apparatus->gauge(); }
double scale_of(const Comparison& comparison) { return gauge_of(comparison).shown; }
std::string unit_of(const Comparison& comparison) { return gauge_of(comparison).unit; }
std::string gauge_name(const Comparison& comparison) { return gauge_of(comparison).name; }
std::string speed_unit(const Comparison& comparison) {
  return comparison.apparatus->has_depth() ? "mm/s" : "m/s";
}
std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// Runs that agree in solver and law are told apart by further dashes.
std::vector<report::Entry> entries_of(const Comparison& comparison) {
  std::vector<report::Entry> entries;
  std::set<std::pair<int, int>> taken;
  for (const RunView& view : comparison.runs) {
    report::Entry entry = entry_of(view.label, view.solver, view.model);
    entry.doubt = view.doubt.word();
    entry.why = view.doubt.why;
    entry.trouble = view.trouble;
    while (!taken.insert({entry.colour, entry.dash % 8}).second && taken.size() < 64) ++entry.dash;
    entries.push_back(entry);
  }
  return entries;
}

std::vector<double> history_times(double from, double end) {
  std::vector<double> times;
  for (int i = 0; i <= history_samples; ++i) {
    const double t = end * std::pow(static_cast<double>(i) / history_samples, 1.7);
    if (t >= from) times.push_back(t);
  }
  return times;
}

Axis time_axis(const Comparison& comparison) {
  // Solvers pass or miss their end by a step: 59.99 s is read as 60.
  return {"time", "s",          false,
          true,   std::nullopt, std::max(0.1 * std::round(10.0 * comparison.end), comparison.end)};
}

Plot gauge_plot(const Comparison& comparison) {
  Plot plot{gauge_of(comparison).key,
            gauge_name(comparison) + " against time",
            "",
            time_axis(comparison),
            {gauge_name(comparison), unit_of(comparison), false, true, std::nullopt, std::nullopt},
            {},
            true,
            std::nullopt};
  plot.caption = gauge_of(comparison).caption_for(comparison.gauges, comparison.apparatus->judged_by());
  double lowest_end = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    Curve curve{"", static_cast<int>(i), {}, {}};
    for (const double t : history_times(0.0, comparison.end)) {
      const auto value = view.gauge_at(t);
      curve.x.push_back(t);
      curve.y.push_back(value ? scale_of(comparison) * *value : none);
    }
    if (view.held && !view.exact && view.measures.end) curve.held_from = *view.measures.end;
    if (view.measures.gauge_end) lowest_end = std::min(lowest_end, 1e3 * *view.measures.gauge_end);
    plot.curves.push_back(std::move(curve));
  }
  // A slump's whole rise hides what matters: how its runs part at the end.
  if (comparison.apparatus->spreads() && std::isfinite(lowest_end)) {
    const double step = 1e4 * comparison.grain.length;  // mm: of the standard cone 10
    plot.focus = step * std::floor(0.9 * lowest_end / step);
  }
  return plot;
}

/// What else each run recorded, against time.
Chapter further_chapter(const Comparison& comparison) {
  Chapter chapter{"gauges", "What else was gauged", {}};
  for (const Gauge& gauge : comparison.apparatus->further_gauges()) {
    Plot plot{.id = gauge.key,
              .title = gauge.name + " against time",
              .caption = gauge.caption_for(comparison.gauges, comparison.apparatus->judged_by())};
    plot.x = time_axis(comparison);
    plot.y = {gauge.name, gauge.unit, false, true};
    for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
      const Series series = column(comparison.runs[i].run, gauge.column, gauge.si);
      if (series.empty()) continue;
      Curve curve{.entry = static_cast<int>(i)};
      for (const double t : history_times(series.time.front(), std::min(series.end(), comparison.end))) {
        curve.x.push_back(t);
        curve.y.push_back(gauge.shown * series.at(t));
      }
      // What is at rest stays as it is, but for its flocs, which go on growing.
      if (const RunView& view = comparison.runs[i];
          view.held && !curve.x.empty() && curve.x.back() < comparison.end) {
        const double growth = gauge.column == "flocculation_mean" ? flocculation_at_rest(view) : 0.0;
        carry_on(curve, growth, comparison.end);
      }
      plot.curves.push_back(std::move(curve));
    }
    // A height that never leaves zero says nothing.
    const bool says = std::any_of(plot.curves.begin(), plot.curves.end(), [](const Curve& curve) {
      return std::any_of(curve.y.begin(), curve.y.end(), [](double y) { return y != 0.0; });
    });
    if (says) chapter.blocks.push_back(std::move(plot));
  }
  return chapter;
}

std::optional<Block> profiles(const Comparison& comparison) {
  const bool depth_profiles = comparison.apparatus->has_depth();
  report::Frames frames{"profiles", depth_profiles ? "depth profiles" : "velocity profiles"};
  frames.caption =
      depth_profiles
          ? "Depth: concrete volume per plan area, for every solver. Vertical scale exaggerated. Drag, use "
            "the arrow keys, or press play."
          : "Drag, use the arrow keys, or press play.";
  frames.times = comparison.frames;
  frames.grid = {depth_profiles ? (comparison.radial ? "radius" : "distance") : "height above the mid-plane",
                 "mm"};
  frames.value = {
      depth_profiles ? "depth" : "velocity", depth_profiles ? "mm" : "m/s", false, false, 0.0, std::nullopt};
  if (!depth_profiles) frames.value.from = std::nullopt;
  for (const double x : comparison.grid) frames.coordinate.push_back(1e3 * x);
  frames.upright = !depth_profiles;
  bool any = false;
  // A hundredth of what is told of lengths is more than a screen shows.
  const double per_mm = 0.1 / comparison.grain.length;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    report::Frames::Curve curve{static_cast<int>(i), {}};
    for (const double t : comparison.frames) {
      auto values = comparison.runs[i].profile(t, comparison.grid).value_or(std::vector<double>());
      for (double& v : values) v = depth_profiles ? std::round(1e3 * v * per_mm) / per_mm : v;
      any = any || !values.empty();
      curve.values.push_back(std::move(values));
    }
    frames.curves.push_back(std::move(curve));
  }
  if (!any || frames.times.empty() || frames.coordinate.empty()) return std::nullopt;
  return frames;
}

Table table_of_runs(const Comparison& comparison, const std::string& id, const std::string& title,
                    const std::vector<RunColumn>& columns,
                    const std::function<bool(const RunView&)>& wanted) {
  Table table{id, title, "", {{"Run"}}, {}};
  table.columns.front().text = true;
  for (const RunColumn& column : columns) table.columns.push_back(column.column);
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    if (!wanted(view)) continue;
    Table::Row row{{Table::Cell(view.label)}, static_cast<int>(i)};
    for (const RunColumn& column : columns) row.cells.push_back(column.value(view));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table::Cell verdict(const RunView& view) {
  if (view.exact) return "exact";
  const std::string said = word(view.run.info, "/verdict");
  return view.trouble.empty() ? said : view.trouble + (said.empty() ? "" : "; " + said);
}

Table measures_table(const Comparison& comparison) {
  std::vector<RunColumn> columns = comparison.apparatus->measure_columns(comparison);
  columns.push_back(measure_column("Volume drift", "%", signed_fixed(3), &Measures::volume_drift, 100.0));
  columns.push_back({{"Verdict", "", {}, true}, verdict});
  Table table = table_of_runs(comparison, "measures", "measures of each run", columns,
                              [](const RunView&) { return true; });
  table.caption = comparison.apparatus->measures_caption(comparison);
  return table;
}

std::string square_caption(const Comparison& comparison) {
  const Square& square = *comparison.square;
  const auto label = [&](const std::optional<std::size_t>& run) { return comparison.runs[*run].label; };
  return fmt::format(
      "Total: {0} less {1}. Law: fluid less elasto-viscoplastic, the mean of both solvers. Discretisation: "
      "OpenFOAM less MPM, "
      "the mean of both laws; the two sum to the total. Shared: half of what the law does in OpenFOAM beyond "
      "what it does in "
      "MPM, which can be given to neither. Noise: the scatter of the four runs about their trend and half "
      "the change of their "
      "spread when the edge is read at {4:g} instead of {5:g} mm, as root sum square. The other corners: {2} "
      "and "
      "{3}.",
      label(square.foam_fluid), label(square.mpm_solid), label(square.mpm_fluid), label(square.foam_solid),
      500.0 * comparison.gauges.spread_depth, 2000.0 * comparison.gauges.spread_depth);
}

/// The difference at each time, split.
std::optional<Chapter> square_chapter(const Comparison& comparison) {
  if (!comparison.square) return std::nullopt;
  const Square& square = *comparison.square;
  Chapter chapter{"square", "Law, discretisation and noise"};
  if (square.at.empty()) {
    for (const std::string& command : square.missing)
      chapter.blocks.push_back(Text{
          fmt::format(
              "The square of (MPM, OpenFOAM) and (fluid, elasto-viscoplastic) lacks a run. Make it: `{}`",
              command),
          Text::Style::warning});
    return chapter.blocks.empty() ? std::nullopt : std::optional(chapter);
  }
  const double scale = scale_of(comparison);
  const std::string unit = unit_of(comparison);
  const std::pair<const char*, double Square::At::*> parts[] = {
      {"total", &Square::At::total},
      {"law", &Square::At::law},
      {"discretisation", &Square::At::discretisation},
      {"shared", &Square::At::interaction},
      {"noise", &Square::At::noise}};
  Plot plot{.id = "split",
            .title = "the difference between solvers and laws, split",
            .caption = square_caption(comparison)};
  plot.x = time_axis(comparison);
  plot.y = {"difference in " + gauge_name(comparison), unit};
  Table table{.id = "split-table", .title = "the difference, split at each time"};
  table.columns = {{"Time (s)", "", significant(3), true}};
  int colour = 0;
  for (const auto& [name, part] : parts) {
    Curve curve{.name = name};
    for (const Square::At& at : square.at) {
      curve.x.push_back(at.time);
      curve.y.push_back(scale * (at.*part));
    }
    curve.colour = colour == 0 ? -1 : colour - 1;
    curve.dash = colour++;
    plot.curves.push_back(std::move(curve));
    table.columns.push_back(
        {name, unit, comparison.apparatus->has_depth() ? signed_lengths(comparison) : significant(3)});
  }
  for (const double time : comparison.times) {
    const auto at = std::lower_bound(square.at.begin(), square.at.end(), time - 1e-9,
                                     [](const Square::At& a, double t) { return a.time < t; });
    if (at == square.at.end()) continue;
    Table::Row row{{Table::Cell(at->time)}};
    for (const auto& [name, part] : parts) row.cells.push_back(scale * ((*at).*part));
    table.rows.push_back(std::move(row));
  }
  chapter.blocks = {plot, table};
  return chapter;
}

std::optional<Chapter> shear_chapter(const Comparison& comparison) {
  Plot plot{"shear-rate",
            "99th percentile of the shear rate",
            fmt::format("Norm: sqrt(2 D:D). The customary threshold of rest is {:g} 1/s.",
                        comparison.thresholds.rest_shear_rate),
            time_axis(comparison),
            {"shear rate", "1/s", true, true, std::nullopt, std::nullopt},
            {}};
  plot.x.logarithmic = true;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const Series& series = comparison.runs[i].shear_rate;
    if (series.empty()) continue;
    Curve curve{"", static_cast<int>(i), {}, {}};
    for (const double t : history_times(series.time.front(), std::min(series.end(), comparison.end))) {
      const double value = series.at(t);
      if (!(t > 0.0) || !(value > 0.0)) continue;
      curve.x.push_back(t);
      curve.y.push_back(value);
    }
    if (!curve.x.empty()) plot.curves.push_back(std::move(curve));
  }
  if (plot.curves.empty()) return std::nullopt;
  return Chapter{"rest", "How it comes to rest", {plot}};
}

std::optional<Chapter> residual_chapter(const Comparison& comparison) {
  const double scale = comparison.apparatus->has_depth() ? 1e3 : 1.0;
  const std::string unit = speed_unit(comparison);
  const auto moving = [](const RunView& view) { return !view.exact && view.measures.residual.has_value(); };
  Bars bars{"residual",
            comparison.apparatus->has_depth()
                ? fmt::format("growth of the {} over the last seconds", gauge_name(comparison))
                : "plug velocity over the last seconds",
            comparison.apparatus->residual_caption(comparison),
            {"speed", unit, true},
            {},
            {{"measured", {}}, {"predicted by the regularisation", {}}}};
  for (const RunView& view : comparison.runs) {
    if (!moving(view)) continue;
    const Measures& m = view.measures;
    bars.categories.push_back(view.label + (view.doubt.any() ? fmt::format(" ({})", view.doubt.word()) : "") +
                              (view.trouble.empty() ? "" : " (incomplete)"));
    const double floor = comparison.apparatus->has_depth() ? 10.0 * comparison.grain.speed : 1e-8;
    bars.groups[0].values.push_back(std::max(std::abs(*m.residual) * scale, floor));
    bars.groups[1].values.push_back(m.predicted_creep && *m.predicted_creep > 0.0 ? scale * *m.predicted_creep
                                                                                  : none);
  }
  if (bars.categories.empty()) return std::nullopt;
  const Table table = table_of_runs(
      comparison, "residual-speeds", "residual speeds and their cause",
      {measure_column("Measured", unit, significant(2), &Measures::residual, scale),
       measure_column("Predicted creep", unit, significant(2), &Measures::predicted_creep, scale),
       {{"Ratio", "", significant(2)},
        [](const RunView& view) {
          const auto& creep = view.measures.predicted_creep;
          return creep && *creep > 0.0 ? Table::Cell(std::abs(*view.measures.residual) / *creep)
                                       : Table::Cell();
        }},
       {{"Exact", unit, {}, true},
        [scale](const RunView& view) {
          const Measures& m = view.measures;
          return m.approach_most ? Table::Cell(fmt::format("{:.2g} to {:.2g}", scale * *m.approach_least,
                                                           scale * *m.approach_most))
                                 : Table::Cell();
        }},
       measure_column("Scatter", unit_of(comparison), significant(2), &Measures::residual_scatter, scale),
       {{"Cause", "", {}, true},
        [](const RunView& view) { return Table::Cell(to_string(view.measures.cause)); }},
       {{"Noise monitor", "", {}, true},
        [](const RunView& view) { return Table::Cell(word(view.run.info, "/verdict")); }}},
      moving);
  return Chapter{"moving", "What still moves at the end, and why", {bars, table}};
}

/// What the gauge is counted from where a run is cut: the arrested spread of a slump.
double stop_base(const Comparison& comparison, const RunView& view) {
  if (!comparison.apparatus->grows()) return 0.0;
  return view.measures.overshoot_reference.value_or(view.measures.gauge_end.value_or(0.0));
}

/// What each rule by which people stop would have read of each fluid, less the arrested gauge.
std::optional<Table> rules_table(const Comparison& comparison) {
  if (!comparison.apparatus->grows()) return std::nullopt;
  const double scale = scale_of(comparison);
  const std::string gauge = gauge_name(comparison), unit = unit_of(comparison);
  Table table{"stop-rules", "what rules to stop by would have read",
              "Fluids never rest, so that runs are cut by a rule. Error: the " + gauge +
                  " when the rule cuts, less the arrested one. A dash: it does not cut this run."};
  table.columns = {{"Run", "", {}, true},
                   {"Rule", "", {}, true},
                   {"Cuts at", "s", significant(3)},
                   {capitalised(gauge), unit, lengths(comparison)},
                   {"Error", unit, signed_lengths(comparison)},
                   {"Error of the arrested " + gauge, "%", fixed(1)}};
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    if (view.exact || !view.fluid || !view.measures.overshoot_reference) continue;
    const double arrested = *view.measures.overshoot_reference;
    for (const RuleStop& stop : stops_by_rules(view, comparison.thresholds)) {
      Table::Row row;
      row.entry = static_cast<int>(i);
      row.cells = {view.label, stop.rule};
      if (stop.time) {
        const double error = *stop.gauge - arrested;
        row.cells.insert(row.cells.end(),
                         {*stop.time, scale * *stop.gauge, scale * error, 100.0 * error / arrested});
      } else {
        row.cells.resize(table.columns.size());
      }
      table.rows.push_back(std::move(row));
    }
  }
  if (table.rows.empty()) return std::nullopt;
  return table;
}

std::optional<Chapter> stops_chapter(const Comparison& comparison) {
  if (comparison.stops.size() < 2) return std::nullopt;
  const bool depth_profiles = comparison.apparatus->has_depth();
  const std::string gauge = gauge_name(comparison);
  const double scale = scale_of(comparison);
  Plot plot{"stops",
            depth_profiles ? gauge + " that is read if the run is cut at a time"
                           : "plug velocity if the run is cut at a time",
            depth_profiles
                ? "Counted from the arrested " + gauge +
                      " of the elasto-viscoplastic run of the same solver "
                      "where there is one, "
                      "else of any solver, else from the run's own end. A level line needs no choice of when "
                      "to stop; the "
                      "slope of any other is the error that choice makes."
                : "A run that has come to rest needs no choice of when to stop.",
            {"time of the stop", "s", false, false, comparison.stops.front(), comparison.stops.back()},
            {depth_profiles ? gauge + " less the arrested one" : "plug velocity", unit_of(comparison)},
            {}};
  const auto measured = [](const RunView& view) {
    return !view.exact && view.measures.stop_lowest.has_value();
  };
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    if (!measured(view)) continue;
    Curve curve{"", static_cast<int>(i), comparison.stops, {}};
    for (const double stop : comparison.stops) {
      const auto value = view.gauge_at(stop);
      curve.y.push_back(value ? scale * (*value - stop_base(comparison, view)) : none);
    }
    if (view.held && view.measures.end) curve.held_from = *view.measures.end;
    plot.curves.push_back(std::move(curve));
  }
  if (plot.curves.empty()) return std::nullopt;
  const Format format = depth_profiles ? lengths(comparison) : significant(3);
  const auto range = [](const RunView& view) {
    return *view.measures.stop_highest - *view.measures.stop_lowest;
  };
  std::vector<RunColumn> columns = {
      measure_column("Lowest reading", unit_of(comparison), format, &Measures::stop_lowest, scale),
      measure_column("Highest reading", unit_of(comparison), format, &Measures::stop_highest, scale),
      {{"Range", unit_of(comparison), format},
       [=](const RunView& view) { return Table::Cell(scale * range(view)); }}};
  if (depth_profiles)
    columns.push_back(
        {{"Range of the arrested " + gauge, "%", fixed(1)}, [&comparison, range](const RunView& view) {
           return Table::Cell(100.0 * range(view) / stop_base(comparison, view));
         }});
  Chapter chapter{"arbitrary-stops",
                  "What an arbitrary stop would have said",
                  {plot, table_of_runs(comparison, "stop-readings", "readings over all arbitrary stops",
                                       columns, measured)}};
  if (auto rules = rules_table(comparison)) chapter.blocks.push_back(std::move(*rules));
  return chapter;
}

std::string difference_word(const std::string& kind) {
  return kind == "both" ? "law and solver" : kind == "exact" ? "exact solution" : kind;
}

std::optional<Chapter> pairs_chapter(const Comparison& comparison) {
  if (comparison.pairs.empty()) return std::nullopt;
  const bool depth_profiles = comparison.apparatus->has_depth();
  const double scale = scale_of(comparison);
  const double depth = depth_profiles ? 1e3 : 1.0;
  const std::string unit = depth_profiles ? "mm" : "m/s";
  Table table{
      "pairs", "differences between profiles",
      std::string(
          comparison.radial
              ? "Norms of the difference in depth on a common radius grid, weighted by plan area over all "
                "that either run covers"
          : depth_profiles
              ? "Norms of the difference in depth on a common grid, over all that either run covers"
              : "Norms of the difference in velocity on a common grid") +
          ": L1 the mean, L2 the root of the mean square, L∞ the largest."};
  table.columns = {{"Run", "", {}, true},
                   {"against", "", {}, true},
                   {"Differs in", "", {}, true},
                   {capitalised(gauge_name(comparison)), unit_of(comparison),
                    depth_profiles ? signed_lengths(comparison) : significant(3)},
                   {"L1", unit, depth_profiles ? lengths(comparison, 2) : significant(3)},
                   {"L2", unit, depth_profiles ? lengths(comparison, 2) : significant(3)},
                   {"L∞", unit, depth_profiles ? lengths(comparison, 1) : significant(3)},
                   {depth_profiles ? "Volume that lies elsewhere" : "L1, relative", "%", significant(2)},
                   {"L2, relative", "%", significant(2)}};
  table.choice = "Time";
  std::map<double, std::vector<Table::Row>> by_time;
  for (const Pair& pair : comparison.pairs)
    for (const Pair::At& at : pair.at) {
      const auto& e = at.error;
      by_time[at.time].push_back(
          {{comparison.runs[pair.run].label, comparison.runs[pair.reference].label,
            difference_word(pair.kind), cell(at.gauge_difference, scale), depth * e.l1, depth * e.l2,
            depth * e.linf, 100.0 * e.l1_relative, 100.0 * e.l2_relative},
           static_cast<int>(pair.run),
           "",
           fmt::format("{:.4g} s", at.time)});
    }
  for (auto& [time, rows] : by_time)
    for (auto& row : rows) table.rows.push_back(std::move(row));
  return Chapter{"differences", "Differences between profiles", {table}};
}

std::optional<Chapter> cost_chapter(const Comparison& comparison) {
  const auto priced = [](const RunView& view) { return !view.exact && view.measures.cpu.has_value(); };
  Bars bars{"cost",
            "CPU time of each run",
            "CPU seconds summed over all threads, on the machine named under Provenance.",
            {"CPU time", "s"},
            {},
            {{"CPU time", {}}}};
  for (const RunView& view : comparison.runs) {
    if (!priced(view)) continue;
    bars.categories.push_back(view.label);
    bars.groups[0].values.push_back(*view.measures.cpu);
  }
  if (bars.categories.empty()) return std::nullopt;
  const auto [least, most] = std::minmax_element(bars.groups[0].values.begin(), bars.groups[0].values.end());
  bars.x.logarithmic = *least > 0.0 && *most > 20.0 * *least;
  const auto info = [](const std::string& name, const std::string& key, const std::string& other = "") {
    return RunColumn{{name, "", key.ends_with("cpu_s") ? significant(3) : fixed(0)},
                     [=](const RunView& view) {
                       const auto value = number(view.run.info, key.c_str());
                       return cell(value || other.empty() ? value : number(view.run.info, other.c_str()));
                     }};
  };
  return Chapter{
      "costs",
      "What it cost",
      {bars, table_of_runs(comparison, "costs-of-runs", "cost of each run",
                           {measure_column("CPU time", "s", significant(3), &Measures::cpu),
                            measure_column("Wall time", "s", significant(3), &Measures::wall),
                            measure_column("CPU per simulated second", "s", significant(3),
                                           &Measures::cpu_per_simulated_second),
                            info("Steps", "/steps"), info("Particles", "/particles"), info("Cells", "/cells"),
                            info("Particle-steps or cell-steps per CPU second", "/particle_steps_per_cpu_s",
                                 "/cell_steps_per_cpu_s")},
                           priced)}};
}

void flatten(const Json& json, const std::string& prefix,
             std::vector<std::pair<std::string, std::string>>& facts) {
  for (const auto& [key, value] : json.items()) {
    std::string name = prefix + key;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (value.is_object())
      flatten(value, name + " ", facts);
    else
      facts.emplace_back(name, value.is_string() ? value.get<std::string>() : value.dump());
  }
}

Chapter provenance_chapter(const Comparison& comparison, const Json& json) {
  Chapter chapter{"provenance", "Provenance", {}};
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    report::Details details{view.label, {}};
    const std::string reason = word(view.run.info, "/reason"), verdict = word(view.run.info, "/verdict");
    details.facts = {{"folder", view.run.directory.string()},
                     {"status", word(view.run.info, "/status") + (reason.empty() ? "" : ": " + reason)},
                     {"verdict", verdict.empty() ? "none" : verdict}};
    flatten(json["runs"][i]["made_by"], "", details.facts);
    chapter.blocks.push_back(details);
  }
  if (const std::string scene = comparison.runs.front().run.info.value("scene", ""); !scene.empty())
    chapter.blocks.push_back(report::Details{"The scene, as read", {}, scene});
  return chapter;
}

/// What the numbers are good to, and which of them may be held against which.
Chapter trust_chapter(const Comparison& comparison) {
  Chapter chapter{"trust", "How far it can be trusted, and which comparison is fair"};
  for (const Finding& finding : comparison.findings)
    if (finding.topic == Finding::Topic::context) chapter.blocks.push_back(Text{finding.text});
  chapter.blocks.push_back(Text{comparison.fair});
  return chapter;
}

std::vector<Block> words_of(const Comparison& comparison) {
  std::vector<Block> blocks;
  std::map<Finding::Topic, std::string> told;
  for (const Finding& finding : comparison.findings) {
    std::string& text = told[finding.topic];
    text += (text.empty() ? "" : finding.topic == Finding::Topic::stop ? "\n" : " ") + finding.text;
  }
  if (told.contains(Finding::Topic::opening))
    blocks.push_back(Text{told[Finding::Topic::opening], Text::Style::opening});
  for (const std::string& note : comparison.notes) blocks.push_back(Text{note, Text::Style::warning});
  if (!comparison.missing.empty())
    blocks.push_back(Text{
        "The scene names runs that are not among these: " + words::listed(comparison.missing, "; ") + ".",
        Text::Style::warning});
  const std::pair<Finding::Topic, std::string> questions[] = {
      {Finding::Topic::stop, comparison.apparatus->stop_question()},
      {Finding::Topic::apart, "How far apart are they?"},
      {Finding::Topic::cause, "Which difference is physics, which numerics?"},
      {Finding::Topic::cost, "What did it cost?"}};
  for (const auto& [topic, question] : questions)
    if (told.contains(topic)) blocks.push_back(report::Answer{question, told[topic]});
  return blocks;
}

}  // namespace

void carry_on(report::Curve& curve, double rate, double end) {
  const double from = curve.x.back(), value = curve.y.back();
  curve.held_from = from;
  // Not one straight line: on a logarithmic axis a steady growth is bent.
  constexpr int points = 30;
  for (int i = 1; i <= points; ++i) {
    const double share = static_cast<double>(i) / points,
                 time = from > 0.0 ? from * std::pow(end / from, share) : end * share;
    curve.x.push_back(time);
    curve.y.push_back(value + rate * (time - from));
  }
}

report::Entry entry_of(const std::string& name, const std::string& solver, const std::string& model) {
  report::Entry entry{name};
  const bool exact = solver == "exact";
  entry.colour = exact ? -1 : laws::order_of(model);
  entry.dash = exact ? 5 : solver == "mpm" ? 0 : solver == "foam" ? 1 : 2;
  return entry;
}

report::Page page_of(const Comparison& comparison, const Json& json) {
  report::Page page{"comparison",
                    comparison.title,
                    entries_of(comparison),
                    words_of(comparison),
                    gauge_plot(comparison),
                    {},
                    json,
                    json["provenance"]};
  const auto add = [&](std::optional<Chapter> chapter) {
    if (chapter) page.chapters.push_back(std::move(*chapter));
  };
  Chapter shapes{"shapes", "Shapes"};
  if (auto depths = profiles(comparison)) shapes.blocks.push_back(std::move(*depths));
  for (auto& section : fields::sections_of(comparison)) shapes.blocks.push_back(std::move(section));
  if (!shapes.blocks.empty()) add(std::move(shapes));
  if (Chapter further = further_chapter(comparison); !further.blocks.empty()) add(std::move(further));
  for (Chapter& own : comparison.apparatus->chapters(comparison)) add(std::move(own));
  add(square_chapter(comparison));
  add(shear_chapter(comparison));
  add(residual_chapter(comparison));
  add(stops_chapter(comparison));
  add(trust_chapter(comparison));
  add(input_chapter(comparison));
  add(Chapter{"all-measures", "Measures", {measures_table(comparison)}});
  add(pairs_chapter(comparison));
  add(cost_chapter(comparison));
  add(provenance_chapter(comparison, json));
  return page;
}

}  // namespace flowrest::compare
