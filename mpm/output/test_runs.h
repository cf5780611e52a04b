#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mpm/output/run.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

/// Runs small enough for a test, in a folder of their own.
namespace flowrest::mpm::test {

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The Roussel slump on cells of 20 mm for 0.3 s, some 160 steps, with `more` laid over it.
inline scenes::Scene tiny_slump(const std::vector<std::string>& more = {}) {
  std::vector<std::string> set = {"mpm.cell=0.02",
                                  "mpm.threads=1",
                                  "time.end=0.3",
                                  "output.history_interval=0.05",
                                  "output.profile_interval=0.1",
                                  "output.snapshot_interval=0.1",
                                  "output.checkpoint_interval=0.1"};
  set.insert(set.end(), more.begin(), more.end());
  return scenes::load_scene("roussel-slump", {set, {}});
}

inline std::vector<std::string> with(std::vector<std::string> some, const std::vector<std::string>& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

/// A test with a temporary folder.
class RunTest : public testing::Test {
 protected:
  RunOptions options(const std::string& name) const {
    RunOptions o;
    o.directory = folder / name;
    o.quiet = true;
    return o;
  }
  /// Runs a scene, whatever ran in the folder before, and reads what it left.
  runs::Run run_and_read(const scenes::Scene& scene, const std::string& name = "run") const {
    RunOptions anew = options(name);
    anew.force = true;
    run(scene, anew);
    return runs::read_run(folder / name);
  }

  runs::TemporaryFolder temporary;
  std::filesystem::path folder = temporary.path();
};

}  // namespace flowrest::mpm::test
