#include "runs/folder.h"

#include <fmt/format.h>

#include "runs/machine.h"

namespace flowrest::runs {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (machine_is_at_fault(error.value()))
    throw MachineError(fmt::format("{}: cannot be made a folder: {}", folder.string(), error.message()));
  if (error || !std::filesystem::is_directory(folder))
    throw RunError(fmt::format("{}: cannot be made a folder: {}", folder.string(),
                               error ? error.message() : "a file of that name is in the way"));
}

}  // namespace flowrest::runs
