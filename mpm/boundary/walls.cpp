#include "mpm/boundary/walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace flowrest::mpm {

namespace {

Vector plus(const Vector& a, const Vector& b, double scale = 1.0) {
  return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector unit(const Vector& a) {
  const double length = std::sqrt(dot(a, a));
  if (!(length > 0.0)) throw std::invalid_argument("a wall's normal has no length");
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// Without std::hypot's care for the very large and the very small, which costs most of a distance.
double norm(double u, double v) { return std::sqrt(u * u + v * v); }

/// Number of equal parts of a length, none longer than `spacing`.
int parts(double length, double spacing) {
  constexpr double round_off = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(length / spacing - round_off)));
}

/// Middle of part i of n of [from, to].
double middle(double from, double to, int i, int n) { return from + (to - from) * (i + 0.5) / n; }

}  // namespace

HalfSpace::HalfSpace(int dimension, const Vector& place, const Vector& normal, const Extent& extent)
    : dimension_(dimension), place_(place), normal_(unit(normal)), extent_(extent) {}

double HalfSpace::distance(const Vector& x) const { return dot(normal_, plus(x, place_, -1.0)); }

std::vector<SurfacePoint> HalfSpace::surface(double spacing) const {
  // Along the grid's own axes where the plane lies along them.
  Vector first{}, second{};
  if (dimension_ == 2) {
    first = {-normal_[1], normal_[0], 0.0};
  } else {
    std::size_t least = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (std::abs(normal_[a]) < std::abs(normal_[least])) least = a;
    Vector axis{};
    axis[least] = 1.0;
    first = unit(cross(normal_, axis));
    second = cross(normal_, first);
  }
  double reach = 0.0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension_); ++a)
    reach += std::abs(extent_.upper[a] - place_[a]) + std::abs(extent_.lower[a] - place_[a]);
  const int n = parts(reach, spacing);
  const int depth = dimension_ == 3 ? n : 0;
  std::vector<SurfacePoint> points;
  for (int i = -n; i < n; ++i)
    for (int j = -depth; j < std::max(depth, 1); ++j) {
      const double across = dimension_ == 3 ? (j + 0.5) * spacing : 0.0;
      const Vector x = plus(plus(place_, first, (i + 0.5) * spacing), second, across);
      if (extent_.holds(x, dimension_)) points.push_back({x, normal_});
    }
  return points;
}

double Outline::distance(double u, double v) const {
  double nearest = std::numeric_limits<double>::infinity();  // squared
  bool inside = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& a = corners[i];
    const auto& b = corners[(i + 1) % corners.size()];
    const double du = b[0] - a[0], dv = b[1] - a[1];
    const double share = std::clamp(((u - a[0]) * du + (v - a[1]) * dv) / (du * du + dv * dv), 0.0, 1.0);
    const double across = u - a[0] - share * du, up = v - a[1] - share * dv;
    nearest = std::min(nearest, across * across + up * up);
    if ((a[1] > v) != (b[1] > v) && u < a[0] + (v - a[1]) / dv * du) inside = !inside;
  }
  return inside ? -std::sqrt(nearest) : std::sqrt(nearest);
}

double Prism::distance(const Vector& x) const {
  switch (swept_.sweep) {
    case Sweep::none:
      return outline_.distance(x[0], x[1]);
    case Sweep::revolved:
      return outline_.distance(norm(x[0], x[1]), x[2]);
    case Sweep::extruded:
      break;
  }
  const auto axis = static_cast<std::size_t>(swept_.axis);
  const double flat = outline_.distance(x[axis == 0 ? 1 : 0], x[axis == 2 ? 1 : 2]);
  const double beyond = std::max(swept_.from - x[axis], x[axis] - swept_.to);
  if (flat <= 0.0 && beyond <= 0.0) return std::max(flat, beyond);
  return norm(std::max(flat, 0.0), std::max(beyond, 0.0));
}

