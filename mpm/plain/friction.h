#pragma once

#include "laws/parameters.h"
#include "mpm/boundary/wall_transfer.h"
#include "mpm/plain/grid.h"

/// Coulomb's friction on plane walls along the grid.
namespace flowrest::mpm::derivatives {
template <int Dim>
class StepAdjoint;
}

namespace flowrest::mpm::plain {

/// Of the velocity at the wall half comes from the first node inside, half from the ghost node behind it. The
/// wall's impulse is shared by the two, and limited along the wall to the friction coefficient times its part
/// across the wall; it never pulls. The share of it that is left is how far the wall holds. What is held across
/// or along moves as before a wall of no slip: as the mirrored body does, also in the velocities before the
/// step, of which particles keep a share.
template <class T, int Dim>
class PlaneFriction {
  /// Goes it backwards (derivatives/reverse_step.h).
  template <int>
  friend class derivatives::StepAdjoint;
  template <class, int>
  friend class PlaneFriction;

 public:
  /// `coefficients`: of each axis' lower and upper wall.
  explicit PlaneFriction(const std::array<std::array<T, 2>, 3>& coefficients) : coefficients_(coefficients) {}

  /// Holds new velocities.
  void hold(Grid<T, Dim>& grid) {
    find_pairs(grid);
    for (Pair& p : pairs_) relax(grid.node(p.first), grid.node(p.ghost), p, false);
  }

 private:
  void find_pairs(const Grid<T, Dim>& grid) {
    pairs_.clear();
    holds_.assign(grid.size(), T(0));
    for (const Mirror& mirror : grid.mirrors()) {
      if (mirror.wall != PlaneWall::friction) continue;
      const bool upper = mirror.ghost > mirror.image;
      const T& friction = coefficients_[static_cast<std::size_t>(mirror.axis)][upper ? 1 : 0];
      const std::size_t begin = pairs_.size();
      grid.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        pairs_.push_back(
            Pair{image, ghost, absent, mirror.axis, upper ? -1.0 : 1.0, friction, {}, {}, {}, false});
      });
      std::size_t next = begin;
      grid.across(mirror.axis, mirror.image, mirror.second,
                  [&](std::size_t, std::size_t second) { pairs_[next++].second = second; });
    }
  }

 public:
  /// The same once more, after other walls have changed the velocities: the two impulses together obey the law.
  void hold_again(Grid<T, Dim>& grid) {
    for (Pair& p : pairs_) relax(grid.node(p.first), grid.node(p.ghost), p, true);
  }
  /// Takes the transfer's error out of the first nodes, in the share in which the wall holds (correct_transfer in
  /// step.h), and returns the walls' work on the material, J.
  T finish(Grid<T, Dim>& grid) {
    T work(0);
    for (const Pair& p : pairs_)
      if (p.pressed)
        for (std::size_t c = 0; c < Dim; ++c)
          work += p.impulse[c] * at_wall(grid.node(p.first), grid.node(p.ghost), &Node<T, Dim>::velocity, c);
    for (const Pair& p : pairs_)
      if (p.second != absent)
        correct_transfer(grid.node(p.first), grid.node(p.ghost), grid.node(p.second), p);
    for (const Pair& p : pairs_) holds_[p.first] = laws::larger(holds_[p.first], p.held);
    return work;
  }

  /// How far a node is held, 0 to 1.
  const T& holds(std::size_t node) const { return holds_[node]; }

 private:
  using Part = Vec<T, Dim> Node<T, Dim>::*;
  static constexpr std::size_t absent = ~std::size_t{0};
  struct Pair {
    std::size_t first, ghost, second;
    int axis;
    double inwards;  ///< 1 for a lower wall, -1 for an upper one
    T friction;
    Vec<T, Dim> impulse;  ///< kg m/s, on the material
    T pressing;           ///< kg m/s that the wall gives the material across itself
    T held;               ///< share of what would hold it along the wall
    bool pressed;
  };

  static T at_wall(const Node<T, Dim>& first, const Node<T, Dim>& ghost, Part part, std::size_t c) {
    return T(0.5) * ((first.*part)[c] + (ghost.*part)[c]);
  }

  static void relax(Node<T, Dim>& first, Node<T, Dim>& ghost, Pair& p, bool again) {
    using std::sqrt;
    if (!(first.mass > T(0)) || !(ghost.mass > T(0))) return;
    const auto axis = static_cast<std::size_t>(p.axis);
    const T inertia = T(4) * first.mass * ghost.mass / (first.mass + ghost.mass);
    Vec<T, Dim> wanted;
    T square(0);
    for (std::size_t c = 0; c < Dim; ++c) {
      wanted[c] = p.impulse[c] - inertia * at_wall(first, ghost, &Node<T, Dim>::velocity, c);
      if (c != axis) square += wanted[c] * wanted[c];
    }
    const T change = at_wall(first, ghost, &Node<T, Dim>::velocity, axis) -
                     at_wall(first, ghost, &Node<T, Dim>::before, axis);
    const T pressing = laws::larger(T(0), T(p.pressing - T(p.inwards) * inertia * change));
    p.pressed = T(p.inwards) * wanted[axis] > T(0);
    p.pressing = p.pressed ? pressing : T(0);
    const T limit = p.friction * p.pressing, along = square > T(0) ? T(sqrt(square)) : T(0);
    p.held = !p.pressed ? T(0) : along > limit ? T(limit / along) : T(1);
    const bool holds = p.pressed && !(along > limit);
    for (std::size_t c = 0; c < Dim; ++c) {
      const bool wholly = c == axis ? p.pressed : holds;
      const T share = c == axis ? T(p.pressed ? 1 : 0) : p.held;
      const T impulse = share * wanted[c], more = impulse - p.impulse[c];
      p.impulse[c] = impulse;
      if (wholly && !again) {
        mirror(first, ghost, &Node<T, Dim>::velocity, c);
        mirror(first, ghost, &Node<T, Dim>::before, c);
      } else {
        first.velocity[c] += T(0.5) * more / first.mass;
        ghost.velocity[c] += T(0.5) * more / ghost.mass;
      }
    }
  }

  static void mirror(Node<T, Dim>& first, Node<T, Dim>& ghost, Part part, std::size_t c) {
    const T brought = first.mass * (first.*part)[c] - ghost.mass * (ghost.*part)[c];
    (first.*part)[c] = brought / (first.mass + ghost.mass);
    (ghost.*part)[c] = -(first.*part)[c];
  }

  static void correct_transfer(Node<T, Dim>& first, Node<T, Dim>& ghost, const Node<T, Dim>& second,
                               const Pair& p) {
    if (!(p.held > T(0))) return;
    const T share =
        T(wall_transfer_correction) * known_profile<T>(second.mass, first.mass + ghost.mass) * p.held;
    for (const Part part : {&Node<T, Dim>::velocity, &Node<T, Dim>::before})
      for (std::size_t c = 0; c < Dim; ++c) {
        const T bend = (second.*part)[c] - T(2) * (first.*part)[c] + (ghost.*part)[c];
        const T correction = share * bend;
        (first.*part)[c] -= correction;
        (ghost.*part)[c] += correction;
      }
  }

  std::array<std::array<T, 2>, 3> coefficients_;
  std::vector<Pair> pairs_;
  std::vector<T> holds_;  ///< by node
};

}  // namespace flowrest::mpm::plain
