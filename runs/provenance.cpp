#include <sys/resource.h>
#include <sys/utsname.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

#include "git_version.h"
#include "runs/run_directory.h"

namespace flowrest::runs {

namespace {

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const auto colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string system_name() {
  utsname name{};
  if (uname(&name) != 0) return "unknown";
  return std::string(name.sysname) + " " + name.release + " " + name.machine;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

double seconds_of(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

nlohmann::ordered_json provenance() {
  return {
    {"flowrest", FLOWREST_VERSION}, {"git_hash", FLOWREST_GIT_HASH}, {"git_dirty", FLOWREST_GIT_DIRTY},
        {"sources", FLOWREST_SOURCES}, {"build", FLOWREST_BUILD_TYPE},
#if defined(__clang__)
        {"compiler", "Clang " __clang_version__},
#elif defined(__GNUC__)
        {"compiler", "GCC " __VERSION__},
#else
        {"compiler", "unknown"},
#endif
        {"system", system_name()}, {"cpu", cpu_model()}, {"cores", std::thread::hardware_concurrency()},
        {"written", utc_now()},
  };
}

std::string version_in(const nlohmann::ordered_json& provenance) {
  const auto text = [&](const char* key) {
    const auto found = provenance.find(key);
    return found != provenance.end() && found->is_string() ? found->get<std::string>() : "unknown";
  };
  const auto modified = provenance.find("git_dirty");
  return text("flowrest") + " (commit " + text("git_hash").substr(0, 12) +
         (modified != provenance.end() && *modified == true ? ", modified)" : ")");
}

double peak_memory_bytes() {
  const auto kibibytes = [](int who) {
    rusage usage{};
    getrusage(who, &usage);
    return static_cast<double>(usage.ru_maxrss);
  };
  return 1024.0 * std::max(kibibytes(RUSAGE_SELF), kibibytes(RUSAGE_CHILDREN));
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds(bool children) {
  return seconds_of(RUSAGE_SELF) + (children ? seconds_of(RUSAGE_CHILDREN) : 0.0);
}

}  // namespace flowrest::runs
