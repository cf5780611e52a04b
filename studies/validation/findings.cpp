#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "compare/apparatus/apparatus.h"
#include "compare/words.h"
#include "studies/validation/validation.h"

namespace flowrest::studies::validation {

namespace {

using compare::words::listed;
using Holds = Finding::Holds;

constexpr double least_motion = 0.1;   ///< of gauges.still_speed; slower is not told from rest
constexpr double least_change = 1e-3;  ///< of the flocculation state, as a share
constexpr double told_apart = 0.005;   ///< s: half the interval at which histories are recorded
constexpr double grids_apart = 15.0;   ///< mm, of spreads on two grids
constexpr std::size_t named_at_most = 4;

compare::words::Grain grain_of(const SceneFound& scene) {
  return compare::words::grain_of(scene.gauges, scene.apparatus->judged_by());
}
std::string rate(const SceneFound& scene, double mm_per_s) {
  return compare::words::speed(1e-3 * mm_per_s, grain_of(scene));
}
std::string length(const SceneFound& scene, double mm) {
  return compare::words::spread(1e-3 * mm, grain_of(scene));
}

/// The scene's runs at its own resolution, by solver and law.
std::vector<const Found*> fine_runs(const SceneFound& scene) {
  std::vector<const Found*> runs;
  for (const Found& run : scene.runs)
    if (!run.wanted.coarse) runs.push_back(&run);
  return runs;
}

Finding finding(const std::string& claim, const std::string& source, const std::string& scene,
                const Wanted& of) {
  return {claim, source, scene, of.solver, scenes::to_string(of.model)};
}

bool publishes(const SceneFound& scene, const std::string& quantity) {
  return std::any_of(scene.numbers.begin(), scene.numbers.end(),
                     [&](const Number& n) { return n.published.quantity == quantity; });
}

/// The end of the solid's gauge in the same solver.
std::optional<double> end_of_solid(const SceneFound& scene, Solver solver) {
  for (const Found* run : fine_runs(scene))
    if (run->wanted.solver == solver && laws::can_rest(run->wanted.model)) return run->gauge_end;
  return std::nullopt;
}

/// Whether a run that was made says nothing of rest: it did not come to its end.
bool says_nothing(const Found& run) {
  return run.outcome.ending != Ending::finished || !run.end || !run.gauge_end;
}

void add_rest(std::vector<Finding>& all, const SceneFound& scene) {
  for (const Found* run : fine_runs(scene)) {
    const bool solid = laws::can_rest(run->wanted.model);
    const std::string source = scene.apparatus->spreads() ? "Yu Figs. 8 and 14" : "Yu Figs. 19 and 20";
    Finding f = finding(solid ? "the solid stops by itself" : "the fluid does not stop", source, scene.name,
                        run->wanted);
    const auto moving = [&] {
      return fmt::format("{} after {} it still {} by {}", run->arrival ? "full length;" : "",
                         compare::words::time(*run->end), run->arrival ? "rises at the end wall" : "moves",
                         rate(scene, *run->creep));
    };
    if (says_nothing(*run) || (!run->rest && !run->creep)) {
      all.push_back(f);
      continue;
    }
    if (solid) {
      f.holds = run->rest ? Holds::yes : Holds::no;
      f.seen = run->rest ? "rests after " + compare::words::time(*run->rest) : moving();
    } else {
      f.holds =
          std::abs(*run->creep) > 1e3 * least_motion * scene.gauges.still_speed ? Holds::yes : Holds::no;
      f.seen = moving();
      if (const auto solid_end = end_of_solid(scene, run->wanted.solver))
        f.seen +=
            fmt::format(", {} {} the solid's end", length(scene, std::abs(*run->gauge_end - *solid_end)),
                        *run->gauge_end >= *solid_end ? "beyond" : "short of");
    }
    if (f.seen.starts_with(" ")) f.seen.erase(0, 1);
    all.push_back(f);
  }
}

/// Whether the concrete arrives at the end of an L-box where it does in the experiment, and stops short where
/// it does not.
void add_length(std::vector<Finding>& all, const SceneFound& scene) {
  const bool arrives = publishes(scene, "arrival_s"), short_of_it = publishes(scene, "front_mm");
  for (const Found* run : fine_runs(scene)) {
    if (!arrives && !(short_of_it && laws::can_rest(run->wanted.model))) continue;
    Finding f = finding(
        arrives ? "reaches the end wall, as measured" : "the solid stops short of the end wall, as measured",
        "Yu Table 3", scene.name, run->wanted);
    if (!says_nothing(*run)) {
      f.seen = run->arrival ? "arrives after " + compare::words::time(*run->arrival)
                            : fmt::format("is at {} after {}", length(scene, *run->gauge_end),
                                          compare::words::time(*run->end));
      f.holds = run->arrival.has_value() == arrives ? Holds::yes : Holds::no;
      if (!arrives && !run->arrival && !run->rest && run->creep) {
        f.seen += ", moving on by " + rate(scene, *run->creep);
        // As much time again must not bring it to the wall.
        const double wall = *scene.length_mm;
        if (*run->gauge_end + *run->creep * *run->end > wall) f.holds = Holds::undecided;
      }
    }
    all.push_back(f);
  }
}

/// Yu's mean flocculation states, Figs. 15, 21 and 22; a funnel's, Figs. 26 and 27, are those of flow alone.
void add_flocculation(std::vector<Finding>& all, const SceneFound& scene) {
  for (const Flocculation& f : scene.flocculation) {
    const auto add = [&](const std::string& claim, Holds holds, const std::string& seen) {
      all.push_back({claim,
                     scene.apparatus->judged_by() == scenes::MainGauge::discharge ? "Yu Figs. 26 and 27"
                                                                                  : "Yu Figs. 15, 21, 22",
                     scene.name, f.solver, scenes::to_string(f.model), holds, seen});
    };
    const auto said = [](bool holds) { return holds ? Holds::yes : Holds::no; };
    if (!f.rises_only)
      add("λ falls while the concrete flows", said(f.least < (1.0 - least_change) * f.start),
          fmt::format("from {:.2f} to {:.2f} within {}", f.start, f.least, compare::words::time(f.least_at)));
    if (!scene.apparatus->rests() || !(f.growth_at_rest > 0.0)) continue;
    const double share = f.rate_end / f.growth_at_rest;
    const std::string goes = fmt::format("{} by {:.2g} a second at {}, {:.0f} % of what it has at rest",
                                         f.rate_end < 0.0 ? "falls" : "grows", std::abs(f.rate_end),
                                         compare::words::time(f.end_at), 100.0 * std::abs(share));
    if (laws::can_rest(f.model))
      add("λ grows again once the solid rests", said(f.held || f.rate_end > 0.0),
          f.held ? fmt::format("rests with {:.2f}, from where it grows by {:.2g} a second", f.end,
                               f.growth_at_rest)
                 : goes);
    else if (f.rises_only)
      add("λ of the fresh concrete grows more slowly in the fluid than at rest", said(share < 1.0 - 1e-2),
          goes);
    else
      add("λ keeps falling in the fluid", said(f.rate_end < 0.0), goes);
  }
}

/// Numbers of a quantity from a source, of one solver, at hand.
struct Group {
  std::vector<const Number*> numbers = {};
  bool whole = true;  ///< every one of them is known
};

std::map<std::pair<Solver, std::string>, Group> groups_of(const std::vector<SceneFound>& scenes,
                                                          const std::string& quantity,
                                                          const std::string& source, bool all_laws) {
  std::map<std::pair<Solver, std::string>, Group> groups;
  for (const SceneFound& scene : scenes)
    for (const Number& n : scene.numbers) {
      if (n.published.quantity != quantity || n.published.source != source) continue;
      const auto put = [&](const std::string& law) {
        Group& group = groups[{n.solver, law}];
        if (n.ours)
          group.numbers.push_back(&n);
        else
          group.whole = false;
      };
      put(scenes::to_string(n.model));
      if (all_laws) put("all laws");
    }
  return groups;
}

std::string named(const Number& n) {
  if (laws::can_rest(n.model)) return n.published.scene;
  return fmt::format("{} {}", n.published.scene, scenes::to_string(n.model));
}

/// The order of the funnels' times: every pair that the paper tells apart.
void add_order(std::vector<Finding>& all, const std::vector<SceneFound>& scenes) {
  for (const auto& [who, group] : groups_of(scenes, "light_s", "Yu Table 4", true)) {
    const std::size_t count = group.numbers.size();
    if (count < 2 && group.whole) continue;
    Finding f{fmt::format("the V-funnels' times are in the paper's order"), "Yu Table 4",
              fmt::format("{} times", count), who.first, who.second};
    int pairs = 0, in_order = 0, alike = 0;
    std::vector<std::string> inverted;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) {
        const Number &a = *group.numbers[i], &b = *group.numbers[j];
        if (!(*a.published.target() < *b.published.target() - 1e-9)) continue;
        ++pairs;
        const double later = *b.ours - *a.ours;
        if (std::abs(later) < told_apart)
          ++alike;
        else if (later > 0.0)
          ++in_order;
        else
          inverted.push_back(
              fmt::format("{} ({:.2f} s) and {} ({:.2f} s)", named(a), *a.ours, named(b), *b.ours));
      }
    f.seen = fmt::format("{} of {} pairs are in order", in_order, pairs);
    if (alike > 0) f.seen += fmt::format("; {} cannot be told apart", alike);
    if (!inverted.empty()) {
      const std::size_t more = inverted.size() > named_at_most ? inverted.size() - named_at_most : 0;
      inverted.resize(inverted.size() - more);
      f.seen += fmt::format("; the other way round: {}{}", listed(inverted, "; "),
                            more > 0 ? fmt::format(", and {} more", more) : "");
    }
    f.holds = !inverted.empty() ? Holds::no : alike > 0 || !group.whole ? Holds::undecided : Holds::yes;
    if (pairs == 0) f.holds = Holds::not_run, f.seen.clear();
    all.push_back(f);
  }
}

/// Table 2: one set of parameters a mix, for all rests.
void add_spreads(std::vector<Finding>& all, const std::vector<SceneFound>& scenes) {
  for (const auto& [who, group] : groups_of(scenes, "spread_mm", "Yu Table 2", false)) {
    Finding f{"one set of parameters a mix gives every spread within 30 mm, on grids less than 15 mm apart",
              "Yu Table 2", fmt::format("{} spreads", group.numbers.size()), who.first, who.second};
    double worst = 0.0, apart = 0.0;
    bool within = true, two_grids = true, walls = false;
    std::string where;
    for (const Number* n : group.numbers) {
      within = within && n->within.value_or(false);
      walls = walls || !n->walls_differ.empty();
      if (n->coarse)
        apart = std::max(apart, std::abs(*n->ours - *n->coarse));
      else
        two_grids = false;
      if (const auto d = n->difference(); d && std::abs(*d) >= std::abs(worst)) {
        worst = *d;
        where = n->published.scene;
      }
    }
    if (!group.numbers.empty()) {
      f.seen =
          fmt::format("at most {:.0f} mm too {} ({}){}{}", std::abs(worst), worst < 0.0 ? "narrow" : "wide",
                      where, two_grids ? fmt::format("; two grids differ by {:.0f} mm at most", apart) : "",
                      walls ? "; its walls are not the scene's" : "");
      f.holds = !within || apart > grids_apart ? Holds::no
                : group.whole && two_grids     ? Holds::yes
                                               : Holds::undecided;
    }
    all.push_back(f);
  }
}

}  // namespace

