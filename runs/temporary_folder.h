#pragma once

#include <filesystem>
#include <optional>

namespace flowrest::runs {

/// Whether every program reads this path as it stands: absolute and not long, of ASCII letters, digits and
/// ". _ - + /" only, and without "processor", by which OpenFOAM knows the parts of a case.
bool is_plain(const std::filesystem::path&);

/// A folder of the system's temporary ones that goes when it goes out of scope, with all that is in it.
class TemporaryFolder {
 public:
  enum class Name {
    any,   ///< in TMPDIR wherever that is
    plain  ///< of a plain path: in TMPDIR where that has one, else in /tmp, /var/tmp or /dev/shm
  };
  /// @throws RunError where none can be made.
  explicit TemporaryFolder(Name = Name::any);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A name by which every program can reach a folder, whatever characters its path has: the path itself where
/// that is plain, else a link to it in a temporary folder, which goes when this goes out of scope.
class PlainName {
 public:
  /// @throws RunError where no link can be made.
  explicit PlainName(const std::filesystem::path& folder);
  const std::filesystem::path& path() const { return path_; }
  /// A folder whose real path is plain: the folder itself or the one that the link lies in.
  const std::filesystem::path& plain_folder() const { return place_ ? place_->path() : path_; }

 private:
  std::optional<TemporaryFolder> place_;
  std::filesystem::path path_;
};

}  // namespace flowrest::runs
