#pragma once

#include <optional>

#include "compare/comparison.h"
#include "compare/report/page.h"

namespace flowrest::compare::fields {

/// Particles beside cells over a vertical section at the same times; nothing where no run of the comparison is a
/// body in space or none left its states. It holds at most `most_times` states of each run and about `budget`
/// bytes: particles beyond that are thinned out.
std::optional<report::Section> section_of(const Comparison&, std::size_t most_times = 18,
                                          std::size_t budget = 1'100'000);

}  // namespace flowrest::compare::fields
