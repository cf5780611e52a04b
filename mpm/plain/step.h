#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <span>

#include "laws/equation_of_state.h"
#include "laws/law.h"
#include "mpm/boundary/nozzle.h"
#include "mpm/boundary/wall_transfer.h"
#include "mpm/plain/contact.h"
#include "mpm/plain/friction.h"
#include "mpm/plain/grid.h"
#include "mpm/plain/tensor.h"
#include "mpm/solver/choices.h"

/// The method on a page: one step of `quadratic-apic` over any scalar, in the order in which it happens. Read
/// `Body::step` first, then its stages from top to bottom.
///
/// Yu: Yu et al. 2026. Jiang: Jiang et al. 2015, APIC.
namespace flowrest::mpm::derivatives {
template <int Dim>
class StepAdjoint;
}

namespace flowrest::mpm::plain {

/// What the material is.
template <class T>
struct Material {
  T density{};  ///< kg/m3, at rest and without pressure
  laws::EquationOfState<T> state;
  laws::Law law = laws::Law::elasto_viscoplastic;
  laws::Parameters<T> parameters;
  bool thixotropic = false;
  laws::Structure<T> structure;
  laws::Ageing<T> ageing;
};

/// How it is computed.
struct Numerics {
  bool axisymmetric = false;
  double cell = 0.0;  ///< m
  std::array<AxisBounds, 3> bounds{};
  Dilatation dilatation = Dilatation::smooth;  ///< or the cell average
  bool explicit_fluid = false;  ///< a fluid's stress is that of its rate, else found implicitly
  bool free_surface = true;     ///< where there is none, as in a duct, every cell is full and stays so
  double density_correction =
      0.0;  ///< share of an overlap, or of a gap at a wall, taken back per unit strain
};

template <class T, int Dim>
struct Particle {
  Cell<Dim> cell{};
  Vec<T, Dim> place{};                    ///< within its cell, in [0, 1)
  Vec<T, Dim> velocity{};                 ///< m/s
  std::array<Vec<T, Dim>, Dim> affine{};  ///< APIC: [i][j] is the difference of v_i over a cell along j, m/s
  Deviator<T> stress{};                   ///< Pa
  T volume_ratio{1};                      ///< J
  T pressure{};                           ///< Pa, of its own volume
  T mass{};                               ///< kg
  T rate{};                               ///< 1/s, plastic shear rate of a solid, total one of a fluid
  T flocculation{};                       ///< lambda
};

/// What a step tells.
template <class T>
struct Outcome {
  double largest_speed = 0.0;     ///< m/s
  double largest_pressure = 0.0;  ///< Pa
  T dissipated{};                 ///< J
  T wall_work{};                  ///< J, of walls of any shape and nozzles
  T momentum{};                   ///< kg m/s along the first axis, of the velocities that moved the particles
  std::uint32_t faults = 0;       ///< particles that moved further than a cell, or are no longer finite
};

/// The gradient L referred to the body in the middle of the step, L - dt/2 L L (Hughes and Winget 1980, Eq. 5): a
/// motion x + dt v stretches by dt L and by half its square, which turns a spinning body into a growing one unless
/// the strain says so.
template <class T>
Tensor<T> referred_to_midpoint(const Tensor<T>& gradient, const T& dt) {
  const Tensor<T> square = gradient * gradient;
  Tensor<T> referred = gradient;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) referred[i][j] -= T(0.5) * dt * square[i][j];
  return referred;
}

/// What a particle makes of how full its surroundings are. With little around it, it is a drop, whose nodes
/// carry nothing else and weigh next to nothing near a cell's face: the less there is, the less of the
/// strain of volume it feels is its own. Where particles overlap they drifted together under shear, which
/// no divergence sees: it is told that it is compressed, in proportion to the shearing. Beside a plane wall that
/// holds, where material covers it, a gap is closed the same way. `correction`: 1/s, of the shearing.
template <int Dim, class T>
T heeded_dilatation(const T& dilatation, const T& filling, const T& covered, const T& correction) {
  constexpr double drop_filling = 0.2;  // a plane surface has a half, an edge a quarter
  const T full(1), share = laws::smaller(T(filling / T(drop_filling)), full);
  T heeded = dilatation * share * share * (Dim == 3 ? share : full);
  if (filling > full)
    heeded -= correction * (filling - full);
  else
    heeded += correction * (full - filling) * covered;
  return heeded;
}

