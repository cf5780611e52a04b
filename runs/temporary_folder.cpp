#include "runs/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "runs/run_directory.h"

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

/// Programs keep paths in buffers of a few hundred characters, and add to them.
constexpr std::size_t longest_plain = 100;

bool is_plain_character(char c) {
  constexpr std::string_view others = "._-+/";
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         others.find(c) != std::string_view::npos;
}

/// Where temporary folders may lie, the best place first.
std::vector<fs::path> places() {
  std::vector<fs::path> found;
  if (const char* given = std::getenv("TMPDIR"); given != nullptr && *given != '\0') {
    std::error_code error;
    if (const fs::path absolute = fs::absolute(given, error); !error) found.push_back(absolute);
  }
  found.insert(found.end(), {"/tmp", "/var/tmp", "/dev/shm"});
  return found;
}

}  // namespace

bool is_plain(const fs::path& path) {
  const std::string& text = path.native();
  return path.is_absolute() && text.size() <= longest_plain &&
         std::all_of(text.begin(), text.end(), is_plain_character) &&
         text.find("processor") == std::string::npos;
}

TemporaryFolder::TemporaryFolder(Name wanted) {
  std::string tried;
  for (const fs::path& place : places()) {
    if (wanted == Name::plain && !is_plain(place)) continue;
    std::string name = (place / "flowrest-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) {
      path_ = name;
      return;
    }
    tried += fmt::format("{}{} ({})", tried.empty() ? "" : ", ", place.string(), std::strerror(errno));
  }
  throw RunError(
      fmt::format("no temporary folder can be made in {}; TMPDIR names a folder that can be written", tried));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

PlainName::PlainName(const fs::path& folder) : path_(fs::absolute(folder).lexically_normal()) {
  if (is_plain(path_)) return;
  place_.emplace(TemporaryFolder::Name::plain);
  const fs::path link = *place_ / path_.filename().c_str(), target = path_;
  path_ = is_plain(link) ? link : *place_ / "folder";
  std::error_code error;
  fs::create_directory_symlink(target, path_, error);
  if (error)
    throw RunError(
        fmt::format("{}: cannot be linked to {}: {}", path_.string(), target.string(), error.message()));
}

}  // namespace flowrest::runs
