#pragma once

#include "compare/comparison.h"

/// Differences between runs.
namespace flowrest::compare {

/// Compares every computed run with every exact one, and each two computed runs once, the earlier as the
/// reference.
void compare_pairs(Comparison&);

}  // namespace flowrest::compare
