// Motions that are exactly known, or measured, of bodies made by hand: no scene needed. Every bound is stated
// beside what was measured, on AVX-512 in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "mpm/solver/test_bodies.h"

using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

constexpr double gravity = 9.81;

/// The largest coordinate along an axis, m.
double farthest(Solver& solver, std::size_t axis) {
  double most = 0.0;
  solver.visit([&](const ParticleBatch& batch) {
    for (std::size_t i = 0; i < batch.count; ++i) most = std::max(most, batch.position[axis][i]);
  });
  return most;
}

double kinetic_and_elastic_energy(Solver& solver) {
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

}  // namespace

TEST(Rotation, AnElasticBlockKeepsItsEnergyAndAngularMomentumOverTenTurns) {
  // Measured: energy 0.4 % in 2D and 0.9 % in 3D, angular momentum to round-off. With the strain of the
  // step's beginning instead of its middle the block grew unseen and kept 58 % of its energy. linear-flip is
  // not made for this: its relaxation of 50 ms leaves 8 % of the angular momentum after ten turns.
  for (const int dimension : {2, 3}) {
    SolverSettings s = concrete({dimension, false, Transfer::quadratic_apic, false});
    s.flow.yield_stress = 1e9;
    const double turns_a_second = 3.0, rate = 2.0 * std::numbers::pi * turns_a_second;
    const CellIndex last = dimension == 3 ? CellIndex{108, 108, 102} : CellIndex{108, 108, 0};
    auto seeds = block(s, {100, 100, 100}, last, dimension == 3 ? 2 : 3);
    for (auto& seed : seeds) {
      const double x = (seed.cell[0] + seed.position[0] - 104.0) * s.cell;
      const double y = (seed.cell[1] + seed.position[1] - 104.0) * s.cell;
      seed.velocity = {-rate * y, rate * x, 0.0};
    }
    auto solver = make_solver(s, seeds);
    Open start(*solver, s);
    for (std::size_t p = 0; p < start.size(); ++p) {
      start.affine(0, 1)[p] = -rate * s.cell;
      start.affine(1, 0)[p] = rate * s.cell;
    }
    solver = make_solver(s, start.state);
    const double energy = kinetic_and_elastic_energy(*solver);
    const double angular = momenta(start).angular[2], scale = momenta(start).angular_scale;
    const double step = usual_step(s);
    const int steps = static_cast<int>(std::ceil(10.0 / turns_a_second / step));
    for (int i = 0; i < steps; ++i) solver->step(step, {0.0, 0.0, 0.0});
    Open end(*solver, s);
    const double energy_kept = kinetic_and_elastic_energy(*solver) / energy;
    const double angular_kept = momenta(end).angular[2] / angular;
    std::printf("    %dD: energy %.5f, angular momentum 1 - %.2g of what it was\n", dimension, energy_kept,
                1.0 - angular_kept);
    EXPECT_NEAR(energy_kept, 1.0, 0.01);
    EXPECT_NEAR(angular_kept, 1.0, 1e-8 * scale / angular);
  }
}

TEST(SimpleShear, FlocculationBreaksDownAsTheClosedFormSays) {
  // Without stress worth speaking of, a block keeps the shear it starts with: lambda tends to
  // A / (tau0 alpha rate), exponentially with alpha rate (Yu et al. 2026, Eq. 12). Roussel 2006, Eq. 7.
  SolverSettings s = concrete({2, false, Transfer::quadratic_apic, false});
  s.law = Law::elasto_viscoplastic_thixotropic;
  s.flow.yield_stress = 1e-9;
  s.flow.plastic_viscosity = 1e-9;
  s.flow.flocculation_growth = 0.4;
  s.flow.deflocculation = 0.2;
  s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 8, true};
  const double rate = 5.0, begin = 3.0;
  auto seeds = block(s, {0, 20, 0}, {8, 26, 0}, 3);
  for (auto& seed : seeds) {
    seed.velocity[0] = rate * (seed.cell[1] + seed.position[1] - 23.0) * s.cell;
    seed.flocculation = begin;
  }
  auto solver = make_solver(s, seeds);
  Open start(*solver, s);
  for (double& a : start.affine(0, 1)) a = rate * s.cell;
  solver = make_solver(s, start.state);
  const double step = 1e-3, steady = s.flow.flocculation_growth / (s.flow.deflocculation * rate);
  double worst = 0.0;
  for (int i = 1; i <= 1500; ++i) {
    solver->step(step, {0.0, 0.0, 0.0});
    if (i % 100 != 0) continue;
    const double exact = steady + (begin - steady) * std::exp(-s.flow.deflocculation * rate * i * step);
    solver->visit([&](const ParticleBatch& b) {
      for (const double lambda : b.flocculation) worst = std::max(worst, std::abs(lambda / exact - 1.0));
    });
  }
  std::printf("    largest error of lambda %.2g, from %.3g to %.3g\n", worst, begin, steady);
  EXPECT_LT(worst, 1e-3);
}

