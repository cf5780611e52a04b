#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/comparison.h"
#include "compare/words.h"

namespace flowrest::compare {

namespace {

using words::listed;

std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string difference_of_spread(double metres) {
  const double mm = std::round(1000.0 * metres);
  if (mm == 0.0) return "the same to the millimetre";
  return fmt::format("{:.0f} mm {}", std::abs(mm), mm > 0.0 ? "wider" : "narrower");
}

std::string noise_clause(const RunView& view) {
  return view.noisy ? fmt::format("; noisy: {}", view.noise) : "";
}

/// What an elasto-viscoplastic slump came to.
std::string arrest_sentence(const RunView& view) {
  const Measures& m = view.measures;
  const std::string noise = view.noisy ? fmt::format(" (noisy: {})", view.noise) : "";
  const std::string more = m.growth_to_come ? fmt::format(", with at most {:.0f} mm still to come",
                                                          std::ceil(1e3 * *m.growth_to_come))
                                            : "";
  if (view.held)
    return fmt::format("{} comes to rest{} with a spread of {}{}{}.", view.label,
                       m.rest_declared ? fmt::format(" after {}", words::time(*m.rest_declared)) : "",
                       words::spread(*m.gauge_end), more, noise);
  const auto rest = m.rest_by_shear_rate ? m.rest_by_shear_rate : m.rest_by_spread_rate;
  if (m.cause == Cause::at_rest && rest)
    return fmt::format("{} has all but stopped by {} and ends with a spread of {}{}.", view.label,
                       words::time(*rest), words::spread(*m.gauge_end), noise);
  return fmt::format("{} has not come to rest by {}: its spread is {}{}{}.", view.label, words::time(*m.end),
                     words::spread(*m.gauge_end),
                     m.residual ? fmt::format(" and grows by {}", words::speed(*m.residual)) : "", noise);
}

/// "MPM papanastasiou stands at 589 mm (13 mm past the arrested spread, still growing by 0.13 mm/s)".
std::string fluid_clause(const RunView& view) {
  const Measures& m = view.measures;
  std::string inner;
  const auto add = [&](const std::string& part) { inner += (inner.empty() ? "" : ", ") + part; };
  if (m.overshoot_reference) {
    const double over = std::round(1000.0 * (*m.gauge_end - *m.overshoot_reference));
    add(over == 0.0 ? std::string("level with the arrested spread")
                    : fmt::format("{:.0f} mm {} the arrested spread", std::abs(over),
                                  over > 0.0 ? "past" : "short of"));
  }
  if (m.residual)
    add(fmt::format("{} by {}", *m.residual >= 0.0 ? "growing" : "shrinking",
                    words::speed(std::abs(*m.residual))));
  return fmt::format("{} stands at {}{}{}{}", view.label, words::spread(*m.gauge_end),
                     inner.empty() ? "" : " (", inner, inner.empty() ? "" : noise_clause(view) + ")");
}

/// The fluids, those that end together in one sentence.
std::vector<std::string> fluid_sentences(const Comparison& comparison) {
  std::map<double, std::vector<std::string>> by_end;
  for (const RunView& view : comparison.runs)
    if (view.fluid && !view.gauge.empty())
      by_end[std::round(2.0 * *view.measures.end) / 2.0].push_back(fluid_clause(view));
  std::vector<std::string> sentences;
  for (const auto& [end, clauses] : by_end)
    sentences.push_back(
        fmt::format("{} not come to rest by {}: {}.",
                    clauses.size() == 1 ? "The regularised fluid has" : "The regularised fluids have",
                    words::time(end), listed(clauses)));
  return sentences;
}

/// The latest time at which a pair of runs can be compared.
const Pair::At* last_gauged(const Pair& pair) {
  for (auto at = pair.at.rbegin(); at != pair.at.rend(); ++at)
    if (at->gauge_difference) return &*at;
  return nullptr;
}

/// What still moves, held against what the regularisation alone predicts.
std::string cause_sentence(const Comparison& comparison) {
  std::vector<std::string> creep, either, noise, unexplained;
  const auto speed = [&](double value) {
    return comparison.kind == scenes::Kind::slump ? words::speed(value) : words::velocity(value);
  };
  for (const RunView& view : comparison.runs) {
    const Measures& m = view.measures;
    if (!m.residual || !m.predicted_creep || !(*m.predicted_creep > 0.0)) continue;
    const std::string part = fmt::format("{} ({} of {} predicted)", view.label, speed(std::abs(*m.residual)),
                                         speed(*m.predicted_creep));
    if (m.cause == Cause::creep) creep.push_back(part);
    if (m.cause == Cause::creep_or_noise) either.push_back(part);
    if (m.cause == Cause::noise) noise.push_back(part);
    if (m.cause == Cause::unexplained) unexplained.push_back(part);
  }
  std::string text;
  const auto add = [&](const std::vector<std::string>& parts, const std::string& what) {
    if (!parts.empty()) text += fmt::format("{}{}: {}.", text.empty() ? "" : " ", what, listed(parts));
  };
  add(creep, "What still moves is no more than the creep of the regularisation");
  add(either, "Creep of the regularisation or noise, which cannot be told apart here");
  add(noise, "Noise of the numerics, beyond what the regularisation explains");
  add(unexplained, "Faster than the regularisation explains, though no noise was reported");
  return text;
}

/// Law against solver: the same solver with another law, and the same law in another solver.
std::string split_sentence(const Comparison& comparison) {
  std::vector<std::string> law, solver;
  for (const Pair& pair : comparison.pairs) {
    if (pair.kind != "law" && pair.kind != "solver") continue;
    const Pair::At* at = last_gauged(pair);
    if (!at) continue;
    const RunView &run = comparison.runs[pair.run], &reference = comparison.runs[pair.reference];
    // Two fluids differ by their regularisation only; the law is read off against the material that stops.
    if (pair.kind == "law" && reference.fluid) continue;
    const std::string what = comparison.kind == scenes::Kind::slump
                                 ? difference_of_spread(*at->gauge_difference)
                                 : fmt::format("{} {}", words::velocity(std::abs(*at->gauge_difference)),
                                               *at->gauge_difference >= 0.0 ? "faster" : "slower");
    (pair.kind == "law" ? law : solver)
        .push_back(fmt::format("{} ends {} than {}", run.label, what, reference.label));
  }
  std::string text;
  if (!law.empty()) text += fmt::format("Changing only the law: {}.", listed(law));
  if (!solver.empty())
    text += fmt::format("{}Changing only the solver: {}.", text.empty() ? "" : " ", listed(solver));
  return text;
}

/// Runs whose spread depends on the depth at which it is read: their edge is a film.
std::string edge_sentence(const Comparison& comparison) {
  std::vector<std::string> films;
  for (const RunView& view : comparison.runs) {
    const Measures& m = view.measures;
    if (view.exact || !m.spread_1_5mm || !m.spread_6mm || !(comparison.cell > 0.0)) continue;
    if (*m.spread_1_5mm - *m.spread_6mm < 3.0 * comparison.cell) continue;
    films.push_back(
        fmt::format("{} ({:.0f} to {:.0f} mm)", view.label, 1e3 * *m.spread_6mm, 1e3 * *m.spread_1_5mm));
  }
  return films.empty()
             ? ""
             : fmt::format(
                   "The edge is a thin film, so that the spread depends on whether it is read at 6 mm or "
                   "at 1.5 mm of depth: {}.",
                   listed(films));
}

std::string cost_sentence(const Comparison& comparison) {
  std::vector<std::string> costs;
  for (const RunView& view : comparison.runs)
    if (view.measures.cpu && !view.exact)
      costs.push_back(fmt::format("{} {}", view.label, words::duration(*view.measures.cpu)));
  return costs.empty() ? "" : fmt::format("CPU time: {}.", listed(costs));
}

std::string trouble_sentences(const Comparison& comparison) {
  std::string text;
  for (const RunView& view : comparison.runs)
    if (!view.trouble.empty())
      text += fmt::format("{}{} is incomplete ({}); what follows knows it only that far{}.",
                          text.empty() ? "" : " ", view.label, view.trouble, noise_clause(view));
  return text;
}

using Topic = Finding::Topic;

void tell(Comparison& comparison, Topic topic, std::string text) {
  if (!text.empty()) comparison.findings.push_back({topic, capitalised(std::move(text))});
}

void describe_slump(Comparison& comparison) {
  std::vector<std::string> exact;
  for (const RunView& view : comparison.runs) {
    if (view.gauge.empty()) continue;
    if (view.exact)
      exact.push_back(fmt::format("{} ({})", words::spread(*view.measures.gauge_end), view.label));
    if (!view.exact && !view.fluid) tell(comparison, Topic::stop, arrest_sentence(view));
  }
  for (std::string& sentence : fluid_sentences(comparison))
    tell(comparison, Topic::stop, std::move(sentence));
  tell(comparison, Topic::difference, split_sentence(comparison));
  tell(comparison, Topic::difference, cause_sentence(comparison));
  tell(comparison, Topic::difference, edge_sentence(comparison));
  if (!exact.empty())
    tell(comparison, Topic::context, fmt::format("The quasi-static solutions give {}.", listed(exact)));
}

std::string duct_sentence(const RunView& view) {
  const Measures& m = view.measures;
  const std::string noise = view.noisy ? fmt::format(" (noisy: {})", view.noise) : "";
  const std::string largest =
      words::velocity(*std::max_element(view.gauge.value.begin(), view.gauge.value.end()));
  if (m.stop_after_step && m.cause != Cause::creep)
    return fmt::format("{} reaches {} and stops {} after the last change of force{}.", view.label, largest,
                       words::time(*m.stop_after_step), noise);
  if (!m.residual) return fmt::format("{} reaches {}{}.", view.label, largest, noise);
  return fmt::format("{} reaches {} and still moves at {}{}.", view.label, largest,
                     words::velocity(*m.residual), noise);
}

void describe_duct(Comparison& comparison) {
  for (const RunView& view : comparison.runs)
    if (!view.exact && !view.gauge.empty()) tell(comparison, Topic::stop, duct_sentence(view));
  for (const RunView& view : comparison.runs)
    if (view.measures.stopping_bound)
      tell(comparison, Topic::stop,
           fmt::format("The exact material stops within {} of the last change of force.",
                       words::time(*view.measures.stopping_bound)));
  std::vector<std::string> errors;
  for (const Pair& pair : comparison.pairs) {
    if (pair.kind != "exact") continue;
    // Where the exact material is at rest there is nothing to be relative to.
    const auto steady = std::find_if(pair.at.begin(), pair.at.end(),
                                     [](const Pair::At& at) { return at.error.l2_relative > 0.0; });
    if (steady != pair.at.end())
      errors.push_back(fmt::format("{} by {} at {}", comparison.runs[pair.run].label,
                                   words::percent(steady->error.l2_relative), words::time(steady->time)));
  }
  if (!errors.empty())
    tell(comparison, Topic::difference,
         fmt::format("In L2 the profiles differ from the exact steady one: {}.", listed(errors)));
  tell(comparison, Topic::difference, split_sentence(comparison));
  tell(comparison, Topic::difference, cause_sentence(comparison));
}

std::string fair_slump(const Comparison& comparison) {
  std::string text =
      "The exact profiles are quasi-static: they are the shapes at which gravity is just held by the yield "
      "stress, reached "
      "without inertia. A cone that is let go at once arrives with momentum and spreads past them; how far "
      "depends on its "
      "viscosity. (For Roussel's benchmark, plastic viscosities of 20, 50 and 500 Pa s arrested at 578, 559 "
      "and 540 mm in one "
      "and the same scheme, about 3.5 % of overshoot at 50 Pa s; taken to infinite viscosity, 556 ± 10 mm "
      "for a spread whose "
      "second-order solution is 562 mm.) The leading order in height over radius, whose foot lies at 600 mm "
      "there, leaves out "
      "the extensional stress in the unsheared layer and is too wide; a run that matches it does so because "
      "its errors cancel. "
      "So the fair comparisons are: one run with another of the same law, which shows the discretisation; "
      "one run with another "
      "of the same solver, which shows the law; and any run with the second-order profile only as a lower "
      "limit that inertia "
      "carries it past.";
  const bool axisymmetric = comparison.radial;
  return axisymmetric ? text
                      : "The exact profile is quasi-static and of leading order: inertia carries a slump "
                        "that is let go at "
                        "once past it. The fair comparisons are those between runs: the same law in two "
                        "solvers shows the "
                        "discretisation, two laws in the same solver show the law.";
}

}  // namespace

void describe(Comparison& comparison) {
  comparison.findings.clear();
  tell(comparison, Topic::stop, trouble_sentences(comparison));
  if (comparison.kind == scenes::Kind::slump) {
    describe_slump(comparison);
    comparison.fair = fair_slump(comparison);
  } else {
    describe_duct(comparison);
    comparison.fair =
        "The steady profiles are exact, and any run may be held against them. How a flow stops has no closed "
        "form, but a bound "
        "that no exact material can pass. Under a force below yield a regularised fluid creeps for ever at a "
        "speed that its "
        "law alone fixes: compare it with that speed, and only what is beyond it with the solver. Codes "
        "agree on velocity "
        "profiles long before they agree on arrest: judge by both.";
  }
  tell(comparison, Topic::context, cost_sentence(comparison));
  if (comparison.kind == scenes::Kind::slump && comparison.cell > 0.0)
    tell(comparison, Topic::context,
         fmt::format("Each run stands on one grid: differences below a cell ({:g} mm) are not settled by "
                     "this comparison.",
                     1000.0 * comparison.cell));
}

}  // namespace flowrest::compare
