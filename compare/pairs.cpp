#include "compare/pairs.h"

#include "compare/apparatus/apparatus.h"

namespace flowrest::compare {

namespace {

std::string pair_kind(const RunView& run, const RunView& reference) {
  if (reference.exact || run.exact) return "exact";
  const bool same_solver = run.solver == reference.solver, same_model = run.model == reference.model;
  if (same_solver) return same_model ? "settings" : "law";
  return same_model ? "solver" : "both";
}

}  // namespace

void compare_pairs(Comparison& comparison) {
  const double floor = comparison.apparatus->has_depth() ? 0.01 * comparison.grain.length : 0.0;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i)
    for (std::size_t j = 0; j < comparison.runs.size(); ++j) {
      const RunView& run = comparison.runs[i];
      const RunView& reference = comparison.runs[j];
      if (run.exact || (!reference.exact && j >= i)) continue;
      Pair pair{i, j, pair_kind(run, reference), {}};
      std::vector<double> times = comparison.times;
      if (reference.exact && !comparison.apparatus->has_depth()) {
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

}  // namespace flowrest::compare
