#include "studies/verification/scene_runs.h"

#include <fmt/format.h>

#include "runs/process.h"
#include "scenes/installation.h"

namespace flowrest::studies::verification {

namespace fs = std::filesystem;

std::string setting(const std::string& key, double value) { return fmt::format("{}={:.17g}", key, value); }

runs::Run run_scene(const std::string& scene, const std::vector<std::string>& set, const std::string& solver,
                    const Workplace& place) {
  const fs::path directory = place.folder / "run", log = place.folder / "log";
  fs::remove_all(directory);
  std::vector<std::string> arguments = {solver, scene, "-o", directory.string()};
  for (const std::string& s : set) arguments.insert(arguments.end(), {"--set", s});
  for (const char* s : {"mpm.threads=1", "output.snapshot_interval=1e6", "output.checkpoint_interval=1e6"})
    arguments.insert(arguments.end(), {"--set", s});
  runs::Process process(scenes::program_file(), arguments, fs::current_path(), log, {});
  bool asked = false;
  while (!process.wait(0.2))
    if (place.interrupted()) asked = process.hand_on_interrupts();
  if (asked) throw runs::NumericsError("interrupted");
  const runs::ProcessEnd end = *process.poll();
  if (!end.good()) throw runs::NumericsError(fmt::format("{}: {}", end.how(), runs::last_words(log)));
  return runs::read_run(directory);
}

}  // namespace flowrest::studies::verification
