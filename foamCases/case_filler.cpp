#include "foamCases/case_filler.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "foamCases/concrete_laws.h"
#include "foamCases/wedge_grid.h"
#include "runs/run_directory.h"
#include "scenes/step_limits.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using scenes::Model;
using scenes::Scene;
using scenes::SceneError;

namespace {

constexpr double most_duct_cells = 1e5;
constexpr double for_ever = 1e9;  // s

/// The name by which a case loads the plug-in.
constexpr const char* plug_in_link = "libflowrestRheology.so";

/// What a user may keep in a case folder beside its sources, and a copy must not take along.
bool belongs_to_case(const fs::path& name) {
  static constexpr std::array<const char*, 6> parts = {"0.orig",          "constant", "system",
                                                       "sceneParameters", "Allrun",   "Allclean"};
  return std::find(parts.begin(), parts.end(), name.string()) != parts.end();
}

[[noreturn]] void refuse(const Scene& scene, const std::string& what) {
  throw SceneError(fmt::format("{}: {}", scene.path.string(), what));
}

void check_model(const Scene& scene) {
  const auto& material = scene.material;
  switch (material.model) {
    case Model::elasto_viscoplastic:
      break;
    case Model::papanastasiou:
      if (!material.regularisation_time)
        refuse(scene, "model papanastasiou needs material.regularisation_time, in s and above 0");
      break;
    case Model::bi_viscous:
      if (!material.critical_shear_rate)
        refuse(scene, "model bi-viscous needs material.critical_shear_rate, in 1/s and above 0");
      break;
    case Model::newtonian:
      break;
  }
}

std::string mesh_parameters(const Scene& scene) {
  const auto& cone = scene.slump();
  const auto grid = wedge_grid(scene);
  const double half_width =
      cone.domain_radius * std::tan(0.5 * scene.foam.wedge_angle * std::numbers::pi / 180.0);
  return fmt::format(
      "// Mesh, m: a wedge of {} degrees with cells of about {} m.\n"
      "coneHeight          {};\n"
      "coneRadiusBottom    {};\n"
      "flankNormal         ({} 0 {});  // (height, 0, bottom radius - top radius)\n"
      "domainRadius        {};\n"
      "domainHeight        {};\n"
      "halfWidth           {};  // domainRadius tan(half angle)\n"
      "minusHalfWidth      {};\n"
      "radialCells         {};\n"
      "coneCells           {};\n"
      "airCells            {};\n",
      scene.foam.wedge_angle, scene.foam.cell, cone.cone_height, cone.cone_radius_bottom, cone.cone_height,
      cone.cone_radius_bottom - cone.cone_radius_top, cone.domain_radius, cone.domain_height, half_width,
      -half_width, grid.rings, grid.cone_rows, grid.air_rows);
}

std::string time_parameters(const Scene& scene) {
  const double step = scenes::largest_foam_step(scene);
  return fmt::format(
      "\n// Time, s.\n"
      "endTime             {};\n"
      "firstDeltaT         {};\n"
      "maxDeltaT           {};\n"
      "maxCourant          {};\n"
      "sampleInterval      {};\n"
      "snapshotInterval    {};\n",
      scene.time.end, std::min(0.02 * step, 0.01 * scene.time.end), step, scene.foam.max_courant,
      sample_interval(scene), scene.output.snapshot_interval);
}

std::string phase_parameters(const Scene& scene) {
  return fmt::format(
      "\n// Phases: densities in kg/m3, kinematic viscosities in m2/s. Air this viscous tames jets over the "
      "toe at no\n"
      "// cost in spread.\n"
      "airDensity          {};\n"
      "airViscosity        {};\n"
      "concreteDensity     {};\n\n",
      scene.foam.air_density, scene.foam.air_kinematic_viscosity, scene.material.density);
}

const char* wall(const Scene& scene) { return scene.base.law == scenes::Wall::slip ? "slip" : "noSlip"; }

std::string slump_parameters(const Scene& scene) {
  return mesh_parameters(scene) + time_parameters(scene) +
         fmt::format(
             "\n// Forces and walls.\n"
             "gravity             (0 0 {});  // m/s2\n"
             "baseWall            {};\n",
             -scene.forces.gravity, wall(scene));
}

/// A source holds for the steps that end within its times; a step that ends on a change still has the old
/// force.
std::string body_forces(const Scene& scene) {
  const auto& forces = scene.forces.body_force;
  const double late = 1e-3 * scenes::largest_foam_step(scene);
  std::string text;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const auto& [time, force] = forces[i];
    const double end = i + 1 < forces.size() ? forces[i + 1].first : for_ever;
    text += fmt::format(
        "    from{0}\n    {{\n        type            vectorSemiImplicitSource;\n        timeStart       "
        "{1};\n"
        "        duration        {2};\n        selectionMode   all;\n        volumeMode      specific;\n"
        "        injectionRateSuSp {{ U (({3} 0 0) 0); }}\n    }}\n",
        i, time + late, std::max(end - time - 0.5 * late, 0.0), force);
  }
  return text;
}

