#pragma once

#include <vector>

#include "compare/comparison.h"
#include "compare/report/page.h"

namespace flowrest::compare::fields {

/// Particles beside cells over a vertical section at the same times, and of an L-box in space a level one, on
/// which the bars leave their streaks; none where no run of the comparison left its states. They hold at most
/// `most_times` states of each run and about `budget` bytes together: particles beyond that are thinned out.
std::vector<report::Section> sections_of(const Comparison&, std::size_t most_times = 18,
                                         std::size_t budget = 1'100'000);

}  // namespace flowrest::compare::fields
