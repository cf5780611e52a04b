#include "compare/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/apparatus/apparatus.h"
#include "compare/comparison.h"
#include "compare/measures/gauges.h"
#include "compare/measures/run_measures.h"
#include "compare/run_view.h"
#include "compare/words.h"

namespace flowrest::compare {

namespace {

using words::listed;
using Topic = Finding::Topic;

std::string end_of(const Comparison& comparison, const RunView& view) {
  const auto& end = view.measures.gauge_end;
  if (!end)
    return fmt::format("nothing that can be read (nowhere {:g} mm deep)",
                       1e3 * comparison.apparatus->edge_depth(view.gauges));
  return words::of(comparison.apparatus->gauge(), *end, view.measures.uncertainty, comparison.grain);
}

/// What is known of the difference between two runs; a run without an uncertainty adds none.
double uncertainty_of(const RunView& run, const RunView& reference) {
  return std::hypot(run.measures.uncertainty.value_or(0.0), reference.measures.uncertainty.value_or(0.0));
}

/// "62 ± 14 mm wider", or that the two cannot be told apart.
std::string difference_in(const Comparison& comparison, double value, double uncertainty) {
  const Gauge& gauge = comparison.apparatus->gauge();
  const bool known = gauge.unit == "mm" || uncertainty > 0.0;
  if (known && std::abs(value) <= uncertainty)
    return fmt::format("level within {}", words::of(gauge, uncertainty, std::nullopt, comparison.grain));
  return fmt::format("{} {}", words::of(gauge, std::abs(value), uncertainty, comparison.grain),
                     value > 0.0 ? gauge.more : gauge.less);
}

std::string doubt_clause(const RunView& view) {
  return view.doubt.any() ? fmt::format("; {}: {}", view.doubt.word(), view.doubt.why) : "";
}

/// "still grows by 0.10 to 0.15 mm/s then": a thin film of the exact material.
std::string approach_words(const Comparison& comparison, const Measures& m) {
  return fmt::format("still grows by {:.2g} to {} then", 1e3 * *m.approach_least,
                     words::speed(*m.approach_most, comparison.grain));
}

/// What an elasto-viscoplastic body came to.
std::string arrest_sentence(const Comparison& comparison, const RunView& view) {
  const std::string& gauge = comparison.apparatus->gauge().name;
  const Measures& m = view.measures;
  const std::string doubt = doubt_in_brackets(view);
  const double finest = comparison.grain.length;
  const std::string more =
      m.growth_to_come
          ? fmt::format(", with at most {} still to come",
                        words::spread(finest * std::max(1.0, std::ceil(*m.growth_to_come / finest)),
                                      comparison.grain))
          : "";
  const auto cells = number(view.run.info, "/resolution/cells_at_end");
  const std::string limited =
      cells && *cells < 1.0
          ? fmt::format(", limited by the cell (its sheared layer is {:.1g} cells thick by then),", *cells)
          : "";
  if (view.held)
    return fmt::format("{} comes to rest{}{} with a {} of {}{}{}.", view.label,
                       m.rest_declared ? fmt::format(" after {}", words::time(*m.rest_declared)) : "",
                       limited, gauge, end_of(comparison, view), more, doubt);
  const auto rest = m.rest_by_shear_rate ? m.rest_by_shear_rate : m.rest_by_spread_rate;
  if (m.cause == Cause::at_rest && rest)
    return fmt::format("{} has all but stopped by {} and ends with a {} of {}{}.", view.label,
                       words::time(*rest), gauge, end_of(comparison, view), doubt);
  const std::string exact =
      m.approach_most ? fmt::format(", where a thin film of it {}", approach_words(comparison, m)) : "";
  return fmt::format(
      "{} has not come to rest by {}: its {} is {}{}{}{}.", view.label, words::time(*m.end), gauge,
      end_of(comparison, view),
      m.residual ? fmt::format(" and grows by {}", words::speed(*m.residual, comparison.grain)) : "", exact,
      doubt);
}

/// "MPM papanastasiou stands at 589 mm (13 mm past the arrested spread, still growing by 0.13 mm/s)".
std::string fluid_clause(const Comparison& comparison, const RunView& view) {
  const Gauge& gauge = comparison.apparatus->gauge();
  const Measures& m = view.measures;
  std::string inner;
  const auto add = [&](const std::string& part) { inner += (inner.empty() ? "" : ", ") + part; };
  if (m.overshoot_reference && m.gauge_end) {
    const double over = *m.gauge_end - *m.overshoot_reference;
    add(std::abs(over) <= m.uncertainty.value_or(0.5 * comparison.grain.length)
            ? fmt::format("level with the arrested {}", gauge.name)
            : fmt::format("{} {} the arrested {}",
                          words::of(gauge, std::abs(over), m.uncertainty, comparison.grain),
                          over > 0.0 ? "past" : "short of", gauge.name));
  }
  if (m.residual)
    add(fmt::format("{} by {}", *m.residual >= 0.0 ? "growing" : "shrinking",
                    words::speed(std::abs(*m.residual), comparison.grain)));
  return fmt::format("{} stands at {}{}{}{}", view.label, end_of(comparison, view), inner.empty() ? "" : " (",
                     inner, inner.empty() ? "" : doubt_clause(view) + ")");
}

/// The fluids, those that end together in one sentence.
std::vector<std::string> fluid_sentences(const Comparison& comparison) {
  // Half a second in a minute.
  const double rounding = round_step(comparison.end / 120.0);
  std::map<double, std::vector<std::string>> by_end;
  for (const RunView& view : comparison.runs)
    if (view.fluid && !view.gauge.empty())
      by_end[rounding * std::round(*view.measures.end / rounding)].push_back(fluid_clause(comparison, view));
  const bool newtonian = std::any_of(comparison.runs.begin(), comparison.runs.end(), [](const RunView& view) {
    return view.fluid && !laws::creeps(*view.law);
  });
  std::vector<std::string> sentences;
  for (const auto& [end, clauses] : by_end)
    sentences.push_back(fmt::format("The {}{} not come to rest by {}: {}.", newtonian ? "" : "regularised ",
                                    clauses.size() == 1 ? "fluid has" : "fluids have", words::time(end),
                                    listed(clauses)));
  return sentences;
}

/// The latest time at which a pair of runs can be compared.
const Pair::At* last_gauged(const Pair& pair) {
  for (auto at = pair.at.rbegin(); at != pair.at.rend(); ++at)
    if (at->gauge_difference) return &*at;
  return nullptr;
}

/// Runs whose spread depends on the depth at which it is read: their edge is a film.
std::string edge_sentence(const Comparison& comparison) {
  std::vector<std::string> films;
  for (const RunView& view : comparison.runs) {
    const Measures& m = view.measures;
    if (view.exact || !m.spread_at_half || !m.spread_at_twice) continue;
    if (!ends_in_film(comparison, *m.spread_at_half - *m.spread_at_twice)) continue;
    films.push_back(fmt::format("{} ({:.{}f} to {})", view.label, 1e3 * *m.spread_at_twice,
                                comparison.grain.decimals(),
                                words::spread(*m.spread_at_half, comparison.grain)));
  }
  return films.empty()
             ? ""
             : fmt::format(
                   "The edge is a thin film, so that the spread depends on whether it is read at {:g} mm or "
                   "at {:g} mm of depth: {}.",
                   2000.0 * comparison.gauges.spread_depth, 500.0 * comparison.gauges.spread_depth,
                   listed(films));
}

std::string cost_sentence(const Comparison& comparison) {
  std::vector<std::string> costs;
  for (const RunView& view : comparison.runs)
    if (view.measures.cpu && !view.exact)
      costs.push_back(fmt::format("{} {}", view.label, words::duration(*view.measures.cpu)));
  return costs.empty() ? "" : fmt::format("CPU time: {}.", listed(costs));
}

/// Between which spreads the runs end.
std::string range_sentence(const Comparison& comparison) {
  const RunView *least = nullptr, *most = nullptr;
  for (const RunView& view : comparison.runs) {
    if (view.exact || !view.measures.gauge_end || !view.trouble.empty()) continue;
    if (!least || *view.measures.gauge_end < *least->measures.gauge_end) least = &view;
    if (!most || *view.measures.gauge_end > *most->measures.gauge_end) most = &view;
  }
  if (!least || least == most || !comparison.apparatus->grows()) return "";
  return fmt::format("The {}s end between {} ({}) and {} ({}).", comparison.apparatus->gauge().name,
                     end_of(comparison, *least), least->label, end_of(comparison, *most), most->label);
}

/// The headline: what comes to rest and what does not, with every warning.
std::string opening_sentence(const Comparison& comparison) {
  std::vector<std::string> moving, incomplete;
  std::map<std::string, std::vector<std::string>> doubtful;
  const RunView* arrested = nullptr;
  bool all_fluids = true;
  // What a run declares counts before what is read off its record, a sound run before a noisy one.
  const auto rank = [](const RunView& view) {
    return 4 * view.held + 2 * !view.doubt.noisy + !view.doubt.under_resolved;
  };
  for (const RunView& view : comparison.runs) {
    if (view.exact) continue;
    if (view.doubt.any()) doubtful[view.doubt.word()].push_back(view.label);
    if (!view.trouble.empty()) incomplete.push_back(fmt::format("{} ({})", view.label, view.trouble));
    if (view.gauge.empty() || !view.trouble.empty()) continue;
    const bool rests = view.held || view.measures.cause == Cause::at_rest ||
                       (view.measures.stop_after_step && view.measures.cause != Cause::creep);
    if (rests && (!arrested || rank(view) > rank(*arrested))) arrested = &view;
    if (rests) continue;
    moving.push_back(view.label);
    all_fluids = all_fluids && view.fluid;
  }
  std::string text;
  if (arrested && comparison.apparatus->grows()) {
    const Measures& m = arrested->measures;
    const auto rest = m.rest_declared        ? m.rest_declared
                      : m.rest_by_shear_rate ? m.rest_by_shear_rate
                                             : m.rest_by_spread_rate;
    const auto arrival = reading_of(comparison, *arrested, "arrival_s");
    text = fmt::format("{}{} comes to rest{}", arrested->label,
                       arrival ? fmt::format(" reaches the end wall after {} and", *arrival) : "",
                       rest ? " after " + words::time(*rest) : "");
    const auto height = reading_of(comparison, *arrested, "end_height_mm");
    text += arrival && height ? fmt::format(", {} high at the wall", *height)
                              : fmt::format(" with a {} of {}", comparison.apparatus->gauge().name,
                                            end_of(comparison, *arrested));
  } else {
    text = comparison.apparatus->opening(comparison, arrested);
  }
  const auto add = [&](const std::string& clause) { text += (text.empty() ? "" : "; ") + clause; };
  const std::string who = moving.size() > 2 && all_fluids
                              ? fmt::format("the {} regularised fluids", moving.size())
                              : listed(moving);
  // A funnel runs empty and water never rests: that they move says nothing.
  if (!moving.empty() && comparison.apparatus->motion_is_news())
    add(fmt::format("{} {} still moving at {}", who, moving.size() == 1 ? "is" : "are",
                    words::time(comparison.end)));
  for (const auto& [word, labels] : doubtful) add(fmt::format("{}: {}", word, listed(labels)));
  if (!incomplete.empty()) add(fmt::format("incomplete: {}", listed(incomplete)));
  return text.empty() ? "" : text + ".";
}

std::string trouble_sentences(const Comparison& comparison) {
  std::string text;
  for (const RunView& view : comparison.runs)
    if (!view.trouble.empty())
      text += fmt::format("{}{} is incomplete ({}); what follows knows it only that far{}.",
                          text.empty() ? "" : " ", view.label, view.trouble, doubt_clause(view));
  return text;
}

/// What the uncertainties stand for.
std::string uncertainty_sentence(const Comparison& comparison) {
  std::map<std::string, std::vector<std::string>> by_source;
  for (const RunView& view : comparison.runs)
    if (view.measures.uncertainty) by_source[view.measures.uncertainty_source].push_back(view.label);
  std::vector<std::string> parts;
  for (const auto& [source, labels] : by_source)
    parts.push_back(fmt::format("{} for {}", source, listed(labels)));
  return parts.empty() ? ""
                       : fmt::format("What stands after ± is the largest that is known of each run: {}.",
                                     listed(parts, "; "));
}

}  // namespace

std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string doubt_in_brackets(const RunView& view) {
  return view.doubt.any() ? fmt::format(" ({}: {})", view.doubt.word(), view.doubt.why) : "";
}

std::string cause_sentence(const Comparison& comparison) {
  std::vector<std::string> creep, approach, either, noise, unexplained;
  const auto speed = [&](double value) {
    return comparison.apparatus->grows() ? words::speed(value, comparison.grain) : words::velocity(value);
  };
  for (const RunView& view : comparison.runs) {
    const Measures& m = view.measures;
    if (!m.residual || !m.predicted_creep || !(*m.predicted_creep > 0.0)) continue;
    const std::string part = fmt::format("{} ({} of {} predicted)", view.label, speed(std::abs(*m.residual)),
                                         speed(*m.predicted_creep));
    if (m.cause == Cause::creep) creep.push_back(part);
    if (m.cause == Cause::approaching_rest)
      approach.push_back(fmt::format("{} ({}; exact material {}, its creep {})", view.label,
                                     speed(std::abs(*m.residual)), approach_words(comparison, m),
                                     speed(*m.predicted_creep)));
    if (m.cause == Cause::creep_or_noise) either.push_back(part);
    if (m.cause == Cause::noise) noise.push_back(part);
    if (m.cause == Cause::unexplained) unexplained.push_back(part);
  }
  std::string text;
  const auto add = [&](const std::vector<std::string>& parts, const std::string& what) {
    if (!parts.empty()) text += fmt::format("{}{}: {}.", text.empty() ? "" : " ", what, listed(parts));
  };
  add(creep, fmt::format("What still moves is the creep of the regularisation, within a factor of {:.3g}",
                         comparison.thresholds.creep_factor));
  add(approach, "What still moves is the exact material's own approach to rest, and creep");
  add(either, "Creep of the regularisation or noise, which cannot be told apart here");
  add(noise, "Noise of the numerics, beyond what the regularisation explains");
  add(unexplained, "Faster than the regularisation explains, though no noise was reported");
  return text;
}

std::string arrival_sentence(const Comparison& comparison, const RunView& view, bool with_height) {
  const auto arrival = reading_of(comparison, view, "arrival_s"),
             height = reading_of(comparison, view, "end_height_mm");
  if (!arrival) return "";
  return fmt::format(
      "{} reaches the end wall after {}{}{}.", view.label, *arrival,
      height && with_height ? fmt::format(" and stands {} high there at the end", *height) : "",
      doubt_in_brackets(view));
}

std::string split_sentence(const Comparison& comparison) {
  std::vector<std::string> law, solver;
  for (const Pair& pair : comparison.pairs) {
    if (pair.kind != "law" && pair.kind != "solver") continue;
    const Pair::At* at = last_gauged(pair);
    if (!at) continue;
    const RunView &run = comparison.runs[pair.run], &reference = comparison.runs[pair.reference];
    // Two fluids differ by their regularisation only; the law is read off against the material that stops.
    if (pair.kind == "law" && reference.fluid) continue;
    const std::string what =
        comparison.apparatus->has_depth()
            ? difference_in(comparison, *at->gauge_difference, uncertainty_of(run, reference))
            : fmt::format("{} {}", words::velocity(std::abs(*at->gauge_difference)),
                          *at->gauge_difference >= 0.0 ? "faster" : "slower");
    (pair.kind == "law" ? law : solver)
        .push_back(fmt::format("{} ends {} {} {}", run.label, what,
                               what.starts_with("level") ? "with" : "than", reference.label));
  }
  std::string text;
  if (!law.empty()) text += fmt::format("Changing only the law: {}.", listed(law));
  if (!solver.empty())
    text += fmt::format("{}Changing only the solver: {}.", text.empty() ? "" : " ", listed(solver));
  return text;
}

std::string square_sentence(const Comparison& comparison) {
  if (!comparison.square) return "";
  const Square& square = *comparison.square;
  if (square.at.empty()) {
    if (square.missing.empty()) return "";
    std::vector<std::string> commands;
    for (const std::string& command : square.missing) commands.push_back(fmt::format("`{}`", command));
    return fmt::format("Law and discretisation cannot be told apart in full, for want of {}: {}.",
                       commands.size() == 1 ? "a run" : "runs", listed(commands));
  }
  const Square::At& at = square.at.back();
  const Gauge& gauge = comparison.apparatus->gauge();
  const auto amount = [&](double value) {
    return comparison.apparatus->has_depth()
               ? fmt::format("{}{:.{}f} {}", value < 0.0 ? "−" : "", std::abs(gauge.shown * value),
                             gauge.unit == "mm" ? comparison.grain.decimals() : 0, gauge.unit)
               : words::velocity(value);
  };
  const auto walls = [&](const std::optional<std::size_t>& run) {
    return !comparison.runs[*run].walls_differ.empty();
  };
  const bool walls_too = walls(square.mpm_solid) || walls(square.mpm_fluid) || walls(square.foam_solid) ||
                         walls(square.foam_fluid);
  std::string text = fmt::format(
      "Of the {} between {} and {} at {}, the law makes {} and the discretisation {}; {} more can be given "
      "to neither, and "
      "scatter and the reading of the edge blur it by {}.",
      amount(at.total), comparison.runs[*square.foam_fluid].label, comparison.runs[*square.mpm_solid].label,
      words::time(at.time), amount(at.law), amount(at.discretisation), amount(std::abs(at.interaction)),
      amount(at.noise));
  if (walls_too) text += " What the walls do that differ counts as discretisation here.";
  return text;
}

std::optional<std::string> reading_of(const Comparison& comparison, const RunView& view,
                                      const std::string& quantity) {
  const auto found = view.measures.readings.find(quantity);
  if (found == view.measures.readings.end() || !found->second.value) return std::nullopt;
  return words::reading(*found->second.value, found->second.uncertainty, reading_named(quantity).unit,
                        comparison.grain);
}

std::string event_clause(const Comparison& comparison, const std::string& quantity,
                         const std::string& happens, const std::string& never) {
  std::vector<std::string> seen, dark;
  for (const RunView& view : comparison.runs) {
    if (view.exact) continue;
    if (const auto light = reading_of(comparison, view, quantity))
      seen.push_back(fmt::format("after {} ({})", *light, view.label));
    else if (view.trouble.empty())
      dark.push_back(view.label);
  }
  std::string text = seen.empty() ? "" : happens + " " + listed(seen);
  if (!dark.empty())
    text += fmt::format("{}{} {} by {}", text.empty() ? "" : "; ", listed(dark), never,
                        words::time(comparison.end));
  return text;
}

void tell(Comparison& comparison, Topic topic, std::string text) {
  if (!text.empty()) comparison.findings.push_back({topic, capitalised(std::move(text))});
}

std::string flocculation_sentence(const Comparison& comparison) {
  std::vector<std::string> parts;
  for (const RunView& view : comparison.runs) {
    const Series lambda = column(view.run, "flocculation_mean");
    if (lambda.empty() || lambda.value.front() == 0.0) continue;
    const auto least = std::min_element(lambda.value.begin(), lambda.value.end());
    const double at = lambda.time[static_cast<std::size_t>(least - lambda.value.begin())];
    const bool recovers = lambda.value.back() > *least + 1e-3 * lambda.value.front();
    parts.push_back(fmt::format(
        "from {:.2f} to {:.2f} at {}{} in {}", lambda.value.front(), *least, words::time(at),
        recovers ? fmt::format(", up again to {:.2f} by {}", lambda.value.back(), words::time(lambda.end()))
                 : "",
        view.label));
  }
  return parts.empty() ? "" : fmt::format("The mean flocculation state λ falls {}.", listed(parts, "; "));
}

std::string events_apart(const Comparison& comparison, const std::string& quantity,
                         const std::string& event) {
  std::vector<std::string> law, solver;
  for (const Pair& pair : comparison.pairs) {
    if (pair.kind != "law" && pair.kind != "solver") continue;
    const RunView &run = comparison.runs[pair.run], &reference = comparison.runs[pair.reference];
    const auto own = run.measures.readings.find(quantity), other = reference.measures.readings.find(quantity);
    if (own == run.measures.readings.end() || other == reference.measures.readings.end() ||
        !own->second.value || !other->second.value)
      continue;
    const double difference = *own->second.value - *other->second.value;
    const double known =
        std::hypot(own->second.uncertainty.value_or(0.0), other->second.uncertainty.value_or(0.0));
    (pair.kind == "law" ? law : solver)
        .push_back(
            std::abs(difference) <= std::max(known, comparison.grain.time)
                ? fmt::format("{} {} as early in {} as in {}", event,
                              known > 0.0 ? fmt::format("within {:.2g} s", known) : std::string("about"),
                              run.label, reference.label)
                : fmt::format("{} {} {} in {} than in {}", event,
                              words::reading(std::abs(difference), known, "s", comparison.grain),
                              difference > 0.0 ? "later" : "earlier", run.label, reference.label));
  }
  std::string text;
  if (!law.empty()) text += fmt::format("Changing only the law: {}.", listed(law));
  if (!solver.empty())
    text += fmt::format("{}Changing only the solver: {}.", text.empty() ? "" : " ", listed(solver));
  return text;
}

void describe_growth(Comparison& comparison) {
  std::vector<std::string> arrested, in_time;
  for (const RunView& view : comparison.runs) {
    if (view.gauge.empty()) continue;
    if (view.exact) {
      const Series height = column(view.run, "end_height_mm");
      (view.held ? arrested : in_time)
          .push_back(
              fmt::format("{}{} ({})", end_of(comparison, view),
                          !height.empty() && height.value.back() > 0.0
                              ? fmt::format(", {} high at the end",
                                            words::spread(1e-3 * height.value.back(), comparison.grain))
                              : "",
                          view.label));
      continue;
    }
    tell(comparison, Topic::stop, comparison.apparatus->readings_sentence(comparison, view));
    if (!view.fluid) tell(comparison, Topic::stop, arrest_sentence(comparison, view));
  }
  if (comparison.apparatus->motion_is_news())
    for (std::string& sentence : fluid_sentences(comparison))
      tell(comparison, Topic::stop, std::move(sentence));
  tell(comparison, Topic::apart, range_sentence(comparison));
  tell(comparison, Topic::apart, split_sentence(comparison));
  tell(comparison, Topic::cause, square_sentence(comparison));
  tell(comparison, Topic::cause, cause_sentence(comparison));
  tell(comparison, Topic::context, flocculation_sentence(comparison));
  tell(comparison, Topic::context, edge_sentence(comparison));
  tell(comparison, Topic::context, uncertainty_sentence(comparison));
  if (!arrested.empty())
    tell(comparison, Topic::context, fmt::format("The quasi-static solutions give {}.", listed(arrested)));
  if (!in_time.empty())
    tell(comparison, Topic::context, fmt::format("Solutions in time end at {}.", listed(in_time)));
}

const char* const fair_runs =
    "No exact solution is among these. The same law in two solvers shows the discretisation, two laws in the "
    "same "
    "solver show the law, two grids of the same run show what the numbers are good to. Held against a "
    "measured number "
    "(`flowrest validate`) a run must first be known better than the difference.";

void describe(Comparison& comparison) {
  comparison.findings.clear();
  tell(comparison, Topic::opening, opening_sentence(comparison));
  tell(comparison, Topic::stop, trouble_sentences(comparison));
  comparison.apparatus->describe(comparison);
  tell(comparison, Topic::cost, cost_sentence(comparison));
}

}  // namespace flowrest::compare
