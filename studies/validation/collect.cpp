#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/comparison.h"
#include "compare/comparison_page.h"
#include "compare/fields/section.h"
#include "compare/measures/gauges.h"
#include "compare/run_view.h"
#include "compare/words.h"
#include "runs/command.h"
#include "scenes/plausibility.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

namespace fs = std::filesystem;
using compare::Comparison;
using compare::RunView;
using compare::Series;

/// Samples of a curve in the page: a page of thirty scenes stays small.
constexpr int samples = 160;
constexpr std::size_t section_times = 7, section_bytes = 160'000;

/// A run that is wanted, as a comparison has it; no view where there is no run.
struct Seen {
  const Wanted* wanted = nullptr;
  const RunView* view = nullptr;
};

std::string slug(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  return name;
}

int entry_index(std::vector<report::Entry>& entries, const Wanted& wanted) {
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].name == wanted.label()) return static_cast<int>(i);
  entries.push_back(
      compare::entry_of(wanted.label(), to_string(wanted.solver), scenes::to_string(wanted.model)));
  return static_cast<int>(entries.size()) - 1;
}

/// The name of a run's curve: with its warnings, which are its scene's and not the page's.
std::string curve_name(const Seen& seen) {
  std::string warnings;
  warnings = seen.view->doubt.word();
  if (!seen.view->trouble.empty()) warnings += warnings.empty() ? "incomplete" : ", incomplete";
  return warnings.empty() ? "" : fmt::format("{} ({})", seen.wanted->label(), warnings);
}

const Seen* partner(const std::vector<Seen>& all, const Seen& of, bool coarse) {
  for (const Seen& other : all)
    if (other.wanted->solver == of.wanted->solver && other.wanted->model == of.wanted->model &&
        other.wanted->coarse == coarse)
      return &other;
  return nullptr;
}

/// Why a run that has no such time cannot tell whether it would have had one; empty where it can.
std::string ended_too_early(const Number& n, const RunView& view) {
  const auto target = n.published.target();
  const bool fluid_rests = n.published.quantity == "rest_s" && !laws::can_rest(n.model);
  if (!target || fluid_rests || compare::reading_named(n.published.quantity).unit != "s") return "";
  const double end = view.run.history.at("time_s").back();
  return end < *target ? fmt::format("the run ended after {:.3g} s", end) : "";
}

const compare::ApparatusReport& report_of(const scenes::Scene& scene) {
  return compare::report_of(scene.geometry.apparatus);
}

/// Of a channel before whose end the front may stop.
std::optional<double> channel_length_mm(const scenes::Scene& scene) {
  const auto metres = report_of(scene).channel_length(scene);
  return metres ? std::optional(1e3 * *metres) : std::nullopt;
}

std::vector<Number> numbers_of(const SceneWanted& scene, const std::vector<Seen>& all) {
  std::vector<Number> numbers;
  for (const Published& published : scene.published)
    for (const Seen& fine : all) {
      if (fine.wanted->coarse || (published.model && *published.model != fine.wanted->model)) continue;
      Number n;
      n.published = published;
      n.solver = fine.wanted->solver;
      n.grain = compare::words::grain_of(scene.scene.gauges, scene.scene.main_gauge());
      n.model = fine.wanted->model;
      if (published.quantity == "front_mm") n.wall = channel_length_mm(scene.scene);
      const Seen* coarse = partner(all, fine, true);
      if (fine.view) {
        n.ours = compare::read(fine.view->run, published.quantity);
        n.doubt = fine.view->doubt;
        n.walls_differ = fine.view->walls_differ;
        n.verdict = fine.view->trouble.empty() ? Verdict::never : Verdict::incomplete;
        n.words = fine.view->trouble;
        if (const std::string early = ended_too_early(n, *fine.view); n.words.empty() && !early.empty()) {
          n.verdict = Verdict::incomplete;
          n.words = early;
        }
      }
      if (coarse && coarse->view) n.coarse = compare::read(coarse->view->run, published.quantity);
      if (n.ours && n.coarse)
        n.uncertainty =
            compare::grid_uncertainty(*n.ours, fine.wanted->cell, *n.coarse, coarse->wanted->cell);
      judge(n);
      numbers.push_back(std::move(n));
    }
  return numbers;
}

