#include "mpm/boundary/scene_walls.h"

#include <cmath>
#include <limits>

namespace flowrest::mpm {

namespace {

Contact contact_of(const scenes::WallContact& c) {
  if (c.law == scenes::Wall::friction) return Contact::friction;
  return c.law == scenes::Wall::slip ? Contact::slip : Contact::stick;
}

PlaneWall plane_wall_of(scenes::Wall law) {
  switch (law) {
    case scenes::Wall::no_slip:
      return PlaneWall::no_slip;
    case scenes::Wall::slip:
      return PlaneWall::slip;
    case scenes::Wall::friction:
      return PlaneWall::friction;
  }
  return PlaneWall::none;
}

/// Whether a plane can be held by the grid: then it lies on faces of cells and stays there.
bool lies_on_the_grid(const scenes::WallPiece& wall, const scenes::PlaneAcross& plane, double cell) {
  const double cells = plane.place / cell;
  return std::abs(cells - std::round(cells)) < 1e-6 && wall.lift_velocity == 0.0 && std::isinf(wall.gone_at);
}

/// Shapes of walls as the solver has them.
class ShapeOf {
 public:
  explicit ShapeOf(int dimension) : dimension_(dimension) {}

  std::shared_ptr<const WallShape> operator()(const scenes::PlaneAcross& p) const {
    Vector at{}, normal{};
    at[p.axis] = p.place;
    normal[p.axis] = p.upper ? -1.0 : 1.0;
    return std::make_shared<HalfSpace>(dimension_, at, normal, Extent{p.from, p.to});
  }
  std::shared_ptr<const WallShape> operator()(const scenes::Profiled& p) const {
    const bool turned = p.sweep == scenes::Profiled::Sweep::turned;
    const Sweep sweep = dimension_ == 2 ? Sweep::none : turned ? Sweep::revolved : Sweep::extruded;
    return std::make_shared<Prism>(Outline{p.corners, p.touched},
                                   Prism::Swept{sweep, turned ? 2 : static_cast<int>(p.along), p.from, p.to});
  }
  std::shared_ptr<const WallShape> operator()(const scenes::Bar& p) const {
    return std::make_shared<Cylinder>(dimension_, p.centre, p.radius, p.from, p.to);
  }

 private:
  int dimension_;
};

Wall wall_of(const scenes::WallPiece& piece, int dimension) {
  Wall wall;
  wall.name = piece.name;
  wall.shape = std::visit(ShapeOf(dimension), piece.shape);
  wall.contact = contact_of(piece.contact);
  wall.friction = piece.contact.friction;
  wall.motion.velocity[static_cast<std::size_t>(dimension - 1)] = piece.lift_velocity;
  wall.opens_at = piece.gone_at;
  return wall;
}

void hold_by_the_grid(const scenes::WallPiece& wall, const scenes::PlaneAcross& plane, double cell,
                      AxisBounds& bounds) {
  (plane.upper ? bounds.upper : bounds.lower) = plane_wall_of(wall.contact.law);
  (plane.upper ? bounds.upper_cell : bounds.lower_cell) = static_cast<int>(std::lround(plane.place / cell));
  (plane.upper ? bounds.upper_friction : bounds.lower_friction) = wall.contact.friction;
}

}  // namespace

SceneWalls walls_of(const scenes::Pieces& pieces, int dimension, double cell) {
  SceneWalls made;
  // An axis or a plane of symmetry mirrors the body: what a slip wall does.
  for (const std::size_t axis : pieces.mirrored) made.bounds[axis].lower = PlaneWall::slip;
  if (pieces.periodic)
    made.bounds[*pieces.periodic] = {PlaneWall::none, PlaneWall::none, 0, block_edge, true};
  for (const scenes::WallPiece& wall : pieces.walls) {
    const auto* plane = std::get_if<scenes::PlaneAcross>(&wall.shape);
    if (plane && lies_on_the_grid(wall, *plane, cell)) {
      hold_by_the_grid(wall, *plane, cell, made.bounds[plane->axis]);
    } else {
      made.walls.push_back(wall_of(wall, dimension));
    }
  }
  return made;
}

}  // namespace flowrest::mpm
