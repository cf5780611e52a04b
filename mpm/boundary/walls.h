#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

/// Walls of any shape: a signed distance, a rigid motion and a contact law. They hold the grid's velocities
/// at points of their surface (wall_contact.h) and keep particles out of themselves. Plane walls along the
/// grid that are held for good (plane_walls.h) are cheaper and need none of this.
namespace flowrest::mpm {

/// A place or a direction, along the solver's axes; in two dimensions the third is zero. m
using Vector = std::array<double, 3>;

/// What a wall does to material that touches it.
enum class Contact {
  stick,     ///< moves with the wall, also when pulled
  slip,      ///< free along the wall, and free to leave it
  friction,  ///< Coulomb: held along the wall by at most `friction` times what presses it; free to leave
};

/// A place on a wall's surface at which the wall acts, for its share of the surface.
struct SurfacePoint {
  Vector place{};   ///< m, in the wall's own frame
  Vector normal{};  ///< of unit length, out of the wall
};

/// The part of space where surface points are of use, m.
struct Extent {
  Vector lower{}, upper{};
  bool holds(const Vector& x, int dimension) const {
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
      if (x[a] < lower[a] || x[a] > upper[a]) return false;
    return true;
  }
};

/// The body of a wall, in its own frame.
class WallShape {
 public:
  virtual ~WallShape() = default;
  /// Signed distance to the wall's surface, positive outside the wall, where material may be. m
  virtual double distance(const Vector&) const = 0;
  /// Points that cover the surface, at most `spacing` metres apart.
  virtual std::vector<SurfacePoint> surface(double spacing) const = 0;
};

/// A half space: everything behind a plane of any orientation. Its surface is sampled within `extent`.
class HalfSpace final : public WallShape {
 public:
  HalfSpace(int dimension, const Vector& place, const Vector& normal, const Extent& extent);
  double distance(const Vector&) const override;
  std::vector<SurfacePoint> surface(double spacing) const override;

 private:
  int dimension_;
  Vector place_, normal_;
  Extent extent_;
};

/// A closed outline in a plane, counterclockwise, whose edges may be left without points where no material
/// can come (the far side of a mould).
struct Outline {
  std::vector<std::array<double, 2>> corners;  ///< m
  std::vector<bool> touched;                   ///< per edge, from corner i to corner i + 1
  double distance(double u, double v) const;   ///< m, positive outside
};

/// How an outline becomes a body.
enum class Sweep {
  none,      ///< two dimensions: the outline itself
  extruded,  ///< along one axis, over [from, to]; the other two axes are the outline's, in their order
  revolved,  ///< about the last axis of three: the outline's are radius and height
};

/// A polygon extruded or revolved: boxes, plates, funnels with inclined faces, moulds.
class Prism final : public WallShape {
 public:
  struct Swept {
    Sweep sweep = Sweep::none;
    int axis = 1;                 ///< extruded along this one
    double from = 0.0, to = 0.0;  ///< m; revolved: rad
  };
  Prism(Outline outline, const Swept& swept) : outline_(std::move(outline)), swept_(swept) {}
  double distance(const Vector&) const override;
  std::vector<SurfacePoint> surface(double spacing) const override;

 private:
  Outline outline_;
  Swept swept_;
};

/// A round bar along one axis of three (upright: the last), or in two dimensions a disc.
///
/// A bar about as thick as a cell is held by shape functions wider than itself and would block more than its
/// own width: its surface points lie a little within it and are as few as hold it (retracted forcing points;
/// Breugem 2012, J. Comput. Phys. 231), so many and so deep that it drags as Stokes' flow through a lattice
/// of bars says, from one cell to a diameter on (mpm_walls_test).
class Cylinder final : public WallShape {
 public:
  /// `centre` lies on the axis; the bar reaches from `from` to `to` along it. m
  Cylinder(int dimension, const Vector& centre, double radius, double from, double to);
  double distance(const Vector&) const override;
  std::vector<SurfacePoint> surface(double spacing) const override;

 private:
  int dimension_;
  Vector centre_;
  double radius_, from_, to_;
};

/// A rigid translation at constant velocity over a span of time, still before and after.
struct WallMotion {
  Vector velocity{};  ///< m/s
  double from = 0.0;  ///< s
  double until = std::numeric_limits<double>::infinity();
  bool moves() const { return velocity != Vector{}; }
  Vector displacement(double time) const;  ///< m
  Vector velocity_at(double time) const;   ///< m/s
};

struct Wall {
  std::string name;
  std::shared_ptr<const WallShape> shape;
  Contact contact = Contact::stick;
  double friction = 0.0;  ///< coefficient, of Contact::friction
  WallMotion motion;
  double opens_at = std::numeric_limits<double>::infinity();  ///< s: a gate that is gone from then on

  bool stands(double time) const { return time < opens_at; }
  /// Signed distance at a time, m.
  double distance(const Vector& x, double time) const;
};

/// Moves a place that lies inside walls to their surface; returns whether it did. `reach` bounds the motion
/// along each axis, m.
bool push_out(const std::vector<Wall>&, int dimension, double time, double reach, Vector& place);

}  // namespace flowrest::mpm
