#pragma once

#include <filesystem>
#include <string>

/// Where the parts of flowrest lie that are files: beside the folder of the running program. A build tree has
/// the layout of an installed one (cmake/FlowrestInstall.cmake), so that there is one way to look.
namespace flowrest::scenes {

/// The file of the running program.
std::filesystem::path program_file();

/// A folder that flowrest brings, such as "scenes": share/flowrest/NAME. Nothing may be there.
std::filesystem::path shared_folder(const std::string& name);

/// A library that flowrest brings for OpenFOAM: lib/flowrest/openfoam/NAME. Nothing may be there.
std::filesystem::path openfoam_library(const std::string& name);

}  // namespace flowrest::scenes
