#include "foamCases/openfoam.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>

#include "runs/run_directory.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

namespace {

fs::path programs_folder() {
  if (const char* given = std::getenv("FLOWREST_OPENFOAM_PROGRAMS"); given != nullptr && *given != '\0')
    return fs::absolute(given);
  return FLOWREST_OPENFOAM_PROGRAMS;
}

std::optional<fs::path> find(const std::string& name) {
  const fs::path path = programs_folder() / name;
  std::error_code error;
  if (fs::is_regular_file(path, error) && access(path.c_str(), X_OK) == 0) return path;
  return std::nullopt;
}

}  // namespace

fs::path openfoam_program(const std::string& name) {
  if (const auto found = find(name)) return *found;
  throw runs::MissingProgram(fmt::format(
      "{} is not there: `flowrest foam` needs the OpenFOAM that it was built with (Debian: apt-get install "
      "openfoam)",
      (programs_folder() / name).string()));
}

fs::path openfoam_mpirun() {
  // Debian's mpirun is that of the MPI which an administrator prefers, and its OpenFOAM one of Open MPI's.
  if (const auto found = find("mpirun.openmpi")) return *found;
  return openfoam_program("mpirun");
}

/// Debian's OpenFOAM needs to be told where its etc folder is, and nothing else; Open MPI that root may use
/// it.
runs::Environment openfoam_environment() {
  auto environment = runs::Environment::of_helper();
  return environment.set("WM_PROJECT_DIR", FLOWREST_OPENFOAM_PROJECT)
      .set("OMPI_ALLOW_RUN_AS_ROOT", "1")
      .set("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
}

}  // namespace flowrest::foam
