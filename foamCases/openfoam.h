#pragma once

#include <filesystem>
#include <string>

#include "runs/environment.h"

/// Which OpenFOAM is run, and what its programs are told. It is the one that flowrest was built with (the
/// plug-in fits no other), whatever a shell has sourced and whatever lies on the PATH: Debian's, or the one
/// that was sourced when CMake was told to take that (openfoam.cmake).
namespace flowrest::foam {

/// A program of OpenFOAM's: in the folder that FLOWREST_OPENFOAM_PROGRAMS names where it is set, else where
/// the OpenFOAM lies that flowrest was built with.
/// @throws runs::MissingProgram where it is not there.
std::filesystem::path openfoam_program(const std::string& name);

/// The mpirun of the Open MPI that OpenFOAM was built with.
/// @throws runs::MissingProgram where it is not there.
std::filesystem::path openfoam_mpirun();

/// The environment of OpenFOAM's programs and of mpirun.
runs::Environment openfoam_environment();

}  // namespace flowrest::foam
