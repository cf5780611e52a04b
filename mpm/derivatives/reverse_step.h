#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "mpm/derivatives/dual.h"
#include "mpm/derivatives/strain_adjoint.h"
#include "mpm/derivatives/variation.h"
#include "mpm/plain/inputs.h"

/// One step of the plain method, backwards.
namespace flowrest::mpm::derivatives {

/// What a step's adjoint adds up beside the particles' own: the derivatives of the final reading by what goes into
/// the step.
template <int Dim>
struct InputBars {
  std::vector<double> numbers;               ///< of plain::visit_numbers
  plain::Vec<double, Dim> acceleration{};    ///< of this step
  std::vector<std::vector<double>> nozzles;  ///< of this step, of what moves each
};

/// The adjoint of a step: from the derivatives of a reading by the particles after it to those by the particles
/// before it. The stages are those of plain::Body::step, from the last to the first.
///
/// What a stage adds up over nodes is read from them backwards, and what it reads is added up: gathers become
/// scatters. What is a particle's or a pair of nodes' own is differentiated with dual numbers by all that goes into
/// it. Derivatives by a particle's place go through the weights, of which duals carry them, too.
///
/// Notation: bars are derivatives of the reading, of a variable or a whole particle or node, as in reverse
/// differentiation (Griewank and Walther 2008).
template <int Dim>
class StepAdjoint {
 public:
  using Body = plain::Body<double, Dim>;
  using Particle = plain::Particle<double, Dim>;
  using Particles = std::vector<Particle>;
  using Node = plain::Node<double, Dim>;
  /// A nozzle of a step: which of the settings', and what moves it (motion_from).
  struct NozzleInputs {
    std::size_t number;
    std::vector<double> motion;
  };
  struct Step {
    double time, step, keep;
    plain::Vec<double, Dim> acceleration;
    std::vector<NozzleInputs> nozzles;
  };

  /// In words what it does not serve; empty where it serves all.
  static std::string not_served(const SolverSettings& s) {
    if (!s.walls.empty()) return "walls of any shape";
    if (s.b_bar() != Dilatation::smooth) return "a dilatation that is averaged over cells";
    if (!s.free_surface) return "cells that are full and stay so, as in a duct";
    return "";
  }

  StepAdjoint(const SolverSettings& settings, const plain::Inputs<double>& inputs)
      : settings_(settings),
        inputs_(inputs),
        cell_(settings.cell),
        strain_(settings, inputs),
        cell_volume_(Dim == 3 ? cell_ * cell_ * cell_ : cell_ * cell_) {}

  /// Makes the step of `body`, whose state is that before it, and keeps what going back needs.
  void forwards(Body& body, const Step& step) {
    plain::Cell<Dim> lowest = body.particles_.front().cell, highest = lowest;
    for (const Particle& p : body.particles_)
      for (std::size_t a = 0; a < Dim; ++a) {
        lowest[a] = std::min(lowest[a], p.cell[a] - 1);
        highest[a] = std::max(highest[a], p.cell[a] + 1);
      }
    body.grid_.cover(lowest, highest);  // so that nodes keep their numbers throughout the step
    const double dt = step.step;
    old_ = body.particles_;
    acting_ = body.acting_pressure();
    before_ = body.grid_.averages();
    step_ = dt;
    body.particles_to_grid(dt);
    unfolded_mass_.clear();
    for (const Node& node : body.grid_.nodes()) unfolded_mass_.push_back(node.mass);
    body.forces_to_velocities(dt, step.acceleration, step.keep);
    nozzled_.clear();
    if constexpr (Dim == 3)
      for (const NozzleInputs& nozzle : step.nozzles) {
        const auto motion = motion_from(settings_.nozzles[nozzle.number], cell_, nozzle.motion, step.step);
        auto& seen = nozzled_.emplace_back();
        for (std::size_t n = 0; n < body.grid_.size(); ++n)
          if (body.carries(body.grid_.node(n)) && motion.at(place_of(body, n)))
            seen.push_back({n, body.grid_.node(n).velocity});
        body.hold_to_nozzle(motion);
      }
    rub(body);
    corrected_.clear();
    for (const plain::Mirror& mirror : body.grid_.mirrors()) {
      auto& seen = corrected_.emplace_back();
      if (mirror.wall == PlaneWall::no_slip)
        body.grid_.across(mirror.axis, mirror.image, mirror.second,
                          [&](std::size_t first, std::size_t second) {
                            const Node &one = body.grid_.node(first), &two = body.grid_.node(second);
                            if (one.mass > 0.0) seen.push_back({first, second, one, two});
                          });
      body.correct_transfer(mirror);
    }
    body.mirror_velocities();
    body.grid_to_particles(step.keep);
    gradient_.resize(old_.size());
    filling_.resize(old_.size());
    coverage_.resize(old_.size());
    moved_.resize(old_.size());
    for (std::size_t q = 0; q < old_.size(); ++q) {
      gradient_[q] = body.motions_[q].gradient;
      filling_[q] = body.motions_[q].filling;
      coverage_[q] = body.coverage(q);
      moved_[q] = body.motions_[q].velocity;
      body.motions_[q].gradient = plain::referred_to_midpoint(body.motions_[q].gradient, dt);
    }
    body.average_dilatation();
    plain::Outcome<double> outcome;
    body.strain_to_stress(dt, body.material_.ageing.grown(step.time + dt), outcome);
    ratio_.resize(old_.size());
    for (std::size_t q = 0; q < old_.size(); ++q) ratio_[q] = body.particles_[q].volume_ratio;
    body.move(step.time + dt, dt, outcome);
    placed_ = body.particles_;
    body.cover_and_sort();
    dilatations_ = body.grid_.averages();
    body.update_volumes(dt);
  }

