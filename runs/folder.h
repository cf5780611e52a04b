#pragma once

#include <filesystem>

namespace flowrest::runs {

/// Makes a folder, and those it lies in; one that is there stays as it is.
/// @throws RunError where it cannot be made or a file of that name is in the way.
void make_folder(const std::filesystem::path&);

}  // namespace flowrest::runs