/// How a quantity changes over the last fifth of a run.
std::optional<compare::Trend> last_trend(const Series& series) {
  return compare::trend(series, series.time.front() + 0.8 * (series.end() - series.time.front()),
                        series.end());
}

/// The fluids of each solver at the time at which the solid rests, and later.
std::vector<Perpetual> perpetual_of(const std::vector<Seen>& all, const compare::Gauge& gauge) {
  std::vector<Perpetual> found;
  for (const Seen& fluid : all) {
    if (fluid.wanted->coarse || !fluid.view || !fluid.view->fluid || fluid.view->gauge.empty() ||
        !laws::creeps(fluid.wanted->model))
      continue;
    Perpetual p{.solver = fluid.wanted->solver, .fluid = fluid.wanted->model};
    for (const bool same_solver : {true, false})
      for (const Seen& solid : all)
        if (!p.rest && !solid.wanted->coarse && solid.view && !solid.view->fluid &&
            (solid.wanted->solver == fluid.wanted->solver) == same_solver)
          if (const auto rest = compare::read(solid.view->run, "rest_s")) {
            p.rest = rest;
            if (const auto value = solid.view->gauge_at(*rest)) p.solid = gauge.shown * *value;
          }
    const double end = fluid.view->gauge.end();
    p.from = p.rest.value_or(0.5 * end);
    std::vector<double> times;
    for (const double factor : {1.0, 2.0, 5.0})
      if (factor * p.from < 0.99 * end) times.push_back(factor * p.from);
    times.push_back(end);
    for (const double time : times)
      if (const auto value = fluid.view->gauge_at(time)) p.fluid_at.emplace_back(time, gauge.shown * *value);
    found.push_back(std::move(p));
  }
  return found;
}

std::vector<Flocculation> flocculation_of(const std::vector<Seen>& all) {
  std::vector<Flocculation> found;
  for (const Seen& seen : all) {
    if (seen.wanted->coarse || !seen.view) continue;
    const Series lambda = compare::column(seen.view->run, "flocculation_mean");
    if (lambda.empty()) continue;
    const auto least = std::min_element(lambda.value.begin(), lambda.value.end());
    Flocculation f{.solver = seen.wanted->solver, .model = seen.wanted->model};
    f.start = lambda.value.front();
    f.least = *least;
    f.least_at = lambda.time[static_cast<std::size_t>(least - lambda.value.begin())];
    f.end = lambda.value.back();
    f.end_at = lambda.end();
    if (const auto trend = last_trend(lambda)) f.rate_end = trend->slope;
    f.held = seen.view->held;
    f.growth_at_rest = compare::flocculation_at_rest(*seen.view);
    f.rises_only = !(f.start > 0.0);
    found.push_back(f);
  }
  return found;
}

report::Curve curve_of(const Series& series, double shown, double end, int entry, std::string name) {
  report::Curve curve{.name = std::move(name), .entry = entry};
  const double from = series.time.front(), to = std::min(series.end(), end);
  for (int i = 0; i <= samples; ++i) {
    // Dense early, where most happens.
    const double t = from + (to - from) * std::pow(static_cast<double>(i) / samples, 1.7);
    curve.x.push_back(t);
    curve.y.push_back(shown * series.at(t));
  }
  return curve;
}

report::Curve level(const std::string& name, double value, double end, int dash) {
  return {.name = name, .x = {0.0, end}, .y = {value, value}, .colour = -1, .dash = dash};
}

/// The published values of the quantity that a gauge ends at, as lines.
void add_published(report::Plot& plot, const SceneWanted& scene, const compare::Gauge& gauge, double end) {
  std::set<double> drawn;
  for (const Published& p : scene.published) {
    if (p.quantity != gauge.column) continue;
    const double unit = gauge.si * gauge.shown;
    if (p.measured && drawn.insert(*p.measured).second)
      plot.curves.push_back(level("measured", unit * *p.measured, end, 4));
    if (p.paper && drawn.insert(*p.paper).second)
      plot.curves.push_back(
          level(p.mark == Mark::exact ? "exact" : "the paper's own run", unit * *p.paper, end, 5));
  }
}