std::string duct_parameters(const Scene& scene) {
  const auto cells = duct_cells(scene);
  return fmt::format(
             "// Mesh, m: a column of cells from plate to plate.\n"
             "ductHeight          {};\n"
             "ductCells           {};\n"
             "cellWidth           {};\n",
             scene.duct().height, cells, scene.duct().height / static_cast<double>(cells)) +
         time_parameters(scene) +
         fmt::format(
             "\n// Forces (N/m3, from a time on) and walls.\nplateWall           {};\nbodyForces\n{{\n{}}}\n",
             wall(scene), body_forces(scene));
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) throw runs::RunError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

void check_supported(const Scene& scene) {
  check_model(scene);
  if (scene.kind == scenes::Kind::duct) {
    duct_cells(scene);
    return;
  }
  if (scene.geometry.dimension != scenes::Dimension::axisymmetric)
    refuse(scene, fmt::format("geometry.dimension {}: the slump case is a wedge; allowed: axisymmetric",
                              scenes::to_string(scene.geometry.dimension)));
  wedge_grid(scene);
}

std::size_t duct_cells(const Scene& scene) {
  const double cells = scene.duct().height / scene.foam.cell;
  if (!(cells >= 0.5 && cells <= most_duct_cells))
    refuse(scene, fmt::format("foam.cell = {:g} m lays {:.3g} cells between the plates; allowed: 1 to {:g}",
                              scene.foam.cell, cells, most_duct_cells));
  return static_cast<std::size_t>(std::lround(cells));
}

fs::path cases_folder() {
  if (const char* folder = std::getenv("FLOWREST_FOAM_CASES"); folder != nullptr && *folder != '\0')
    return folder;
  return FLOWREST_FOAM_CASES_FOLDER;
}

double sample_interval(const Scene& scene) {
  return std::min(scene.output.history_interval, scene.output.profile_interval);
}

std::string scene_parameters(const Scene& scene, bool plug_in) {
  return fmt::format(
             "// The scene '{}' in numbers: the only file of this case that `flowrest foam` writes. Every "
             "dictionary\n"
             "// includes it. SI units; stresses and viscosities of the transport models are over the "
             "density.\n\n",
             scene.name) +
         (scene.kind == scenes::Kind::duct ? duct_parameters(scene) : slump_parameters(scene)) +
         phase_parameters(scene) + concrete_laws(scene, plug_in);
}

void fill_case(const Scene& scene, const fs::path& directory, const std::optional<fs::path>& plug_in) {
  const fs::path source = cases_folder() / scenes::to_string(scene.kind);
  std::error_code error;
  if (!fs::is_directory(source / "system", error))
    throw runs::RunError(
        fmt::format("{}: no OpenFOAM case is there; FLOWREST_FOAM_CASES must name the folder that holds one "
                    "per kind of scene",
                    source.string()));
  try {
    fs::create_directories(directory);
    for (const auto& entry : fs::directory_iterator(source))
      if (belongs_to_case(entry.path().filename()))
        fs::copy(entry.path(), directory / entry.path().filename(),
                 fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    fs::remove_all(directory / "constant" / "polyMesh");
    fs::copy(directory / "0.orig", directory / "0", fs::copy_options::recursive);
    fs::remove(directory / plug_in_link);
    if (plug_in) fs::create_symlink(*plug_in, directory / plug_in_link);
  } catch (const fs::filesystem_error& fault) {
    throw runs::RunError(fmt::format("{}: the case cannot be copied: {}", directory.string(), fault.what()));
  }
  write_text(directory / "sceneParameters", scene_parameters(scene, plug_in.has_value()));
  write_text(directory / "case.foam", "");
}

}  // namespace flowrest::foam
