#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "runs/errors.h"

namespace flowrest::runs {

/// A folder of the system's temporary ones that goes when it goes out of scope, with all that is in it.
class TemporaryFolder {
 public:
  /// @throws RunError where none can be made.
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "flowrest-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw RunError(name + ": cannot be made");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace flowrest::runs
