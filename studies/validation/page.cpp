#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/measures/gauges.h"
#include "compare/words.h"
#include "runs/run_directory.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

using compare::words::listed;
using compare::words::reading;
using report::Column;
using report::Format;
using report::Table;
using report::Text;

constexpr std::size_t told_at_most = 6;  ///< of a list in a sentence

std::string who(Solver solver, scenes::Model model) {
  return fmt::format("{} {}", solver == Solver::mpm ? "MPM" : "OpenFOAM", scenes::to_string(model));
}
std::string who(const Number& n) { return who(n.solver, n.model); }

std::string unit_of(const Number& n) { return compare::reading_named(n.published.quantity).unit; }

bool is_solid(const Number& n) { return n.model == scenes::Model::elasto_viscoplastic; }

/// "a, b, c and 4 more".
std::string some_of(std::vector<std::string> items, const std::string& separator,
                    std::size_t most = told_at_most) {
  const std::size_t more = items.size() > most ? items.size() - most : 0;
  items.resize(items.size() - more);
  if (more == 0) return listed(items, separator);
  return fmt::format("{}{}and {} more", fmt::join(items, separator), separator, more);
}

Table::Cell cell(const std::optional<double>& value) { return value ? Table::Cell(*value) : Table::Cell(); }

/// A cell that is not broken between a number and its unit.
std::string unbroken(const std::string& text) {
  std::string whole;
  for (const char c : text) whole += c == ' ' ? std::string("\u00a0") : std::string(1, c);
  return whole;
}

/// A value as its uncertainty has it, for a column of several units.
Table::Cell worded(const std::optional<double>& value, const std::optional<double>& uncertainty,
                   const std::string& unit) {
  return value ? Table::Cell(unbroken(reading(*value, uncertainty, unit))) : Table::Cell();
}