/// A gauge of every run against time.
std::optional<report::Plot> plot_of(const SceneWanted& scene, const std::vector<Seen>& all,
                                    const compare::Gauge& gauge, double end,
                                    std::vector<report::Entry>& entries) {
  report::Plot plot{.id = slug(scene.name) + "-" + slug(gauge.key),
                    .title = fmt::format("{}: {} against time", scene.name, gauge.name),
                    .caption = gauge.caption_for(scene.scene.gauges, scene.scene.main_gauge())};
  plot.x = {"time", "s", false, true};
  plot.y = {gauge.name, gauge.unit, false, true};
  bool moves = false;
  for (const Seen& seen : all) {
    if (seen.wanted->coarse || !seen.view) continue;
    const Series series = compare::column(seen.view->run, gauge.column, gauge.si);
    if (series.empty()) continue;
    report::Curve curve =
        curve_of(series, gauge.shown, end, entry_index(entries, *seen.wanted), curve_name(seen));
    moves = moves || std::any_of(curve.y.begin(), curve.y.end(), [](double y) { return y != 0.0; });
    if (seen.view->held && curve.x.back() < end) {
      // What is at rest stays as it is, but for its flocs, which go on growing by the law.
      const double growth =
          gauge.column == "flocculation_mean" ? compare::flocculation_at_rest(*seen.view) : 0.0;
      compare::carry_on(curve, growth, end);
    }
    plot.curves.push_back(std::move(curve));
  }
  if (!moves) return std::nullopt;
  // Where solids rest long before the fluids end, what happens is squeezed into a corner of a linear axis.
  constexpr double long_before = 8.0, first_shown = 0.05;
  for (const report::Curve& curve : plot.curves)
    if (curve.held_from && long_before * *curve.held_from < end) {
      plot.x.logarithmic = true;
      plot.x.from = first_shown;
    }
  add_published(plot, scene, gauge, end);
  return plot;
}

/// The level section, in which bars leave their streaks.
std::optional<report::Section> streaks_of(const SceneWanted& scene, const Comparison& comparison,
                                          const std::vector<Seen>& all, std::vector<report::Entry>& entries) {
  if (!report_of(scene.scene).seen_from_above() || !scene.scene.thixotropy) return std::nullopt;
  for (report::Section& section : compare::fields::sections_of(comparison, section_times, section_bytes)) {
    if (section.id != "level-sections") continue;
    std::erase_if(section.panels, [&](report::Section::Panel& panel) {
      const RunView* view = &comparison.runs[static_cast<std::size_t>(panel.entry)];
      const auto seen = std::find_if(all.begin(), all.end(),
                                     [&](const Seen& s) { return s.view == view && !s.wanted->coarse; });
      if (seen == all.end()) return true;
      panel.entry = entry_index(entries, *seen->wanted);
      return false;
    });
    section.id = slug(scene.name) + "-streaks";
    section.title = scene.name + ": " + section.title;
    section.clock = section.id;
    if (!section.panels.empty()) return section;
  }
  return std::nullopt;
}

std::vector<report::Block> figures_of(const SceneWanted& scene, const Comparison& comparison,
                                      const std::vector<Seen>& all, std::vector<report::Entry>& entries) {
  std::vector<report::Block> figures;
  double end = 0.0;
  for (const Seen& seen : all)
    if (!seen.wanted->coarse && seen.view && !seen.view->gauge.empty())
      end = std::max(end, seen.view->gauge.end());
  std::vector<compare::Gauge> gauges = {report_of(scene.scene).gauge()};
  for (const compare::Gauge& gauge : report_of(scene.scene).further_gauges()) {
    if (gauge.key != "height" && gauge.key != "start_height") gauges.push_back(gauge);
  }
  for (const compare::Gauge& gauge : gauges)
    if (auto plot = plot_of(scene, all, gauge, end, entries)) figures.emplace_back(std::move(*plot));
  if (auto section = streaks_of(scene, comparison, all, entries)) figures.emplace_back(std::move(*section));
  return figures;
}

