// Any three files are a run or are refused with a RunError. The input is cut at its first two zero bytes into
// run.json, history.csv and profiles.csv.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "runs/run_directory.h"

namespace fs = std::filesystem;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fs::path folder = [] {
    const fs::path made = fs::path(fs::exists("/dev/shm") ? "/dev/shm" : "/tmp") /
                          ("flowrest-fuzz-" + std::to_string(getpid()));
    fs::create_directories(made);
    return made;
  }();
  std::string rest(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"run.json", "history.csv", "profiles.csv"}) {
    const auto end = rest.find('\0');
    std::ofstream(folder / name, std::ios::binary) << rest.substr(0, end);
    rest = end == std::string::npos ? "" : rest.substr(end + 1);
  }
  try {
    const auto run = flowrest::runs::read_run(folder);
    run.label();
  } catch (const flowrest::runs::RunError&) {
  }
  return 0;
}
