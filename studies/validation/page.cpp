#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/measures/gauges.h"
#include "compare/words.h"
#include "runs/command.h"
#include "runs/run_directory.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

using compare::words::listed;
using compare::words::reading;
using report::Format;
using report::Table;
using report::Text;

constexpr std::size_t told_at_most = 6;  ///< of a list in a sentence

std::string who(Solver solver, scenes::Model model) {
  return fmt::format("{} {}", solver == Solver::mpm ? "MPM" : "OpenFOAM", scenes::to_string(model));
}
std::string who(const Number& n) { return who(n.solver, n.model); }

std::string unit_of(const Number& n) { return compare::reading_named(n.published.quantity).unit; }

bool is_solid(const Number& n) { return laws::can_rest(n.model); }

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

std::string plain(double value, const std::string& unit) {
  return unbroken(fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", unit));
}

/// A value as its uncertainty has it, for a column of several units; four digits are enough.
Table::Cell worded(const std::optional<double>& value, const std::optional<double>& uncertainty,
                   const std::string& unit, const compare::words::Grain& grain) {
  constexpr double finest = 5e-4;
  if (!value) return {};
  if (uncertainty && *uncertainty < finest * std::abs(*value)) return plain(*value, unit);
  return unbroken(reading(*value, uncertainty, unit, grain));
}

/// The verdict in a word or two: what is not known well enough says on which side of the allowed ours lies.
std::string short_verdict(const Number& n) {
  if (n.verdict != Verdict::unresolved || !n.within) return to_string(n.verdict);
  return *n.within ? "unresolved, within" : "unresolved, off";
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
    if (auto chapter = findings_chapter(); !chapter.blocks.empty())
      page_.chapters.push_back(std::move(chapter));
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
    int judged = 0, dependent = 0, within = 0;
    for (const Number* n : numbers()) {
      if (who(*n) != label || n->verdict == Verdict::not_comparable) continue;
      ++judged;
      ++counts[n->verdict];
      within += n->verdict == Verdict::unresolved && n->within.value_or(false);
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
    for (const auto& [verdict, name] : others) {
      if (counts[verdict] == 0) continue;
      rest.push_back(fmt::format("{} {}", counts[verdict], name));
      if (verdict == Verdict::unresolved && within > 0)
        rest.back() += fmt::format(" (of which {} within what is allowed)", within);
    }
    return fmt::format(
        "{} meets {} of {} published numbers{}{}", label, counts[Verdict::agrees], judged,
        dependent > 0 ? fmt::format(" ({} of them calibrated or circular, so no evidence)", dependent) : "",
        rest.empty() ? "" : "; " + listed(rest));
  }

  /// How many runs are still to be made.
  std::string missing() const {
    std::size_t count = 0;
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs) count += run.outcome.ending == Ending::missing;
    return count == 0 ? "" : fmt::format("; {} run{} missing", count, count == 1 ? " is" : "s are");
  }

  /// What carries a warning: runs that are noisy, came to no end, or have other walls.
  std::string warnings() const {
    std::map<std::string, std::vector<std::string>> doubtful;
    std::vector<std::string> failed;
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs) {
        const auto note = [&](std::vector<std::string>& names) {
          if (names.empty() || names.back() != scene.name) names.push_back(scene.name);
        };
        if (run.doubt.any()) note(doubtful[run.doubt.word()]);
        if (run.outcome.ending != Ending::finished && run.outcome.ending != Ending::missing) note(failed);
      }
    std::vector<std::string> parts;
    if (!failed.empty()) parts.push_back("runs of " + some_of(failed, ", ", 3) + " ended without a result");
    for (const auto& [word, scenes] : doubtful)
      parts.push_back(fmt::format("runs of {} are {}", some_of(scenes, ", ", 3), word));
    for (const auto& [walls, scenes] : other_walls())
      parts.push_back(
          fmt::format("walls are not the scene's in {} run{}: {}", scenes, scenes == 1 ? "" : "s", walls));
    if (parts.empty()) return "";
    std::string text = listed(parts, "; ") + ".";
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
  }

  /// How many runs have which walls otherwise than their scene.
  std::map<std::string, int> other_walls() const {
    std::map<std::string, int> counts;
    for (const SceneFound& scene : validation_.scenes)
      for (const Found& run : scene.runs)
        if (!run.walls_differ.empty() && !run.wanted.coarse) ++counts[run.walls_differ];
    return counts;
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
    page_.words.push_back(Text{opening + missing() + ".", Text::Style::opening});
    const auto answer = [&](const char* question, const std::string& text) {
      if (!text.empty()) page_.words.push_back(report::Answer{question, text});
    };
    answer("And the other solvers and laws?", more);
    answer("Do solids stop, fluids flow on, and flocs go as the papers have it?", claims());
    answer("Which numbers are missed by the material that stops?", misses());
    answer("When does each model stop?", stops());
    answer("What would an arbitrary stopping time have changed?", arbitrary_stops());
    answer("Which difference is physics, which numerics?", physics_and_numerics());
    answer("What carries a warning?", warnings());
    answer("What did it cost?", cost());
  }

  /// The papers' claims that every run bears out, and those that some do not.
  std::string claims() const {
    std::map<Finding::Holds, int> counts;
    std::vector<std::string> broken;
    int judged = 0;
    for (const Finding& f : validation_.findings) {
      if (f.holds == Finding::Holds::not_run) continue;
      ++judged;
      ++counts[f.holds];
      if (f.holds == Finding::Holds::no && std::find(broken.begin(), broken.end(), f.claim) == broken.end())
        broken.push_back(f.claim);
    }
    if (judged == 0) return "";
    std::string text = fmt::format("{} of {} findings hold", counts[Finding::Holds::yes], judged);
    if (counts[Finding::Holds::undecided] > 0)
      text += fmt::format(", {} are undecided", counts[Finding::Holds::undecided]);
    text += ".";
    if (!broken.empty()) {
      for (std::string& claim : broken) claim = "“" + claim + "”";
      text += " Not everywhere: " + some_of(broken, "; ") + ".";
    }
    return text;
  }

  /// What is missed, by what it is and in which solver; the numbers themselves stand in the table.
  std::string misses() const {
    std::vector<std::pair<std::string, std::vector<std::string>>> groups;
    for (const Number* n : numbers()) {
      if (!is_solid(*n) || (n->verdict != Verdict::misses && n->verdict != Verdict::never)) continue;
      const std::string what = fmt::format("{} in {}{}", compare::reading_named(n->published.quantity).name,
                                           n->solver == Solver::mpm ? "MPM" : "OpenFOAM",
                                           n->walls_differ.empty() ? "" : " (" + n->walls_differ + ")");
      auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == what; });
      if (group == groups.end()) group = groups.insert(groups.end(), {what, {}});
      const std::string target = plain(*n->published.target(), unit_of(*n));
      group->second.push_back(n->verdict == Verdict::never
                                  ? fmt::format("never instead of {} ({})", target, n->published.scene)
                                  : fmt::format("{} instead of {} ({})",
                                                reading(*n->ours, n->uncertainty, unit_of(*n), n->grain),
                                                target, n->published.scene));
    }
    constexpr std::size_t told_of_each = 2;
    std::vector<std::string> items;
    for (const auto& [what, each] : groups) items.push_back(what + ": " + some_of(each, ", ", told_of_each));
    return items.empty() ? "" : some_of(items, "; ") + ".";
  }

  std::string stops() const {
    std::vector<double> rests;
    int solids = 0, fluids = 0, restless = 0;
    for (const SceneFound& scene : validation_.scenes) {
      // What is driven, or drains, has no rest to come to.
      if (!scene.apparatus->rests()) continue;
      for (const Found& run : scene.runs) {
        if (run.wanted.coarse || run.outcome.ending != Ending::finished) continue;
        const bool solid = laws::can_rest(run.wanted.model);
        (solid ? solids : fluids)++;
        if (!solid) continue;
        if (run.rest)
          rests.push_back(*run.rest);
        else
          ++restless;
      }
    }
    std::string text;
    if (!rests.empty()) {
      const auto [first, last] = std::minmax_element(rests.begin(), rests.end());
      text = fmt::format(
          "{} of {} elasto-viscoplastic slumps and L-boxes come to rest, {}.", rests.size(), solids,
          *first == *last
              ? "after " + compare::words::time(*first)
              : fmt::format("between {} and {}", compare::words::time(*first), compare::words::time(*last)));
    } else if (solids > 0) {
      text = "No elasto-viscoplastic slump or L-box comes to rest before its end.";
    }
    if (restless > 0 && !rests.empty())
      text += fmt::format(" {} {} still moving at {} end.", restless, restless == 1 ? "is" : "are",
                          restless == 1 ? "its" : "their");
    if (fluids > 0)
      text += fmt::format("{}{}", text.empty() ? "" : " ",
                          fluids == 1 ? "Their fluid never does."
                                      : fmt::format("The {} fluid runs of them never do.", fluids));
    return text;
  }

  std::string arbitrary_stops() const {
    struct Drift {
      double value = 0.0;
      std::string words;
    };
    std::map<std::string, std::vector<Drift>> by_unit;
    for (const SceneFound& scene : validation_.scenes)
      for (const Perpetual& p : scene.perpetual)
        if (const auto change = p.rest ? p.change() : std::nullopt) {
          const auto& gauge = scene.apparatus->gauge();
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
      if (!scene.apparatus->grows()) continue;
      const auto of = [&](const Found& a, auto same) -> std::optional<double> {
        for (const Found& b : scene.runs)
          if (&a != &b && a.gauge_end && b.gauge_end && same(a.wanted, b.wanted))
            return std::abs(*a.gauge_end - *b.gauge_end);
        return std::nullopt;
      };
      for (const Found& run : scene.runs) {
        if (run.wanted.coarse || run.outcome.ending != Ending::finished) continue;
        const auto fine = [](const Wanted& w) { return !w.coarse; };
        const bool solid = laws::can_rest(run.wanted.model);
        if (!solid)
          if (const auto d = of(run, [&](const Wanted& a, const Wanted& b) {
                return fine(b) && a.solver == b.solver && laws::can_rest(b.model);
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
    const auto length = [&](double mm) { return compare::words::spread(1e-3 * mm, finest_grain()); };
    const auto add = [&](const char* what, std::vector<double>& values) {
      if (values.empty()) return;
      std::sort(values.begin(), values.end());
      parts.push_back(
          values.front() == values.back() || values.size() == 2
              ? fmt::format("{} by {}{}", what, length(values.back()), values.size() > 1 ? " at most" : "")
              : fmt::format("{} by {} in the middle and {} at most", what, length(values[values.size() / 2]),
                            length(values.back())));
    };
    add("another law (physics) moves the end of a spread or front", law);
    add("another solver (discretisation)", solver);
    add("another grid (numerics)", grid);
    if (parts.empty()) return "";
    std::string text = listed(parts, "; ") + ".";
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
  }

  /// Of the smallest body among the scenes.
  compare::words::Grain finest_grain() const {
    compare::words::Grain finest;
    for (const SceneFound& scene : validation_.scenes) {
      const auto grain = compare::words::grain_of(scene.gauges, scene.apparatus->judged_by());
      if (grain.length < finest.length) finest = grain;
    }
    return finest;
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
                     {"Verdict", "", {}, true},
                     {"Measured", "", {}, false, "measured"},
                     {"The paper's own", "", {}, false, "paper"},
                     {"Ours", "", {}, false, "ours"},
                     {"Difference", "", {}, false, "difference"},
                     {"Allowed", "", {}, false, "allowed"},
                     {"Grids differ by", "", {}, false, "grids_differ_by"},
                     {"Evidence", "", {}, true},
                     {"In words", "", {}, true},
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
    if (difference) {
      const std::string sign = *difference > 0.0 ? "+" : *difference < 0.0 ? "−" : "";
      apart = sign + (unit == "mm" ? unbroken(compare::words::spread(1e-3 * std::abs(*difference), n.grain))
                                   : unbroken(fmt::format("{:.2g} {}", std::abs(*difference), unit)));
    }
    std::string grids;
    if (n.ours && n.coarse) {
      const double apart_by = std::abs(*n.ours - *n.coarse);
      grids =
          unit == "mm" ? unbroken(compare::words::spread(1e-3 * apart_by, n.grain)) : plain(apart_by, unit);
    }
    std::string words = n.words;
    if (!n.walls_differ.empty() && n.ours) words += "; walls differ: " + n.walls_differ;
    if (n.doubt.any()) words += fmt::format("; {}: {}", n.doubt.word(), n.doubt.why);
    Table::Row row{{p.scene, compare::reading_named(p.quantity).name, who(n), short_verdict(n),
                    known(p.measured), known(p.paper), worded(n.ours, n.uncertainty, unit, n.grain), apart,
                    plain(p.allowed, unit), grids, to_string(p.mark), words, p.source},
                   entry_of(who(n))};
    std::vector<std::string> badges;
    if (n.verdict != Verdict::agrees && n.verdict != Verdict::not_comparable)
      badges.push_back(short_verdict(n));
    if (n.doubt.any()) badges.push_back(n.doubt.word());
    if (!n.walls_differ.empty()) badges.emplace_back("other walls");
    row.badge = fmt::format("{}", fmt::join(badges, ", "));
    return row;
  }

  report::Chapter numbers_chapter() const {
    report::Chapter chapter{"numbers", "Published numbers", {}};
    Table table = numbers_table("published", "published numbers and ours");
    table.caption =
        "Ours is at the scene's resolution; what stands after ± is the difference to the second resolution, "
        "taken on to zero cell size at first order. A number agrees where it is known at least as well as is "
        "allowed "
        "and lies within it; it misses where it lies outside, and is known as well or further out than its "
        "±. Anything "
        "else is unresolved, within what is allowed or off. Calibrated: the paper fitted a parameter of the "
        "scene to "
        "this very number. Circular: a parameter was computed back from it. Neither is evidence for the "
        "model.";
    for (const Number* n : numbers()) table.rows.push_back(row_of(*n));
    if (table.rows.empty())
      chapter.blocks.push_back(Text{"Nothing published is known of these scenes."});
    else
      chapter.blocks.push_back(std::move(table));
    if (auto times = parity("times", "s", "ours against published times"))
      chapter.blocks.push_back(std::move(*times));
    return chapter;
  }

  /// Claims, and what each solver and law makes of them in all scenes.
  report::Chapter findings_chapter() const {
    report::Chapter chapter{"claims-of-the-papers", "What the papers say of flow and rest", {}};
    const auto row = [&](const Finding& f, const std::string& label) {
      return Table::Row{{f.claim, f.scene, label, to_string(f.holds), f.seen, f.source},
                        entry_of(label),
                        f.holds == Finding::Holds::yes ? "" : to_string(f.holds)};
    };
    Table counts{.id = "claims", .title = "what the papers find, and how often it is found here"};
    counts.caption =
        "Besides their numbers the papers say how concrete comes to rest and how its flocs go. A finding is "
        "one such "
        "claim in one scene, solver and law, at the scene's resolution; all of them are in the table below.";
    counts.columns = {{"What the papers find", "", {}, true},
                      {"Solver and law", "", {}, true},
                      {"Holds", "", {}, false, "holds"},
                      {"Not in", "", {}, true, "not_in"},
                      {"Source", "", {}, true}};
    Table each{.id = "findings", .title = "every finding"};
    each.columns = {{"What the papers find", "", {}, true}, {"Scene", "", {}, true},
                    {"Solver and law", "", {}, true},       {"Verdict", "", {}, true},
                    {"What is seen", "", {}, true},         {"Source", "", {}, true}};
    struct Count {
      int holds = 0, judged = 0;
      std::vector<std::string> not_in = {};
      std::string source = {};
    };
    std::vector<std::pair<std::pair<std::string, std::string>, Count>> by_claim;
    for (const Finding& f : validation_.findings) {
      const std::string label = fmt::format("{} {}", f.solver == Solver::mpm ? "MPM" : "OpenFOAM", f.law);
      each.rows.push_back(row(f, label));
      const std::pair key{f.claim, label};
      auto at = std::find_if(by_claim.begin(), by_claim.end(), [&](const auto& c) { return c.first == key; });
      if (at == by_claim.end()) at = by_claim.insert(by_claim.end(), {key, {}});
      Count& count = at->second;
      if (count.source.find(f.source) == std::string::npos)
        count.source += (count.source.empty() ? "" : "; ") + f.source;
      if (f.holds == Finding::Holds::not_run) continue;
      ++count.judged;
      if (f.holds == Finding::Holds::yes)
        ++count.holds;
      else
        count.not_in.push_back(f.holds == Finding::Holds::undecided ? f.scene + " (undecided)" : f.scene);
    }
    for (auto& [key, count] : by_claim)
      counts.rows.push_back(
          {{key.first, key.second,
            count.judged == 0 ? std::string("not run")
                              : unbroken(fmt::format("{} of {}", count.holds, count.judged)),
            some_of(count.not_in, ", "), count.source},
           entry_of(key.second),
           ""});
    if (each.rows.empty()) return chapter;
    chapter.blocks.push_back(std::move(counts));
    chapter.blocks.push_back(std::move(each));
    return chapter;
  }

  report::Chapter perpetual_chapter() const {
    report::Chapter chapter{"perpetual", "What the fluid's perpetual flow makes of each scene", {}};
    Table table{.id = "perpetual-flow", .title = "the fluid when the solid rests, and later"};
    table.caption =
        "A regularised fluid never stops: whoever reads it picks a time. Here it is read when the "
        "elasto-viscoplastic run of the same solver (else of the other) comes to rest, at two and five times "
        "that, "
        "and at its end; where the solid does not rest, from half of the fluid's own time on. The last "
        "column is "
        "what another choice of that time would have changed; its digits are for that change within one run "
        "only.";
    table.columns = {{"Scene", "", {}, true},   {"Fluid", "", {}, true},
                     {"Gauge", "", {}, true},   {"Solid rests", "s", {Format::Kind::significant, 3}},
                     {"Solid, at rest", ""},    {"Read from", "s", {Format::Kind::significant, 3}},
                     {"Fluid then", ""},        {"at twice that", ""},
                     {"at five times", ""},     {"Fluid's end", "s", {Format::Kind::significant, 3}},
                     {"Fluid, at its end", ""}, {"Change", ""}};
    for (const SceneFound& scene : validation_.scenes) {
      const compare::Gauge& gauge = scene.apparatus->gauge();
      const auto value = [&](const std::optional<double>& v) {
        return v ? Table::Cell(
                       unbroken(fmt::format("{:.{}f} {}", *v, gauge.unit == "m/s" ? 4 : 1, gauge.unit)))
                 : Table::Cell();
      };
      for (const Perpetual& p : scene.perpetual) {
        if (p.fluid_at.empty()) continue;
        const auto at = [&](double factor) -> std::optional<double> {
          for (const auto& [time, v] : p.fluid_at)
            if (std::abs(time - factor * p.from) < 1e-9) return v;
          return std::nullopt;
        };
        table.rows.push_back({{scene.name, who(p.solver, p.fluid), gauge.name, cell(p.rest), value(p.solid),
                               p.from, value(at(1.0)), value(at(2.0)), value(at(5.0)),
                               p.fluid_at.back().first, value(p.fluid_at.back().second), value(p.change())},
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
                     {"Changes then by", "1/s", {Format::Kind::significant, 2}},
                     {"of what it grows by at rest", "%", {Format::Kind::fixed, 0}}};
    for (const SceneFound& scene : validation_.scenes)
      for (const Flocculation& f : scene.flocculation) {
        const int entry = entry_of(who(f.solver, f.model));
        const double share = f.growth_at_rest > 0.0 ? 100.0 * f.rate_end / f.growth_at_rest : report::none;
        table.rows.push_back({{scene.name, who(f.solver, f.model), f.start, f.least, f.least_at, f.end,
                               f.end_at, f.rate_end, f.held ? Table::Cell("rests") : Table::Cell(share)},
                              entry});
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
      std::string here = "not among these scenes: " + runs::command_line({"validate", item.scene});
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
                        reading(*n.ours, n.uncertainty, unit_of(n), n.grain),
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
                              whole ? run.doubt.word() : to_string(run.outcome.ending)});
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
