#include "studies/verification/scene_runs.h"

#include <fmt/format.h>

#include <fstream>

#include "runs/process.h"
#include "scenes/installation.h"

namespace flowrest::studies::verification {

namespace fs = std::filesystem;

std::string setting(const std::string& key, double value) { return fmt::format("{}={:.17g}", key, value); }

namespace {

/// Runs a command of this program to its end.
void run_command(std::vector<std::string> arguments, const std::vector<std::string>& set,
                 const Workplace& place) {
  const fs::path log = place.folder / "log";
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
}

}  // namespace

runs::Run run_scene(const std::string& scene, const std::vector<std::string>& set, const std::string& solver,
                    const Workplace& place) {
  const fs::path directory = place.folder / "run";
  fs::remove_all(directory);
  run_command({solver, scene, "-o", directory.string()}, set, place);
  return runs::read_run(directory);
}

nlohmann::json run_gradient(const std::string& scene, const std::vector<std::string>& set,
                            const std::string& of, const std::string& by, const std::string& mode,
                            const Workplace& place) {
  const fs::path directory = place.folder / "run";
  fs::remove_all(directory);
  run_command(
      {"gradient", scene, "--of", of, "--by", by, "--mode", mode, "--check", "-o", directory.string()}, set,
      place);
  std::ifstream file(directory / "gradient.json");
  return nlohmann::json::parse(file);
}

}  // namespace flowrest::studies::verification
