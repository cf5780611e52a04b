#include "runs/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "runs/console.h"
#include "runs/folder.h"
#include "runs/machine.h"

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

/// Room for a run.json beside the one that is there, bytes.
constexpr off_t room = 131072;

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// Whether an open file is the one that the path names: between the two it may have been removed.
bool is_at(int file, const fs::path& path) {
  struct stat open_one {
  }, named{};
  return fstat(file, &open_one) == 0 && stat(path.c_str(), &named) == 0 && open_one.st_ino == named.st_ino &&
         open_one.st_dev == named.st_dev;
}

/// Who holds the lock of a folder, in words.
std::string holder(int file, const fs::path& folder) {
  std::array<char, 512> text{};
  const ssize_t length = pread(file, text.data(), text.size() - 1, 0);
  std::istringstream signature(length > 0 ? text.data() : "");
  pid_t pid = 0;
  std::string host;
  if (!(signature >> pid >> host)) return fmt::format("{}: another process is writing here", folder.string());
  if (host != host_name())
    return fmt::format("{}: process {} on {} is writing here", folder.string(), pid, host);
  if (kill(pid, 0) != 0 && errno == ESRCH)
    return fmt::format("{}: process {} has ended, but programs that it started are still writing here",
                       folder.string(), pid);
  return fmt::format("{}: process {} is writing here", folder.string(), pid);
}

fs::path whole_path(const fs::path& folder) {
  std::error_code ignored;
  const fs::path path = fs::absolute(folder, ignored).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

/// The outermost of a folder's parents, itself included, that is not there; empty where all are.
fs::path first_missing(const fs::path& folder) {
  fs::path missing;
  std::error_code ignored;
  for (fs::path path = whole_path(folder); !path.empty() && !fs::exists(path, ignored);
       path = path.parent_path())
    missing = path;
  return missing;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) : folder_(folder), first_made_(first_missing(folder)) {
  make_folder(folder);
  while (!take()) {
  }
  sign();
}

/// Takes the lock of the file that is there now. False where the file went meanwhile, with its last holder.
bool FolderLock::take() {
  const fs::path path = folder_ / file_name;
  // Not closed on exec: what we start goes on holding the folder if we are killed.
  file_ = open(path.c_str(), O_RDWR | O_CREAT, 0644);
  if (file_ < 0) cannot_be_written(path, errno);
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) {
      const std::string who = holder(file_, folder_);
      close(std::exchange(file_, -1));
      throw RunError(who + "; wait for it, end it, or name another folder");
    }
    say(stderr, fmt::format("{}: the file system has no locks ({}); see that nothing else writes here\n",
                            folder_.string(), std::generic_category().message(errno)));
  } else if (!is_at(file_, path)) {
    close(std::exchange(file_, -1));
    return false;
  }
  return true;
}

void FolderLock::sign() {
  const std::string text = fmt::format("{} {}\n", getpid(), host_name());
  // On a full disk it stays unsigned; it holds all the same.
  if (ftruncate(file_, 0) == 0) static_cast<void>(pwrite(file_, text.data(), text.size(), 0) != 0);
}

FolderLock::~FolderLock() {
  if (file_ < 0) return;
  close(file_);
  // Programs that we started may hold it still. Where nobody does, a new descriptor can have it.
  const fs::path path = folder_ / file_name;
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file >= 0) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0 && is_at(file, path)) unlink(path.c_str());
    close(file);
  }
  if (first_made_.empty()) return;
  const fs::path outermost = first_made_.parent_path();
  for (fs::path made = whole_path(folder_); made != outermost; made = made.parent_path())
    if (rmdir(made.c_str()) != 0) return;  // something came into it
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : folder_(std::move(other.folder_)),
      first_made_(std::move(other.first_made_)),
      file_(std::exchange(other.file_, -1)) {}

void FolderLock::keep_room() { static_cast<void>(posix_fallocate(file_, 0, room) != 0); }

void FolderLock::give_room() { sign(); }

}  // namespace flowrest::runs
