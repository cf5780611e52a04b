#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mpm/solver/solver.h"
#include "mpm/test_random.h"

/// Small bodies made by hand, and a solver's particles laid open.
namespace flowrest::mpm::test {

/// What one body of a test is computed with.
struct Variant {
  int dimension = 2;
  bool axisymmetric = false;
  Transfer transfer = Transfer::quadratic_apic;
  bool single_precision = false;
};

inline std::string name_of(const Variant& v) {
  return std::string(v.axisymmetric     ? "axisymmetric"
                     : v.dimension == 3 ? "3D"
                                        : "2D") +
         (v.transfer == Transfer::quadratic_apic ? ", quadratic APIC" : ", linear FLIP") +
         (v.single_precision ? ", float" : ", double");
}

inline std::vector<Variant> every_variant() {
  std::vector<Variant> all;
  for (const bool single : {false, true})
    for (const auto transfer : {Transfer::quadratic_apic, Transfer::linear_flip}) {
      all.push_back({2, false, transfer, single});
      all.push_back({2, true, transfer, single});
      all.push_back({3, false, transfer, single});
    }
  return all;
}

/// Roussel's concrete on cells of 10 mm, no walls, one thread.
inline SolverSettings concrete(const Variant& v) {
  SolverSettings s;
  s.dimension = v.dimension;
  s.axisymmetric = v.axisymmetric;
  s.transfer = v.transfer;
  s.single_precision = v.single_precision;
  s.cell = 0.01;
  s.density = 2300.0;
  s.flip_relaxation_time = 0.05;
  s.flow.yield_stress = 50.0;
  s.flow.plastic_viscosity = 50.0;
  s.flow.regularisation_time = 100.0;
  s.flow.critical_shear_rate = 0.01;
  s.state = {1e5 / 1.2, 1e5 / 2.6, 7.0};
  s.threads = 1;
  if (v.axisymmetric) s.bounds[0].lower = PlaneWall::slip;
  return s;
}

/// Two thirds of the largest stable step.
inline double usual_step(const SolverSettings& s) {
  return 0.7 * s.cell / std::sqrt((s.state.bulk_modulus + 4.0 / 3.0 * s.state.shear_modulus) / s.density);
}

/// A block of whole cells [first, last), `per_axis` particles along each axis in each, jittered where
/// `random` is given.
inline std::vector<Seed> even_block(const SolverSettings& s, const CellIndex& first, const CellIndex& last,
                                    int per_axis, Random* random = nullptr) {
  std::vector<Seed> seeds;
  const int depth = s.dimension == 3 ? per_axis : 1;
  const double volume = std::pow(s.cell / per_axis, s.dimension);
  for (int i = first[0]; i < last[0]; ++i)
    for (int j = first[1]; j < last[1]; ++j)
      for (int k = first[2]; k < std::max(last[2], first[2] + 1); ++k)
        for (int a = 0; a < per_axis; ++a)
          for (int b = 0; b < per_axis; ++b)
            for (int c = 0; c < depth; ++c) {
              Seed seed;
              seed.cell = {i, j, s.dimension == 3 ? k : 0};
              const int site[3] = {a, b, c};
              for (std::size_t x = 0; x < static_cast<std::size_t>(s.dimension); ++x)
                seed.position[x] = (site[x] + (random ? random->uniform() : 0.5)) / per_axis;
              const double radius = (i + seed.position[0]) * s.cell;
              seed.volume = volume * (s.axisymmetric ? 2.0 * std::numbers::pi * radius : 1.0);
              seeds.push_back(seed);
            }
  return seeds;
}

/// The same, each particle's volume a little larger than the last one's, so that its mass tells it apart
/// whatever order particles come in.
inline std::vector<Seed> block(const SolverSettings& s, const CellIndex& first, const CellIndex& last,
                               int per_axis, Random* random = nullptr) {
  auto seeds = even_block(s, first, last, per_axis, random);
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i].volume *= 1.0 + 1e-5 * static_cast<double>(i);
  return seeds;
}

/// The block most tests use: far from the origin, jittered, with random velocities of up to `speed` m/s.
inline std::vector<Seed> restless_block(const SolverSettings& s, Random& random, double speed = 0.5) {
  const int edge = s.dimension == 3 ? 6 : 10;
  auto seeds = block(s, {21, 17, 18}, {21 + edge, 17 + edge, 18 + edge}, 2, &random);
  for (auto& seed : seeds)
    for (std::size_t a = 0; a < static_cast<std::size_t>(s.dimension); ++a)
      seed.velocity[a] = random.between(-speed, speed);
  return seeds;
}