Found found_run(const Folder& folder, const Seen& seen, const compare::Gauge& gauge) {
  Found found{*seen.wanted, outcome_of(folder, seen.wanted->point)};
  found.label = fmt::format("{}, {:.4g} mm cells", seen.wanted->label(), 1e3 * seen.wanted->cell);
  if (!seen.view) return found;
  const RunView& view = *seen.view;
  found.trouble = view.trouble;
  found.doubt = view.doubt;
  found.walls_differ = view.walls_differ;
  found.rest = compare::read(view.run, "rest_s");
  found.end = view.measures.end;
  if (view.measures.gauge_end) found.gauge_end = gauge.shown * *view.measures.gauge_end;
  found.arrival = compare::read(view.run, "arrival_s");
  if (report_of(*seen.wanted->point.scene).grows()) {
    const Series series = compare::column(view.run, found.arrival ? "end_height_mm" : gauge.column,
                                          found.arrival ? 1.0 : 1e3 * gauge.si);
    if (!series.empty())
      if (const auto trend = last_trend(series)) found.creep = trend->slope;
  }
  found.cpu = view.measures.cpu.value_or(0.0);
  found.version = compare::word(view.run.info, "/provenance/git_hash");
  return found;
}

std::vector<std::string> notes_of(const SceneFound& scene, const std::string& left_out) {
  std::vector<std::string> notes;
  std::map<std::string, std::vector<std::string>> walls;
  for (const Found& found : scene.runs) {
    if (!found.walls_differ.empty() && !found.wanted.coarse)
      walls[found.walls_differ].push_back(found.wanted.label());
    if (found.doubt.any())
      notes.push_back(fmt::format("{} is {}: {}.", found.label, found.doubt.word(), found.doubt.why));
    if (!found.trouble.empty()) notes.push_back(fmt::format("{}: {}.", found.label, found.trouble));
    const bool without_data = found.outcome.ending == Ending::refused ||
                              found.outcome.ending == Ending::crashed ||
                              found.outcome.ending == Ending::too_long;
    if (without_data)
      notes.push_back(
          fmt::format("{}: {}: {}", found.label, to_string(found.outcome.ending), found.outcome.reason));
  }
  for (const auto& [difference, labels] : walls)
    notes.push_back(fmt::format("Walls of {} differ from the scene's: {}{}", compare::words::listed(labels),
                                difference, difference.ends_with('.') ? "" : "."));
  if (!left_out.empty()) notes.push_back(left_out);
  return notes;
}

/// The command that makes a scene's runs.
std::string command_for(const std::string& scene, const Options& options) {
  std::vector<std::string> arguments = {"validate",
                                        scenes::is_path(scene) ? runs::path_argument(scene) : scene, "-o",
                                        runs::path_argument(options.folder.lexically_normal())};
  const auto add = [&arguments](const std::string& option, const std::string& value) {
    arguments.insert(arguments.end(), {option, value});
  };
  if (options.solver) add("--solver", to_string(*options.solver));
  if (options.model) add("--model", scenes::to_string(*options.model));
  for (const std::string& s : options.set) add("--set", s);
  if (options.coarsening != Options().coarsening) add("--coarsening", fmt::format("{}", options.coarsening));
  if (options.any_version) arguments.emplace_back("--any-version");
  return runs::command_line(arguments);
}

SceneFound collect_scene(const Folder& folder, const SceneWanted& wanted, const Options& options,
                         std::vector<report::Entry>& entries) {
  const compare::Gauge& gauge = report_of(wanted.scene).gauge();
  SceneFound scene{.name = wanted.name,
                   .title = wanted.scene.title,
                   .apparatus = &report_of(wanted.scene),
                   .gauges = wanted.scene.gauges,
                   .length_mm = channel_length_mm(wanted.scene)};
  std::vector<fs::path> directories;
  for (const Wanted& run : wanted.runs) {
    entry_index(entries, run);
    if (fs::exists(folder.run(run.point.id) / "run.json")) directories.push_back(folder.run(run.point.id));
  }
  Comparison comparison;
  if (!directories.empty()) comparison = compare::compare_runs(directories);
  std::vector<Seen> all;
  for (const Wanted& run : wanted.runs) {
    Seen seen{&run};
    for (const RunView& view : comparison.runs)
      if (view.run.directory == folder.run(run.point.id)) seen.view = &view;
    all.push_back(seen);
  }
  std::vector<std::string> missing;
  for (const Seen& seen : all) {
    scene.runs.push_back(found_run(folder, seen, gauge));
    if (scene.runs.back().outcome.ending == Ending::missing) missing.push_back(scene.runs.back().label);
  }
  if (!missing.empty()) scene.how_to_make = command_for(wanted.name, options);
  scene.numbers = numbers_of(wanted, all);
  scene.perpetual = perpetual_of(all, gauge);
  scene.flocculation = flocculation_of(all);
  scene.figures = figures_of(wanted, comparison, all, entries);
  scene.notes = scenes::plausibility_notes(wanted.scene);
  for (std::string& note : notes_of(scene, wanted.left_out)) scene.notes.push_back(std::move(note));
  if (!missing.empty())
    scene.notes.push_back(fmt::format("Not made, or not to the end: {}. Make what is missing: `{}`",
                                      compare::words::listed(missing), scene.how_to_make));
  return scene;
}

}  // namespace

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::agrees:
      return "agrees";
    case Verdict::misses:
      return "misses";
    case Verdict::unresolved:
      return "unresolved";
    case Verdict::never:
      return "never happens";
    case Verdict::incomplete:
      return "incomplete";
    case Verdict::not_run:
      return "not run";
    case Verdict::not_comparable:
      return "not comparable";
  }
  throw std::logic_error("a verdict without a name");
}

