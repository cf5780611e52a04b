#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scenes/scene.h"

/// What an apparatus is made of, in terms that every solver understands. Solvers see pieces, never the
/// apparatus.
namespace flowrest::scenes {

/// A place or a direction along the axes of the computation, of which the last is the vertical one: two in a
/// plane or a section of revolution (whose first axis is the radius), three in space. m
using Point = std::array<double, 3>;
/// Corners of a closed outline, counterclockwise: along the first axis and the vertical, m.
using Corners = std::vector<std::array<double, 2>>;

/// What material is under its own weight when a scene begins.
enum class Filling {
  unburdened,     ///< as if weightless: released as it stands
  settled,        ///< at rest in a container that it fills, compressed by its weight
  poured_to_rest  ///< so much as fills the container unburdened: it stands lower under its weight
};

/// A body of material at the start.
struct Body {
  Point lower{}, upper{};  ///< its bounding box, m
  std::function<bool(const Point&)> contains;
  bool convex = false;  ///< certainly: the middle of two points inside is inside
  Corners outline;      ///< of its section
  double turn = 0.0;    ///< rad; in space: by which the outline is turned about the vertical, 0: extruded
  double extent = 0.0;  ///< that is computed: m2 of a section, m3 in space
  double volume = 0.0;  ///< of the part that is computed, of a section of revolution the whole; m3, plane: m2
  Filling filling = Filling::unburdened;
};

/// Everything on one side of a plane across an axis.
struct PlaneAcross {
  std::size_t axis = 0;
  bool upper = false;  ///< the wall lies above it, else below
  double place = 0.0;  ///< m along the axis
  Point from{}, to{};  ///< the part of it that material can reach
};
/// A polygon in a plane of the vertical, extruded along the other axis or turned about the vertical. In two
/// dimensions the polygon itself.
struct Profiled {
  enum class Sweep { extruded, turned };
  Corners corners;
  std::vector<bool> touched;  ///< per edge from corner i to i + 1: whether material can come there
  Sweep sweep = Sweep::extruded;
  std::size_t along = 1;        ///< the axis it is extruded along
  double from = 0.0, to = 0.0;  ///< m along it, or rad about the vertical
};
/// A round upright bar.
struct Bar {
  Point centre{};
  double radius = 0.0, from = 0.0, to = 0.0;  ///< m, and heights
};

/// A wall: its shape, how it holds and how it moves.
struct WallPiece {
  std::string name;
  std::variant<PlaneAcross, Profiled, Bar> shape;
  WallContact contact;
  double lift_velocity = 0.0;                                ///< m/s, upwards, from the start
  double gone_at = std::numeric_limits<double>::infinity();  ///< s, from when it does not stand any more
};

/// A round upright nozzle out of which material comes for a time, held to its motion.
struct Feed {
  double bore = 0.0, wall = 0.0;           ///< m: radius inside, and thickness
  std::function<Point(double)> mouth;      ///< m: centre of its end at a time (s)
  std::function<double(double)> extruded;  ///< m of the column in it that have come out until then
  double column = 0.0;                     ///< m of it in all
  double begins_at = 0.0, gone_at = 0.0;   ///< s: when it is there
};

/// Where material that comes so far ends a run, m.
struct Domain {
  double radius = 0.0, height = 0.0;
};

/// Along which axis a run's profiles are read, and what they hold.
struct ProfileAxis {
  enum class Of { depth, velocity };
  Of of = Of::depth;
  std::string coordinate;  ///< of profiles.csv: "r_m", "x_m", "y_m"
  std::string value() const { return of == Of::depth ? "depth_m" : "velocity_m_s"; }
  /// The columns of profiles.csv.
  std::string header() const { return "time_s," + coordinate + "," + value(); }
  bool radial() const { return coordinate == "r_m"; }
};

/// How far material spreads from the middle: about the vertical axis, or in a plane to either side.
struct SpreadGauge {
  bool about_axis = true;
};
/// How far material runs along x, from `begin` on, and how deep it stands at either end. m
struct ChannelGauge {
  double begin = 0.0, length = 0.0;
  double width = 1.0;  ///< of the whole channel, in a plane 1
};
/// What runs out through a rectangular outlet at height 0, about the vertical axis. m
struct OutletGauge {
  double half_width = 0.0, half_depth = 0.0;
  double half_top = 0.0;  ///< of the width of what stands over it
  double quarters = 1.0;  ///< of it that are computed
};
/// How fast material flows between two plates. m
struct PlatesGauge {
  double height = 0.0;
};
/// Which section a strand has behind the nozzle that lays it: from `behind` the nozzle's axis on, over a
/// length. m
struct SectionGauge {
  double behind = 0.0, length = 0.0;
};
/// What a run is judged by, one alternative for each MainGauge.
using Gauged = std::variant<SpreadGauge, ChannelGauge, OutletGauge, PlatesGauge, SectionGauge>;

struct Pieces {
  std::vector<Body> bodies;
  std::vector<WallPiece> walls;
  std::vector<Feed> feeds;              ///< one after the other
  std::vector<std::size_t> mirrored;    ///< axes with a plane of symmetry, or the axis of revolution, at 0
  std::optional<std::size_t> periodic;  ///< the axis along which everything repeats
  double whole_over_computed = 1.0;     ///< the whole body over the part that is computed
  bool free_surface = true;             ///< where there is none, every cell is full and stays so
  bool runs_out = false;                ///< of a neck that it fills, in which it has no free surface either
  double drop = 0.0;                    ///< m that material can fall at most
  std::optional<double> whole_cells_over;  ///< m: a height that is a whole number of cells
  std::optional<double> half_cells_over;   ///< m: a height that is a whole number of cells and a half
  /// m: the narrowest passage that walls leave; infinite where material is open to one side.
  double passage = std::numeric_limits<double>::infinity();
  std::optional<Domain> domain;
  Gauged gauged;
  ProfileAxis profile;
};

/// The edge of a cell (m) next to `wanted` of which a height (m) has a whole number and a half, at least one and
/// a half.
double cell_with_half(double height, double wanted);
/// What of a scene a yield stress would have to hold.
std::optional<Load> load_of(const Scene&);
/// @throws std::invalid_argument where the scene's dimension is not one of its apparatus'.
Pieces pieces_of(const Scene&);

}  // namespace flowrest::scenes
