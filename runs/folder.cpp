#include "runs/folder.h"

#include <fmt/format.h>

#include "runs/machine.h"

namespace flowrest::runs {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (machine_is_at_fault(error.value()))
    throw MachineError(fmt::format("{}: cannot be made a folder: {}", folder.string(), error.message()));
  if (error || !fs::is_directory(folder))
    throw RunError(fmt::format("{}: cannot be made a folder: {}", folder.string(),
                               error ? error.message() : "a file of that name is in the way"));
}

void copy_writable(const fs::path& from, const fs::path& to) {
  if (fs::is_directory(from)) {
    fs::create_directories(to);
    for (const auto& entry : fs::directory_iterator(from))
      copy_writable(entry.path(), to / entry.path().filename());
    return;
  }
  fs::copy_file(from, to, fs::copy_options::overwrite_existing);
  fs::permissions(to, fs::perms::owner_write, fs::perm_options::add);
}

}  // namespace flowrest::runs
