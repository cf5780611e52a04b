#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foamCases/sampler.h"
#include "scenes/scene.h"

/// What is peculiar to each apparatus in OpenFOAM: its case folder, its structured mesh, how it is filled and
/// gauged. Whatever follows from pieces (scenes/pieces.h) is asked of them instead.
namespace flowrest::foam {

/// A program of OpenFOAM's and what it is called with.
struct Utility {
  std::string program;
  std::vector<std::string> arguments = {};
};

/// A file of a case that is written of the scene.
struct CaseFile {
  std::filesystem::path path;  ///< in the case
  std::string text;
};

/// The apparatus of one scene, which must outlive it.
class ApparatusCase {
 public:
  explicit ApparatusCase(const scenes::Scene& scene) : scene_(scene) {}
  virtual ~ApparatusCase() = default;
  ApparatusCase(const ApparatusCase&) = delete;
  ApparatusCase& operator=(const ApparatusCase&) = delete;

  const scenes::Scene& scene() const { return scene_; }

  /// The folder of its case among the cases.
  virtual std::string folder() const;
  /// @throws scenes::SceneError where its mesh cannot be laid out, saying what is allowed.
  virtual void check() const { cells(); }
  /// Cells of its mesh.
  virtual std::size_t cells() const = 0;
  /// Of cells across the axis along which its decomposeParDict cuts.
  virtual std::size_t slices() const = 0;
  /// Whether cells lean towards the axes: what is mended there is mended by the plug-in.
  virtual bool leans() const { return false; }
  /// Whether shear rates follow from the cells' velocities; else the plug-in writes them.
  virtual bool rates_follow_from_velocities() const { return true; }
  /// Cells of its mesh as they are counted before it is laid out: of vessels to some 20 %.
  virtual double estimated_cells() const = 0;
  /// Where the mesh is finest, m.
  virtual double smallest_cell() const { return scene_.foam.cell; }
  /// Whether steps grow once it is slow.
  virtual bool steps_grow() const { return false; }
  /// At which something moves through its finest cells for as long as a run lasts, m/s; nothing where only the
  /// start is so fast.
  virtual std::optional<double> lasting_speed() const { return std::nullopt; }
  /// Whether its concrete slows down under a surface.
  virtual bool slows() const { return true; }

  /// What sceneParameters says of its mesh and its concrete at the start.
  virtual std::string mesh_parameters() const = 0;
  /// What sceneParameters says of forces and walls.
  virtual std::string force_parameters() const;
  /// The files that are written anew into its case, beside sceneParameters.
  virtual std::vector<CaseFile> files() const { return {}; }
  /// The initial fraction as the entry internalField, a line to a row of cells; empty where a utility of
  /// OpenFOAM makes it.
  virtual std::string initial_fraction() const { return ""; }
  /// What makes its initial state of the mesh, in order.
  virtual std::vector<Utility> utilities() const = 0;
  /// Function objects that it alone has, which work after every step.
  virtual std::string function_objects(bool /*plug_in*/) const { return ""; }
  /// Which of the scene's walls the case does not have, in words; empty where it has them all.
  virtual std::string walls_differ() const { return ""; }
  /// Settles what depends on whether there is the plug-in, and the scene leaves open.
  virtual void settle(scenes::Foam&, bool /*plug_in*/) const {}

  virtual std::unique_ptr<Sampler> sampler(CaseFields, runs::RunWriter&, bool plug_in) const = 0;

 protected:
  /// Of a fall by the body's height, m/s.
  double fall_speed() const;
  /// @throws scenes::SceneError that names the scene.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  const scenes::Scene& scene_;
};

/// The one place of this room where apparatus are told apart.
std::unique_ptr<ApparatusCase> case_of(const scenes::Scene&);

}  // namespace flowrest::foam
