#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scenes/scene.h"

/// Fills an OpenFOAM case from a scene: the case is copied as it is, and one file in it, sceneParameters, is
/// written.
namespace flowrest::foam {

/// Says whether the built-in case can run a scene, with its model, dimension and walls.
/// @throws scenes::SceneError naming what it cannot and what is allowed.
void check_supported(const scenes::Scene&);

/// The folder of the cases: FLOWREST_FOAM_CASES where set, else those that flowrest brings.
std::filesystem::path cases_folder();

/// Components of the velocity that a case solves for: those whose residuals tell of noise.
std::string solved_components(const scenes::Scene&);

/// Simulated seconds between the samples interFoam writes for the gauges.
double sample_interval(const scenes::Scene&);

/// The text of sceneParameters, with the laws of the plug-in or OpenFOAM's own.
std::string scene_parameters(const scenes::Scene&, bool plug_in, int ranks = 1);

/// Writes sceneParameters of a case that is there already.
void fill_parameters(const scenes::Scene&, const std::filesystem::path& directory, bool plug_in, int ranks);

/// Copies the scene's case into `directory`, with its sceneParameters and its initial fields in 0/, and a
/// link to the plug-in (its path) where it takes that.
/// @throws runs::RunError where the case cannot be found or copied, or `directory` holds what `flowrest foam`
/// did not put there.
void fill_case(const scenes::Scene&, const std::filesystem::path& directory,
               const std::optional<std::filesystem::path>& plug_in, int ranks = 1);

}  // namespace flowrest::foam