/// What the law leaves of a trial stress: `lambda` and `rate` of the step before.
template <class T>
laws::Relaxed<T> relaxed(const Material<T>& material, const T& dt, const T& grown,
                         const laws::Trial<T>& trial, const T& lambda, const T& rate) {
  return laws::visit(material.law, [&](auto law) {
    using Law = decltype(law);
    return material.thixotropic ? laws::Thixotropic<Law>::relax(material.parameters, material.structure,
                                                                trial, dt, lambda, rate, grown)
                                : Law::relax(material.parameters, trial, rate);
  });
}

/// An explicit fluid's stress at a shear rate, and its structure after the step: `lambda` and `rate_before` of the step
/// before.
template <class T>
laws::Relaxed<T> flowing(const Material<T>& material, const T& dt, const T& grown, const T& rate,
                         const T& lambda, const T& rate_before) {
  const T flocculation = material.thixotropic ? material.structure.stepped(lambda, rate_before, dt) : lambda;
  const T stress = laws::visit(material.law, [&](auto law) {
    using Law = laws::Thixotropic<decltype(law)>;
    return law.stress(material.thixotropic ? Law::with_structure(material.parameters, flocculation, grown)
                                           : material.parameters,
                      rate);
  });
  return {stress, rate, flocculation};
}

/// The elastic trial (Yu, Eqs. 30 and 37) and its return to the flow law (laws/): a particle's new stress, rate and
/// flocculation. Gives the stress' invariant, Pa. `grown`: what the yield stress has grown by with age, Pa.
template <class T, int Dim>
T stressed(const Material<T>& material, bool explicit_fluid, const T& dt, const T& grown,
           const Tensor<T>& gradient, Particle<T, Dim>& p) {
  // Of an explicit fluid twice the rate, whose invariant is the shear rate.
  Deviator<T> trial = T(2) * strain_rate_deviator(gradient);
  T shear(0);
  if (!explicit_fluid) {
    shear = material.state.shear(p.volume_ratio) * dt;
    trial = rotated(p.stress, gradient, dt) + shear * trial;
  }
  const T size = trial.invariant();
  const laws::Relaxed<T> to =
      explicit_fluid ? flowing(material, dt, grown, size, p.flocculation, p.rate)
                     : relaxed(material, dt, grown, laws::Trial<T>{size, shear}, p.flocculation, p.rate);
  p.stress = size > T(0) ? T(to.stress / size) * trial : trial;
  p.rate = to.rate;
  p.flocculation = to.flocculation;
  return to.stress;
}

template <class T, int Dim>
class Body {
  /// Goes the stages backwards (derivatives/reverse_step.h).
  template <int>
  friend class derivatives::StepAdjoint;

 public:
  using Vector = Vec<T, Dim>;

  /// `friction`: of the plane walls of friction among `numerics.bounds`, of each axis' lower and upper one.
  Body(const Material<T>& material, const Numerics& numerics, std::unique_ptr<Contact<T, Dim>> walls,
       const std::vector<Particle<T, Dim>>& particles, const std::array<std::array<T, 2>, 3>& friction = {})
      : material_(material),
        numerics_(numerics),
        grid_(numerics.bounds),
        planes_(friction),
        walls_(std::move(walls)) {
    take(particles);
  }

  /// Takes these particles instead of those that it has.
  void take(const std::vector<Particle<T, Dim>>& particles) {
    particles_ = particles;
    cover_and_sort();
    update_volumes(T(0));
  }

  /// Advances by `dt` seconds from `time` under a uniform acceleration (m/s2). `keep` is the share of their
  /// own velocity, and of its affine part, that particles keep over the step: none is APIC as published.
  /// `nozzles`: those that are there, in three dimensions.
  Outcome<T> step(double time, const T& dt, const Vector& acceleration, const T& keep,
                  std::span<const NozzleMotion<T>> nozzles = {}) {
    Outcome<T> outcome;
    particles_to_grid(dt);
    forces_to_velocities(dt, acceleration, keep);
    outcome.wall_work = hold_to_nozzles(nozzles);
    planes_.hold(grid_);
    if (walls_) {
      outcome.wall_work += hold_to_walls(time, dt, acceleration);
      planes_.hold_again(grid_);
    }
    outcome.wall_work += planes_.finish(grid_);
    hold_to_planes();
    grid_to_particles(keep);
    for (Motion& motion : motions_) motion.gradient = referred_to_midpoint(motion.gradient, dt);
    average_dilatation();
    strain_to_stress(dt, material_.ageing.grown(T(time) + dt), outcome);
    move(time + value(dt), dt, outcome);
    cover_and_sort();
    update_volumes(dt);
    return outcome;
  }