std::vector<SurfacePoint> Prism::surface(double spacing) const {
  std::vector<SurfacePoint> points;
  for (std::size_t e = 0; e < outline_.corners.size(); ++e) {
    if (!outline_.touched[e]) continue;
    const auto& a = outline_.corners[e];
    const auto& b = outline_.corners[(e + 1) % outline_.corners.size()];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    const double nu = (b[1] - a[1]) / length, nv = (a[0] - b[0]) / length;  // outwards: counterclockwise
    const int along = parts(length, spacing);
    for (int i = 0; i < along; ++i) {
      const double u = middle(a[0], b[0], i, along), v = middle(a[1], b[1], i, along);
      if (swept_.sweep == Sweep::none) {
        points.push_back({{u, v, 0.0}, {nu, nv, 0.0}});
        continue;
      }
      const bool revolved = swept_.sweep == Sweep::revolved;
      const int across = parts((swept_.to - swept_.from) * (revolved ? u : 1.0), spacing);
      for (int j = 0; j < across; ++j) {
        const double s = middle(swept_.from, swept_.to, j, across);
        SurfacePoint p;
        if (revolved) {
          p = {{u * std::cos(s), u * std::sin(s), v}, {nu * std::cos(s), nu * std::sin(s), nv}};
        } else {
          const auto axis = static_cast<std::size_t>(swept_.axis);
          p.place[axis] = s;
          p.place[axis == 0 ? 1 : 0] = u;
          p.place[axis == 2 ? 1 : 2] = v;
          p.normal[axis == 0 ? 1 : 0] = nu;
          p.normal[axis == 2 ? 1 : 2] = nv;
        }
        points.push_back(p);
      }
    }
  }
  return points;
}

Cylinder::Cylinder(int dimension, const Vector& centre, double radius, double from, double to)
    : dimension_(dimension), centre_(centre), radius_(radius), from_(from), to_(to) {}

double Cylinder::distance(const Vector& x) const {
  const double flat = norm(x[0] - centre_[0], x[1] - centre_[1]) - radius_;
  if (dimension_ == 2) return flat;
  const double beyond = std::max(from_ - x[2], x[2] - to_);
  if (flat <= 0.0 && beyond <= 0.0) return std::max(flat, beyond);
  return norm(std::max(flat, 0.0), std::max(beyond, 0.0));
}

std::vector<SurfacePoint> Cylinder::surface(double spacing) const {
  constexpr int fewest_around = 4;
  constexpr double depth = 0.15;  // of the spacing; never more than half of the radius
  const double radius = radius_ - std::min(depth * spacing, 0.5 * radius_);
  const int around = std::max(fewest_around, parts(2.0 * std::numbers::pi * radius, spacing));
  const int along = dimension_ == 3 ? parts(to_ - from_, spacing) : 1;
  std::vector<SurfacePoint> points;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / around;
      const Vector normal = {std::cos(angle), std::sin(angle), 0.0};
      points.push_back({{centre_[0] + radius * normal[0], centre_[1] + radius * normal[1],
                         dimension_ == 3 ? middle(from_, to_, j, along) : 0.0},
                        normal});
    }
  return points;
}

Vector WallMotion::displacement(double time) const {
  const double moving = std::clamp(time, from, std::max(from, until)) - from;
  return {velocity[0] * moving, velocity[1] * moving, velocity[2] * moving};
}

Vector WallMotion::velocity_at(double time) const {
  return time >= from && time < until ? velocity : Vector{};
}

double Wall::distance(const Vector& x, double time) const {
  return shape->distance(plus(x, motion.displacement(time), -1.0));
}

bool push_out(const std::vector<Wall>& walls, int dimension, double time, double reach, Vector& place) {
  bool moved = false;
  const auto axes = static_cast<std::size_t>(dimension);
  for (const Wall& wall : walls) {
    if (!wall.stands(time)) continue;
    const double depth = -wall.distance(place, time);
    if (depth <= 0.0) continue;
    // Out along the gradient of the distance, by differences over a length that is small beside the depths
    // at which particles are caught and large beside round-off.
    const double small = 1e-6 * reach;
    Vector gradient{};
    double square = 0.0;
    for (std::size_t a = 0; a < axes; ++a) {
      Vector ahead = place, behind = place;
      ahead[a] += small;
      behind[a] -= small;
      gradient[a] = (wall.distance(ahead, time) - wall.distance(behind, time)) / (2.0 * small);
      square += gradient[a] * gradient[a];
    }
    if (!(square > 0.0)) continue;
    for (std::size_t a = 0; a < axes; ++a)
      place[a] += std::clamp(gradient[a] / std::sqrt(square) * depth, -reach, reach);
    moved = true;
  }
  return moved;
}

}  // namespace flowrest::mpm