  /// Goes the step backwards that `forwards` has made. `after`: bars of the particles after the step, in the order that
  /// the body then has; they become the bars of those before it, in the order that they had.
  void backwards(const Body& body, const Step& step, Particles& after, InputBars<Dim>& inputs) {
    const std::size_t count = old_.size();
    bars_.assign(count, Particle{});
    for (Particle& b : bars_) b.volume_ratio = 0.0;  // a particle's is 1 to begin with
    nodes_.assign(body.grid_.size(), Node{});
    averages_.assign(body.grid_.size(), plain::Average<double>{});
    pressure_.assign(count, 0.0);
    velocity_.assign(count, plain::Vec<double, Dim>{});
    dilatation_.assign(count, 0.0);
    new_.assign(count, Particle{});
    for (std::size_t k = 0; k < count; ++k) new_[body.came_from_[k]] = after[k];
    volumes_back(body, step);
    move_back(step);
    dilatation_to_growth_back(body);
    strain_back(step, inputs);
    grid_to_particles_back(body, step);
    planes_back(body);
    friction_back(inputs);
    nozzles_back(body, step, inputs);
    forces_back(body, step, inputs);
    particles_to_grid_back(body, step, inputs);
    averages_back(body, inputs);
    after.swap(bars_);
  }

 private:
  using Place = Dual<Dim>;  ///< by a particle's place
  using Stencil = plain::Stencil<Place, Dim>;
  using Friction = plain::PlaneFriction<double, Dim>;
  /// Two nodes before the transfer's correction of the first.
  struct Corrected {
    std::size_t first, second;
    Node one, two;
  };
  static constexpr int material_numbers = 15;

  /// Friction on plane walls, pair by pair, with the nodes that each has found.
  void rub(Body& body) {
    auto& planes = body.planes_;
    auto& grid = body.grid_;
    planes.find_pairs(grid);
    relaxed_.clear();
    taken_out_.clear();
    pairs_.clear();
    if (planes.pairs_.empty()) return;
    for (auto& p : planes.pairs_) {
      relaxed_.push_back({grid.node(p.first), grid.node(p.ghost)});
      Friction::relax(grid.node(p.first), grid.node(p.ghost), p, false);
    }
    for (const auto& p : planes.pairs_) {
      taken_out_.push_back({grid.node(p.first), grid.node(p.ghost),
                            p.second == Friction::absent ? Node{} : grid.node(p.second)});
      if (p.second != Friction::absent)
        Friction::correct_transfer(grid.node(p.first), grid.node(p.ghost), grid.node(p.second), p);
    }
    for (const auto& p : planes.pairs_) planes.holds_[p.first] = std::max(planes.holds_[p.first], p.held);
    pairs_ = planes.pairs_;
    held_bars_.assign(pairs_.size(), 0.0);
  }

  Stencil stencil(const Body& body, const Particle& p) const {
    // The grid's own type matters for the numbers of nodes alone.
    plain::Vec<Place, Dim> place;
    for (std::size_t a = 0; a < Dim; ++a) place[a] = Place::input(p.place[a], a);
    return Stencil(body.grid_, p.cell, place);
  }
  void add_place(Particle& bar, const Place& of, double scale = 1.0) const {
    for (std::size_t a = 0; a < Dim; ++a) bar.place[a] += scale * of.d[a];
  }

  // 8 --------------------------------------------------------------------------------------------------------

