#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runs/run_folder.h"
#include "scenes/scene.h"

namespace flowrest::compare::exact {

/// A run directory that holds a solution, with one line of what it says.
struct ExactRun {
  std::filesystem::path directory;
  std::string summary;
};

/// Writes every exact or asymptotic solution the scene has into a run directory of its own below `directory`:
/// a slump leaves `leading-order` and `second-order` (a plane one only the first), a duct
/// `steady`, an L-box `arrested`. Nothing is written of a scene that has none. `flocculation`: that with
/// which a thixotropic material comes to rest or flows steadily, which hangs on its history and must be
/// given. An earlier solution of the same settings is written anew.
/// @throws runs::RunError where the scene has no such solution, saying why, or another run stands in the way.
std::vector<ExactRun> write_exact_runs(const scenes::Scene&, const std::filesystem::path& directory,
                                       std::optional<double> flocculation = std::nullopt,
                                       runs::Replace = runs::Replace::unfinished);

/// @throws runs::RunError where write_film_run has no film for this scene, saying why.
void check_film(const scenes::Scene&);

/// The slump as a thin film of the scene's Bingham material, in time: what its own law lets it do, without
/// inertia and without a grid over its depth. `plug_pulls`: with the extensional stress of the plug, so that
/// it comes to the second-order slump instead of the leading-order one.
/// @throws runs::RunError where the scene is no such slump, saying why.
ExactRun write_film_run(const scenes::Scene&, const std::filesystem::path& directory, bool plug_pulls = false,
                        runs::Replace = runs::Replace::unfinished);

}  // namespace flowrest::compare::exact
