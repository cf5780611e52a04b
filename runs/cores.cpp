#include "runs/cores.h"

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

/// Cores of the affinity mask, however many the machine has.
int cores_of_mask() {
  for (int size = 1024; size <= 1 << 20; size *= 2) {
    cpu_set_t* const set = CPU_ALLOC(size);
    if (!set) break;
    const std::size_t bytes = CPU_ALLOC_SIZE(size);
    const int found = sched_getaffinity(0, bytes, set) == 0 ? CPU_COUNT_S(bytes, set) : 0;
    CPU_FREE(set);
    if (found > 0) return found;
  }
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// The number above 0 that a variable begins with ("4" or "4,2"), if it does.
std::optional<int> limit_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (!value) return std::nullopt;
  std::string text = value;
  text = text.substr(0, text.find(','));
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  if (first == std::string::npos) return std::nullopt;
  int number = 0;
  const char *const begin = text.data() + first, *const end = text.data() + last + 1;
  const auto read = std::from_chars(begin, end, number);
  if (read.ec != std::errc() || read.ptr != end || number < 1) return std::nullopt;
  return number;
}

bool holds(const std::string& list, const std::string& word) {
  std::istringstream words(list);
  for (std::string w; std::getline(words, w, ',');)
    if (w == word) return true;
  return false;
}

/// A hierarchy of control groups: where it is mounted, and the group that stands there.
struct Mount {
  fs::path at, group;
};

/// From a line of /proc/self/mountinfo: `36 35 98:0 GROUP AT options ... - type source options`.
std::optional<Mount> mount_of(const std::string& line, bool second_version) {
  std::istringstream words(line);
  std::string word, group, at, type, source, options;
  words >> word >> word >> word >> group >> at;
  while (words >> word && word != "-") continue;
  words >> type >> source >> options;
  if (second_version ? type == "cgroup2" : type == "cgroup" && holds(options, "cpu")) return Mount{at, group};
  return std::nullopt;
}

/// The quota in one group's folder, in cores.
std::optional<double> quota_in(const fs::path& folder, bool second_version) {
  const auto first_word = [&](const char* name, std::string& rest) {
    std::ifstream file(folder / name);
    std::string word;
    file >> word >> rest;
    return word;
  };
  std::string period, ignored;
  const std::string quota =
      second_version ? first_word("cpu.max", period) : first_word("cpu.cfs_quota_us", ignored);
  if (!second_version) period = first_word("cpu.cfs_period_us", ignored);
  const double granted = std::atof(quota.c_str()), of = std::atof(period.c_str());
  if (!(granted > 0.0) || !(of > 0.0)) return std::nullopt;  // "max" and -1 are no limit
  return granted / of;
}

/// The least quota of a group and of those that hold it.
std::optional<double> quota_of(const fs::path& root, const std::string& group, bool second_version) {
  std::ifstream mounts(root / "proc/self/mountinfo");
  std::optional<double> least;
  for (std::string line; std::getline(mounts, line);) {
    const auto mount = mount_of(line, second_version);
    if (!mount) continue;
    const fs::path top = root / mount->at.relative_path();
    // In a container the group may be named as the machine outside knows it: then what is mounted is ours.
    fs::path below = fs::path(group).lexically_relative(mount->group);
    if (below.empty() || *below.begin() == ".." || !fs::exists(top / below)) below = ".";
    for (fs::path folder = (top / below).lexically_normal();; folder = folder.parent_path()) {
      if (const auto quota = quota_in(folder, second_version))
        least = std::min(*quota, least.value_or(*quota));
      if (fs::path rest = folder.lexically_relative(top); rest.empty() || rest == "." || rest == "..") break;
    }
  }
  return least;
}

}  // namespace

std::optional<double> core_quota(const fs::path& root) {
  std::ifstream groups(root / "proc/self/cgroup");
  std::optional<double> least;
  for (std::string line; std::getline(groups, line);) {
    // `hierarchy:controllers:group`, with no controllers in version 2
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (!controllers.empty() && !holds(controllers, "cpu")) continue;
    if (const auto quota = quota_of(root, line.substr(second + 1), controllers.empty()))
      least = std::min(*quota, least.value_or(*quota));
  }
  return least;
}

int cores() {
  int ours = cores_of_mask();
  if (const auto quota = core_quota()) ours = std::min(ours, static_cast<int>(std::min(*quota, 1e6)));
  for (const char* variable : {"OMP_NUM_THREADS", "OMP_THREAD_LIMIT", "SLURM_CPUS_PER_TASK"})
    ours = std::min(ours, limit_in(variable).value_or(ours));
  return std::max(1, ours);
}

}  // namespace flowrest::runs
