#pragma once

#include <memory>
#include <vector>

#include "mpm/solver/solver.h"

namespace flowrest::mpm::plain {

/// What the plain step does not serve of a solver's settings, in words; empty where it serves them all.
std::string not_served(const SolverSettings&);

/// The plain step (step.h) behind the interface that runs are made with: one thread, the same results as the
/// kernels but for round-off.
/// @throws std::invalid_argument where the settings are not served.
std::unique_ptr<Solver> make_solver(const SolverSettings&, const SeedSource&);
std::unique_ptr<Solver> make_solver(const SolverSettings&, const StoredState&);
std::unique_ptr<Solver> make_solver(const SolverSettings&, const std::vector<Seed>&);
std::unique_ptr<Solver> make_solver(const SolverSettings&, const SolverState&);

}  // namespace flowrest::mpm::plain
