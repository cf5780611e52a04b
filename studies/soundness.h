#pragma once

#include <string>

#include "runs/run_directory.h"
#include "scenes/scene.h"

/// Whether what a run wrote can be true: an examination from outside, which knows nothing of the solver.
namespace flowrest::studies {

/// What must not be, of a run that came to its end and calls itself sound; empty where everything holds:
/// every number finite, mass exact, volume within what the equation of state makes of the weight, no energy
/// made, flocculation not negative, no speed beyond that of the fall, no spread beyond the domain. Whatever
/// this finds in a run with the verdict "sound" is silently wrong.
std::string unsound(const runs::Run&, const scenes::Scene&);

}  // namespace flowrest::studies
