#pragma once

#include <optional>

#include "compare/comparison.h"
#include "compare/report/page.h"

namespace flowrest::compare::fields {

/// Particles beside cells over a vertical section at the same times; nothing where no run of the comparison
/// is a body in space or none left its states. At most `budget` bytes of states are put into it: with more,
/// fewer times and particles.
std::optional<report::Section> section_of(const Comparison&, std::size_t budget = 1'100'000);

}  // namespace flowrest::compare::fields
