#include "foamCases/case_filler.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "foamCases/apparatus/apparatus.h"
#include "foamCases/concrete_laws.h"
#include "foamCases/step_rules.h"
#include "runs/folder.h"
#include "runs/run_directory.h"
#include "scenes/installation.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using scenes::Scene;
using scenes::SceneError;

namespace {

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

std::string time_parameters(const ApparatusCase& apparatus) {
  const Scene& scene = apparatus.scene();
  const double step = largest_step(apparatus);
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

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string parameters(const ApparatusCase& apparatus, bool plug_in, int ranks) {
  const Scene& scene = apparatus.scene();
  return fmt::format(
             "{} '{}' in numbers: the only file of this case that `flowrest foam` writes. Every "
             "dictionary\n"
             "// includes it. SI units; stresses and viscosities of the transport models are over the "
             "density.\n\n",
             parameters_begin, scene.name) +
         apparatus.mesh_parameters() + time_parameters(apparatus) + apparatus.force_parameters() +
         phase_parameters(scene) + concrete_laws(apparatus, plug_in) +
         fmt::format("\n// Parts into which decomposePar cuts the case.\nranks               {};\n", ranks);
}

void fill_parameters(const ApparatusCase& apparatus, const fs::path& directory, bool plug_in, int ranks) {
  runs::write_atomically(directory / "sceneParameters", parameters(apparatus, plug_in, ranks));
}

/// Puts what fills the cells into a case's initial field.
void write_initial_fraction(const std::string& fraction, const fs::path& path) {
  std::string text = text_of(path);
  const auto begin = text.find("internalField"), end = text.find(';', begin);
  if (begin == std::string::npos || end == std::string::npos)
    throw runs::RunError(fmt::format("{}: it has no internalField to put the cone into", path.string()));
  runs::write_atomically(path, text.replace(begin, end - begin, fraction));
}

}  // namespace

void check_supported(const Scene& scene) {
  check_model(scene);
  case_of(scene)->check();
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
  return parameters(*case_of(scene), plug_in, ranks);
}

void fill_parameters(const Scene& scene, const fs::path& directory, bool plug_in, int ranks) {
  fill_parameters(*case_of(scene), directory, plug_in, ranks);
}

void fill_case(const Scene& scene, const fs::path& directory, const std::optional<fs::path>& plug_in,
               int ranks) {
  check_ours(directory);
  const auto apparatus = case_of(scene);
  const fs::path source = cases_folder() / apparatus->folder();
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
    if (const auto fraction = apparatus->initial_fraction(); !fraction.empty())
      write_initial_fraction(fraction, directory / "0.orig" / "alpha.concrete");
    // Of a scene that lays none the case's own would lay one.
    fs::remove(directory / "system" / "createBafflesDict");
    for (const CaseFile& file : apparatus->files()) runs::write_atomically(directory / file.path, file.text);
    fs::remove_all(directory / "0");
    runs::copy_writable(directory / "0.orig", directory / "0");
    fs::remove(directory / plug_in_link);
    if (plug_in) fs::create_symlink(*plug_in, directory / plug_in_link);
  } catch (const fs::filesystem_error& fault) {
    throw runs::RunError(fmt::format("{}: the case cannot be copied: {}", directory.string(), fault.what()));
  }
  fill_parameters(*apparatus, directory, plug_in.has_value(), ranks);
  runs::write_atomically(directory / "case.foam", "");
}

}  // namespace flowrest::foam
