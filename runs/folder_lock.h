#pragma once

#include <filesystem>

namespace flowrest::runs {

/// Holds a folder while it lives, so that two never write into one. The lock dies with its holder, and with
/// the programs that the holder has started: they write into the folder, too. A file in the folder carries
/// it, which says who holds it and goes with it.
class FolderLock {
 public:
  static constexpr const char* file_name = ".lock";

  /// Makes the folder where it is not there; one that stays empty goes again with the lock.
  /// @throws RunError where somebody else holds the folder, naming the process, or it cannot be written.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(FolderLock&&) noexcept;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  /// Keeps some room on the disk, as far as the file system does, until `give_room`.
  void keep_room();
  void give_room();

 private:
  bool take();
  void sign();

  std::filesystem::path folder_, first_made_;
  int file_ = -1;
};

}  // namespace flowrest::runs
