#pragma once

#include "compare/comparison.h"

/// What is measured of each run of a comparison.
namespace flowrest::compare {

/// Fills the run's measures, all but those that need other runs.
void measure(RunView&, const Comparison&);

/// How far each slump stands past the arrested spread of an elasto-viscoplastic run.
void measure_overshoot(Comparison&);

}  // namespace flowrest::compare
