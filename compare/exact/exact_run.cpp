#include "compare/exact/exact_run.h"

#include <fmt/format.h>

#include "compare/apparatus/apparatus.h"
#include "runs/run_directory.h"

namespace flowrest::compare::exact {

using scenes::Scene;

void check_film(const Scene& scene) { report_of(scene.geometry.apparatus).check_film(scene); }

ExactRun write_film_run(const Scene& scene, const std::filesystem::path& directory, bool plug_pulls,
                        runs::Replace replace) {
  return report_of(scene.geometry.apparatus).write_film_run(scene, directory, plug_pulls, replace);
}

std::vector<ExactRun> write_exact_runs(const Scene& scene, const std::filesystem::path& directory,
                                       std::optional<double> flocculation, runs::Replace replace) {
  if (std::filesystem::exists(directory / "run.json"))
    throw runs::RunError(fmt::format("{}: is itself a run; name the folder that shall hold the exact runs",
                                     directory.string()));
  return report_of(scene.geometry.apparatus).write_exact_runs(scene, directory, flocculation, replace);
}

}  // namespace flowrest::compare::exact
