#include "foamCases/openfoam.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "runs/errors.h"

namespace flowrest::foam {

namespace fs = std::filesystem;

namespace {

/// The folder of programs that the user names instead; empty where none is named.
fs::path programs_given() {
  const char* given = std::getenv("FLOWREST_OPENFOAM_PROGRAMS");
  return given != nullptr && *given != '\0' ? fs::absolute(given) : fs::path();
}

fs::path programs_folder() {
  const fs::path given = programs_given();
  return given.empty() ? fs::path(FLOWREST_OPENFOAM_PROGRAMS) : given;
}

bool is_program(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && access(path.c_str(), X_OK) == 0;
}

}  // namespace

fs::path openfoam_program(const std::string& name) {
  const fs::path path = programs_folder() / name;
  if (is_program(path)) return path;
  throw runs::MissingProgram(
      fmt::format("{} is not there: `flowrest foam` needs the OpenFOAM that it was built with ({})",
                  path.string(), FLOWREST_OPENFOAM_ORIGIN));
}

fs::path openfoam_mpirun() {
  if (const fs::path given = programs_given(); !given.empty() && is_program(given / "mpirun"))
    return given / "mpirun";
  const fs::path path = FLOWREST_OPENFOAM_MPIRUN;
  if (is_program(path)) return path;
  throw runs::MissingProgram(fmt::format(
      "{}: --ranks needs the mpirun of the Open MPI that OpenFOAM was built with ({})",
      path.empty() ? "there was none when flowrest was configured" : path.string() + " is not there",
      FLOWREST_OPENFOAM_ORIGIN));
}

/// OpenFOAM's programs need to be told where its etc folder is; a sourced one's also where its libraries are.
/// Open MPI needs to be told that root may use it.
runs::Environment openfoam_environment() {
  auto environment = runs::Environment::of_helper();
  environment.set("WM_PROJECT_DIR", FLOWREST_OPENFOAM_PROJECT)
      .set("PATH", programs_folder().string() + ":" + environment.entries().at("PATH"))
      .set("OMPI_ALLOW_RUN_AS_ROOT", "1")
      .set("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
  constexpr std::string_view search = FLOWREST_OPENFOAM_SEARCH;
  if (!search.empty()) environment.set("LD_LIBRARY_PATH", std::string(search));
  return environment;
}

}  // namespace flowrest::foam
