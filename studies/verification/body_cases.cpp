// Bodies made by hand, without a scene: free fall, a column at rest, a spinning block, a film, thixotropy in
// shear, a dam that breaks.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "mpm/solver/solver.h"
#include "runs/run_directory.h"
#include "studies/verification/verification.h"

namespace flowrest::studies::verification {

namespace {

using mpm::CellIndex;
using mpm::Law;
using mpm::ParticleBatch;
using mpm::PlaneWall;
using mpm::Seed;
using mpm::Solver;
using mpm::SolverSettings;
using mpm::Transfer;

constexpr double gravity = 9.81;

struct Variant {
  Transfer transfer = Transfer::quadratic_apic;
  bool single_precision = false;
};

std::string words(const Variant& v) {
  return std::string("MPM ") + (v.transfer == Transfer::quadratic_apic ? "quadratic-apic" : "linear-flip") +
         (v.single_precision ? ", float" : ", double");
}

/// Roussel's concrete on plane cells, no walls, one thread.
SolverSettings concrete(const Variant& v, double cell) {
  SolverSettings s;
  s.dimension = 2;
  s.transfer = v.transfer;
  s.single_precision = v.single_precision;
  s.cell = cell;
  s.density = 2300.0;
  s.flip_relaxation_time = 0.05;
  s.flow.yield_stress = 50.0;
  s.flow.plastic_viscosity = 50.0;
  s.state = {1e5 / 1.2, 1e5 / 2.6, 7.0};
  s.threads = 1;
  return s;
}

double acoustic_step(const SolverSettings& s, double courant = 0.7) {
  return courant * s.cell / std::sqrt((s.state.bulk_modulus + 4.0 / 3.0 * s.state.shear_modulus) / s.density);
}

/// Whole cells [first, last), `per_axis` particles along each axis in each.
std::vector<Seed> block(const SolverSettings& s, const CellIndex& first, const CellIndex& last,
                        int per_axis) {
  std::vector<Seed> seeds;
  for (int i = first[0]; i < last[0]; ++i)
    for (int j = first[1]; j < last[1]; ++j)
      for (int a = 0; a < per_axis; ++a)
        for (int b = 0; b < per_axis; ++b) {
          Seed seed;
          seed.cell = {i, j, 0};
          seed.position = {(a + 0.5) / per_axis, (b + 0.5) / per_axis, 0.0};
          seed.volume = std::pow(s.cell / per_axis, 2);
          seeds.push_back(seed);
        }
  return seeds;
}

/// The solver with its particles' affine velocities set: the difference of component i over a cell along axis
/// j, m/s. They stand behind positions and velocities, i by i.
std::unique_ptr<Solver> with_affine(std::unique_ptr<Solver> solver, const SolverSettings& s,
                                    const std::array<std::array<double, 2>, 2>& affine) {
  auto state = solver->state();
  const auto dimension = static_cast<std::size_t>(s.dimension);
  for (std::size_t i = 0; i < dimension; ++i)
    for (std::size_t j = 0; j < dimension; ++j)
      for (double& value : state.arrays.at(2 * dimension + i * dimension + j)) value = affine[i][j];
  return mpm::make_solver(s, state);
}

void step(Solver& solver, double dt, const std::array<double, 3>& acceleration, const Workplace& place) {
  if (place.interrupted()) throw runs::NumericsError("interrupted");
  solver.step(dt, acceleration);
}

/// A block in free fall: its centre of mass follows g t^2 / 2 to round-off, whatever it is made of. The
/// lattice of steps makes the sum g dt^2 n (n + 1) / 2, which is what is compared.
Case free_fall(const Variant& v) {
  Case c;
  c.name = "Free fall";
  c.variant = words(v);
  c.against = "the sum of the steps, g dt^2 n (n + 1) / 2";
  c.norm = "relative error of the fall";
  c.value_name = "fall";
  c.value_unit = "m";
  c.grids = {0.04, 0.02, 0.01};
  c.largest_error = v.single_precision ? 1e-4 : 1e-11;
  c.round_off = v.single_precision ? 1e-4 : 1e-11;
  c.quick = true;
  c.cost = 0.5;
  c.compute = [=](double cell, const Workplace& place) {
    const SolverSettings s = concrete(v, cell);
    const int edge = static_cast<int>(std::lround(0.16 / cell));
    auto solver = mpm::make_solver(s, block(s, {100, 400, 0}, {100 + edge, 400 + edge, 0}, 2));
    const auto centre = [&] {
      double moment = 0.0, mass = 0.0;
      solver->visit([&](const ParticleBatch& b) {
        for (std::size_t i = 0; i < b.count; ++i) {
          moment += b.mass[i] * b.position[1][i];
          mass += b.mass[i];
        }
      });
      return moment / mass;
    };
    const double before = centre(), dt = acoustic_step(s);
    const int steps = static_cast<int>(0.3 / dt);
    for (int i = 0; i < steps; ++i) step(*solver, dt, {0.0, -gravity, 0.0}, place);
    const double fall = before - centre(), exact = gravity * dt * dt * steps * (steps + 1.0) / 2.0;
    return Measured{std::abs(fall / exact - 1.0), fall};
  };
  return c;
}

/// Row by row of cells the averaged pressure against the weight above the row and half its own. Quadratic
/// functions carry the particles' pressure; of linear ones a cell carries the sum of volume times pressure
/// over its own volume.
Case column(const Variant& v) {
  Case c;
  c.name = "Column at rest, pressure";
  c.variant = words(v);
  c.against = "the weight above";
  c.norm = "largest error of a row, relative to the pressure at the bottom";
  c.value_name = "pressure in the lowest row";
  c.value_unit = "Pa";
  c.grids = {0.04, 0.02, 0.01};
  c.largest_error = 0.02;
  c.quick = true;
  c.cost = 4.0;
  c.compute = [=](double cell, const Workplace& place) {
    SolverSettings s = concrete(v, cell);
    const int across = static_cast<int>(std::lround(0.08 / cell)),
              high = static_cast<int>(std::lround(0.2 / cell));
    s.law = Law::newtonian;
    s.flow.plastic_viscosity = 500.0;  // stills the column's swing (47 rad/s) at 9 a second
    s.bounds[0] = {PlaneWall::slip, PlaneWall::slip, 0, across, false};
    s.bounds[1].lower = PlaneWall::slip;
    auto solver = mpm::make_solver(s, block(s, {0, 0, 0}, {across, high, 0}, 3));
    const double dt = acoustic_step(s);
    for (double t = 0.0; t < 4.0; t += dt) step(*solver, dt, {0.0, -gravity, 0.0}, place);
    struct Row {
      double mass = 0.0, volume = 0.0, thrust = 0.0;
    };
    std::map<int, Row> rows;
    solver->visit([&](const ParticleBatch& b) {
      for (std::size_t i = 0; i < b.count; ++i) {
        Row& row = rows[static_cast<int>(b.position[1][i] / s.cell)];
        row.mass += b.mass[i];
        row.volume += b.volume[i];
        row.thrust += b.volume[i] * b.raw_pressure[i];
      }
    });
    const double bottom = s.density * gravity * high * s.cell;
    double above = 0.0, worst = 0.0, carried = 0.0;
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
      const double weight = (above + 0.5 * row->second.mass) * gravity / (across * s.cell);
      carried = row->second.thrust /
                (v.transfer == Transfer::quadratic_apic ? row->second.volume : across * s.cell * s.cell);
      worst = std::max(worst, std::abs(carried - weight));
      above += row->second.mass;
    }
    return Measured{worst / bottom, carried};
  };
  return c;
}

double kinetic_and_elastic_energy(Solver& solver) {
  double energy = 0.0;
  solver.visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      double speed_squared = 0.0;
      for (const auto& velocity : b.velocity) speed_squared += velocity[i] * velocity[i];
      energy += 0.5 * b.mass[i] * speed_squared + b.elastic_energy[i];
    }
  });
  return energy;
}