  const std::vector<Particle<T, Dim>>& particles() const { return particles_; }
  const Grid<T, Dim>& grid() const { return grid_; }
  /// Of each particle its number before the last sorting.
  const std::vector<std::size_t>& came_from() const { return came_from_; }
  Contact<T, Dim>* walls() const { return walls_.get(); }
  /// Of the nozzle on the material in the last step, kg m/s.
  const Vector& nozzle_impulse() const { return nozzle_impulse_; }
  std::size_t occupied_cells() const { return cells_.size(); }

  /// The pressure that acts on every particle: what the particles around it, or in its cell, have on average.
  std::vector<T> acting_pressure() const {
    std::vector<T> pressure(particles_.size());
    if (is_smooth()) {
      for (std::size_t p = 0; p < particles_.size(); ++p)
        pressure[p] = averaged(stencil(particles_[p]), &Average<T>::pressure);
    } else {
      for (std::size_t p = 0; p < particles_.size(); ++p) pressure[p] = particles_[p].pressure;
      average_over_cells(pressure);
    }
    return pressure;
  }

 private:
  /// What the grid tells a particle.
  struct Motion {
    Vector velocity{};     ///< m/s
    Tensor<T> gradient{};  ///< 1/s
    T dilatation{};        ///< 1/s, averaged over the cell; 0 where nodes average it
    T filling{};
  };

  // 1 ------------------------------------------------------------------------------------------------------

