#pragma once

#include <utility>
#include <vector>

#include "compare/comparison.h"

/// What is measured of each run of a comparison.
namespace flowrest::compare {

/// (from time, force) in ascending time, N/m3; empty where the run does not say.
std::vector<std::pair<double, double>> body_forces(const RunView&);

/// Fills the run's measures, all but those that need other runs.
void measure(RunView&, const Comparison&);

/// How far each slump stands past the arrested spread of an elasto-viscoplastic run.
void measure_overshoot(Comparison&);

/// How well the readings of each run are known by another grid, and its gauge at the end: by a run of the
/// same law and solver on another grid where there is one, else by its cell; never less than its scatter nor,
/// where its edge is a film, than half of what it changes by when the edge is read at half or at twice the
/// depth.
void measure_uncertainty(Comparison&);

/// Whether the spread's change between readings at half and at twice its depth (m) is that of a film and not
/// of a sloping edge: three cells or more.
bool ends_in_film(const Comparison&, double sensitivity);

}  // namespace flowrest::compare
