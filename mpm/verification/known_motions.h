#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mpm/boundary/walls.h"
#include "mpm/solver/solver.h"
#include "mpm/solver/test_bodies.h"

/// Motions of bodies made by hand whose outcome is known, made in one place: the tests judge them, and so
/// does `flowrest verify`, on several grids.
namespace flowrest::mpm::known {

using test::Open;
using test::usual_step;
using test::Variant;

constexpr double gravity = 9.81;

/// How a step is taken; a caller that may be interrupted throws from his own.
using Step = std::function<void(Solver&, double, const std::array<double, 3>&)>;
inline void plain_step(Solver& solver, double step, const std::array<double, 3>& acceleration) {
  solver.step(step, acceleration);
}

inline double kinetic_and_elastic_energy(Solver& solver) {
  double energy = 0.0;
  solver.visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      double speed_squared = 0.0;
      for (const auto& v : b.velocity) speed_squared += v[i] * v[i];
      energy += 0.5 * b.mass[i] * speed_squared + b.elastic_energy[i];
    }
  });
  return energy;
}

/// Mean velocity along a direction, m/s.
inline double mean_velocity(Solver& solver, const Vector& direction) {
  double momentum = 0.0, mass = 0.0;
  solver.visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      mass += b.mass[i];
      for (std::size_t a = 0; a < b.velocity.size(); ++a)
        momentum += b.mass[i] * b.velocity[a][i] * direction[a];
    }
  });
  return momentum / mass;
}

/// The same solver whose particles' affine velocities are set: the difference of component i over a cell
/// along axis j, m/s. linear-flip has none.
inline std::unique_ptr<Solver> with_affine(std::unique_ptr<Solver> solver, const SolverSettings& s,
                                           const std::array<std::array<double, 2>, 2>& affine) {
  Open open(*solver, s);
  if (!open.affine_stored) return solver;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (double& value : open.affine(i, j))
        value = affine[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return make_solver(s, open.state);
}

/// An elastic block of `edge` by `edge` cells, in space `thickness` high, that spins about its middle. rad/s
inline std::unique_ptr<Solver> spinning_block(SolverSettings& s, int edge, int thickness, int per_axis,
                                              double rate) {
  constexpr int first = 100;
  s.flow.yield_stress = 1e9;
  auto seeds =
      test::even_block(s, {first, first, first}, {first + edge, first + edge, first + thickness}, per_axis);
  const double middle = first + 0.5 * edge;
  for (auto& seed : seeds) {
    seed.velocity[0] = -rate * (seed.cell[1] + seed.position[1] - middle) * s.cell;
    seed.velocity[1] = rate * (seed.cell[0] + seed.position[0] - middle) * s.cell;
  }
  return with_affine(make_solver(s, seeds), s, {{{0.0, -rate * s.cell}, {rate * s.cell, 0.0}}});
}

/// A periodic block without stress worth speaking of, which keeps the shear it starts with, 1/s.
inline std::unique_ptr<Solver> sheared_block(SolverSettings& s, double rate, double flocculation) {
  s.law = laws::Law::elasto_viscoplastic;
  s.thixotropic = true;
  s.flow.yield_stress = 1e-9;
  s.flow.plastic_viscosity = 1e-9;
  s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 8, true};
  auto seeds = test::even_block(s, {0, 20, 0}, {8, 26, 0}, 3);
  for (auto& seed : seeds) {
    seed.velocity[0] = rate * (seed.cell[1] + seed.position[1] - 23.0) * s.cell;
    seed.flocculation = flocculation;
  }
  return with_affine(make_solver(s, seeds), s, {{{0.0, rate * s.cell}, {0.0, 0.0}}});
}

/// A column between slip walls, `across` cells wide, after `time` s under gravity.
inline std::unique_ptr<Solver> settled_column(SolverSettings& s, std::vector<Seed> seeds, int across,
                                              double time, const Step& step = plain_step) {
  s.law = laws::Law::newtonian;
  s.flow.plastic_viscosity = 500.0;  // stills the column's swing (47 rad/s) at 9 a second
  s.bounds[0] = {PlaneWall::slip, PlaneWall::slip, 0, across, false};
  s.bounds[1].lower = PlaneWall::slip;
  auto solver = make_solver(s, seeds);
  const double dt = usual_step(s);
  const int steps = static_cast<int>(std::ceil(time / dt));
  for (int i = 0; i < steps; ++i) step(*solver, dt, {0.0, -gravity, 0.0});
  return solver;
}

struct ColumnPressure {
  double worst = 0.0;   ///< largest difference from the weight above, Pa
  double lowest = 0.0;  ///< in the lowest row, Pa
  double mass = 0.0;    ///< kg
};