namespace {

/// Surface velocity of a film of `layers` cells on an incline after `time` s, m/s. x down the slope.
double film_velocity(double slope_stress_over_yield, double time, int layers, double& fastest_plastic_rate) {
  SolverSettings s = concrete({2, false, Transfer::quadratic_apic, false});
  s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 4, true};
  s.bounds[1].lower = PlaneWall::no_slip;
  s.flow.plastic_viscosity = 20.0;
  auto solver = make_solver(s, block(s, {0, 0, 0}, {4, layers, 0}, 4));
  const double thickness = layers * s.cell;
  const double along = slope_stress_over_yield * s.flow.yield_stress / (s.density * thickness);
  const double across = -std::sqrt(gravity * gravity - along * along);
  // The weight comes on first, slowly, so that the film does not bounce.
  const double step = usual_step(s);
  const int steps = static_cast<int>(time / step), loading = steps / 4;
  for (int i = 0; i < steps; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / loading);
    solver->step(step, {share * along, share * across, 0.0});
  }
  double sum = 0.0;
  int count = 0;
  fastest_plastic_rate = 0.0;
  solver->visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      fastest_plastic_rate = std::max(fastest_plastic_rate, b.rate[i]);
      if (b.position[1][i] < thickness - 1.5 * s.cell) continue;
      sum += b.velocity[0][i];
      ++count;
    }
  });
  return sum / count;
}

}  // namespace

TEST(Film, StopsWhereItsSlopeStressIsTheYieldStress) {
  // A film of thickness H moves where rho g sin(theta) H > tau0, its plug at
  // F (H - tau0 / F)^2 / (2 eta), F = rho g sin(theta). Solved for tau0, the velocity says at which thickness
  // the film would stop.
  double rate = 0.0;
  const int layers = 8;
  const double still = film_velocity(0.98, 4.0, layers, rate);
  EXPECT_EQ(rate, 0.0) << "plastic shear rate below yield, 1/s";
  EXPECT_LT(std::abs(still), 2e-4) << "m/s";
  for (const double ratio : {1.05, 1.5}) {
    const double velocity = film_velocity(ratio, 6.0, layers, rate);
    const double thickness = layers * 0.01, yield = 50.0, viscosity = 20.0;
    const double slope = ratio * yield / thickness;
    const double stops_at = thickness - std::sqrt(2.0 * viscosity * velocity / slope);
    std::printf("    slope stress %.2f of yield: plug at %.4g m/s, would stop at %.5f m, exactly at %.5f m\n",
                ratio, velocity, stops_at, yield / slope);
    EXPECT_NEAR(stops_at, yield / slope, 0.02 * yield / slope) << ratio;
  }
}

namespace {

struct LongSheared {
  double depth = 0.0;      ///< twice the height of the centre of mass, of its first value
  double mean_flow = 0.0;  ///< flow rate of the second half of the time, of the exact one
};

/// A Bingham film of 4 cells and jittered particles on an incline of twice its yield stress, for 40 s: a
/// strain of about 80 at its base.
LongSheared long_sheared_film(double density_correction) {
  SolverSettings s = concrete({2, false, Transfer::quadratic_apic, false});
  s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 4, true};
  s.bounds[1].lower = PlaneWall::no_slip;
  s.density_correction = density_correction;
  Random random(7);
  auto solver = make_solver(s, block(s, {0, 0, 0}, {4, 4, 0}, 3, &random));
  const double thickness = 4 * s.cell, slope = 2.0 * s.flow.yield_stress / thickness;
  const double along = slope / s.density, across = -std::sqrt(gravity * gravity - along * along);
  const double sheared = thickness - s.flow.yield_stress / slope;
  const double exact =
      slope * sheared * sheared / (2.0 * s.flow.plastic_viscosity) * (thickness - sheared / 3.0) / thickness;
  const double step = usual_step(s);
  const int steps = static_cast<int>(40.0 / step), loading = static_cast<int>(2.0 / step);
  const auto centre_and_speed = [&] {
    double height = 0.0, speed = 0.0, mass = 0.0;
    solver->visit([&](const ParticleBatch& b) {
      for (std::size_t i = 0; i < b.count; ++i) {
        height += b.mass[i] * b.position[1][i];
        speed += b.mass[i] * b.velocity[0][i];
        mass += b.mass[i];
      }
    });
    return std::pair{height / mass, speed / mass};
  };
  const double first = centre_and_speed().first;
  LongSheared result;
  int samples = 0;
  for (int i = 0; i < steps; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / loading);
    solver->step(step, {share * along, share * across, 0.0});
    if (i < steps / 2 || i % 500 != 0) continue;
    result.mean_flow += centre_and_speed().second / exact;
    ++samples;
  }
  result.mean_flow /= samples;
  result.depth = centre_and_speed().first / first;
  return result;
}

}  // namespace