  /// J' = J growth(dt D), D the nodes' dilatation at the new place.
  void volumes_back(const Body& body, const Step& step) {
    for (std::size_t q = 0; q < old_.size(); ++q) {
      Particle& bar = new_[q];
      const Stencil s = stencil(body, placed_[q]);
      Place dilatation(0.0);
      s.visit([&](std::size_t n, const auto& at) {
        dilatation += s.weight_of(at) * Place(dilatations_[n].dilatation);
      });
      const double strain = step.step * dilatation.v, ratio_bar = bar.volume_ratio;
      bar.volume_ratio = ratio_bar * (1.0 + strain + 0.5 * strain * strain);
      const double of_dilatation = ratio_bar * ratio_[q] * (1.0 + strain) * step.step;
      add_place(bar, dilatation, of_dilatation);
      s.visit([&](std::size_t n, const auto& at) {
        averages_[n].dilatation += s.weight_of(at).v * of_dilatation;
      });
    }
  }

  // 7 --------------------------------------------------------------------------------------------------------

  /// Where a plane wall holds a particle back, its place hangs on nothing.
  void move_back(const Step& step) {
    for (std::size_t q = 0; q < old_.size(); ++q) {
      for (std::size_t a = 0; a < Dim; ++a) {
        const double went = moved_[q][a] * step.step / cell_, place = old_[q].place[a] + went;
        const AxisBounds& b = settings_.bounds[a];
        const bool leaves_below =
            place < 0.0 && b.lower != PlaneWall::none && old_[q].cell[a] - 1 < b.lower_cell;
        const bool leaves_above =
            place >= 1.0 && b.upper != PlaneWall::none && old_[q].cell[a] + 1 >= b.upper_cell;
        if (leaves_below || leaves_above) continue;
        bars_[q].place[a] += new_[q].place[a];
        velocity_[q][a] += new_[q].place[a] * step.step / cell_;
      }
      bars_[q].mass += new_[q].mass;
    }
  }

  // 5 --------------------------------------------------------------------------------------------------------

  /// From the nodes' dilatation to the growth that particles bring, and with it to their own dilatation.
  void dilatation_to_growth_back(const Body& body) {
    unmirror(body, &plain::Average<double>::dilatation);
    for (std::size_t n = 0; n < averages_.size(); ++n) {
      // Before the division a node holds the volume of the state before the step.
      const double volume = before_[n].volume;
      double& bar = averages_[n].dilatation;
      if (!(volume > 0.0)) {
        bar = 0.0;
        continue;
      }
      averages_[n].volume -= bar * dilatations_[n].dilatation / volume;
      bar /= volume;
    }
    unfold(body, &plain::Average<double>::dilatation);
    for (std::size_t q = 0; q < old_.size(); ++q) {
      const Particle& p = old_[q];
      const Stencil s = stencil(body, p);
      Place growth_bar(0.0);
      s.visit([&](std::size_t n, const auto& at) {
        growth_bar += s.weight_of(at) * Place(averages_[n].dilatation);
      });
      const double dilatation = own_dilatation(q);
      add_place(bars_[q], growth_bar, p.mass * p.volume_ratio * dilatation);
      bars_[q].mass += growth_bar.v * p.volume_ratio * dilatation;
      bars_[q].volume_ratio += growth_bar.v * p.mass * dilatation;
      dilatation_[q] = growth_bar.v * p.mass * p.volume_ratio;
    }
  }

  double own_dilatation(std::size_t q) const {
    return plain::heeded_dilatation<Dim>(plain::referred_to_midpoint(gradient_[q], step_).trace(),
                                         filling_[q], coverage_[q],
                                         settings_.density_correction * old_[q].rate);
  }

  // 5 and 6 --------------------------------------------------------------------------------------------------

  /// All that a particle makes of its gradient by itself (StrainAdjoint).
  void strain_back(const Step& step, InputBars<Dim>& inputs) {
    strain_bars_.resize(old_.size());
    for (std::size_t q = 0; q < old_.size(); ++q) {
      bars_[q].volume_ratio += new_[q].volume_ratio;
      strain_bars_[q] =
          strain_.back({step.time, step.step}, old_[q], {gradient_[q], filling_[q], coverage_[q]},
                       dilatation_[q], new_[q], bars_[q], inputs.numbers);
    }
  }

  // 4 --------------------------------------------------------------------------------------------------------