std::string plain(double value, const std::string& unit) {
  return unbroken(fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", unit));
}

class ValidationPage {
 public:
  explicit ValidationPage(const Validation& validation) : validation_(validation) {}

  report::Page page() {
    page_.kind = "validation";
    page_.title = validation_.scenes.size() == 1 ? validation_.scenes.front().title : "The papers' scenes";
    page_.entries = validation_.entries;
    page_.data = to_json(validation_);
    page_.provenance = runs::provenance();
    write_words();
    page_.figure = parity("lengths", "mm", "ours against published lengths");
    page_.chapters.push_back(numbers_chapter());
    if (auto chapter = perpetual_chapter(); !chapter.blocks.empty())
      page_.chapters.push_back(std::move(chapter));
    if (auto chapter = flocculation_chapter(); !chapter.blocks.empty())
      page_.chapters.push_back(std::move(chapter));

    page_.chapters.push_back({"scenes", "Scene by scene", {}});
    for (const SceneFound& scene : validation_.scenes) page_.chapters.push_back(scene_chapter(scene));
    page_.chapters.push_back(papers_chapter());
    page_.chapters.push_back(runs_chapter());
    return std::move(page_);
  }

 private:
  int entry_of(const std::string& label) const {
    for (std::size_t i = 0; i < validation_.entries.size(); ++i)
      if (validation_.entries[i].name == label) return static_cast<int>(i);
    return -1;
  }

  std::vector<const Number*> numbers() const {
    std::vector<const Number*> all;
    for (const SceneFound& scene : validation_.scenes)
      for (const Number& n : scene.numbers) all.push_back(&n);
    return all;
  }

  /// How many of its numbers a solver and law meets, and how many of them are evidence.
  std::string tally(const std::string& label) const {
    std::map<Verdict, int> counts;
    int judged = 0, dependent = 0;
    for (const Number* n : numbers()) {
      if (who(*n) != label || n->verdict == Verdict::not_comparable) continue;
      ++judged;
      ++counts[n->verdict];
      if (n->verdict == Verdict::agrees &&
          (n->published.mark == Mark::calibrated || n->published.mark == Mark::circular))
        ++dependent;
    }
    if (judged == 0) return "";
    std::vector<std::string> rest;
    const std::pair<Verdict, const char*> others[] = {{Verdict::misses, "missed"},
                                                      {Verdict::unresolved, "unresolved by these grids"},
                                                      {Verdict::never, "not reached"},
                                                      {Verdict::incomplete, "incomplete"},
                                                      {Verdict::not_run, "not run"}};
    for (const auto& [verdict, name] : others)
      if (counts[verdict] > 0) rest.push_back(fmt::format("{} {}", counts[verdict], name));
    return fmt::format(
        "{} meets {} of {} published numbers{}{}", label, counts[Verdict::agrees], judged,
        dependent > 0 ? fmt::format(" ({} of them calibrated or circular, so no evidence)", dependent) : "",
        rest.empty() ? "" : "; " + listed(rest));
  }

  /// What carries a warning: how many runs are noisy, came to no end, or are missing.
  std::string warnings() const {
    std::vector<std::string> noisy, failed;
    std::size_t missing = 0;
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs) {
        const auto note = [&](std::vector<std::string>& names) {
          if (names.empty() || names.back() != scene.name) names.push_back(scene.name);
        };
        if (!run.noise.empty()) note(noisy);
        if (run.outcome.ending == Ending::missing)
          ++missing;
        else if (run.outcome.ending != Ending::finished)
          note(failed);
      }
    std::string text;
    if (!noisy.empty()) text += "; noisy runs of " + some_of(noisy, ", ", 3);
    if (!failed.empty()) text += "; runs without a result of " + some_of(failed, ", ", 3);
    if (missing > 0) text += fmt::format("; {} run{} missing", missing, missing == 1 ? " is" : "s are");
    return text;
  }

  void write_words() {
    std::string opening, more;
    for (const report::Entry& entry : validation_.entries) {
      const std::string text = tally(entry.name);
      if (text.empty()) continue;
      if (opening.empty())
        opening = text;
      else
        more += (more.empty() ? "" : "\n") + text + ".";
    }
    if (opening.empty()) opening = "Nothing published is known of these scenes";
    page_.words.push_back(Text{opening + warnings() + ".", Text::Style::opening});
    const auto answer = [&](const char* question, const std::string& text) {
      if (!text.empty()) page_.words.push_back(report::Answer{question, text});
    };
    answer("And the other solvers and laws?", more);
    answer("Which numbers are missed by the material that stops?", misses());
    answer("When does each model stop?", stops());
    answer("What would an arbitrary stopping time have changed?", arbitrary_stops());
    answer("Which difference is physics, which numerics?", physics_and_numerics());
    answer("What did it cost?", cost());
  }

  std::string misses() const {
    std::vector<std::string> items;
    for (const Number* n : numbers())
      if (is_solid(*n) && (n->verdict == Verdict::misses || n->verdict == Verdict::never))
        items.push_back(fmt::format("{} ({}, {}): {}", n->published.scene,
                                    compare::reading_named(n->published.quantity).name,
                                    n->solver == Solver::mpm ? "MPM" : "OpenFOAM", n->words));
    return items.empty() ? "" : some_of(items, "; ") + ".";
  }

  std::string stops() const {
    std::vector<double> rests;
    int solids = 0, fluids = 0, restless = 0;
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs) {
        if (run.wanted.coarse || run.outcome.ending != Ending::finished) continue;
        const bool solid = run.wanted.model == scenes::Model::elasto_viscoplastic;
        (solid ? solids : fluids)++;
        if (!solid) continue;
        if (run.rest)
          rests.push_back(*run.rest);
        else
          ++restless;
      }
    std::string text;
    if (!rests.empty()) {
      const auto [first, last] = std::minmax_element(rests.begin(), rests.end());
      text = fmt::format("{} of {} elasto-viscoplastic runs come to rest, {}.", rests.size(), solids,
                         *first == *last ? "after " + compare::words::time(*first)
                                         : fmt::format("between {} and {}", compare::words::time(*first),
                                                       compare::words::time(*last)));
    } else if (solids > 0) {
      text = "No elasto-viscoplastic run comes to rest before its end.";
    }
    if (restless > 0 && !rests.empty())
      text += fmt::format(" {} {} still moving at {} end.", restless, restless == 1 ? "is" : "are",
                          restless == 1 ? "its" : "their");
    if (fluids > 0)
      text += fmt::format(
          "{}{}", text.empty() ? "" : " ",
          fluids == 1 ? "The fluid never does." : fmt::format("The {} fluid runs never do.", fluids));
    return text;
  }

  /// The change of a fluid's gauge after the solid has come to rest; none where there is no such time.
  static std::optional<double> drift(const Perpetual& p) {
    if (!p.rest || p.fluid_at.size() < 2) return std::nullopt;
    return p.fluid_at.back().second - p.fluid_at.front().second;
  }

  std::string arbitrary_stops() const {
    struct Drift {
      double value = 0.0;
      std::string words;
    };
    std::map<std::string, std::vector<Drift>> by_unit;
    for (const SceneFound& scene : validation_.scenes)
      for (const Perpetual& p : scene.perpetual)
        if (const auto change = drift(p)) {
          const auto& gauge = compare::gauge_of(scene.kind);
          by_unit[gauge.unit].push_back(
              {*change, fmt::format("{:.{}f} {} in {} ({}, from {} to {})", *change,
                                    std::abs(*change) < 10.0 ? 1 : 0, gauge.unit, scene.name,
                                    who(p.solver, p.fluid), compare::words::time(p.fluid_at.front().first),
                                    compare::words::time(p.fluid_at.back().first))});
        }
    std::string text;
    for (auto& [unit, drifts] : by_unit) {
      std::sort(drifts.begin(), drifts.end(),
                [](const Drift& a, const Drift& b) { return std::abs(a.value) < std::abs(b.value); });
      text += fmt::format(
          "{}Between the time at which the solid rests and their own end the fluids flow on by {}{}.",
          text.empty() ? "" : " ", drifts.front().words,
          drifts.size() > 1 ? " to " + drifts.back().words : "");
    }
    return text;
  }

  /// Differences between laws in one solver, between solvers of one law, and between two grids of one run.
  std::string physics_and_numerics() const {
    std::vector<double> law, solver, grid;
    for (const SceneFound& scene : validation_.scenes) {
      if (!compare::grows_to_rest(scene.kind)) continue;
      const auto of = [&](const Found& a, auto same) -> std::optional<double> {
        for (const Found& b : scene.runs)
          if (&a != &b && a.gauge_end && b.gauge_end && same(a.wanted, b.wanted))
            return std::abs(*a.gauge_end - *b.gauge_end);
        return std::nullopt;
      };
      for (const Found& run : scene.runs) {
        if (run.wanted.coarse || run.outcome.ending != Ending::finished) continue;
        const auto fine = [](const Wanted& w) { return !w.coarse; };
        const bool solid = run.wanted.model == scenes::Model::elasto_viscoplastic;
        if (!solid)
          if (const auto d = of(run, [&](const Wanted& a, const Wanted& b) {
                return fine(b) && a.solver == b.solver && b.model == scenes::Model::elasto_viscoplastic;
              }))
            law.push_back(*d);
        if (run.wanted.solver == Solver::foam)
          if (const auto d = of(run, [&](const Wanted& a, const Wanted& b) {
                return fine(b) && b.solver == Solver::mpm && a.model == b.model;
              }))
            solver.push_back(*d);
        if (const auto d = of(run, [&](const Wanted& a, const Wanted& b) {
              return b.coarse && a.solver == b.solver && a.model == b.model;
            }))
          grid.push_back(*d);
      }
    }
    std::vector<std::string> parts;
    const auto add = [&](const char* what, std::vector<double>& values) {
      if (values.empty()) return;
      std::sort(values.begin(), values.end());
      parts.push_back(
          values.front() == values.back() || values.size() == 2
              ? fmt::format("{} by {:.0f} mm{}", what, values.back(), values.size() > 1 ? " at most" : "")
              : fmt::format("{} by {:.0f} mm in the middle and {:.0f} mm at most", what,
                            values[values.size() / 2], values.back()));
    };
    add("another law (physics) moves the end of a spread or front", law);
    add("another solver (discretisation)", solver);
    add("another grid (numerics)", grid);
    if (parts.empty()) return "";
    std::string text = listed(parts, "; ") + ".";
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
  }

  std::string cost() const {
    std::map<std::string, double> by_solver;
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs)
        by_solver[run.wanted.solver == Solver::mpm ? "MPM" : "OpenFOAM"] += run.cpu;
    std::vector<std::string> parts;
    for (const auto& [solver, cpu] : by_solver)
      if (cpu > 0.0) parts.push_back(fmt::format("{} {}", solver, compare::words::duration(cpu)));
    return parts.empty() ? "" : fmt::format("CPU time of all runs: {}.", listed(parts));
  }

  /// Ours against the target, of all numbers of one unit; what agrees lies on the line.
  std::optional<report::Block> parity(const std::string& id, const std::string& unit,
                                      const std::string& title) const {
    report::Plot plot{.id = id, .title = title};
    plot.caption =
        "Each point a published number: measured where there is a measurement, else the paper's own "
        "simulation. On the "
        "line ours is equal to it; bars show how well two grids know ours.";
    plot.x = {"published", unit};
    plot.y = {"ours", unit};
    double low = std::numeric_limits<double>::infinity(), high = 0.0;
    for (std::size_t e = 0; e < validation_.entries.size(); ++e) {
      report::Curve curve{.entry = static_cast<int>(e), .line = false, .marks = true};
      for (const Number* n : numbers()) {
        if (!n->ours || !n->published.target() || unit_of(*n) != unit ||
            entry_of(who(*n)) != static_cast<int>(e))
          continue;
        const double target = *n->published.target(), pm = n->uncertainty.value_or(0.0);
        curve.x.push_back(target);
        curve.y.push_back(*n->ours);
        curve.low.push_back(*n->ours - pm);
        curve.high.push_back(*n->ours + pm);
        curve.hover.push_back(fmt::format("{}\n{}\n{}", n->published.scene,
                                          compare::reading_named(n->published.quantity).name, n->words));
        low = std::min({low, target, *n->ours});
        high = std::max({high, target, *n->ours});
      }
      if (!curve.x.empty()) plot.curves.push_back(std::move(curve));
    }
    if (plot.curves.empty()) return std::nullopt;
    report::Curve equal{
        .name = "equal", .x = {0.95 * low, 1.05 * high}, .y = {0.95 * low, 1.05 * high}, .colour = -1};
    equal.hover = {"", ""};
    plot.curves.push_back(std::move(equal));
    return plot;
  }

  static Table numbers_table(const std::string& id, const std::string& title) {
    Table table{.id = id, .title = title};
    table.columns = {{"Scene", "", {}, true},
                     {"What", "", {}, true},
                     {"Solver and law", "", {}, true},
                     {"Measured", "", {}, false, "measured"},
                     {"The paper's own", "", {}, false, "paper"},
                     {"Ours", "", {}, false, "ours"},
                     {"Difference", "", {}, false, "difference"},
                     {"Verdict", "", {}, true},
                     {"Evidence", "", {}, true},
                     {"Grids differ by", "", {}, false, "grids_differ_by"},
                     {"Allowed", "", {}, false, "allowed"},
                     {"Source", "", {}, true}};
    return table;
  }

  Table::Row row_of(const Number& n) const {
    const Published& p = n.published;
    const std::string unit = unit_of(n);
    const auto known = [&](const std::optional<double>& value) {
      return value ? Table::Cell(plain(*value, unit)) : Table::Cell();
    };
    const auto difference = n.difference();
    Table::Cell apart;
    if (difference)
      apart = unbroken(fmt::format("{}{}",
                                   *difference > 0.0   ? "+"
                                   : *difference < 0.0 ? "−"
                                                       : "",
                                   reading(std::abs(*difference), n.uncertainty, unit)));
    std::string grids;
    if (n.ours && n.coarse) {
      const double apart_by = std::abs(*n.ours - *n.coarse);
      grids = unit == "mm" ? unbroken(fmt::format("{:.0f} mm", apart_by)) : plain(apart_by, unit);
    }
    Table::Row row{{p.scene, compare::reading_named(p.quantity).name, who(n), known(p.measured),
                    known(p.paper), worded(n.ours, n.uncertainty, unit), apart, n.words, to_string(p.mark),
                    grids, plain(p.allowed, unit), p.source},
                   entry_of(who(n))};
    std::string badge =
        n.verdict == Verdict::agrees || n.verdict == Verdict::not_comparable ? "" : to_string(n.verdict);
    if (!n.noise.empty()) badge += badge.empty() ? "noisy" : ", noisy";
    row.badge = badge;
    return row;
  }

  report::Chapter numbers_chapter() const {
    report::Chapter chapter{"numbers", "Published numbers", {}};
    Table table = numbers_table("published", "published numbers and ours");
    table.caption =
        "Ours is at the scene's resolution; what stands after ± is the difference to the second resolution, "
        "taken on to "
        "zero cell size at first order. A number agrees where it is known better than what is allowed and "
        "lies within it. "
        "Calibrated: the paper fitted a parameter of the scene to this very number. Circular: a parameter "
        "was computed "
        "back from it. Neither is evidence for the model.";
    for (const Number* n : numbers()) table.rows.push_back(row_of(*n));
    if (table.rows.empty())
      chapter.blocks.push_back(Text{"Nothing published is known of these scenes."});
    else
      chapter.blocks.push_back(std::move(table));
    if (auto times = parity("times", "s", "ours against published times"))
      chapter.blocks.push_back(std::move(*times));
    return chapter;
  }

  report::Chapter perpetual_chapter() const {
    report::Chapter chapter{"perpetual", "What the fluid's perpetual flow makes of each scene", {}};
    Table table{.id = "perpetual-flow", .title = "the fluid when the solid rests, and later"};
    table.caption =
        "A regularised fluid never stops: whoever reads it picks a time. Here it is read when the "
        "elasto-viscoplastic run "
        "of the same solver (else of the other) comes to rest, at two and five times that, and at its end. "
        "The last "
        "column is what another choice of that time would have changed; digits beyond the ± of the published "
        "numbers "
        "are for that change within one run only.";
    table.columns = {{"Scene", "", {}, true},
                     {"Fluid", "", {}, true},
                     {"Gauge", "", {}, true},
                     {"Solid rests", "s", {Format::Kind::significant, 3}},
                     {"Solid, at rest", ""},
                     {"Fluid then", ""},
                     {"at twice that", ""},
                     {"at five times", ""},
                     {"Fluid's end", "s", {Format::Kind::significant, 3}},
                     {"Fluid, at its end", ""},
                     {"Change", ""}};
    for (const SceneFound& scene : validation_.scenes) {
      const compare::Gauge& gauge = compare::gauge_of(scene.kind);
      const auto value = [&](const std::optional<double>& v) {
        return v ? Table::Cell(
                       unbroken(fmt::format("{:.{}f} {}", *v, gauge.unit == "m/s" ? 4 : 1, gauge.unit)))
                 : Table::Cell();
      };
      for (const Perpetual& p : scene.perpetual) {
        if (p.fluid_at.empty()) continue;
        const auto at = [&](double factor) -> std::optional<double> {
          for (const auto& [time, v] : p.fluid_at)
            if (p.rest && std::abs(time - factor * *p.rest) < 1e-9) return v;
          return std::nullopt;
        };
        table.rows.push_back({{scene.name, who(p.solver, p.fluid), gauge.name, cell(p.rest), value(p.solid),
                               value(at(1.0)), value(at(2.0)), value(at(5.0)), p.fluid_at.back().first,
                               value(p.fluid_at.back().second), value(drift(p))},
                              entry_of(who(p.solver, p.fluid)),
                              p.rest ? "" : "the solid does not rest"});
      }
    }
    if (!table.rows.empty()) chapter.blocks.push_back(std::move(table));
    return chapter;
  }

  report::Chapter flocculation_chapter() const {
    report::Chapter chapter{"flocculation", "How the flocs break and grow", {}};
    Table table{.id = "flocculation-states", .title = "mean flocculation state λ"};
    table.caption =
        "λ falls while flow breaks the flocs. Where nothing shears the concrete it grows by A/τ0 a second; "
        "an "
        "elasto-viscoplastic run that has come to rest goes on so from its end.";
    table.columns = {{"Scene", "", {}, true},
                     {"Solver and law", "", {}, true},
                     {"At the start", "", {Format::Kind::fixed, 2}},
                     {"Least", "", {Format::Kind::fixed, 2}},
                     {"Least at", "s", {Format::Kind::significant, 3}},
                     {"At the end", "", {Format::Kind::fixed, 2}},
                     {"End", "s", {Format::Kind::significant, 3}},
                     {"In words", "", {}, true}};
    for (const SceneFound& scene : validation_.scenes)
      for (const Flocculation& f : scene.flocculation) {
        if (!(f.start > 0.0)) continue;
        const double noticeable = 1e-3 * f.start;
        const bool falls = f.least<f.start - noticeable, grows = f.end> f.least + noticeable;
        std::string words = falls ? "falls while it flows" : "does not fall";
        if (f.held)
          words += fmt::format("; at rest it recovers by {:.2g} a second", f.growth_at_rest);
        else
          words += grows ? fmt::format("; grows again, by {:.2g} of the {:.2g} a second it has at rest",
                                       (f.end - f.least) / (f.end_at - f.least_at), f.growth_at_rest)
                         : "; still falling at the end";
        table.rows.push_back(
            {{scene.name, f.label, f.start, f.least, f.least_at, f.end, f.end_at, words}, entry_of(f.label)});
      }
    if (!table.rows.empty()) chapter.blocks.push_back(std::move(table));
    return chapter;
  }

  /// Which figure and table of the papers is reproduced by which scene.
  report::Chapter papers_chapter() const {
    report::Chapter chapter{"papers", "The papers' figures and tables", {}};
    Table table{.id = "papers-items", .title = "figures and tables, and the scenes that reproduce them"};
    table.caption =
        "Yu: J. Yu et al. 2026, elasto-viscoplastic and thixotropic. Zhang: Zhang et al. 2026, appendix B.";
    table.columns = {{"Of the papers", "", {}, true},
                     {"Scene", "", {}, true},
                     {"What", "", {}, true},
                     {"Here", "", {}, true}};
    for (const PaperItem& item : validation_.items) {
      std::string here = fmt::format("not among these scenes: flowrest validate {}", item.scene);
      for (const SceneFound& scene : validation_.scenes) {
        if (scene.name != item.scene) continue;
        const auto done = std::count_if(scene.runs.begin(), scene.runs.end(), [](const Found& run) {
          return run.outcome.ending == Ending::finished;
        });
        here = fmt::format("{} of {} runs", done, scene.runs.size());
      }
      table.rows.push_back({{item.paper + " " + item.item, item.scene, item.what, here}});
    }
    chapter.blocks.push_back(std::move(table));
    return chapter;
  }

  report::Chapter scene_chapter(const SceneFound& scene) const {
    std::string id = "scene-" + scene.name;
    for (char& c : id)
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '-';
    report::Chapter chapter{id, fmt::format("{} ({})", scene.title, scene.name), {}, 3};
    for (const std::string& note : scene.notes) chapter.blocks.push_back(Text{note, Text::Style::warning});
    for (const Number& n : scene.numbers)
      if (n.ours)
        chapter.blocks.push_back(Text{
            fmt::format("{}: {} {}{}; {}.", who(n), compare::reading_named(n.published.quantity).name,
                        reading(*n.ours, n.uncertainty, unit_of(n)),
                        n.published.target() ? fmt::format(", {} {}",
                                                           n.published.measured              ? "measured"
                                                           : n.published.mark == Mark::exact ? "exact"
                                                                                             : "in the paper",
                                                           plain(*n.published.target(), unit_of(n)))
                                             : "",
                        n.words),
            Text::Style::small});
    for (const report::Block& figure : scene.figures) chapter.blocks.push_back(figure);
    return chapter;
  }

  report::Chapter runs_chapter() const {
    report::Chapter chapter{"runs", "Runs, their ends and their cost", {}};
    Table table{.id = "all-runs", .title = "every run"};
    table.columns = {{"Scene", "", {}, true},
                     {"Run", "", {}, true},
                     {"Ending", "", {}, true},
                     {"Rest", "s", {Format::Kind::significant, 3}},
                     {"Recorded until", "s", {Format::Kind::significant, 3}},
                     {"CPU time", "s", {Format::Kind::significant, 3}},
                     {"Made by", "", {}, true},
                     {"Folder", "", {}, true}};
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs) {
        std::string ending = to_string(run.outcome.ending);
        if (!run.outcome.reason.empty()) ending += ": " + run.outcome.reason;
        const bool whole = run.outcome.ending == Ending::finished;
        table.rows.push_back({{scene.name, run.label, ending, cell(run.rest), cell(run.end),
                               run.cpu > 0.0 ? Table::Cell(run.cpu) : Table::Cell(),
                               run.version.substr(0, 12), "runs/" + run.wanted.point.id},
                              entry_of(run.wanted.label()),
                              !whole              ? to_string(run.outcome.ending)
                              : run.noise.empty() ? ""
                                                  : "noisy"});
      }
    chapter.blocks.push_back(std::move(table));
    chapter.blocks.push_back(
        Text{"Profiles, sections and the difference between the runs of one scene are shown by `flowrest "
             "compare RUN...` "
             "of their folders.",
             Text::Style::small});
    return chapter;
  }

  const Validation& validation_;
  report::Page page_;
};

}  // namespace

report::Page page_of(const Validation& validation) { return ValidationPage(validation).page(); }

}  // namespace flowrest::studies::validation