/// Row by row of cells the averaged pressure against the weight above the row and half its own. With
/// quadratic functions that acts on particles; of linear ones a cell carries the sum of volume times pressure
/// over its own volume, which differ where a lattice row more or less than three happens to lie in the cell.
inline ColumnPressure column_pressure(Solver& solver, const SolverSettings& s, int across) {
  struct Row {
    double mass = 0.0, volume = 0.0, thrust = 0.0;
  };
  std::map<int, Row> rows;
  solver.visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      Row& row = rows[static_cast<int>(b.position[1][i] / s.cell)];
      row.mass += b.mass[i];
      row.volume += b.volume[i];
      row.thrust += b.volume[i] * (b.acting_pressure.empty() ? b.raw_pressure : b.acting_pressure)[i];
    }
  });
  ColumnPressure result;
  for (auto found = rows.rbegin(); found != rows.rend(); ++found) {
    const Row& row = found->second;
    const double weight = (result.mass + 0.5 * row.mass) * gravity / (across * s.cell);
    result.lowest =
        row.thrust / (s.transfer == Transfer::quadratic_apic ? row.volume : across * s.cell * s.cell);
    result.worst = std::max(result.worst, std::abs(result.lowest - weight));
    result.mass += row.mass;
  }
  return result;
}

/// A film of `layers` cells on an incline, x down the slope, at the end of `time`.
struct Film {
  double velocity = 0.0;              ///< of its upper part, m/s
  double fastest_plastic_rate = 0.0;  ///< 1/s
  double slope = 0.0;                 ///< F = rho g sin(theta), N/m3

  /// A film of thickness H moves where F H > tau0, its plug at F (H - tau0 / F)^2 / (2 eta). Solved for tau0
  /// / F, the velocity says at which thickness it would stop.
  double stops_at(double thickness, double viscosity) const {
    return thickness - std::sqrt(2.0 * viscosity * std::max(0.0, velocity) / slope);
  }
};

/// `ratio` is the stress at its base over the yield stress. The plug is read above `read_above` of its
/// thickness.
inline Film film_on_incline(SolverSettings& s, int layers, double ratio, double time, double read_above,
                            const Step& step = plain_step) {
  s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 4, true};
  s.bounds[1].lower = PlaneWall::no_slip;
  auto solver = make_solver(s, test::even_block(s, {0, 0, 0}, {4, layers, 0}, 4));
  const double thickness = layers * s.cell;
  Film film;
  film.slope = ratio * s.flow.yield_stress / thickness;
  const double along = film.slope / s.density, across = -std::sqrt(gravity * gravity - along * along);
  const double dt = usual_step(s);
  const int steps = static_cast<int>(time / dt), loading = steps / 4;
  for (int i = 0; i < steps; ++i) {  // the weight comes on slowly, so that the film does not bounce
    const double share = std::min(1.0, static_cast<double>(i) / loading);
    step(*solver, dt, {share * along, share * across, 0.0});
  }
  int count = 0;
  solver->visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      film.fastest_plastic_rate = std::max(film.fastest_plastic_rate, b.rate[i]);
      if (b.position[1][i] < read_above * thickness) continue;
      film.velocity += b.velocity[0][i];
      ++count;
    }
  });
  film.velocity /= count;
  return film;
}

/// How the front of a breaking dam runs beside the measured one.
struct DamBreak {
  double delay = 0.0;  ///< of the measured clock, in sqrt(W / 2g)
  double worst = 0.0;  ///< largest relative difference of the front after it
};

inline double interpolated(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto after = static_cast<std::size_t>(std::upper_bound(x.begin() + 1, x.end() - 1, at) - x.begin());
  return y[after - 1] + (y[after] - y[after - 1]) * (at - x[after - 1]) / (x[after] - x[after - 1]);
}

/// The largest coordinate along an axis, m.
inline double farthest(Solver& solver, std::size_t axis) {
  double most = 0.0;
  solver.visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) most = std::max(most, b.position[axis][i]);
  });
  return most;
}

/// A column of water `across` cells wide and twice as high: times t sqrt(2 g / W) and fronts x / W of Martin
/// and Moyce 1952, table 2, n^2 = 2. Their clock includes the time the membrane takes to give way, which no
/// inviscid computation has: it is fitted, and what is compared is how the front runs after it.
inline DamBreak dam_break(SolverSettings& s, int across, const Step& step = plain_step) {
  const std::vector<std::pair<double, double>> measured = {{1.19, 1.44}, {1.43, 1.67}, {1.63, 1.89},
                                                           {1.83, 2.11}, {1.98, 2.33}, {2.20, 2.56},
                                                           {2.32, 2.78}, {2.51, 3.00}};
  const double width = across * s.cell, sound = 15.0 * std::sqrt(2.0 * gravity * 2.0 * width);
  s.law = laws::Law::newtonian;
  s.density = 1000.0;
  s.flow.plastic_viscosity = 1e-3;
  s.state = {s.density * sound * sound, 1e-3 * s.density * sound * sound, 7.0};
  s.bounds[0].lower = PlaneWall::slip;
  s.bounds[1].lower = PlaneWall::slip;
  auto solver = make_solver(s, test::even_block(s, {0, 0, 0}, {across, 2 * across, 0}, 3));
  const double dt = 0.5 * s.cell / sound, scale = std::sqrt(2.0 * gravity / width);
  std::vector<double> time = {0.0}, front = {farthest(*solver, 0) / width};
  while (front.back() < 3.2) {
    for (int i = 0; i < 10; ++i) step(*solver, dt, {0.0, -gravity, 0.0});
    time.push_back(time.back() + 10.0 * dt * scale);
    front.push_back(farthest(*solver, 0) / width);
    if (time.back() > 5.0) throw std::runtime_error("the column does not run");
  }
  DamBreak result;
  for (const auto& [t, x] : measured)
    result.delay += (t - interpolated(front, time, x)) / static_cast<double>(measured.size());
  for (const auto& [t, x] : measured)
    result.worst = std::max(result.worst, std::abs(interpolated(time, front, t - result.delay) / x - 1.0));
  return result;
}