/// A state wherever it lies, brought into memory.
inline SolverState all_of(const StoredState& stored) {
  SolverState all{stored.cells, {}, stored.tile_capacity, stored.wall_forces};
  for (int k = 0; k < stored.array_count; ++k) all.arrays.push_back(stored.array(k));
  return all;
}

/// A solver's state with its arrays by name.
struct Open {
  SolverState state;
  int dimension;
  double cell;
  bool affine_stored;

  Open(SolverState of, const SolverSettings& s)
      : state(std::move(of)),
        dimension(s.dimension),
        cell(s.cell),
        affine_stored(s.transfer == Transfer::quadratic_apic) {}
  Open(Solver& solver, const SolverSettings& s) : Open(solver.state(), s) {}

  std::size_t size() const { return state.cells.size(); }
  std::vector<double>& array(int index) { return state.arrays.at(static_cast<std::size_t>(index)); }
  std::vector<double>& within(int axis) { return array(axis); }
  std::vector<double>& velocity(int axis) { return array(dimension + axis); }
  /// Velocity difference over a cell, of component i along axis j, m/s.
  std::vector<double>& affine(int i, int j) { return array(2 * dimension + i * dimension + j); }
  std::vector<double>& deviator(int component) { return array(after_affine() + component); }
  std::vector<double>& volume_ratio() { return array(after_affine() + components()); }
  std::vector<double>& pressure() { return array(after_affine() + components() + 1); }
  std::vector<double>& mass() { return array(after_affine() + components() + 2); }
  std::vector<double>& rate() { return array(after_affine() + components() + 3); }
  double position(int axis, std::size_t p) {
    return (state.cells[p][static_cast<std::size_t>(axis)] + within(axis)[p]) * cell;
  }
  int components() const { return dimension == 3 ? 5 : 3; }

  /// Particles in the order of their masses.
  std::vector<std::size_t> by_mass() {
    std::vector<std::size_t> order(size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return mass()[a] < mass()[b]; });
    return order;
  }

 private:
  int after_affine() const { return 2 * dimension + (affine_stored ? dimension * dimension : 0); }
};

struct Momenta {
  std::array<double, 3> linear{};
  double linear_scale = 0.0;  ///< sum of m |v|
  std::array<double, 3> angular{};
  double angular_scale = 0.0;
};

/// Linear momentum, and angular momentum about the origin with what APIC's affine velocities carry:
/// sum of m h/4 (A_ji - A_ij), A the velocity differences over a cell (Jiang et al. 2015, section 5.3).
inline Momenta momenta(Open& open) {
  Momenta m;
  for (std::size_t p = 0; p < open.size(); ++p) {
    const double mass = open.mass()[p];
    std::array<double, 3> x{}, v{};
    for (int a = 0; a < open.dimension; ++a) {
      x[static_cast<std::size_t>(a)] = open.position(a, p);
      v[static_cast<std::size_t>(a)] = open.velocity(a)[p];
    }
    const auto affine = [&](int i, int j) {
      return open.affine_stored && i < open.dimension && j < open.dimension ? open.affine(i, j)[p] : 0.0;
    };
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      const int ib = static_cast<int>(b), ic = static_cast<int>(c);
      m.linear[a] += mass * v[a];
      m.angular[a] +=
          mass * (x[b] * v[c] - x[c] * v[b]) + mass * open.cell / 4.0 * (affine(ic, ib) - affine(ib, ic));
    }
    m.linear_scale += mass * std::hypot(v[0], v[1], v[2]);
    m.angular_scale += mass * std::hypot(x[0], x[1], x[2]) * std::hypot(v[0], v[1], v[2]);
  }
  return m;
}

/// The same solver with random stresses of about `size` Pa in it.
inline std::unique_ptr<Solver> stressed(std::unique_ptr<Solver> solver, const SolverSettings& s,
                                        Random& random, double size) {
  Open open(*solver, s);
  for (int c = 0; c < open.components(); ++c)
    for (double& v : open.deviator(c)) v = random.between(-size, size);
  for (std::size_t p = 0; p < open.size(); ++p) {
    open.volume_ratio()[p] = 1.0 - random.between(-size, size) / s.state.bulk_modulus;
    open.pressure()[p] = s.state.pressure(open.volume_ratio()[p]);
  }
  return make_solver(s, open.state);
}

}  // namespace flowrest::mpm::test
