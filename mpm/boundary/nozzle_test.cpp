// Particles that come and go, and a nozzle that moves what is in it.
#include "mpm/boundary/nozzle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mpm/sampling/feed.h"
#include "mpm/solver/test_bodies.h"

using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

constexpr std::array<double, 3> weightless = {0.0, 0.0, 0.0};
constexpr std::array<double, 3> falling = {0.0, 0.0, -9.81};

const auto nobody = [](const Vector&) { return false; };
const auto unseen = [](const ParticleBatch&) {};

void expect_same(Solver& a, Solver& b) {
  const SolverState one = a.state(), other = b.state();
  ASSERT_EQ(one.cells, other.cells);
  for (std::size_t k = 0; k < one.arrays.size(); ++k)
    ASSERT_EQ(one.arrays[k], other.arrays[k]) << "array " << k;
}

double mass_of(Solver& solver) {
  double mass = 0.0;
  solver.visit_motion([&](const ParticleBatch& batch) {
    for (const double m : batch.mass) mass += m;
  });
  return mass;
}

/// A strand's start: half of a tube of 25 mm over a floor that holds, 12.5 mm high, on cells of 25 / 7 mm.
struct Print {
  SolverSettings settings;
  double printing = 0.03, extrusion = 0.0336;

  explicit Print(bool single = false) : settings(concrete({3, false, Transfer::quadratic_apic, single})) {
    settings.cell = 0.0125 / 3.5;
    settings.density = 2100.0;
    settings.flow.yield_stress = 630.0;
    settings.flow.plastic_viscosity = 7.5;
    settings.density_correction = 1.0;
    settings.bounds[1].lower = PlaneWall::slip;
    settings.bounds[2].lower = PlaneWall::no_slip;
    Nozzle nozzle;
    nozzle.bore = 0.0125;
    nozzle.wall = 0.003;
    nozzle.mouth = [v = printing](double time) -> Vector { return {0.02 + v * time, 0.0, 0.0125}; };
    nozzle.extruded = [u = extrusion](double time) { return u * time; };
    settings.nozzles = {nozzle};
  }
  Feed feed() const { return {settings.nozzles.front(), settings.cell, 2, true, 0.0}; }
};

}  // namespace

TEST(Exchange, OfNothingChangesNothing) {
  for (const auto& v : every_variant()) {
    SolverSettings s = concrete(v);
    s.bounds[static_cast<std::size_t>(v.dimension - 1)] = {
        PlaneWall::friction, PlaneWall::none, 17, 0, false, 0.3, 0.0};
    Random one(3), other(3);
    auto a = make_solver(s, restless_block(s, one)), b = make_solver(s, restless_block(s, other));
    const double step = usual_step(s);
    for (int i = 0; i < 20; ++i) {
      a->step(step, falling);
      b->step(step, falling);
      if (i % 7 == 3) b->exchange(nobody, unseen, {});
    }
    SCOPED_TRACE(name_of(v));
    expect_same(*a, *b);
  }
}

TEST(Exchange, TakesOutWhatLeavesAndPutsInWhatComes) {
  const SolverSettings s = concrete({3, false, Transfer::quadratic_apic, false});
  Random random(4);
  auto solver = make_solver(s, restless_block(s, random));
  solver->step(usual_step(s), weightless);
  const double before = mass_of(*solver);
  double out = 0.0;
  const auto beyond = [&](const Vector& x) { return x[0] > 24.0 * s.cell; };
  const auto come = block(s, {40, 17, 18}, {42, 19, 20}, 2);
  double in = 0.0;
  for (const Seed& seed : come) in += seed.volume * s.density;
  solver->exchange(
      beyond,
      [&](const ParticleBatch& batch) {
        for (std::size_t i = 0; i < batch.count; ++i) {
          EXPECT_TRUE(beyond({batch.position[0][i], batch.position[1][i], batch.position[2][i]}));
          EXPECT_GT(batch.elastic_energy[i], 0.0);
          out += batch.mass[i];
        }
      },
      come);
  EXPECT_GT(out, 0.3 * before);
  EXPECT_LT(out, 0.7 * before);
  EXPECT_NEAR(mass_of(*solver), before - out + in, 1e-12 * before);
  for (int i = 0; i < 5; ++i) solver->step(usual_step(s), weightless);
}

/// Far enough above the mouth no node is free: the column comes down as one, at its speed.
TEST(Nozzle, MovesTheColumnAsOneBody) {
  const Print print;
  Feed feed = print.feed();
  auto solver = make_solver(print.settings, feed.due(0.0, 1e-3));
  const double step = 0.5 * usual_step(print.settings), mouth = 0.0125;
  double time = 0.0, seen = 0.0;
  for (int i = 0; i < 400; ++i) {
    solver->set_time(time);
    solver->step(step, falling);
    time += step;
    const auto come = feed.due(time, step);
    if (!come.empty()) solver->exchange(nobody, unseen, come);
  }
  solver->visit([&](const ParticleBatch& batch) {
    for (std::size_t i = 0; i < batch.count; ++i) {
      if (batch.position[2][i] < mouth + 1.6 * print.settings.cell) continue;
      const double from_axis =
          std::hypot(batch.position[0][i] - 0.02 - print.printing * time, batch.position[1][i]);
      // Quadratic functions reach one and a half cells along each axis: beside the tube's wall the column lags.
      const bool reaches_wall = from_axis > 0.0125 - 2.2 * print.settings.cell;
      EXPECT_NEAR(batch.velocity[0][i], print.printing, (reaches_wall ? 0.05 : 1e-9) * print.printing);
      EXPECT_NEAR(batch.velocity[2][i], -print.extrusion, (reaches_wall ? 0.5 : 1e-9) * print.extrusion);
      seen += batch.mass[i];
    }
  });
  EXPECT_GT(seen, 0.0);
  EXPECT_NEAR(mass_of(*solver), 2100.0 * feed.volume(), 1e-12 * mass_of(*solver));
}

/// What holds the column carries its weight, and drags the strand along.
TEST(Nozzle, CarriesWhatHangsInIt) {
  Print print;
  print.settings.nozzles.front().extruded = [](double) { return 0.0; };
  print.settings.nozzles.front().mouth = [](double) -> Vector { return {0.02, 0.0, 0.1}; };
  Feed feed = print.feed();
  auto solver = make_solver(print.settings, feed.due(0.0, 1e-3));
  const double weight = 9.81 * mass_of(*solver), step = usual_step(print.settings);
  double mean = 0.0;
  for (int i = 0; i < 400; ++i) {
    solver->set_time(i * step);
    solver->step(step, falling);
    if (i >= 200) mean += solver->nozzle_force()[2] / 200.0;
  }
  EXPECT_NEAR(mean, weight, 0.03 * weight);
  print.settings.nozzles.front().gone_at = 0.0;
  auto free = make_solver(print.settings, print.feed().due(0.0, 1e-3));
  free->set_time(0.0);
  free->step(step, falling);
  EXPECT_EQ(free->nozzle_force()[2], 0.0);
}