std::string to_string(Finding::Holds holds) {
  switch (holds) {
    case Holds::yes:
      return "holds";
    case Holds::no:
      return "does not hold";
    case Holds::undecided:
      return "undecided";
    case Holds::not_run:
      return "not run";
  }
  throw std::logic_error("a finding without a word for it");
}

std::vector<Finding> findings_of(const std::vector<SceneFound>& scenes) {
  std::vector<Finding> all;
  add_spreads(all, scenes);
  for (const SceneFound& scene : scenes)
    if (scene.length_mm) add_length(all, scene);
  add_order(all, scenes);
  for (const SceneFound& scene : scenes)
    if (scene.apparatus->rests()) add_rest(all, scene);
  for (const SceneFound& scene : scenes) add_flocculation(all, scene);
  // Claim by claim, in the order in which they first came.
  std::vector<std::string> claims;
  for (const Finding& f : all)
    if (std::find(claims.begin(), claims.end(), f.claim) == claims.end()) claims.push_back(f.claim);
  std::stable_sort(all.begin(), all.end(), [&](const Finding& a, const Finding& b) {
    return std::find(claims.begin(), claims.end(), a.claim) <
           std::find(claims.begin(), claims.end(), b.claim);
  });
  return all;
}

}  // namespace flowrest::studies::validation