/// Directions of a wall in the plane of the first and the last axis, turned from the grid by `angle`.
struct Frame {
  Vector along{}, up{};
  Frame(double angle, int dimension) {
    const auto last = static_cast<std::size_t>(dimension - 1);
    along[0] = std::cos(angle);
    along[last] = std::sin(angle);
    up[0] = -std::sin(angle);
    up[last] = std::cos(angle);
  }
};

inline Vector combined(const Vector& origin, const Frame& f, double along, double up, double across) {
  Vector x;
  for (std::size_t a = 0; a < 3; ++a) x[a] = origin[a] + along * f.along[a] + up * f.up[a];
  if (f.up[1] == 0.0 && f.along[1] == 0.0) x[1] += across;
  return x;
}

inline Seed seed_at(const Vector& x, double cell, double volume, int dimension) {
  Seed s;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) {
    s.cell[a] = static_cast<int>(std::floor(x[a] / cell));
    s.position[a] = x[a] / cell - s.cell[a];
  }
  s.volume = volume;
  return s;
}

constexpr Vector place_on_wall = {0.5, 0.5, 0.5};

/// A block whose base lies on a wall through `place_on_wall`, `length` by `height` cells (and four across in
/// space), three particles along a cell's edge, on a lattice along the wall.
inline std::vector<Seed> block_on_wall(const SolverSettings& s, const Frame& f, int length, int height) {
  std::vector<Seed> seeds;
  const double spacing = s.cell / 3.0;
  const int across = s.dimension == 3 ? 12 : 1;
  for (int i = 0; i < 3 * length; ++i)
    for (int k = 0; k < 3 * height; ++k)
      for (int j = 0; j < across; ++j)
        seeds.push_back(seed_at(combined(place_on_wall, f, (i + 0.5 - 1.5 * length) * spacing,
                                         (k + 0.5) * spacing, s.dimension == 3 ? (j + 0.5) * spacing : 0.0),
                                s.cell, std::pow(spacing, s.dimension), s.dimension));
  return seeds;
}

inline Wall plane_wall(int dimension, const Frame& f, Contact contact, double friction) {
  const Extent extent = {{0.0, 0.2, 0.0}, {1.6, dimension == 3 ? 0.8 : 1.6, 1.6}};
  Wall wall;
  wall.name = "plane";
  wall.shape = std::make_shared<HalfSpace>(dimension, place_on_wall, f.up, extent);
  wall.contact = contact;
  wall.friction = friction;
  return wall;
}

/// How a block slides: on a wall that is turned from the grid, which is inclined once the block has settled
/// on it.
struct Slide {
  double angle = 0.0;     ///< of the wall to the grid
  double slope = 0.0;     ///< of the wall to the horizontal
  double friction = 0.0;  ///< Coulomb's coefficient

  /// g (sin - mu cos), m/s2
  double exact() const { return gravity * (std::sin(slope) - friction * std::cos(slope)); }
};

/// Acceleration over `time` of an elastic slab of 12 by 2 cells of 10 mm, finer cells making up the same,
/// m/s2.
inline double sliding_acceleration(SolverSettings s, const Slide& slide, double time,
                                   const Step& step = plain_step) {
  s.flow.yield_stress = 1e9;
  const Frame f(slide.angle, s.dimension);
  s.walls = {plane_wall(s.dimension, f, Contact::friction, slide.friction)};
  const auto cells = [&](double length) {
    return std::max(1, static_cast<int>(std::lround(length / s.cell)));
  };
  // A flat slab: a tall elastic block takes to rocking, which real ones do too (friction-driven flutter).
  auto solver = make_solver(s, block_on_wall(s, f, cells(0.12), cells(0.02)));
  const double dt = usual_step(s);
  const auto advance = [&](double inclination, double span) {
    std::array<double, 3> pull{};
    for (std::size_t a = 0; a < 3; ++a)
      pull[a] = gravity * (std::sin(inclination) * f.along[a] - std::cos(inclination) * f.up[a]);
    const int steps = static_cast<int>(std::ceil(span / dt));
    for (int i = 0; i < steps; ++i) step(*solver, dt, pull);
    return steps * dt;
  };
  advance(0.0, 0.3);
  // Inclining it takes weight off the wall, and the block bounces on it for a while.
  advance(slide.slope, 0.3);
  const double early = mean_velocity(*solver, f.along);
  const double span = advance(slide.slope, time);
  return (mean_velocity(*solver, f.along) - early) / span;
}

}  // namespace flowrest::mpm::known
