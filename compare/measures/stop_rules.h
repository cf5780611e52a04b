#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"

/// Rules by which people cut the run of a fluid that never comes to rest, and what each would have read.
namespace flowrest::compare {

/// Where one rule cuts one run.
struct RuleStop {
  std::string rule;                  ///< "speed below 0.1 mm/s"
  std::optional<double> time = {};   ///< s; nothing: the rule never cuts this run, or it is no longer
  std::optional<double> gauge = {};  ///< the gauge then, SI
};

/// Round times of the standard apparatus, 10, 20, 25 and 60 s; the root mean square of the speed below 1e-4 m/s
/// (Zhang et al., B.3) and 1e-3 m/s; the 99th percentile of the shear rate below 0.1 and 0.01 1/s; the growth
/// of the gauge below 1 and 0.1 mm/s. Times, speeds and rates are scaled to the body as the thresholds of the
/// comparison are. A rule cuts where its quantity, after its largest value, is first below.
std::vector<RuleStop> stops_by_rules(const RunView&, const Thresholds&);

}  // namespace flowrest::compare
