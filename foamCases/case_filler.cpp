#include "foamCases/case_filler.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>

#include "foamCases/concrete_laws.h"
#include "foamCases/quarter_grid.h"
#include "foamCases/vessel_mesh.h"
#include "foamCases/wedge_grid.h"
#include "runs/folder.h"
#include "runs/run_directory.h"
#include "scenes/installation.h"
#include "scenes/step_limits.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using scenes::Scene;
using scenes::SceneError;

namespace {

constexpr double most_duct_cells = 1e5;
constexpr double for_ever = 1e9;  // s

/// The name by which a case loads the plug-in.
constexpr const char* plug_in_link = "libflowrestRheology.so";

/// How every sceneParameters begins: what tells a case of ours from another.
constexpr const char* parameters_begin = "// The scene";

/// Refuses a folder that holds something else than a case of ours.
void check_ours(const fs::path& directory) {
  std::error_code error;
  if (!fs::exists(directory, error) || fs::is_empty(directory, error)) return;
  std::ifstream file(directory / "sceneParameters");
  std::string line;
  if (std::getline(file, line) && line.starts_with(parameters_begin)) return;
  throw runs::RunError(
      fmt::format("{}: it is not empty and no case that `flowrest foam` made (it has no sceneParameters of a "
                  "scene); name a new "
                  "or an empty folder",
                  directory.string()));
}

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
  for (const laws::Parameter parameter : laws::every_parameter)
    if (laws::needs(scene.material.model, parameter) && !scene.material.has(parameter))
      refuse(scene, fmt::format("model {} needs material.{}, in {} and above 0",
                                scenes::to_string(scene.material.model), laws::key_of(parameter),
                                laws::unit_of(parameter)));
}

bool is_quarter(const Scene& scene) {
  return scene.kind() == scenes::Kind::slump && scene.geometry.dimension == scenes::Dimension::quarter;
}

std::string quarter_mesh_parameters(const Scene& scene) {
  const auto& cone = scene.slump();
  const auto grid = quarter_grid(scene);
  return fmt::format(
      "// Mesh, m: a quarter of the domain with cells of about {} m.\n"
      "coneHeight          {};\n"
      "domainRadius        {};\n"
      "domainHeight        {};\n"
      "sideCells           {};\n"
      "baseHeight          {};  // of a layer of thinner cells, which resolve the sheared base and the toe\n"
      "baseCells           {};\n"
      "coneCells           {};\n"
      "airCells            {};\n",
      scene.foam.cell, cone.cone_height, cone.domain_radius, cone.domain_height, grid.side,
      grid.cone_row_height, grid.base_rows, grid.cone_rows, grid.air_rows);
}

std::string mesh_parameters(const Scene& scene) {
  if (is_quarter(scene)) return quarter_mesh_parameters(scene);
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
      "baseHeight          {};  // of a layer of thinner cells, which resolve the sheared base and the toe\n"
      "baseCells           {};\n"
      "coneCells           {};\n"
      "airCells            {};\n",
      scene.foam.wedge_angle, scene.foam.cell, cone.cone_height, cone.cone_radius_bottom, cone.cone_height,
      cone.cone_radius_bottom - cone.cone_radius_top, cone.domain_radius, cone.domain_height, half_width,
      -half_width, grid.rings, grid.cone_row_height, grid.base_rows, grid.cone_rows, grid.air_rows);
}

