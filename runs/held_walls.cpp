#include "runs/held_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace flowrest::runs {

namespace {

constexpr double none = std::numeric_limits<double>::infinity();

/// From a point to the straight edge between two corners, in a plane.
double to_edge(const std::array<double, 2>& a, const std::array<double, 2>& b, double x, double height) {
  const double along[2] = {b[0] - a[0], b[1] - a[1]};
  const double squared = along[0] * along[0] + along[1] * along[1];
  const double share =
      squared > 0.0 ? std::clamp(((x - a[0]) * along[0] + (height - a[1]) * along[1]) / squared, 0.0, 1.0)
                    : 0.0;
  return std::hypot(x - a[0] - share * along[0], height - a[1] - share * along[1]);
}

/// How far a place lies outside [from, to].
double outside(double place, double from, double to) { return std::max({0.0, from - place, place - to}); }

/// Distance of a place in the axes of the computation from a shape's surface.
struct Distance {
  scenes::Point at;
  bool space;

  double height() const { return at[space ? 2 : 1]; }

  double operator()(const scenes::PlaneAcross& plane) const {
    return plane.upper ? plane.place - at[plane.axis] : at[plane.axis] - plane.place;
  }
  double operator()(const scenes::Profiled& shape) const {
    if (!space) return to_outline(shape, at[0]);
    if (shape.sweep == scenes::Profiled::Sweep::turned) return to_outline(shape, std::hypot(at[0], at[1]));
    return std::hypot(to_outline(shape, at[1 - shape.along]), outside(at[shape.along], shape.from, shape.to));
  }
  double operator()(const scenes::Bar& bar) const {
    const double from_axis = std::hypot(at[0] - bar.centre[0], at[1] - bar.centre[1]);
    const double beyond_end = outside(height(), bar.from, bar.to);
    if (beyond_end == 0.0) return from_axis - bar.radius;
    return std::hypot(std::max(0.0, from_axis - bar.radius), beyond_end);
  }

  /// To those of its edges that material can touch.
  double to_outline(const scenes::Profiled& shape, double x) const {
    double nearest = none;
    const std::size_t corners = shape.corners.size();
    for (std::size_t i = 0; i < corners; ++i)
      if (shape.touched[i])
        nearest = std::min(nearest, to_edge(shape.corners[i], shape.corners[(i + 1) % corners], x, height()));
    return nearest;
  }
};

bool holds(const scenes::WallPiece& wall) {
  return wall.contact.law != scenes::Wall::slip && wall.lift_velocity == 0.0 && std::isinf(wall.gone_at);
}

/// A floor under an outlet at height 0.
bool lies_under_outlet(const scenes::WallPiece& wall, std::size_t vertical) {
  const auto* plane = std::get_if<scenes::PlaneAcross>(&wall.shape);
  return plane && plane->axis == vertical && !plane->upper && plane->place < 0.0;
}

}  // namespace

HeldWalls::HeldWalls(const scenes::Pieces& pieces, int dimension)
    : space_(dimension == 3), runs_out_(pieces.runs_out) {
  for (const scenes::WallPiece& wall : pieces.walls)
    if (holds(wall) && !(runs_out_ && lies_under_outlet(wall, space_ ? 2 : 1))) walls_.push_back(wall);
}

double HeldWalls::distance(double x, double across, double height) const {
  if (runs_out_ && height < 0.0) return none;
  const Distance from{space_ ? scenes::Point{x, across, height} : scenes::Point{x, height, 0.0}, space_};
  double nearest = none;
  for (const scenes::WallPiece& wall : walls_) nearest = std::min(nearest, std::visit(from, wall.shape));
  return nearest;
}

}  // namespace flowrest::runs