  void grid_to_particles_back(const Body& body, const Step& step) {
    const double per_cell = 1.0 / cell_;
    for (std::size_t q = 0; q < old_.size(); ++q) {
      Particle& bar = bars_[q];
      const Particle &p = old_[q], &after = new_[q];
      const auto& [g, of_filling, of_cover] = strain_bars_[q];
      if (settings_.axisymmetric) {
        const double r = radius(p);
        velocity_[q][0] += g[2][2] / r;
        if (p.cell[0] + p.place[0] > 1e-6) bar.place[0] -= g[2][2] * moved_[q][0] / (r * r) * cell_;
      }
      cover_back(body, q, of_cover);
      const Stencil s = stencil(body, p);
      Place reading(0.0);
      s.visit([&](std::size_t n, const auto& at) {
        const Node& node = body.grid_.node(n);
        Node& node_bar = nodes_[n];
        const Place weight = s.weight_of(at);
        const auto slope = s.slope_of(at), offset = s.offset_of(at);
        reading += weight * Place(of_filling * node.filling);
        node_bar.filling += weight.v * of_filling;
        for (std::size_t i = 0; i < Dim; ++i) {
          const double change = node.velocity[i] - node.before[i];
          Place kept(after.velocity[i]), strain(0.0);
          for (std::size_t j = 0; j < Dim; ++j) {
            kept += Place(4.0 * after.affine[i][j]) * offset[j];
            strain += Place(per_cell * g[i][j]) * slope[j];
          }
          const Place of_change = weight * kept, of_velocity = weight * Place(velocity_[q][i]) + strain;
          reading += of_change * Place(change) + of_velocity * Place(node.velocity[i]);
          node_bar.velocity[i] += of_velocity.v + of_change.v;
          node_bar.before[i] -= of_change.v;
        }
      });
      add_place(bar, reading);
      for (std::size_t i = 0; i < Dim; ++i) {
        bar.velocity[i] += step.keep * after.velocity[i];
        for (std::size_t j = 0; j < Dim; ++j) bar.affine[i][j] += step.keep * after.affine[i][j];
      }
    }
  }

  /// The cover that a particle has taken up beside walls that hold (plain::Body::covered).
  void cover_back(const Body& body, std::size_t q, double of_cover) {
    if (of_cover == 0.0 || !(coverage_[q] > 0.0)) return;
    const Particle& p = old_[q];
    const plain::Mirror* decisive = nullptr;
    for (const plain::Mirror& mirror : body.grid_.mirrors())
      if (mirror.wall != PlaneWall::slip && cover_at(body, p, mirror, 0.0, nullptr) == coverage_[q])
        decisive = &mirror;
    if (decisive) cover_at(body, p, *decisive, of_cover, &bars_[q]);
  }

  /// A wall's cover at a particle; where `bar` is not null, its adjoint with `of_cover` as well.
  double cover_at(const Body& body, const Particle& p, const plain::Mirror& mirror, double of_cover,
                  Particle* bar) {
    const auto axis = static_cast<std::size_t>(mirror.axis);
    if (std::abs(p.cell[axis] - mirror.image) > 1) return 0.0;
    const Stencil s = stencil(body, p);
    Place sum(0.0);
    s.visit([&](std::size_t, const auto& at) {
      plain::Cell<Dim> node = p.cell;
      for (std::size_t a = 0; a < Dim; ++a) node[a] += static_cast<int>(at[a]) - 1;
      if (node[axis] != mirror.image && node[axis] != mirror.ghost) return;
      node = body.grid_.wrapped(body.before_walls(node));
      const Place weight = s.weight_of(at);
      sum += weight * Place(body.cover_of(node, mirror));
      if (!bar) return;
      plain::Cell<Dim> over = node;
      over[axis] = mirror.second;
      const std::size_t first = body.grid_.index(node), second = body.grid_.index(over);
      constexpr double span = Body::wholly_covered_from - Body::covered_from;
      const double share = (body.grid_.node(second).filling - Body::covered_from) / span;
      const double holds = mirror.is_whole() ? 1.0 : body.planes_.holds(first);
      if (share > 0.0 && share < 1.0) nodes_[second].filling += of_cover * weight.v * holds / span;
      if (!mirror.is_whole()) add_held(first, of_cover * weight.v * std::clamp(share, 0.0, 1.0));
    });
    if (bar) add_place(*bar, sum, of_cover);
    return sum.v;
  }

  /// To the pair that decides how far a node is held.
  void add_held(std::size_t node, double bar) {
    std::size_t most = pairs_.size();
    for (std::size_t i = 0; i < pairs_.size(); ++i)
      if (pairs_[i].first == node && (most == pairs_.size() || pairs_[i].held > pairs_[most].held)) most = i;
    if (most < pairs_.size()) held_bars_[most] += bar;
  }

  // 3 --------------------------------------------------------------------------------------------------------