/// An elastic block turns ten times: its energy stays. linear-flip is not made for this: its relaxation
/// smooths velocities and does not know rotation.
Case rotation(const Variant& v) {
  Case c;
  c.name = "Spinning elastic block, energy after ten turns";
  c.variant = words(v);
  c.against = "conservation";
  c.norm = "share of the energy lost or made";
  c.value_name = "energy kept";
  c.value_unit = "";
  c.exact_value = 1.0;
  c.grids = {0.02, 0.01, 0.005};
  c.largest_error = 0.01;
  c.cost = 10.0;
  c.compute = [=](double cell, const Workplace& place) {
    SolverSettings s = concrete(v, cell);
    s.flow.yield_stress = 1e9;
    const double turns_a_second = 3.0, rate = 2.0 * std::numbers::pi * turns_a_second;
    const int edge = static_cast<int>(std::lround(0.08 / cell)), first = 100;
    auto seeds = block(s, {first, first, 0}, {first + edge, first + edge, 0}, 3);
    const double middle = first + 0.5 * edge;
    for (auto& seed : seeds) {
      seed.velocity[0] = -rate * (seed.cell[1] + seed.position[1] - middle) * s.cell;
      seed.velocity[1] = rate * (seed.cell[0] + seed.position[0] - middle) * s.cell;
    }
    auto solver = with_affine(mpm::make_solver(s, seeds), s, {{{0.0, -rate * s.cell}, {rate * s.cell, 0.0}}});
    const double dt = acoustic_step(s);
    const double begin = kinetic_and_elastic_energy(*solver);
    const int steps = static_cast<int>(std::ceil(10.0 / turns_a_second / dt));
    for (int i = 0; i < steps; ++i) step(*solver, dt, {}, place);
    const double kept = kinetic_and_elastic_energy(*solver) / begin;
    return Measured{std::abs(kept - 1.0), kept};
  };
  return c;
}

