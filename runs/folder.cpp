#include "runs/folder.h"

#include <fmt/format.h>

#include "runs/run_directory.h"

namespace flowrest::runs {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder))
    throw RunError(fmt::format("{}: cannot be made a folder: {}", folder.string(),
                               error ? error.message() : "a file of that name is in the way"));
}

}  // namespace flowrest::runs