std::string time_parameters(const Scene& scene) {
  const double step = scenes::largest_foam_step(scene);
  return fmt::format(
      "\n// Time, s.\n"
      "endTime             {};\n"
      "firstDeltaT         {};\n"
      "maxDeltaT           {};\n"
      "maxCourant          {};\n"
      "outerCorrectors     {};\n"
      "sampleInterval      {};\n"
      "snapshotInterval    {};\n",
      scene.time.end, std::min(0.02 * step, 0.01 * scene.time.end), step, scene.foam.max_courant,
      scene.foam.outer_correctors, sample_interval(scene), scene.output.snapshot_interval);
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

/// The velocity's condition on a wall as a patch takes it in.
std::string wall_condition(const Scene& scene) {
  // OpenFOAM's own slip is wrong on walls that lean, as forces are (rheology/inclined_cells.h).
  const bool leans = scene.kind() == scenes::Kind::v_funnel || scene.kind() == scenes::Kind::l_box;
  if (scene.base.law == scenes::Wall::slip && leans) return "{ type coulombFriction; friction 0; }";
  if (scene.base.law != scenes::Wall::friction) return fmt::format("{{ type {}; }}", wall(scene));
  return fmt::format("{{ type coulombFriction; friction {}; }}", scene.base.friction);
}

std::string slump_parameters(const Scene& scene) {
  return mesh_parameters(scene) + time_parameters(scene) +
         fmt::format(
             "\n// Forces and walls.\n"
             "gravity             (0 0 {});  // m/s2\n"
             "baseWall            {}\n",
             -scene.forces.gravity, wall_condition(scene));
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

/// Fills the box that the concrete stands in; faces of cells lie on its sides.
std::string vessel_parameters(const Scene& scene) {
  const auto [low, high] = initial_box(scene);
  return fmt::format(
             "// Concrete at the start, m: a box between two corners. The mesh is in system/blockMeshDict.\n"
             "fillLow             ({} {} {});\n"
             "fillHigh            ({} {} {});\n",
             low[0], low[1], low[2], high[0], high[1], high[2]) +
         time_parameters(scene) +
         fmt::format(
             "\n// Forces and walls.\n"
             "gravity             (0 0 {});  // m/s2\n"
             "baseWall            {}\n",
             -scene.forces.gravity, wall_condition(scene));
}

std::string geometry_parameters(const Scene& scene) {
  if (is_vessel(scene)) return vessel_parameters(scene);
  return scene.kind() == scenes::Kind::duct ? duct_parameters(scene) : slump_parameters(scene);
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Puts the cone into a quarter's initial field: no utility of OpenFOAM cuts cells by a cone.
void write_initial_fraction(const Scene& scene, const fs::path& path) {
  std::string text = text_of(path);
  const auto begin = text.find("internalField"), end = text.find(';', begin);
  if (begin == std::string::npos || end == std::string::npos)
    throw runs::RunError(fmt::format("{}: it has no internalField to put the cone into", path.string()));
  runs::write_atomically(path, text.replace(begin, end - begin, initial_fraction(scene)));
}

}  // namespace

std::string initial_fraction(const Scene& scene) {
  const auto grid = quarter_grid(scene);
  const auto fraction = cone_fraction(scene, grid);
  std::string text = fmt::format("internalField   nonuniform List<scalar>\n{}\n(\n", grid.cells());
  for (std::size_t cell = 0; cell < fraction.size(); ++cell)
    text +=
        fmt::format("{}{}", fraction[cell], (cell + 1) % static_cast<std::size_t>(grid.side) ? " " : "\n");
  return text + ")";
}

std::string vessel_block_mesh(const Scene& scene) {
  return block_mesh_dictionary(vessel_mesh(scene),
                               fmt::format("// The mesh of the scene '{}', m: `flowrest foam` writes it, "
                                           "blocks of cells of about {} m. x runs along "
                                           "the\n// channel or across the funnel's slopes, z upwards. Gauges "
                                           "count on the order of the cells.\n",
                                           scene.name, scene.foam.cell));
}

std::string gate_baffles(const Scene& scene) {
  const auto gate = gate_of(scene);
  if (!gate) return "";
  // A little before the faces it stands for: walls in the same plane are walls already.
  constexpr double before = 1e-5, beyond = 1e-3;  // m
  const auto& [low, high, velocity] = *gate;
  return fmt::format(
      "// The gate of the scene '{}': `flowrest foam` writes this. Each of its faces becomes a wall to "
      "either "
      "side and a\n// pair of openings upon it, which liftedGate gives their areas.\n\n"
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       dictionary;\n"
      "    object      createBafflesDict;\n}}\n\n"
      "internalFacesOnly   false;\nnoFields            true;\n\n"
      "baffles\n{{\n    gate\n    {{\n        type        searchableSurface;\n"
      "        surface     searchablePlate;\n        origin      ({:g} {:g} {:g});\n        span        "
      "({:g} {:g} "
      "{:g});\n"
      "        patches\n        {{\n"
      "            behind         {{ name gateBehind; type wall; }}\n"
      "            before         {{ name gateBefore; type wall; }}\n"
      "            openingBehind  {{ name openingBehind; type cyclic; neighbourPatch openingBefore; }}\n"
      "            openingBefore  {{ name openingBefore; type cyclic; neighbourPatch openingBehind; }}\n"
      "        }}\n    }}\n}}\n",
      scene.name, low[0] + before, low[1] - beyond, low[2] - beyond, 0.0, high[1] - low[1] + 2.0 * beyond,
      high[2] - low[2] + beyond);
}

void check_supported(const Scene& scene) {
  check_model(scene);
  if (scene.kind() == scenes::Kind::duct) {
    duct_cells(scene);
    return;
  }
  if (is_vessel(scene)) {
    vessel_mesh(scene);
    return;
  }
  if (scene.geometry.dimension != scenes::Dimension::axisymmetric && !is_quarter(scene))
    refuse(
        scene,
        fmt::format("geometry.dimension {}: there is a slump case as a wedge and one as a quarter; allowed: "
                    "axisymmetric, quarter",
                    scenes::to_string(scene.geometry.dimension)));
  mesh_cells(scene);
}

std::string case_name(const Scene& scene) {
  return scenes::to_string(scene.kind()) + (is_quarter(scene) ? "-quarter" : "");
}

std::size_t duct_cells(const Scene& scene) {
  const double cells = scene.duct().height / scene.foam.cell;
  if (!(cells >= 0.5 && cells <= most_duct_cells))
    refuse(scene, fmt::format("foam.cell = {:g} m lays {:.3g} cells between the plates; allowed: 1 to {:g}",
                              scene.foam.cell, cells, most_duct_cells));
  return static_cast<std::size_t>(std::lround(cells));
}

std::size_t mesh_cells(const Scene& scene) {
  if (scene.kind() == scenes::Kind::duct) return duct_cells(scene);
  if (is_vessel(scene)) return mesh_cells(vessel_mesh(scene)).size();
  return is_quarter(scene) ? quarter_grid(scene).cells() : wedge_grid(scene).cells();
}

fs::path cases_folder() {
  if (const char* folder = std::getenv("FLOWREST_FOAM_CASES"); folder != nullptr && *folder != '\0')
    return folder;
  return scenes::shared_folder("foamCases");
}

std::string solved_components(const Scene& scene) {
  return scene.geometry.dimension == scenes::Dimension::quarter ||
                 scene.geometry.dimension == scenes::Dimension::half
             ? "xyz"
             : "xz";
}

double sample_interval(const Scene& scene) {
  return std::min(scene.output.history_interval, scene.output.profile_interval);
}

std::string scene_parameters(const Scene& scene, bool plug_in, int ranks) {
  return fmt::format(
             "{} '{}' in numbers: the only file of this case that `flowrest foam` writes. Every "
             "dictionary\n"
             "// includes it. SI units; stresses and viscosities of the transport models are over the "
             "density.\n\n",
             parameters_begin, scene.name) +
         geometry_parameters(scene) + phase_parameters(scene) + concrete_laws(scene, plug_in) +
         fmt::format("\n// Parts into which decomposePar cuts the case.\nranks               {};\n", ranks);
}

void fill_parameters(const Scene& scene, const fs::path& directory, bool plug_in, int ranks) {
  runs::write_atomically(directory / "sceneParameters", scene_parameters(scene, plug_in, ranks));
}

void fill_case(const Scene& scene, const fs::path& directory, const std::optional<fs::path>& plug_in,
               int ranks) {
  check_ours(directory);
  const fs::path source = cases_folder() / case_name(scene);
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
        runs::copy_writable(entry.path(), directory / entry.path().filename());
    fs::remove_all(directory / "constant" / "polyMesh");
    if (is_quarter(scene)) write_initial_fraction(scene, directory / "0.orig" / "alpha.concrete");
    if (is_vessel(scene))
      runs::write_atomically(directory / "system" / "blockMeshDict", vessel_block_mesh(scene));
    const fs::path baffles = directory / "system" / "createBafflesDict";
    fs::remove(baffles);
    if (gate_of(scene)) runs::write_atomically(baffles, gate_baffles(scene));
    fs::remove_all(directory / "0");
    runs::copy_writable(directory / "0.orig", directory / "0");
    fs::remove(directory / plug_in_link);
    if (plug_in) fs::create_symlink(*plug_in, directory / plug_in_link);
  } catch (const fs::filesystem_error& fault) {
    throw runs::RunError(fmt::format("{}: the case cannot be copied: {}", directory.string(), fault.what()));
  }
  fill_parameters(scene, directory, plug_in.has_value(), ranks);
  runs::write_atomically(directory / "case.foam", "");
}

}  // namespace flowrest::foam