TEST(Film, KeepsItsDepthAndFlowHoweverLongItIsSheared) {
  // Particles drift together where material is sheared for long, unseen by the volume they carry: without
  // the density correction the film sinks by a sixth, and of its flow four tenths are left.
  const LongSheared without = long_sheared_film(0.0), with = long_sheared_film(1.0);
  std::printf("    depth %.3f and flow %.3f of the exact; without correction %.3f and %.3f\n", with.depth,
              with.mean_flow, without.depth, without.mean_flow);
  EXPECT_NEAR(with.depth, 1.0, 0.02);
  EXPECT_NEAR(with.mean_flow, 1.0, 0.15);
  EXPECT_LT(without.depth, 0.9) << "the correction is tested on a film that does not need it";
}

TEST(DamBreak, TheFrontRunsAsMartinAndMoyceMeasuredIt) {
  // A column twice as high as wide: times t sqrt(2 g / W) and fronts x / W of Martin and Moyce (1952), table
  // 2, n^2 = 2, W = 2.25 in. Their clock includes the time the membrane takes to give way, which no inviscid
  // computation has: it is fitted, and what is compared is how the front runs after it.
  // Measured: delay 0.27, fronts within 2.1 %, the same at twice the resolution.
  const std::vector<std::pair<double, double>> measured = {{1.19, 1.44}, {1.43, 1.67}, {1.63, 1.89},
                                                           {1.83, 2.11}, {1.98, 2.33}, {2.20, 2.56},
                                                           {2.32, 2.78}, {2.51, 3.00}};
  SolverSettings s = concrete({2, false, Transfer::quadratic_apic, false});
  s.law = Law::newtonian;
  s.density = 1000.0;
  s.flow.plastic_viscosity = 1e-3;
  const int across = 24;
  const double width = across * s.cell;
  const double sound = 15.0 * std::sqrt(2.0 * gravity * 2.0 * width);
  s.state = {s.density * sound * sound, 1e-3 * s.density * sound * sound, 7.0};
  s.bounds[0].lower = PlaneWall::slip;
  s.bounds[1].lower = PlaneWall::slip;
  auto solver = make_solver(s, block(s, {0, 0, 0}, {across, 2 * across, 0}, 3));
  const double step = 0.5 * s.cell / sound, scale = std::sqrt(2.0 * gravity / width);
  std::vector<double> time = {0.0}, front = {farthest(*solver, 0) / width};
  while (front.back() < 3.2) {
    for (int i = 0; i < 10; ++i) solver->step(step, {0.0, -gravity, 0.0});
    time.push_back(time.back() + 10.0 * step * scale);
    front.push_back(farthest(*solver, 0) / width);
    ASSERT_LT(time.back(), 5.0) << "the column does not run";
  }
  const auto interpolated = [](const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto after = static_cast<std::size_t>(std::upper_bound(x.begin() + 1, x.end() - 1, at) - x.begin());
    return y[after - 1] + (y[after] - y[after - 1]) * (at - x[after - 1]) / (x[after] - x[after - 1]);
  };
  double delay = 0.0;
  for (const auto& [t, x] : measured)
    delay += (t - interpolated(front, time, x)) / static_cast<double>(measured.size());
  double worst = 0.0;
  for (const auto& [t, x] : measured)
    worst = std::max(worst, std::abs(interpolated(time, front, t - delay) / x - 1.0));
  std::printf("    the measured front is %.3f W / sqrt(2 g W) late; after that they differ by up to %.2g\n",
              delay, worst);
  EXPECT_GT(delay, 0.0);
  EXPECT_LT(delay, 0.4);
  EXPECT_LT(worst, 0.05);
}