/// A film of thickness H moves where rho g sin(theta) H > tau0, its plug at F (H - tau0 / F)^2 / (2 eta),
/// F = rho g sin(theta). Solved for tau0, the velocity says at which thickness it would stop.
Case film(const Variant& v) {
  const double thickness = 0.08, yield = 50.0, viscosity = 20.0, ratio = 1.5;
  Case c;
  c.name = "Film on an incline, thickness at which it stops";
  c.variant = words(v);
  c.against = "tau0 / (rho g sin theta), by way of the plug's velocity";
  c.norm = "relative error of the thickness";
  c.value_name = "stopping thickness";
  c.value_unit = "mm";
  c.exact_value = 1e3 * thickness / ratio;
  c.grids = {0.02, 0.01, 0.005};
  c.largest_error = 0.02;
  c.quick = v.transfer == Transfer::quadratic_apic && !v.single_precision;
  c.cost = 8.0;
  c.compute = [=](double cell, const Workplace& place) {
    SolverSettings s = concrete(v, cell);
    s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 4, true};
    s.bounds[1].lower = PlaneWall::no_slip;
    s.flow.yield_stress = yield;
    s.flow.plastic_viscosity = viscosity;
    const int layers = static_cast<int>(std::lround(thickness / cell));
    auto solver = mpm::make_solver(s, block(s, {0, 0, 0}, {4, layers, 0}, 4));
    const double along = ratio * yield / (s.density * thickness);
    const double across = -std::sqrt(gravity * gravity - along * along);
    const double dt = acoustic_step(s);
    const int steps = static_cast<int>(6.0 / dt), loading = steps / 4;
    for (int i = 0; i < steps; ++i) {  // the weight comes on slowly, so that the film does not bounce
      const double share = std::min(1.0, static_cast<double>(i) / loading);
      step(*solver, dt, {share * along, share * across, 0.0}, place);
    }
    double sum = 0.0;
    int count = 0;
    solver->visit([&](const ParticleBatch& b) {
      for (std::size_t i = 0; i < b.count; ++i)
        if (b.position[1][i] > 0.85 * thickness) {
          sum += b.velocity[0][i];
          ++count;
        }
    });
    const double velocity = std::max(0.0, sum / count), slope = ratio * yield / thickness;
    const double stops_at = thickness - std::sqrt(2.0 * viscosity * velocity / slope);
    return Measured{std::abs(stops_at / (yield / slope) - 1.0), 1e3 * stops_at};
  };
  return c;
}

/// Without stress worth speaking of a block keeps the shear it starts with: lambda tends to A / (tau0 alpha
/// rate), exponentially with alpha rate (Roussel 2006, Eq. 7; Yu et al. 2026, Eq. 12). What is refined is the
/// step.
Case thixotropic_shear(const Variant& v) {
  const double rate = 5.0, begin = 3.0, growth = 0.4, alpha = 0.2, end = 2.0;
  const double steady = growth / (alpha * rate);
  const double exact = steady + (begin - steady) * std::exp(-alpha * rate * end);
  Case c;
  c.name = "Thixotropy in simple shear";
  c.variant = words(v);
  c.against = "closed form";
  c.norm = "largest relative error of the flocculation";
  c.value_name = "flocculation after 2 s";
  c.value_unit = "";
  c.exact_value = exact;
  c.refined = "Courant number";
  c.grids = {0.8, 0.4, 0.2};
  c.largest_error = 1e-3;
  c.quick = true;
  c.cost = 3.0;
  c.compute = [=](double courant, const Workplace& place) {
    SolverSettings s = concrete(v, 0.01);
    s.law = Law::elasto_viscoplastic_thixotropic;
    s.flow.yield_stress = 1e-9;
    s.flow.plastic_viscosity = 1e-9;
    s.flow.flocculation_growth = growth;
    s.flow.deflocculation = alpha;
    s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 8, true};
    auto seeds = block(s, {0, 20, 0}, {8, 26, 0}, 3);
    for (auto& seed : seeds) {
      seed.velocity[0] = rate * (seed.cell[1] + seed.position[1] - 23.0) * s.cell;
      seed.flocculation = begin;
    }
    auto solver = with_affine(mpm::make_solver(s, seeds), s, {{{0.0, rate * s.cell}, {0.0, 0.0}}});
    const int steps = static_cast<int>(std::ceil(end / acoustic_step(s, courant)));
    for (int i = 0; i < steps; ++i) step(*solver, end / steps, {}, place);
    double sum = 0.0, worst = 0.0;
    std::size_t count = 0;
    solver->visit([&](const ParticleBatch& b) {
      for (const double lambda : b.flocculation) {
        worst = std::max(worst, std::abs(lambda / exact - 1.0));
        sum += lambda;
        ++count;
      }
    });
    return Measured{worst, sum / static_cast<double>(count)};
  };
  return c;
}

