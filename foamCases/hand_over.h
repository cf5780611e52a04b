#pragma once

#include <filesystem>
#include <string>

#include "runs/material_state.h"
#include "scenes/scene.h"

/// States that runs of OpenFOAM leave, and that they start from.
namespace flowrest::foam {

/// The state in a time folder of a run's case.
/// @throws runs::RunError where it has none for that time, saying which there are.
runs::MaterialState read_state(const std::string& from);

/// The name that OpenFOAM gives the folder of a time, and the time that it reads from it, s.
std::string folder_of_time(double time);

/// Makes a state the initial fields of a filled case, in the folder of its time. What stands over a column of
/// cells fills it from below; a column at the front or on a flank is cut by the surface that its neighbours
/// show. Volume, momentum and flocculation are the state's. Velocities of cells without concrete are zero, and
/// so is what walls remember of stresses.
void write_state(const scenes::Scene&, const runs::MaterialState&,
                 const std::filesystem::path& case_directory);

}  // namespace flowrest::foam