std::optional<double> Perpetual::change() const {
  if (fluid_at.size() < 2) return std::nullopt;
  return fluid_at.back().second - fluid_at.front().second;
}

std::optional<double> Number::difference() const {
  const auto target = published.target();
  return ours && target ? std::optional(*ours - *target) : std::nullopt;
}

void judge(Number& n) {
  const std::string unit = compare::reading_named(n.published.quantity).unit;
  const auto amount = [&](double value) {
    return fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
  };
  const bool fluid = !laws::can_rest(n.model);
  if (!n.ours) {
    // `never` and `incomplete` are set by whoever read the run.
    if (n.verdict == Verdict::incomplete)
      n.words = "incomplete: " + n.words;
    else if (n.verdict == Verdict::never && fluid && n.published.quantity == "rest_s") {
      n.verdict = Verdict::not_comparable;
      n.words = "a fluid never rests";
    } else
      n.words = n.verdict == Verdict::never ? "never happens" : "not run";
    return;
  }
  const auto difference = n.difference();
  if (!difference) {
    n.verdict = Verdict::not_comparable;
    n.words = "nothing to compare with";
    return;
  }
  const double at_the_wall = n.wall.value_or(0.0) / 1200.0;  // mm: half a millimetre of an L-box's channel
  if (n.wall && *n.ours > *n.wall - at_the_wall && *n.published.target() < *n.wall - at_the_wall) {
    n.verdict = Verdict::misses;
    n.within = false;
    n.words = fmt::format("misses: it reaches the wall at {}, before which it should stop", amount(*n.wall));
    return;
  }
  const double miss = std::abs(*difference), allowed = n.published.allowed;
  n.within = miss <= allowed;
  // What is not known as well as is allowed can miss, where not even its uncertainty reaches what is allowed;
  // it cannot agree.
  const bool known = n.uncertainty && *n.uncertainty <= allowed;
  const bool out_of_reach = n.uncertainty && miss > allowed + *n.uncertainty;
  if (!*n.within && (known || out_of_reach)) {
    n.verdict = Verdict::misses;
    n.words = fmt::format("misses by {}, {} are allowed", amount(miss), amount(allowed));
    return;
  }
  if (!known) {
    n.verdict = Verdict::unresolved;
    n.words = fmt::format("unresolved: {}, {}",
                          *n.within ? fmt::format("within the {} allowed", amount(allowed))
                                    : fmt::format("{} off, {} are allowed", amount(miss), amount(allowed)),
                          n.uncertainty ? fmt::format("but known to ± {} only", amount(*n.uncertainty))
                          : n.coarse    ? "but of unknown uncertainty"
                                        : "but only one resolution has it");
    return;
  }
  n.verdict = Verdict::agrees;
  n.words = n.published.mark == Mark::circular
                ? "agrees, but the scene's yield stress was computed back from it"
            : n.published.mark == Mark::calibrated ? "agrees, but the paper fitted a parameter to it"
                                                   : "agrees";
}

Validation collect(const Folder& folder, const std::vector<SceneWanted>& wanted, const Options& options) {
  Validation validation;
  validation.items = read_paper_items();
  for (const SceneWanted& scene : wanted)
    validation.scenes.push_back(collect_scene(folder, scene, options, validation.entries));
  validation.findings = findings_of(validation.scenes);
  return validation;
}

}  // namespace flowrest::studies::validation
