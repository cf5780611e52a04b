#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compare/exact/solutions.h"
#include "runs/run_directory.h"
#include "runs/run_folder.h"
#include "scenes/scene.h"

/// What the runs of exact solutions share.
namespace flowrest::compare::exact {

/// @throws runs::RunError: the scene has no exact solution.
[[noreturn]] void refuse(const scenes::Scene&, const std::string& why);

/// The scene's material with the yield stress that its structure gives it (Yu et al. 2026, Eq. 11).
/// @throws runs::RunError where it is thixotropic and `flocculation` is not given, or it is and need not be.
Bingham material_of(const scenes::Scene&, std::optional<double> flocculation = std::nullopt);

/// Opens the folder of a solution. What it takes besides the scene stands in its run.json.
runs::RunWriter open_run(const std::filesystem::path& directory, const scenes::Scene&,
                         std::optional<double> flocculation, runs::Replace);

/// Points from the middle to the edge, closer towards the edge where the depth falls steeply, and one just
/// beyond it.
std::vector<double> points_to(double edge);

}  // namespace flowrest::compare::exact