double interpolated(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto after = static_cast<std::size_t>(std::upper_bound(x.begin() + 1, x.end() - 1, at) - x.begin());
  return y[after - 1] + (y[after] - y[after - 1]) * (at - x[after - 1]) / (x[after] - x[after - 1]);
}

/// A column twice as high as wide: times t sqrt(2 g / W) and fronts x / W of Martin and Moyce 1952, table 2,
/// n^2 = 2. Their clock includes the time the membrane takes to give way: it is fitted, and what is compared
/// is how the front runs after it.
Case dam_break(const Variant& v) {
  Case c;
  c.name = "Dam break, front";
  c.variant = words(v);
  c.against = "measured by Martin and Moyce 1952, table 2, the start of their clock fitted";
  c.norm = "largest relative error of the front";
  c.value_name = "delay of the clock";
  c.value_unit = "sqrt(W / 2g)";
  c.refined = "cells across the column";
  c.grids = {1.0 / 12.0, 1.0 / 16.0, 1.0 / 24.0};
  c.largest_error = 0.05;
  c.cost = 12.0;
  c.compute = [=](double grid, const Workplace& place) {
    const std::vector<std::pair<double, double>> measured = {{1.19, 1.44}, {1.43, 1.67}, {1.63, 1.89},
                                                             {1.83, 2.11}, {1.98, 2.33}, {2.20, 2.56},
                                                             {2.32, 2.78}, {2.51, 3.00}};
    const int across = static_cast<int>(std::lround(1.0 / grid));
    const double width = 0.24;
    SolverSettings s = concrete(v, width / across);
    s.law = Law::newtonian;
    s.density = 1000.0;
    s.flow.plastic_viscosity = 1e-3;
    const double sound = 15.0 * std::sqrt(2.0 * gravity * 2.0 * width);
    s.state = {s.density * sound * sound, 1e-3 * s.density * sound * sound, 7.0};
    s.bounds[0].lower = PlaneWall::slip;
    s.bounds[1].lower = PlaneWall::slip;
    auto solver = mpm::make_solver(s, block(s, {0, 0, 0}, {across, 2 * across, 0}, 3));
    const auto farthest = [&] {
      double most = 0.0;
      solver->visit([&](const ParticleBatch& b) {
        for (std::size_t i = 0; i < b.count; ++i) most = std::max(most, b.position[0][i]);
      });
      return most / width;
    };
    const double dt = 0.5 * s.cell / sound, scale = std::sqrt(2.0 * gravity / width);
    std::vector<double> time = {0.0}, front = {farthest()};
    while (front.back() < 3.2) {
      for (int i = 0; i < 10; ++i) step(*solver, dt, {0.0, -gravity, 0.0}, place);
      time.push_back(time.back() + 10.0 * dt * scale);
      front.push_back(farthest());
      if (time.back() > 5.0) throw runs::NumericsError("the column does not run");
    }
    double delay = 0.0, worst = 0.0;
    for (const auto& [t, x] : measured)
      delay += (t - interpolated(front, time, x)) / static_cast<double>(measured.size());
    for (const auto& [t, x] : measured)
      worst = std::max(worst, std::abs(interpolated(time, front, t - delay) / x - 1.0));
    return Measured{worst, delay};
  };
  return c;
}

}  // namespace

std::vector<Case> body_cases() {
  const Variant quadratic, single{Transfer::quadratic_apic, true}, linear{Transfer::linear_flip, false},
      single_linear{Transfer::linear_flip, true};
  std::vector<Case> cases;
  for (const Variant& v : {quadratic, single, linear, single_linear}) {
    cases.push_back(free_fall(v));
    cases.push_back(column(v));
    cases.push_back(film(v));
  }
  for (const Variant& v : {quadratic, single}) {
    cases.push_back(rotation(v));
    cases.push_back(thixotropic_shear(v));
  }
  cases.push_back(dam_break(quadratic));
  return cases;
}

}  // namespace flowrest::studies::verification
