#pragma once

#include "compare/comparison.h"

namespace flowrest::compare {

/// Fills the square where an MPM or OpenFOAM run of the elasto-viscoplastic law and one of a fluid are among
/// the runs; what is missing of it is named with the command that makes it.
void fill_square(Comparison&);

}  // namespace flowrest::compare
