#pragma once

#include <filesystem>

namespace flowrest::runs {

/// Makes a folder, and those it lies in; one that is there stays as it is.
/// @throws RunError where it cannot be made or a file of that name is in the way.
void make_folder(const std::filesystem::path&);

/// Copies a file, or a folder and all that it holds, over what is there. The original may be write-protected,
/// as what is installed often is; the copy is its owner's to write.
/// @throws std::filesystem::filesystem_error
void copy_writable(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace flowrest::runs
