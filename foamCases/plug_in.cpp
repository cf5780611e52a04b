#include "foamCases/plug_in.h"

#include <fmt/format.h>

#include <cstdlib>

#include "foamCases/apparatus/apparatus.h"
#include "runs/run_directory.h"
#include "scenes/installation.h"
#include "scenes/pieces.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using scenes::FoamLaws;
using scenes::Scene;

namespace {

constexpr const char* library = "libflowrestRheology.so";

std::string law(const Scene& scene) {
  return fmt::format("kind {}, model {}{}{}", scenes::name_of(scene.geometry.apparatus),
                     scenes::to_string(scene.material.model), scene.thixotropy ? " with [thixotropy]" : "",
                     scene.base.law == scenes::Wall::friction ? " on walls with friction" : "");
}

}  // namespace

std::optional<fs::path> find_plug_in() {
  fs::path path;
  if (const char* given = std::getenv("FLOWREST_RHEOLOGY"); given != nullptr && *given != '\0') {
    path = given;
  } else {
    path = scenes::openfoam_library(library);
  }
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  return fs::absolute(path);
}

std::string openfoam_of_plug_in() { return FLOWREST_OPENFOAM_VERSION; }

Scene settled(Scene scene, bool plug_in) {
  case_of(scene)->settle(scene.foam, plug_in);
  return scene;
}

bool carries_flocculation(const Scene& scene) {
  return scene.thixotropy && laws::has_yield_stress(scene.material.model);
}

bool needs_plug_in(const Scene& scene) {
  // What is mended where cells lean is mended by the plug-in.
  return case_of(scene)->leans() || scene.base.law == scenes::Wall::friction ||
         laws::can_rest(scene.material.model) || carries_flocculation(scene);
}

std::optional<fs::path> plug_in_for(const Scene& scene) {
  const bool needed = needs_plug_in(scene) || scene.foam.laws == FoamLaws::plug_in;
  if (scene.foam.laws == FoamLaws::built_in) {
    if (!needs_plug_in(scene)) return std::nullopt;
    throw scenes::SceneError(fmt::format(
        "{}: {}: OpenFOAM has nothing such of its own, but foam.laws is built-in; allowed: plug-in or best",
        scene.path.string(), law(scene)));
  }
  // Without a surface one viscosity is one viscosity.
  if (!laws::has_yield_stress(scene.material.model) && !scenes::pieces_of(scene).free_surface && !needed)
    return std::nullopt;
  const auto found = find_plug_in();
  if (!found && needed)
    throw runs::MissingProgram(fmt::format(
        "{} is not there: {} needs flowrest's rheology plug-in for OpenFOAM. `scripts/setup` fetches the "
        "headers it "
        "is compiled against; then configure and build again (or FLOWREST_RHEOLOGY names the library)",
        library, law(scene)));
  return found;
}

}  // namespace flowrest::foam
