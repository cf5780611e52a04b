// Bodies made by hand, without a scene: free fall, a column at rest, a spinning block, a film, a slab that
// slides on an incline, thixotropy in shear, a dam that breaks.
#include <cmath>
#include <numbers>

#include "mpm/verification/known_motions.h"
#include "runs/run_directory.h"
#include "studies/verification/verification.h"

namespace flowrest::studies::verification {

namespace {

using mpm::ParticleBatch;
using mpm::Solver;
using mpm::SolverSettings;
using mpm::Transfer;
using mpm::known::gravity;
using mpm::test::even_block;
using mpm::test::usual_step;

struct Variant {
  Transfer transfer = Transfer::quadratic_apic;
  bool single_precision = false;
};

std::string words(const Variant& v) {
  return std::string("MPM ") + (v.transfer == Transfer::quadratic_apic ? "quadratic-apic" : "linear-flip") +
         (v.single_precision ? ", float" : ", double");
}

SolverSettings concrete(const Variant& v, double cell) {
  SolverSettings s = mpm::test::concrete({2, false, v.transfer, v.single_precision});
  s.cell = cell;
  return s;
}

/// Steps that end where the user interrupts.
mpm::known::Step steps_in(const Workplace& place) {
  return [&place](Solver& solver, double dt, const std::array<double, 3>& acceleration) {
    if (place.interrupted()) throw runs::NumericsError("interrupted");
    solver.step(dt, acceleration);
  };
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
    auto solver = mpm::make_solver(s, even_block(s, {100, 400, 0}, {100 + edge, 400 + edge, 0}, 2));
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
    const double before = centre(), dt = usual_step(s);
    const int steps = static_cast<int>(0.3 / dt);
    const auto step = steps_in(place);
    for (int i = 0; i < steps; ++i) step(*solver, dt, {0.0, -gravity, 0.0});
    const double fall = before - centre(), exact = gravity * dt * dt * steps * (steps + 1.0) / 2.0;
    return Measured{std::abs(fall / exact - 1.0), fall};
  };
  return c;
}

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
    auto solver = mpm::known::settled_column(s, even_block(s, {0, 0, 0}, {across, high, 0}, 3), across, 4.0,
                                             steps_in(place));
    const auto found = mpm::known::column_pressure(*solver, s, across);
    return Measured{found.worst / (s.density * gravity * high * s.cell), found.lowest};
  };
  return c;
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
    const double turns_a_second = 3.0, rate = 2.0 * std::numbers::pi * turns_a_second;
    auto solver = mpm::known::spinning_block(s, static_cast<int>(std::lround(0.08 / cell)), 0, 3, rate);
    const double dt = usual_step(s), begin = mpm::known::kinetic_and_elastic_energy(*solver);
    const int steps = static_cast<int>(std::ceil(10.0 / turns_a_second / dt));
    const auto step = steps_in(place);
    for (int i = 0; i < steps; ++i) step(*solver, dt, {});
    const double kept = mpm::known::kinetic_and_elastic_energy(*solver) / begin;
    return Measured{std::abs(kept - 1.0), kept};
  };
  return c;
}

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
    s.flow.yield_stress = yield;
    s.flow.plastic_viscosity = viscosity;
    const int layers = static_cast<int>(std::lround(thickness / cell));
    const auto moving = mpm::known::film_on_incline(s, layers, ratio, 6.0, 0.85, steps_in(place));
    const double stops_at = moving.stops_at(thickness, viscosity);
    return Measured{std::abs(stops_at / (yield / moving.slope) - 1.0), 1e3 * stops_at};
  };
  return c;
}

/// A slab slides down a wall of Coulomb friction, which is turned from the grid.
Case incline(const Variant& v) {
  const double degree = std::numbers::pi / 180.0;
  const mpm::known::Slide slide{26.0 * degree, 30.0 * degree, 0.3};
  Case c;
  c.name = "Slab on an incline with friction";
  c.variant = words(v);
  c.against = "g (sin - mu cos)";
  c.norm = "relative error of the acceleration";
  c.value_name = "acceleration";
  c.value_unit = "m/s2";
  c.exact_value = slide.exact();
  c.grids = {0.02, 0.01, 0.005};
  c.largest_error = v.transfer == Transfer::quadratic_apic ? 0.005 : 0.02;
  c.quick = v.transfer == Transfer::quadratic_apic && !v.single_precision;
  c.cost = 2.0;
  c.compute = [=](double cell, const Workplace& place) {
    const double a = mpm::known::sliding_acceleration(concrete(v, cell), slide, 0.3, steps_in(place));
    return Measured{std::abs(a / slide.exact() - 1.0), a};
  };
  return c;
}

/// What is refined is the step.
Case thixotropic_shear(const Variant& v) {
  const double rate = 5.0, begin = 3.0, end = 2.0;
  const laws::Structure<double> structure{.growth = 0.4, .breakdown = 0.2};
  const double exact = structure.after(begin, rate, end);
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
    s.structure = structure;
    auto solver = mpm::known::sheared_block(s, rate, begin);
    // usual_step() is that of a Courant number of 0.7.
    const int steps = static_cast<int>(std::ceil(end / (usual_step(s) * courant / 0.7)));
    const auto step = steps_in(place);
    for (int i = 0; i < steps; ++i) step(*solver, end / steps, {});
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
    const int across = static_cast<int>(std::lround(1.0 / grid));
    SolverSettings s = concrete(v, 0.24 / across);
    const auto found = mpm::known::dam_break(s, across, steps_in(place));
    return Measured{found.worst, found.delay};
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
    cases.push_back(incline(v));
  }
  for (const Variant& v : {quadratic, single}) {
    cases.push_back(rotation(v));
    cases.push_back(thixotropic_shear(v));
    cases.push_back(dam_break(v));
  }
  return cases;
}

}  // namespace flowrest::studies::verification