  /// Mass, momentum with APIC's affine part (Jiang, section 5.3), filling, and the impulse of the stress:
  /// minus the integral of the stress times the weights' gradients.
  void particles_to_grid(const T& dt) {
    grid_.clear();
    const std::vector<T> pressure = acting_pressure();
    const std::vector<T> factor = numerics_.free_surface ? std::vector<T>{} : full_cell_factors();
    const T per_cell = T(1.0 / numerics_.cell);
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      const Particle<T, Dim>& p = particles_[q];
      const T volume = volume_of(p);
      Tensor<T> stress = (factor.empty() ? p.stress : factor[q] * p.stress).tensor();
      for (std::size_t a = 0; a < 3; ++a) stress[a][a] -= pressure[q];
      const T along = dt * volume * per_cell;
      // Particles of an axisymmetric body are whole rings, which the hoop's stress pulls inwards.
      const T filling = volume / (T(cell_volume()) * circumference(p));
      const T hoop = numerics_.axisymmetric ? dt * volume * stress[2][2] / radius(p) : T(0);
      const Stencil<T, Dim> s = stencil(p);
      s.visit([&](std::size_t n, const auto& at) {
        Node<T, Dim>& node = grid_.node(n);
        const T weight = s.weight_of(at);
        const Vector slope = s.slope_of(at), offset = s.offset_of(at);
        node.mass += weight * p.mass;
        node.filling += weight * filling;
        for (std::size_t i = 0; i < Dim; ++i) {
          T velocity = p.velocity[i], pull(0);
          for (std::size_t j = 0; j < Dim; ++j) {
            velocity += p.affine[i][j] * offset[j];
            pull += stress[i][j] * slope[j];
          }
          node.momentum[i] += weight * p.mass * velocity;
          node.impulse[i] -= along * pull;
        }
        if (numerics_.axisymmetric) node.impulse[0] -= weight * hoop;
      });
    }
  }

  // 2 ------------------------------------------------------------------------------------------------------

  /// New velocities. Every node falls as its mass does; what lies behind a plane wall is that of the mirrored
  /// body, and is folded onto its image with the mirrored body's sign. Behind a wall of friction only the filling
  /// is.
  void forces_to_velocities(const T& dt, const Vector& acceleration, const T& keep) {
    for (Node<T, Dim>& node : grid_.nodes())
      for (std::size_t i = 0; i < Dim; ++i) node.impulse[i] += node.mass * dt * acceleration[i];
    for (const Mirror& mirror : grid_.mirrors())
      grid_.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        Node<T, Dim>&from = grid_.node(ghost), &to = grid_.node(image);
        to.filling += from.filling;
        from.filling = T(0);
        if (!mirror.is_whole()) return;
        to.mass += from.mass;
        for (std::size_t i = 0; i < Dim; ++i) {
          const T sign(mirror.is_odd(static_cast<int>(i)) ? -1 : 1);
          to.momentum[i] += sign * from.momentum[i];
          to.impulse[i] += sign * from.impulse[i];
        }
        from = {};
      });
    for (Node<T, Dim>& node : grid_.nodes())
      if (carries(node))
        for (std::size_t i = 0; i < Dim; ++i) {
          node.velocity[i] = (node.momentum[i] + node.impulse[i]) / node.mass;
          node.before[i] = keep * node.momentum[i] / node.mass;
        }
  }

  /// Nozzles move what is in them (boundary/nozzle.h). Returns their work on the material, J.
  T hold_to_nozzles(std::span<const NozzleMotion<T>> nozzles) {
    T work(0);
    nozzle_impulse_ = {};
    if constexpr (Dim == 3)
      for (const NozzleMotion<T>& nozzle : nozzles) work += hold_to_nozzle(nozzle);
    return work;
  }

  T hold_to_nozzle(const NozzleMotion<T>& motion) {
    T work(0);
    for (std::size_t n = 0; n < grid_.size(); ++n) {
      Node<T, Dim>& node = grid_.node(n);
      if (!carries(node)) continue;
      const Cell<Dim> cell = grid_.cell(n);
      mpm::Vector place{};
      for (std::size_t a = 0; a < Dim; ++a) place[a] = (cell[a] + 0.5) * numerics_.cell;
      const auto held = motion.at(place);
      if (!held) continue;
      for (std::size_t a = 0; a < Dim; ++a) {
        const T change = held->share * (held->velocity[a] - node.velocity[a]);
        node.velocity[a] += change;
        nozzle_impulse_[a] += node.mass * change;
        work += node.mass * change * node.velocity[a];
      }
    }
    return work;
  }

  /// Walls of any shape change the new velocities (contact.h).
  T hold_to_walls(double time, const T& dt, const Vector& acceleration) {
    using std::sqrt;
    const T square = dot<T, Dim>(acceleration, acceleration);
    return walls_->hold(grid_, time, dt, square > T(0) ? dt * sqrt(square) : T(0));
  }

  // 3 ------------------------------------------------------------------------------------------------------

  /// The mirrored body behind plane walls.
  void hold_to_planes() {
    for (const Mirror& mirror : grid_.mirrors()) correct_transfer(mirror);
    mirror_velocities();
  }

  void mirror_velocities() {
    for (const Mirror& mirror : grid_.mirrors())
      grid_.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        Node<T, Dim>& behind = grid_.node(ghost);
        behind.filling = grid_.node(image).filling;
        if (!mirror.is_whole()) return;
        behind = grid_.node(image);
        for (std::size_t i = 0; i < Dim; ++i)
          if (mirror.is_odd(static_cast<int>(i))) {
            behind.velocity[i] = -behind.velocity[i];
            behind.before[i] = -behind.before[i];
          }
      });
  }

  /// A transfer to the grid and back leaves a quadratic profile v = a y + b y^2 as it is, but not across a
  /// no-slip wall, where the mirrored body is a y - b y^2: folding moves the first node by B b h^2, B = 2/21
  /// the integral over the places in a filled cell. With the second difference v2 - 3 v1 = 2 b h^2 of the
  /// first two nodes that is taken out again: B / 2 / (1 - 3 B / 2) = 1/18. Where the second node holds
  /// little the profile is not known.
  void correct_transfer(const Mirror& mirror) {
    if (mirror.wall != PlaneWall::no_slip) return;
    grid_.across(mirror.axis, mirror.image, mirror.second, [&](std::size_t first, std::size_t second) {
      Node<T, Dim>& one = grid_.node(first);
      const Node<T, Dim>& two = grid_.node(second);
      if (!(one.mass > T(0))) return;
      const T share = T(wall_transfer_correction) * known_profile(two.mass, one.mass);
      for (std::size_t i = 0; i < Dim; ++i) {
        one.velocity[i] -= share * (two.velocity[i] - T(3) * one.velocity[i]);
        one.before[i] -= share * (two.before[i] - T(3) * one.before[i]);
      }
    });
  }

  // 4 ------------------------------------------------------------------------------------------------------

  /// Velocities and affine parts (Jiang, section 5.3; the weights' second moment is a quarter of the cell
  /// squared), and for the strain the velocity that moves a particle, its gradient, and how full its
  /// surroundings are.
  void grid_to_particles(const T& keep) {
    motions_.assign(particles_.size(), {});
    const T per_cell = T(1.0 / numerics_.cell), per_moment(4);
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      Particle<T, Dim>& p = particles_[q];
      Motion& motion = motions_[q];
      for (std::size_t i = 0; i < Dim; ++i) {
        p.velocity[i] *= keep;
        for (T& a : p.affine[i]) a *= keep;
      }
      const Stencil<T, Dim> s = stencil(p);
      s.visit([&](std::size_t n, const auto& at) {
        const Node<T, Dim>& node = grid_.node(n);
        const T weight = s.weight_of(at);
        const Vector slope = s.slope_of(at), offset = s.offset_of(at);
        motion.filling += weight * node.filling;
        for (std::size_t i = 0; i < Dim; ++i) {
          motion.velocity[i] += weight * node.velocity[i];
          // What particles take up beside what they keep.
          const T change = node.velocity[i] - node.before[i];
          p.velocity[i] += weight * change;
          const T moment = per_moment * weight * change;
          for (std::size_t j = 0; j < Dim; ++j) {
            p.affine[i][j] += moment * offset[j];
            motion.gradient[i][j] += per_cell * node.velocity[i] * slope[j];
          }
        }
      });
      if (numerics_.axisymmetric) motion.gradient[2][2] = motion.velocity[0] / radius(p);
    }
  }

  // 5 ------------------------------------------------------------------------------------------------------

  /// The rate of dilatation, averaged (B-bar): over a cell's particles, or through the nodes, which give it
  /// back once the particles have moved (`update_volumes`).
  void average_dilatation() {
    std::vector<T> dilatation(particles_.size());
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      dilatation[q] = motions_[q].gradient.trace();
      if (numerics_.free_surface)
        dilatation[q] = heeded_dilatation<Dim>(dilatation[q], motions_[q].filling, coverage(q),
                                               T(numerics_.density_correction) * particles_[q].rate);
    }
    if (!is_smooth()) {
      average_over_cells(dilatation);
      for (std::size_t q = 0; q < particles_.size(); ++q) motions_[q].dilatation = dilatation[q];
      return;
    }
    for (Average<T>& a : grid_.averages()) a.dilatation = T(0);
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      const Particle<T, Dim>& p = particles_[q];
      const T growth = p.mass * p.volume_ratio * dilatation[q];
      const Stencil<T, Dim> s = stencil(p);
      s.visit(
          [&](std::size_t n, const auto& at) { grid_.average(n).dilatation += s.weight_of(at) * growth; });
    }
    fold(&Average<T>::dilatation);
    for (Average<T>& a : grid_.averages()) a.dilatation = a.volume > T(0) ? a.dilatation / a.volume : T(0);
    mirror(&Average<T>::dilatation);
  }

  /// How far a particle lies in material that covers a plane wall which holds it, 0 to 1. The first row of nodes at
  /// the wall has a cover, by the filling of the row over it, and beside a wall of friction as far as the wall holds;
  /// so has its mirror image behind the wall. All others have none, and particles take it up by their weights.
  T coverage(std::size_t q) const {
    const Particle<T, Dim>& p = particles_[q];
    if (motions_[q].filling > T(1)) return T(0);  // nothing asks for it
    return covered(p);
  }
  T covered(const Particle<T, Dim>& p) const {
    T most(0);
    const Stencil<T, Dim> s = stencil(p);
    for (const Mirror& mirror : grid_.mirrors()) {
      if (mirror.wall == PlaneWall::slip) continue;
      const auto axis = static_cast<std::size_t>(mirror.axis);
      if (std::abs(p.cell[axis] - mirror.image) > 1) continue;
      T sum(0);
      s.visit([&](std::size_t, const auto& at) {
        Cell<Dim> node = p.cell;
        for (std::size_t a = 0; a < Dim; ++a) node[a] += static_cast<int>(at[a]) - 1;
        if (node[axis] != mirror.image && node[axis] != mirror.ghost) return;
        node = before_walls(node);
        const T cover = cover_of(grid_.wrapped(node), mirror);
        sum += s.weight_of(at) * cover;
      });
      most = laws::larger(most, sum);
    }
    return most;
  }

  /// A node behind plane walls goes to its image.
  Cell<Dim> before_walls(Cell<Dim> node) const {
    for (const Mirror& mirror : grid_.mirrors()) {
      const auto a = static_cast<std::size_t>(mirror.axis);
      if (node[a] == mirror.ghost) node[a] = mirror.image;
    }
    return node;
  }

  /// Filling of the row over it from which the first row at a wall begins to be covered, and is.
  static constexpr double covered_from = 0.7, wholly_covered_from = 0.95;
  /// Of a node of the first row.
  T cover_of(const Cell<Dim>& node, const Mirror& mirror) const {
    Cell<Dim> over = node;
    over[static_cast<std::size_t>(mirror.axis)] = mirror.second;
    const T share =
        (grid_.node(grid_.index(over)).filling - T(covered_from)) / T(wholly_covered_from - covered_from);
    const T cover = laws::larger(laws::smaller(share, T(1)), T(0));
    return mirror.is_whole() ? cover : T(planes_.holds(grid_.index(node)) * cover);
  }

  // 6 ------------------------------------------------------------------------------------------------------

  /// New stresses (`stressed`). `grown`: what the yield stress has grown by with age, Pa.
  void strain_to_stress(const T& dt, const T& grown, Outcome<T>& outcome) {
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      Particle<T, Dim>& p = particles_[q];
      p.volume_ratio *= growth(T(dt * motions_[q].dilatation));
      p.pressure = material_.state.pressure(p.volume_ratio);
      const T stress = stressed(material_, numerics_.explicit_fluid, dt, grown, motions_[q].gradient, p);
      outcome.dissipated += dt * volume_of(p) * stress * p.rate;
      outcome.largest_pressure = std::max(outcome.largest_pressure, value(p.pressure));
    }
  }

  // 7 ------------------------------------------------------------------------------------------------------

  /// Moves the particles with the grid's velocity, out of walls as they stand at the step's end, and into the
  /// next cell. None passes a plane wall.
  void move(double end, const T& dt, Outcome<T>& outcome) {
    double largest_square = 0.0;
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      Particle<T, Dim>& p = particles_[q];
      const Vector& v = motions_[q].velocity;
      double square = 0.0, farthest = 0.0;
      for (std::size_t a = 0; a < Dim; ++a) {
        const T far = v[a] * dt / T(numerics_.cell);
        p.place[a] += far;
        square += value(v[a]) * value(v[a]);
        farthest += value(far) * value(far);
      }
      outcome.momentum += p.mass * v[0];
      largest_square = std::max(largest_square, square);
      if (walls_) keep_out(end, std::sqrt(farthest), p);
      enter_cell(p, outcome);
    }
    outcome.largest_speed = std::sqrt(largest_square);
  }

  void keep_out(double end, double went, Particle<T, Dim>& p) {
    if (went <= walls_->reach && !walls_->is_near(grid_, p.cell, end)) return;
    Vector place;
    for (std::size_t a = 0; a < Dim; ++a) place[a] = (T(p.cell[a]) + p.place[a]) * T(numerics_.cell);
    if (!walls_->push_out(place, end)) return;
    for (std::size_t a = 0; a < Dim; ++a) p.place[a] = place[a] / T(numerics_.cell) - T(p.cell[a]);
  }

  void enter_cell(Particle<T, Dim>& p, Outcome<T>& outcome) const {
    const T last = T(1) - T(0.5) * T(std::numeric_limits<T>::epsilon());  // before the next cell
    for (std::size_t a = 0; a < Dim; ++a) {
      if (p.place[a] >= T(0) && p.place[a] < T(1)) continue;
      const AxisBounds& bounds = numerics_.bounds[a];
      const int shift = p.place[a] < T(0) ? -1 : 1, next = p.cell[a] + shift;
      const T inside = p.place[a] - T(shift);
      if (!(inside >= T(0) && inside <= T(1))) ++outcome.faults;
      const bool is_held = (shift < 0 && bounds.lower != PlaneWall::none && next < bounds.lower_cell) ||
                           (shift > 0 && bounds.upper != PlaneWall::none && next >= bounds.upper_cell);
      if (is_held) {
        p.place[a] = shift < 0 ? T(0) : last;
      } else {
        p.place[a] = inside < T(0) ? T(0) : inside > last ? last : inside;
        p.cell[a] = next;
      }
    }
    p.cell = grid_.wrapped(p.cell);
  }

  // 8 ------------------------------------------------------------------------------------------------------

  /// Smooth B-bar: particles, in their new places, take up the step's averaged dilatation, and bring their
  /// volume and pressure to the nodes, whose average acts in the next step. Averaging is its own adjoint in
  /// the particles' volume, so that the averaged pressure works on the averaged dilatation. Nodes that are
  /// seen for the first time have no dilatation to give.
  void update_volumes(const T& dt) {
    if (!is_smooth()) return;
    for (Particle<T, Dim>& p : particles_) {
      p.volume_ratio *= growth(T(dt * averaged(stencil(p), &Average<T>::dilatation)));
      p.pressure = material_.state.pressure(p.volume_ratio);
    }
    for (Average<T>& a : grid_.averages()) a = {};
    for (const Particle<T, Dim>& p : particles_) {
      const T volume = p.mass * p.volume_ratio, thrust = volume * p.pressure;
      const Stencil<T, Dim> s = stencil(p);
      s.visit([&](std::size_t n, const auto& at) {
        const T weight = s.weight_of(at);
        grid_.average(n).volume += weight * volume;
        grid_.average(n).pressure += weight * thrust;
      });
    }
    fold(&Average<T>::volume);
    fold(&Average<T>::pressure);
    for (Average<T>& a : grid_.averages()) a.pressure = a.volume > T(0) ? a.pressure / a.volume : T(0);
    mirror(&Average<T>::pressure);
  }

  // What the stages share
  // ------------------------------------------------------------------------------------

  bool is_smooth() const { return numerics_.dilatation == Dilatation::smooth; }
  Stencil<T, Dim> stencil(const Particle<T, Dim>& p) const { return {grid_, p.cell, p.place}; }
  T volume_of(const Particle<T, Dim>& p) const { return p.mass * p.volume_ratio / material_.density; }
  double cell_volume() const {
    return Dim == 3 ? numerics_.cell * numerics_.cell * numerics_.cell : numerics_.cell * numerics_.cell;
  }

  /// m; of a ring on the axis small but not nought
  T radius(const Particle<T, Dim>& p) const {
    const T cells = T(p.cell[0]) + p.place[0];
    return T(numerics_.cell) * laws::larger(cells, T(1e-6));
  }
  T circumference(const Particle<T, Dim>& p) const {
    return numerics_.axisymmetric ? T(2.0 * std::numbers::pi) * radius(p) : T(1);
  }

  /// Whether a node has more than the round-off of a mass.
  bool carries(const Node<T, Dim>& node) const {
    const double full =
        value(material_.density) * cell_volume() * (numerics_.axisymmetric ? numerics_.cell : 1.0);
    return node.mass > T(1e-25 * full);
  }

  /// By how much a strain increment stretches a volume, to second order (Yu, Eq. 30).
  static T growth(const T& strain) { return T(1) + strain + T(0.5) * strain * strain; }

  T averaged(const Stencil<T, Dim>& s, T Average<T>::*what) const {
    T sum(0);
    s.visit([&](std::size_t n, const auto& at) { sum += s.weight_of(at) * (grid_.average(n).*what); });
    return sum;
  }

  /// Sums behind plane walls go to their images; averages there are those of the images. Scalars are even.
  void fold(T Average<T>::*what) {
    for (const Mirror& mirror : grid_.mirrors())
      grid_.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        grid_.average(image).*what += grid_.average(ghost).*what;
        grid_.average(ghost).*what = T(0);
      });
  }
  void mirror(T Average<T>::*what) {
    for (const Mirror& mirror : grid_.mirrors())
      grid_.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        grid_.average(ghost).*what = grid_.average(image).*what;
      });
  }

  /// Replaces what a cell's particles have by its mean, weighted by their volumes.
  void average_over_cells(std::vector<T>& of_particles) const {
    for (const auto& [first, last] : cells_) {
      T sum(0), total(0);
      for (std::size_t q = first; q < last; ++q) {
        const T volume = volume_of(particles_[q]);
        sum += volume * of_particles[q];
        total += volume;
      }
      for (std::size_t q = first; q < last; ++q) of_particles[q] = sum / total;
    }
  }

  /// Quadrature over cells that are known to be full (a duct's): factors 1 + c0 + c . (x - 1/2) of the
  /// particles' shear stress with which their volumes sum over the cell what is constant exactly. Of what
  /// they miss in what is linear along an axis, kept / (kept + spread) is left, `spread` a twelfth where they
  /// lie evenly: across the flow a tenth, along it, where rows stream past each other, half.
  std::vector<T> full_cell_factors() const {
    constexpr std::size_t terms = Dim + 1;
    std::vector<T> factor(particles_.size());
    for (const auto& [first, last] : cells_) {
      std::array<std::array<T, terms>, terms> moment{};
      std::array<T, terms> c{};
      const auto basis = [&](std::size_t term, std::size_t q) {
        return term == 0 ? T(1) : T(particles_[q].place[term - 1] - T(0.5));
      };
      for (std::size_t q = first; q < last; ++q)
        for (std::size_t i = 0; i < terms; ++i)
          for (std::size_t j = 0; j < terms; ++j)
            moment[i][j] += volume_of(particles_[q]) * basis(i, q) * basis(j, q);
      for (std::size_t i = 0; i < terms; ++i) c[i] = T(i == 0 ? cell_volume() : 0.0) - moment[0][i];
      const T volume = moment[0][0];
      for (std::size_t i = 1; i < terms; ++i)
        moment[i][i] += T(numerics_.bounds[i - 1].periodic ? 0.1 : 0.01) * volume;
      // Symmetric and positive: elimination without pivots.
      for (std::size_t i = 0; i < terms; ++i)
        for (std::size_t j = i + 1; j < terms; ++j) {
          const T share = moment[j][i] / moment[i][i];
          for (std::size_t k = i; k < terms; ++k) moment[j][k] -= share * moment[i][k];
          c[j] -= share * c[i];
        }
      for (std::size_t i = terms; i-- > 0;) {
        for (std::size_t j = i + 1; j < terms; ++j) c[i] -= moment[i][j] * c[j];
        c[i] /= moment[i][i];
      }
      for (std::size_t q = first; q < last; ++q) {
        factor[q] = T(1);
        for (std::size_t i = 0; i < terms; ++i) factor[q] += c[i] * basis(i, q);
      }
    }
    return factor;
  }

  /// Makes the grid hold the nodes that the particles see and will see, and sorts them by cell.
  void cover_and_sort() {
    if (particles_.empty()) return;
    Cell<Dim> lowest = particles_.front().cell, highest = lowest;
    for (const Particle<T, Dim>& p : particles_)
      for (std::size_t a = 0; a < Dim; ++a) {
        lowest[a] = std::min(lowest[a], p.cell[a]);
        highest[a] = std::max(highest[a], p.cell[a]);
      }
    if (grid_.cover(lowest, highest) && walls_) walls_->forget_nodes();
    std::vector<std::size_t> start(grid_.size() + 1, 0);
    for (const Particle<T, Dim>& p : particles_) ++start[grid_.index(p.cell) + 1];
    cells_.clear();
    for (std::size_t n = 0; n < grid_.size(); ++n) {
      start[n + 1] += start[n];
      if (start[n + 1] > start[n]) cells_.emplace_back(start[n], start[n + 1]);
    }
    sorted_.resize(particles_.size());
    came_from_.resize(particles_.size());
    for (std::size_t q = 0; q < particles_.size(); ++q) {
      const std::size_t place = start[grid_.index(particles_[q].cell)]++;
      sorted_[place] = particles_[q];
      came_from_[place] = q;
    }
    std::swap(particles_, sorted_);
  }

  Material<T> material_;
  Numerics numerics_;
  Grid<T, Dim> grid_;
  PlaneFriction<T, Dim> planes_;
  std::unique_ptr<Contact<T, Dim>> walls_;  ///< null where there are none but planes along the grid
  std::vector<Particle<T, Dim>> particles_, sorted_;
  std::vector<std::size_t> came_from_;  ///< of each particle, its number before the last sorting
  std::vector<std::pair<std::size_t, std::size_t>> cells_;  ///< particles of each cell: from, to
  std::vector<Motion> motions_;
  Vector nozzle_impulse_{};
};

}  // namespace flowrest::mpm::plain
