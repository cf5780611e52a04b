#include "cli/version.h"

#include <fmt/format.h>

#include "runs/run_directory.h"
#ifdef FLOWREST_HAS_FOAM
#include "foamCases/openfoam.h"
#include "foamCases/plug_in.h"
#endif

namespace flowrest::cli {

namespace {

std::string parts() {
  std::string names = "mpm";
#ifdef FLOWREST_HAS_FOAM
  names +=
      foam::find_plug_in() ? ", foam (with the rheology plug-in)" : ", foam (without the rheology plug-in)";
#endif
#ifdef FLOWREST_HAS_COMPARE
  names += ", compare, studies";
#endif
  return names;
}

#ifdef FLOWREST_HAS_FOAM
std::string interfoam() {
  try {
    return fmt::format("interFoam is {}", foam::openfoam_program("interFoam").string());
  } catch (const runs::MissingProgram& missing) {
    return missing.what();
  }
}

std::string openfoam() {
  const std::string compiled = foam::openfoam_of_plug_in();
  return compiled.empty() ? interfoam() : fmt::format("the plug-in is for {}; {}", compiled, interfoam());
}
#endif

}  // namespace

std::string version_text() {
  const auto made = runs::provenance();
  const auto text = [&made](const char* key) { return made.at(key).get<std::string>(); };
  std::string lines = fmt::format("flowrest {}\n", text("flowrest"));
  lines +=
      fmt::format("commit: {}{}\n", text("git_hash"), made.at("git_dirty").get<bool>() ? ", modified" : "");
  lines += fmt::format("build: {}, {}\n", text("build"), text("compiler"));
  lines += fmt::format("parts: {}", parts());
#ifdef FLOWREST_HAS_FOAM
  lines += fmt::format("\nOpenFOAM: {}", openfoam());
#endif
  return lines;
}

}  // namespace flowrest::cli