  void planes_back(const Body& body) {
    const auto& grid = body.grid_;
    const auto& mirrors = grid.mirrors();
    for (std::size_t m = mirrors.size(); m-- > 0;) {
      const plain::Mirror& mirror = mirrors[m];
      grid.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        Node &behind = nodes_[ghost], &own = nodes_[image];
        own.filling += behind.filling;
        behind.filling = 0.0;
        if (!mirror.is_whole()) return;
        for (std::size_t i = 0; i < Dim; ++i) {
          const double sign = mirror.is_odd(static_cast<int>(i)) ? -1.0 : 1.0;
          own.velocity[i] += sign * behind.velocity[i];
          own.before[i] += sign * behind.before[i];
        }
        own.mass += behind.mass;
        behind = Node{};
      });
    }
    // The transfer's correction along walls of no slip, from the last one to the first.
    for (std::size_t m = mirrors.size(); m-- > 0;)
      for (std::size_t i = corrected_[m].size(); i-- > 0;) {
        const Corrected& seen = corrected_[m][i];
        const auto mass1 = Dual<2>::input(seen.one.mass, 0), mass2 = Dual<2>::input(seen.two.mass, 1);
        const Dual<2> share = Dual<2>(wall_transfer_correction) * known_profile(mass2, mass1);
        double share_bar = 0.0;
        for (const auto part : {&Node::velocity, &Node::before})
          for (std::size_t c = 0; c < Dim; ++c) {
            double &bar1 = (nodes_[seen.first].*part)[c], &bar2 = (nodes_[seen.second].*part)[c];
            share_bar -= bar1 * ((seen.two.*part)[c] - 3.0 * (seen.one.*part)[c]);
            bar2 -= share.v * bar1;
            bar1 += 3.0 * share.v * bar1;
          }
        nodes_[seen.first].mass += share_bar * share.d[0];
        nodes_[seen.second].mass += share_bar * share.d[1];
      }
  }

  // 2 --------------------------------------------------------------------------------------------------------

  void friction_back(InputBars<Dim>& inputs) {
    using D = Dual<32>;
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      const auto& p = pairs_[i];
      if (p.second == Friction::absent || !(p.held > 0.0)) continue;
      std::array<plain::Node<D, Dim>, 3> local;
      std::array<Node*, 3> bars = {&nodes_[p.first], &nodes_[p.ghost], &nodes_[p.second]};
      std::size_t next = 0;
      for (std::size_t k = 0; k < 3; ++k) seed(local[k], taken_out_[i][k], next);
      auto pair = lifted<D>(p);
      pair.held = D::input(p.held, next);
      plain::PlaneFriction<D, Dim>::correct_transfer(local[0], local[1], local[2], pair);
      const D reading = read(local[0], *bars[0]) + read(local[1], *bars[1]);
      clear(*bars[0]);
      clear(*bars[1]);
      next = 0;
      for (Node* bar : bars) take(*bar, reading, next);
      held_bars_[i] += reading.d[next];
    }
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      const auto& p = pairs_[i];
      if (!(relaxed_[i][0].mass > 0.0) || !(relaxed_[i][1].mass > 0.0)) continue;
      std::array<plain::Node<D, Dim>, 2> local;
      std::array<Node*, 2> bars = {&nodes_[p.first], &nodes_[p.ghost]};
      std::size_t next = 0;
      for (std::size_t k = 0; k < 2; ++k) seed(local[k], relaxed_[i][k], next);
      auto pair = lifted<D>(p);
      pair.friction = D::input(p.friction, next);
      plain::PlaneFriction<D, Dim>::relax(local[0], local[1], pair, false);
      const D reading = read(local[0], *bars[0]) + read(local[1], *bars[1]) + D(held_bars_[i]) * pair.held;
      clear(*bars[0]);
      clear(*bars[1]);
      next = 0;
      for (Node* bar : bars) take(*bar, reading, next);
      const std::size_t coefficient = static_cast<std::size_t>(p.axis) * 2 + (p.inwards < 0.0 ? 1 : 0);
      inputs.numbers[material_numbers + inputs_.friction.size() + coefficient] += reading.d[next];
    }
  }

  template <class D>
  typename plain::PlaneFriction<D, Dim>::Pair lifted(const typename Friction::Pair& p) const {
    typename plain::PlaneFriction<D, Dim>::Pair pair{};
    pair.axis = p.axis;
    pair.inwards = p.inwards;
    return pair;
  }
  /// Of a node's mass and velocities: inputs, the reading of their bars, and back.
  template <class D>
  static void seed(plain::Node<D, Dim>& local, const Node& of, std::size_t& next) {
    const auto seeded = [&](double x) { return D::input(x, next++); };
    local.mass = seeded(of.mass);
    for (std::size_t i = 0; i < Dim; ++i) local.velocity[i] = seeded(of.velocity[i]);
    for (std::size_t i = 0; i < Dim; ++i) local.before[i] = seeded(of.before[i]);
  }
  template <class D>
  static D read(const plain::Node<D, Dim>& local, const Node& bar) {
    D sum(0.0);
    for (std::size_t i = 0; i < Dim; ++i)
      sum += D(bar.velocity[i]) * local.velocity[i] + D(bar.before[i]) * local.before[i];
    return sum;
  }
  static void clear(Node& bar) { bar.velocity = bar.before = {}; }
  template <class D>
  static void take(Node& bar, const D& reading, std::size_t& next) {
    bar.mass += reading.d[next++];
    for (std::size_t i = 0; i < Dim; ++i) bar.velocity[i] += reading.d[next++];
    for (std::size_t i = 0; i < Dim; ++i) bar.before[i] += reading.d[next++];
  }

  void nozzles_back(const Body& body, const Step& step, InputBars<Dim>& inputs) {
    inputs.nozzles.assign(step.nozzles.size(), {});
    if constexpr (Dim == 3)
      for (std::size_t k = step.nozzles.size(); k-- > 0;) {
        using D = Dual<8>;
        const NozzleInputs& nozzle = step.nozzles[k];
        std::vector<D> x;
        for (const double number : nozzle.motion) x.push_back(D::input(number, x.size()));
        const NozzleMotion<D> motion = motion_from(settings_.nozzles[nozzle.number], cell_, x, step.step);
        inputs.nozzles[k].assign(x.size(), 0.0);
        for (const auto& [n, velocity] : nozzled_[k]) {
          const auto held = motion.at(place_of(body, n));
          if (!held) continue;
          D reading(0.0);
          for (std::size_t a = 0; a < Dim; ++a) {
            double& bar = nodes_[n].velocity[a];
            reading += D(bar) * held->share * (held->velocity[a] - D(velocity[a]));
            bar *= 1.0 - held->share.v;
          }
          for (std::size_t i = 0; i < x.size(); ++i) inputs.nozzles[k][i] += reading.d[i];
        }
      }
  }

  mpm::Vector place_of(const Body& body, std::size_t node) const {
    const auto cell = body.grid_.cell(node);
    mpm::Vector place{};
    for (std::size_t a = 0; a < Dim; ++a) place[a] = (cell[a] + 0.5) * cell_;
    return place;
  }

  /// v = (momentum + impulse) / M, before = keep momentum / M, of folded nodes.
  void forces_back(const Body& body, const Step& step, InputBars<Dim>& inputs) {
    const auto& grid = body.grid_;
    inputs.acceleration = {};
    const auto& mirrors = grid.mirrors();
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      Node& bar = nodes_[n];
      const Node& node = body.grid_.node(n);  // of mirrored ones the bars are nought
      if (!body.carries(node)) {
        bar.velocity = bar.before = {};
        continue;
      }
      for (std::size_t i = 0; i < Dim; ++i) {
        const double after = (node.momentum[i] + node.impulse[i]) / node.mass;
        const double before = step.keep * node.momentum[i] / node.mass;
        bar.momentum[i] += (bar.velocity[i] + step.keep * bar.before[i]) / node.mass;
        bar.impulse[i] += bar.velocity[i] / node.mass;
        bar.mass -= (bar.velocity[i] * after + bar.before[i] * before) / node.mass;
      }
      bar.velocity = bar.before = {};
    }
    for (std::size_t m = mirrors.size(); m-- > 0;) {
      const plain::Mirror& mirror = mirrors[m];
      grid.across(mirror.axis, mirror.ghost, mirror.image, [&](std::size_t ghost, std::size_t image) {
        Node& behind = nodes_[ghost];
        const Node& own = nodes_[image];
        behind.filling = own.filling;
        if (!mirror.is_whole()) return;
        behind.mass = own.mass;
        for (std::size_t i = 0; i < Dim; ++i) {
          const double sign = mirror.is_odd(static_cast<int>(i)) ? -1.0 : 1.0;
          behind.momentum[i] = sign * own.momentum[i];
          behind.impulse[i] = sign * own.impulse[i];
        }
      });
    }
    // Every node fell with the mass that it had before it was folded.
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      for (std::size_t i = 0; i < Dim; ++i) {
        nodes_[n].mass += step.step * step.acceleration[i] * nodes_[n].impulse[i];
        inputs.acceleration[i] += step.step * unfolded_mass_[n] * nodes_[n].impulse[i];
      }
  }

  // 1 --------------------------------------------------------------------------------------------------------

  void particles_to_grid_back(const Body& body, const Step& step, InputBars<Dim>& inputs) {
    const double density = inputs_.material.density, dt = step.step, per_cell = 1.0 / cell_;
    for (std::size_t q = 0; q < old_.size(); ++q) {
      const Particle& p = old_[q];
      Particle& bar = bars_[q];
      const Stencil s = stencil(body, p);
      const double volume = p.mass * p.volume_ratio / density, along = dt * volume * per_cell;
      auto stress = p.stress.tensor();
      for (std::size_t a = 0; a < 3; ++a) stress[a][a] -= acting_[q];
      const double r = settings_.axisymmetric ? radius(p) : 1.0;
      const double around = settings_.axisymmetric ? 2.0 * std::numbers::pi * r : 1.0;
      const double filling = volume / (cell_volume_ * around);
      const double hoop = settings_.axisymmetric ? dt * volume * stress[2][2] / r : 0.0;
      // Sums over the nodes of their bars, with what the weights make of the place.
      Place mass_sum(0.0), filling_sum(0.0), hoop_sum(0.0), reading(0.0);
      double momentum[Dim] = {}, moment[Dim][Dim] = {}, pull[Dim][Dim] = {};
      s.visit([&](std::size_t n, const auto& at) {
        const Node& node = nodes_[n];
        const Place weight = s.weight_of(at);
        const auto slope = s.slope_of(at), offset = s.offset_of(at);
        mass_sum += weight * Place(node.mass);
        filling_sum += weight * Place(node.filling);
        if (settings_.axisymmetric) hoop_sum += weight * Place(node.impulse[0]);
        for (std::size_t i = 0; i < Dim; ++i) {
          Place velocity(p.velocity[i]);
          momentum[i] += weight.v * node.momentum[i];
          for (std::size_t j = 0; j < Dim; ++j) {
            velocity += Place(p.affine[i][j]) * offset[j];
            moment[i][j] += weight.v * offset[j].v * node.momentum[i];
            pull[i][j] += slope[j].v * node.impulse[i];
            reading -= Place(along * stress[i][j] * node.impulse[i]) * slope[j];
          }
          reading += Place(p.mass * node.momentum[i]) * weight * velocity;
        }
      });
      reading += Place(p.mass) * mass_sum + Place(filling) * filling_sum - Place(hoop) * hoop_sum;
      add_place(bar, reading);
      bar.mass += mass_sum.v;
      plain::Tensor<double> stress_bar;
      double along_bar = 0.0;
      for (std::size_t i = 0; i < Dim; ++i) {
        bar.mass += momentum[i] * p.velocity[i];
        bar.velocity[i] += p.mass * momentum[i];
        for (std::size_t j = 0; j < Dim; ++j) {
          bar.mass += moment[i][j] * p.affine[i][j];
          bar.affine[i][j] += p.mass * moment[i][j];
          stress_bar[i][j] -= along * pull[i][j];
          along_bar -= stress[i][j] * pull[i][j];
        }
      }
      double volume_bar = along_bar * dt * per_cell + filling_sum.v / (cell_volume_ * around);
      if (settings_.axisymmetric) {
        volume_bar -= hoop_sum.v * hoop / volume;
        stress_bar[2][2] -= hoop_sum.v * dt * volume / r;
        if (p.cell[0] + p.place[0] > 1e-6)
          bar.place[0] += (hoop_sum.v * hoop - filling_sum.v * filling) / r * cell_;
      }
      pressure_[q] -= stress_bar.trace();
      // The deviator's third component is minus the sum of the others.
      bar.stress.xx += stress_bar[0][0] - stress_bar[2][2];
      bar.stress.yy += stress_bar[1][1] - stress_bar[2][2];
      bar.stress.xy += stress_bar[0][1] + stress_bar[1][0];
      if (Dim == 3) {
        bar.stress.xz += stress_bar[0][2] + stress_bar[2][0];
        bar.stress.yz += stress_bar[1][2] + stress_bar[2][1];
      }
      bar.mass += volume_bar * p.volume_ratio / density;
      bar.volume_ratio += volume_bar * p.mass / density;
      inputs.numbers[0] -= volume_bar * volume / density;
    }
  }

  /// The acting pressure, and the volumes at the nodes, of the state before the step.
  void averages_back(const Body& body, InputBars<Dim>& inputs) {
    for (std::size_t q = 0; q < old_.size(); ++q) {
      const Stencil s = stencil(body, old_[q]);
      Place pressure(0.0);
      s.visit([&](std::size_t n, const auto& at) {
        const Place weight = s.weight_of(at);
        pressure += weight * Place(before_[n].pressure);
        averages_[n].pressure += weight.v * pressure_[q];
      });
      add_place(bars_[q], pressure, pressure_[q]);
    }
    unmirror(body, &plain::Average<double>::pressure);
    for (std::size_t n = 0; n < averages_.size(); ++n) {
      const double volume = before_[n].volume;
      double& bar = averages_[n].pressure;
      if (!(volume > 0.0)) {
        bar = averages_[n].volume = 0.0;
        continue;
      }
      averages_[n].volume -= bar * before_[n].pressure / volume;
      bar /= volume;
    }
    unfold(body, &plain::Average<double>::pressure);
    unfold(body, &plain::Average<double>::volume);
    using D = Dual<4>;
    const auto& own = inputs_.material.state;
    const laws::EquationOfState<D> state = {D::input(own.bulk_modulus, 1), D(own.shear_modulus),
                                            D::input(own.exponent, 2)};
    for (std::size_t q = 0; q < old_.size(); ++q) {
      const Particle& p = old_[q];
      const double volume = p.mass * p.volume_ratio;
      const Stencil s = stencil(body, p);
      Place of_volume(0.0), of_thrust(0.0);
      s.visit([&](std::size_t n, const auto& at) {
        const Place weight = s.weight_of(at);
        of_volume += weight * Place(averages_[n].volume);
        of_thrust += weight * Place(averages_[n].pressure);
      });
      const D pressure = state.pressure(D::input(p.volume_ratio, 0));
      add_place(bars_[q], of_volume, volume);
      add_place(bars_[q], of_thrust, volume * pressure.v);
      const double volume_bar = of_volume.v + of_thrust.v * pressure.v, pressure_bar = of_thrust.v * volume;
      bars_[q].mass += volume_bar * p.volume_ratio;
      bars_[q].volume_ratio += volume_bar * p.mass + pressure_bar * pressure.d[0];
      inputs.numbers[1] += pressure_bar * pressure.d[1];
      inputs.numbers[3] += pressure_bar * pressure.d[2];
    }
  }

  // What the stages share ------------------------------------------------------------------------------------

  double radius(const Particle& p) const { return cell_ * std::max(p.cell[0] + p.place[0], 1e-6); }

  void unmirror(const Body& body, double plain::Average<double>::*what) {
    const auto& grid = body.grid_;
    const auto& mirrors = grid.mirrors();
    for (std::size_t m = mirrors.size(); m-- > 0;)
      grid.across(mirrors[m].axis, mirrors[m].ghost, mirrors[m].image,
                  [&](std::size_t ghost, std::size_t image) {
                    averages_[image].*what += averages_[ghost].*what;
                    averages_[ghost].*what = 0.0;
                  });
  }
  void unfold(const Body& body, double plain::Average<double>::*what) {
    const auto& grid = body.grid_;
    const auto& mirrors = grid.mirrors();
    for (std::size_t m = mirrors.size(); m-- > 0;)
      grid.across(
          mirrors[m].axis, mirrors[m].ghost, mirrors[m].image,
          [&](std::size_t ghost, std::size_t image) { averages_[ghost].*what = averages_[image].*what; });
  }

  SolverSettings settings_;
  plain::Inputs<double> inputs_;
  double cell_;
  StrainAdjoint<Dim> strain_;
  double cell_volume_;

  // Of the step, forwards, by particle, ...
  double step_ = 0.0;
  Particles old_, placed_;  ///< before it, and after the motion in the same order
  std::vector<double> acting_, filling_, coverage_, ratio_;
  std::vector<plain::Tensor<double>> gradient_;  ///< as gathered
  std::vector<plain::Vec<double, Dim>> moved_;   ///< m/s, the velocity that moves it
  // ... and by node.
  std::vector<plain::Average<double>> before_, dilatations_;  ///< of the state before it, and of its strain
  std::vector<double> unfolded_mass_;
  std::vector<std::vector<Corrected>> corrected_;  ///< by mirror
  /// Nodes that each nozzle holds, and their velocities before.
  std::vector<std::vector<std::pair<std::size_t, plain::Vec<double, Dim>>>> nozzled_;
  std::vector<typename Friction::Pair> pairs_;
  std::vector<std::array<Node, 2>> relaxed_;    ///< a pair before it is held
  std::vector<std::array<Node, 3>> taken_out_;  ///< and before its correction, with the second node

  // Bars.
  Particles bars_, new_;  ///< before the step, and after it in the same order
  std::vector<Node> nodes_;
  std::vector<plain::Average<double>> averages_;
  std::vector<double> pressure_, dilatation_, held_bars_;
  std::vector<plain::Vec<double, Dim>> velocity_;  ///< of moved_
  std::vector<typename StrainAdjoint<Dim>::Strain> strain_bars_;
};

}  // namespace flowrest::mpm::derivatives
