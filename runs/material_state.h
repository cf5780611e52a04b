#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"

/// The state of a body at one time, in terms that every solver can give and take: one run's end is another's
/// beginning.
namespace flowrest::runs {

/// A piece of material: what it carries, and the box that it fills. x is the radius about an axis, y across
/// it, z upwards; of a section the box has no width in y. Its volume is that at rest, of the whole body: mass
/// over density, which no solver changes.
struct Parcel {
  std::array<double, 3> low{}, high{};  ///< m
  double volume = 0.0;                  ///< m3
  std::array<double, 3> velocity{};     ///< m/s
  std::array<double, 6> stress{};       ///< Pa, the deviator: xx, xy, xz, yy, yz, zz
  double shear_rate = 0.0;              ///< 1/s
  double volume_ratio = 1.0;            ///< J, where the state knows it
  double flocculation = 0.0;
};

/// How much material stands over the plan: columns side by side, from the axis or the plane of symmetry on;
/// rings about an axis, strips beside a plane, squares of a quarter.
struct DepthColumns {
  enum class Plan { rings, strips, squares };
  Plan plan = Plan::rings;
  double width = 0.0;         ///< m, of a column
  int along_x = 0;            ///< columns
  int along_y = 1;            ///< columns, of squares
  std::vector<double> depth;  ///< m at rest; column (i, j) is i + along_x j

  /// Plan area of the whole body between these edges, m2; of strips m2 to a metre.
  static double area(Plan, double west, double east, double south, double north);
};

/// Particles as they stand, for a solver that has the same cells.
struct ParticleSites {
  double cell = 0.0;               ///< m
  std::vector<int> along_an_axis;  ///< particles to a cell
  bool operator==(const ParticleSites&) const = default;
};

struct MaterialState {
  std::string from;               ///< as it was asked for: "RUN@5"
  std::string solver;             ///< "mpm", "foam" or "exact"
  std::string model;              ///< of the run, or which solution
  std::string run;                ///< its scene and folder in words
  std::string kind;               ///< its apparatus
  scenes::Dimension dimension{};  ///< of the computation
  double time = 0.0;              ///< s
  double density = 0.0;           ///< kg/m3
  bool knows_pressure = false;    ///< whether the parcels' volume ratios are those of their pressures
  bool flocculates = false;       ///< whether the parcels' flocculation is known
  DepthColumns columns;
  std::vector<Parcel> parcels;
  std::optional<ParticleSites> sites;  ///< where the parcels are particles

  double volume() const;                   ///< m3 at rest, of the whole body
  std::array<double, 3> momentum() const;  ///< kg m/s: sums over the body as it is computed, mirrored in all
  double flocculation() const;             ///< mean by mass
};

/// What --from does, for a command's help.
inline constexpr const char* from_help =
    "Start from the state of another run, RUN@SECONDS (RUN: its latest), whichever solver made it, or from "
    "exact/second-order, the arrested shape of the scene";

/// What --from says.
struct StateName {
  std::string run;             ///< a path, or "exact/second-order"
  std::optional<double> time;  ///< s; the latest where none is given
};
/// @throws RunError where what follows the last @ is no time.
StateName state_name(const std::string& from);

/// The same name whatever folder it is said in: what tells two starts apart.
std::string settled_name(const std::string& from);

/// Reads the state that --from names for a run of a scene.
using StateReader = std::function<MaterialState(const std::string& from, const scenes::Scene&)>;

/// Whether the material of a scene is what a state holds: one body that stands freely on a plate.
bool can_be_handed_over(const scenes::Scene&);

/// Which of the times that a run has recorded is meant: the one within `tolerance` (s), or the latest.
/// @throws RunError naming those that there are.
std::size_t recorded_time(const StateName&, const std::vector<double>& times, double tolerance);

/// @throws RunError where a run of the scene cannot start from the state, and why: another apparatus,
/// dimension, density or volume, an end that is not later, or flocculation that it does not know.
void check_start(const scenes::Scene&, const MaterialState&);

/// What run.json says of a start, under this key.
inline constexpr const char* started_from_key = "started_from";
nlohmann::ordered_json started_from_json(const MaterialState&);

/// What a run.json says of its start: the settled name, empty where it began with its scene's body.
std::string started_from(const nlohmann::ordered_json& info);

}  // namespace flowrest::runs
