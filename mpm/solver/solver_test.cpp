#include "mpm/solver/solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "mpm/solver/kernels.h"
#include "mpm/solver/test_bodies.h"
#include "mpm/transfer/shape.h"
#include "runs/cores.h"
#include "runs/run_directory.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

constexpr std::array<double, 3> weightless = {0.0, 0.0, 0.0};

/// Round-off of a variant's arithmetic.
double unit_of(const Variant& v) {
  return v.single_precision ? static_cast<double>(std::numeric_limits<float>::epsilon())
                            : std::numeric_limits<double>::epsilon();
}

/// The largest difference of positions between two solvers' particles, m, and of velocities, m/s.
std::pair<double, double> difference(Solver& one, Solver& other, const SolverSettings& s) {
  Open a(one, s), b(other, s);
  EXPECT_EQ(a.size(), b.size());
  const auto order_a = a.by_mass(), order_b = b.by_mass();
  double apart = 0.0, velocity = 0.0;
  for (std::size_t i = 0; i < order_a.size(); ++i) {
    EXPECT_EQ(a.mass()[order_a[i]], b.mass()[order_b[i]]);
    for (int x = 0; x < s.dimension; ++x) {
      apart = std::max(apart, std::abs(a.position(x, order_a[i]) - b.position(x, order_b[i])));
      velocity = std::max(velocity, std::abs(a.velocity(x)[order_a[i]] - b.velocity(x)[order_b[i]]));
    }
  }
  return {apart, velocity};
}

void expect_same_bits(const SolverState& a, const SolverState& b, const std::string& what) {
  ASSERT_EQ(a.cells, b.cells) << what;
  ASSERT_EQ(a.arrays.size(), b.arrays.size()) << what;
  for (std::size_t k = 0; k < a.arrays.size(); ++k)
    ASSERT_EQ(a.arrays[k], b.arrays[k]) << what << ", array " << k;
}

}  // namespace

TEST(Solver, FreeFallIsExact) {
  for (const auto& v : every_variant()) {
    const SolverSettings s = concrete(v);
    Random random(1);
    auto seeds = block(s, {21, 97, 18}, {26, 102, 22}, 2, &random);
    const auto up = static_cast<std::size_t>(s.dimension - 1);
    for (auto& seed : seeds) seed.velocity[up] = 1.0;
    auto solver = make_solver(s, seeds);
    Open start(*solver, s);
    const double dt = 5e-4;
    const int steps = 200;
    std::array<double, 3> gravity{};
    gravity[up] = -9.81;
    for (int i = 0; i < steps; ++i) solver->step(dt, gravity);
    Open end(*solver, s);
    const auto before = start.by_mass(), after = end.by_mass();
    const double velocity = 1.0 - 9.81 * dt * steps,
                 drop = dt * steps - 9.81 * dt * dt * steps * (steps + 1) / 2.0;
    const double allowed = 100.0 * unit_of(v);
    for (std::size_t i = 0; i < before.size(); ++i)
      for (int a = 0; a < s.dimension; ++a) {
        const bool falls = a == s.dimension - 1;
        ASSERT_NEAR(end.velocity(a)[after[i]], falls ? velocity : 0.0, allowed * 2.0) << name_of(v);
        ASSERT_NEAR(end.position(a, after[i]), start.position(a, before[i]) + (falls ? drop : 0.0),
                    allowed * s.cell * 20.0)
            << name_of(v);
        ASSERT_NEAR(end.volume_ratio()[after[i]], 1.0, allowed) << name_of(v);
      }
  }
}

TEST(Solver, ATransferLeavesAQuadraticProfileAlongANoSlipWallAsItIs) {
  // v = a y + b y^2 along a wall at y = 0. Untreated, the mirrored body moves the first row of nodes by
  // 2/21 b h^2 in every step. APIC's affine part of it is a + 2 b y and the third moment of the weights.
  for (auto v : every_variant()) {
    if (v.transfer != Transfer::quadratic_apic || v.axisymmetric) continue;
    SolverSettings s = concrete(v);
    const int up = s.dimension - 1, layers = 12;
    const auto up_axis = static_cast<std::size_t>(up);
    s.bounds[up_axis].lower = PlaneWall::no_slip;
    s.state = {1e-3, 1e-3, 7.0};  // no stress worth speaking of
    s.flow.yield_stress = 1e-6;
    s.flow.plastic_viscosity = 1e-6;
    const double slope = 3.0, curvature = -40.0, h = s.cell;
    const CellIndex end = s.dimension == 3 ? CellIndex{8, 8, layers} : CellIndex{8, layers, 0};
    auto seeds = block(s, {0, 0, 0}, end, 4);
    const auto height = [&](const Seed& seed) { return (seed.cell[up_axis] + seed.position[up_axis]) * h; };
    for (auto& seed : seeds) seed.velocity[0] = height(seed) * (slope + curvature * height(seed));
    auto solver = make_solver(s, seeds);
    Open start(*solver, s);
    for (std::size_t p = 0; p < start.size(); ++p) {
      const double x = start.within(up)[p];
      double third_moment = 0.0;
      for (int n = 0; n < Quadratic::nodes; ++n)
        third_moment += Quadratic::weight(n, x) * std::pow(Quadratic::offset(n, x), 3);
      start.affine(0, up)[p] =
          h * (slope + 2.0 * curvature * start.position(up, p) + 4.0 * curvature * h * third_moment);
    }
    solver = make_solver(s, start.state);
    solver->step(1e-9, weightless);
    Open after(*solver, s);
    double worst = 0.0;
    const auto before_order = start.by_mass(), after_order = after.by_mass();
    for (std::size_t i = 0; i < before_order.size(); ++i) {
      const std::size_t p = before_order[i], q = after_order[i];
      // Away from the sides and the top, where the body ends.
      if (start.position(up, p) > 8.0 * h || std::abs(start.position(0, p) - 4.0 * h) > h) continue;
      if (s.dimension == 3 && std::abs(start.position(1, p) - 4.0 * h) > h) continue;
      worst = std::max(worst, std::abs(after.velocity(0)[q] - start.velocity(0)[p]));
    }
    std::printf("    %s: moved by %.2g b h^2\n", name_of(v).c_str(), worst / std::abs(curvature * h * h));
    EXPECT_LT(worst, 0.01 * std::abs(curvature) * h * h) << name_of(v);
  }
}

TEST(Solver, MomentumIsConservedFarFromWallsWhateverTheStress) {
  for (const auto& v : every_variant()) {
    if (v.axisymmetric) continue;
    const SolverSettings s = concrete(v);
    Random random(2);
    auto solver = stressed(make_solver(s, restless_block(s, random)), s, random, 500.0);
    Open start(*solver, s);
    const Momenta before = momenta(start);
    const double dt = usual_step(s);
    for (int i = 0; i < 50; ++i) solver->step(dt, weightless);
    Open end(*solver, s);
    const Momenta after = momenta(end);
    // Per step each particle's share is rounded; what is left is far below what any lost force would be.
    const double allowed = 50.0 * unit_of(v);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(after.linear[a], before.linear[a], allowed * before.linear_scale)
          << name_of(v) << ", axis " << a;
      if (v.transfer != Transfer::quadratic_apic) continue;  // FLIP does not promise it
      EXPECT_NEAR(after.angular[a], before.angular[a], allowed * before.angular_scale)
          << name_of(v) << ", axis " << a;
    }
  }
}

TEST(Solver, VerticalMomentumOfARingIsConserved) {
  for (const auto& v : every_variant()) {
    if (!v.axisymmetric) continue;
    const SolverSettings s = concrete(v);
    Random random(3);
    auto solver = stressed(make_solver(s, restless_block(s, random)), s, random, 500.0);
    Open start(*solver, s);
    const Momenta before = momenta(start);
    for (int i = 0; i < 50; ++i) solver->step(usual_step(s), weightless);
    Open end(*solver, s);
    EXPECT_NEAR(momenta(end).linear[1], before.linear[1], 50.0 * unit_of(v) * before.linear_scale)
        << name_of(v);
  }
}

TEST(Solver, MassIsConstantToTheLastBit) {
  for (const auto& v : every_variant()) {
    const SolverSettings s = concrete(v);
    Random random(4);
    auto solver = make_solver(s, restless_block(s, random));
    Open start(*solver, s);
    std::vector<double> before = start.mass();
    for (int i = 0; i < 50; ++i) solver->step(usual_step(s), weightless);
    Open end(*solver, s);
    std::vector<double> after = end.mass();
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    EXPECT_EQ(before, after) << name_of(v);
  }
}

TEST(Solver, ApicCarriesALinearVelocityFieldExactly) {
  for (const auto& v : every_variant()) {
    if (v.transfer != Transfer::quadratic_apic || v.axisymmetric) continue;
    const SolverSettings s = concrete(v);
    Random random(5);
    auto seeded = make_solver(s, restless_block(s, random, 0.0));
    Open open(*seeded, s);
    double gradient[3][3], offset[3];
    for (int i = 0; i < 3; ++i) {
      offset[i] = random.between(-0.1, 0.1);
      for (double& g : gradient[i]) g = random.between(-1.0, 1.0);
    }
    const auto field = [&](int i, std::size_t p) {
      double value = offset[i];
      for (int j = 0; j < s.dimension; ++j) value += gradient[i][j] * open.position(j, p);
      return value;
    };
    for (std::size_t p = 0; p < open.size(); ++p)
      for (int i = 0; i < s.dimension; ++i) {
        open.velocity(i)[p] = field(i, p);
        for (int j = 0; j < s.dimension; ++j) open.affine(i, j)[p] = gradient[i][j] * s.cell;
      }
    auto solver = make_solver(s, open.state);
    const double dt = 1e-4;
    solver->step(dt, weightless);
    Open after(*solver, s);
    const auto old_order = open.by_mass(), new_order = after.by_mass();
    double divergence = 0.0;
    for (int i = 0; i < s.dimension; ++i) {
      divergence += gradient[i][i];
      for (int j = 0; j < s.dimension; ++j) divergence -= 0.5 * dt * gradient[i][j] * gradient[j][i];
    }
    // The strain is that of the middle of the step: det(I + dt grad v) to second order in the step.
    const double stretched = 1.0 + dt * divergence + 0.5 * dt * dt * divergence * divergence;
    const double allowed = 100.0 * unit_of(v);
    for (std::size_t k = 0; k < old_order.size(); ++k) {
      const std::size_t p = old_order[k], q = new_order[k];
      for (int i = 0; i < s.dimension; ++i) {
        ASSERT_NEAR(after.velocity(i)[q], field(i, p), allowed) << name_of(v);
        ASSERT_NEAR(after.position(i, q), open.position(i, p) + dt * field(i, p), allowed * s.cell)
            << name_of(v);
        for (int j = 0; j < s.dimension; ++j)
          ASSERT_NEAR(after.affine(i, j)[q], gradient[i][j] * s.cell, allowed) << name_of(v);
      }
      ASSERT_NEAR(after.volume_ratio()[q], stretched, 10.0 * allowed * dt / s.cell + unit_of(v))
          << name_of(v);
    }
  }
}

TEST(Solver, ParticlesOnFacesAndCornersOfCellsAreLikeAnyOther) {
  for (const auto& v : every_variant()) {
    const SolverSettings s = concrete(v);
    std::vector<Seed> seeds;
    const double places[] = {0.0, 1.0, 0.5, 0x1p-60};
    int count = 0;
    for (int i = 10; i < 14; ++i)
      for (int j = 10; j < 14; ++j)
        for (const double x : places)
          for (const double y : places)
            seeds.push_back({{i, j, s.dimension == 3 ? 10 : 0},
                             {x, y, s.dimension == 3 ? x : 0.0},
                             1e-7 * (1.0 + 1e-3 * ++count),
                             {0.2, -0.1, s.dimension == 3 ? 0.3 : 0.0},
                             0.0});
    if (v.axisymmetric)
      for (auto& seed : seeds) seed.velocity[0] = 0.0;  // a ring that widens is strained
    auto solver = make_solver(s, seeds);
    for (int i = 0; i < 300; ++i) solver->step(5e-4, weightless);
    Open open(*solver, s);
    ASSERT_EQ(open.size(), seeds.size());
    for (std::size_t p = 0; p < open.size(); ++p)
      for (int a = 0; a < s.dimension; ++a) {
        ASSERT_NEAR(open.velocity(a)[p], seeds[0].velocity[static_cast<std::size_t>(a)], 500.0 * unit_of(v))
            << name_of(v);
        ASSERT_GE(open.within(a)[p], 0.0) << name_of(v);
        ASSERT_LT(open.within(a)[p], 1.0) << name_of(v);
      }
  }
}

TEST(Solver, EveryInstructionSetGivesTheSameAnswerToRoundOff) {
  const auto sets = instruction_sets();
  ASSERT_EQ(sets.back(), "generic");
  std::printf("    this machine runs:");
  for (const auto& set : sets) std::printf(" %s", set.c_str());
  std::printf("\n");
  for (const auto& v : every_variant())
    for (const Law law : {Law::elasto_viscoplastic, Law::papanastasiou}) {
      SolverSettings s = concrete(v);
      s.law = law;
      const auto run = [&](const std::string& set) {
        Random random(6);
        s.instruction_set = set;
        auto solver = make_solver(s, restless_block(s, random));
        EXPECT_EQ(solver->instruction_set(), set);
        // Few enough steps that the blows between the parts of a restless body do not amplify round-off.
        for (int i = 0; i < 25; ++i) solver->step(usual_step(s), {0.0, -9.81, 0.0});
        return solver;
      };
      const auto reference = run("generic");
      for (const auto& set : sets) {
        if (set == "generic") continue;
        const auto other = run(set);
        const auto [apart, velocity] = difference(*reference, *other, s);
        EXPECT_LT(apart, 1e3 * unit_of(v) * s.cell) << name_of(v) << ", " << set;
        EXPECT_LT(velocity, 1e4 * unit_of(v)) << name_of(v) << ", " << set;
      }
    }
}

TEST(Solver, AnInstructionSetTheMachineLacksIsRefused) {
  SolverSettings s = concrete({});
  s.instruction_set = "abacus";
  EXPECT_THROW(make_solver(s, block(s, {0, 0, 0}, {2, 2, 0}, 2)), std::invalid_argument);
}

TEST(Solver, TheNumberOfThreadsChangesNoBit) {
  for (const auto& v : every_variant()) {
    std::vector<SolverState> states;
    std::vector<StepResult> results;
    const auto run_with = [&](int threads) {
      SolverSettings s = concrete(v);
      s.threads = threads;
      s.bounds[static_cast<std::size_t>(s.dimension - 1)].lower = PlaneWall::no_slip;
      Random random(7);
      auto solver = make_solver(s, restless_block(s, random, 4.0));
      EXPECT_EQ(solver->threads(), threads);
      StepResult sum;
      for (int i = 0; i < 20; ++i) {
        const StepResult r = solver->step(0.5 * usual_step(s), {0.0, -9.81, 0.0});
        sum.dissipated += r.dissipated;
        sum.momentum += r.momentum;
        sum.largest_speed = r.largest_speed;
      }
      states.push_back(solver->state());
      results.push_back(sum);
    };
    for (const int threads : {1, 2, 3, 11}) run_with(threads);
    for (std::size_t i = 1; i < states.size(); ++i) {
      expect_same_bits(states[0], states[i], name_of(v));
      EXPECT_EQ(results[0].dissipated, results[i].dissipated) << name_of(v);
      EXPECT_EQ(results[0].momentum, results[i].momentum) << name_of(v);
      EXPECT_EQ(results[0].largest_speed, results[i].largest_speed) << name_of(v);
    }
  }
}

TEST(Solver, UnlessToldItTakesAsManyThreadsAsAreOursAndItsParticlesCanFeed) {
  SolverSettings s = concrete({.dimension = 3});
  const auto threads_of = [&](int edge, int asked) {
    s.threads = asked;
    return make_solver(s, block(s, {0, 0, 0}, {edge, edge, edge}, 2))->threads();
  };
  setenv("OMP_NUM_THREADS", "1", 1);
  EXPECT_EQ(threads_of(16, 0), 1);
  EXPECT_EQ(threads_of(16, 3), 3) << "what the scene asks for counts";
  unsetenv("OMP_NUM_THREADS");
  EXPECT_EQ(threads_of(4, 0), 1) << "512 particles";
  EXPECT_EQ(threads_of(16, 0), std::min(runs::cores(), 32768 / 1500));
}

TEST(Solver, GoesOnFromItsStateBitForBit) {
  for (const auto& v : every_variant())
    for (const int taken : {1, 13, 37}) {
      const SolverSettings s = concrete(v);
      Random random(8);
      auto whole = make_solver(s, restless_block(s, random, 2.0));
      const double dt = 0.5 * usual_step(s);
      for (int i = 0; i < taken; ++i) whole->step(dt, weightless);
      auto resumed = make_solver(s, whole->state());
      for (int i = 0; i < 60; ++i) {
        const double a = whole->step(dt, weightless).dissipated, b = resumed->step(dt, weightless).dissipated;
        ASSERT_EQ(a, b) << name_of(v) << ", step " << i << " after " << taken;
      }
      expect_same_bits(whole->state(), resumed->state(), name_of(v));
    }
}

TEST(Solver, NoParticlePassesAWallHoweverHardItIsThrown) {
  for (const auto& v : every_variant())
    for (const PlaneWall wall : {PlaneWall::slip, PlaneWall::no_slip}) {
      SolverSettings s = concrete(v);
      const auto up = static_cast<std::size_t>(s.dimension - 1);
      // A room of 12 cells around a block thrown into its lower corner, and back up by what it stored.
      for (std::size_t a = 0; a <= up; ++a) s.bounds[a] = {wall, wall, 0, 12, false};
      if (v.axisymmetric) s.bounds[0].lower = PlaneWall::slip;
      Random random(9);
      auto seeds = block(s, {2, 2, 2}, {7, 7, 7}, 2, &random);
      for (auto& seed : seeds)
        for (std::size_t a = 0; a <= up; ++a) seed.velocity[a] = a == 0 ? -3.0 : -5.0;
      auto solver = make_solver(s, seeds);
      double speed = 6.0, lowest = 1.0;
      for (int i = 0; i < 400; ++i) {
        const double sound = s.cell / usual_step(s) * 0.7;
        speed = solver->step(0.3 * s.cell / (2.0 * sound + speed), {0.0, 0.0, 0.0}).largest_speed;
        solver->visit([&](const ParticleBatch& b) {
          for (std::size_t a = 0; a <= up; ++a)
            for (const double x : b.position[a]) {
              lowest = std::min(lowest, x);
              ASSERT_GE(x, 0.0) << name_of(v) << ", axis " << a << ", step " << i;
              ASSERT_LE(x, 12.0 * s.cell) << name_of(v) << ", axis " << a << ", step " << i;
            }
        });
        if (HasFatalFailure()) return;
      }
      EXPECT_LT(lowest, 0.5 * s.cell) << name_of(v) << ": it never came to the wall";
    }
}

TEST(Solver, AHalfColumnBesideAMirrorIsHalfOfTheWholeColumn) {
  for (const auto transfer : {Transfer::quadratic_apic, Transfer::linear_flip}) {
    SolverSettings s = concrete({2, false, transfer, false});
    s.bounds[1].lower = PlaneWall::no_slip;
    Random random(10);
    const auto half = block(s, {0, 0, 0}, {5, 12, 0}, 3, &random);
    auto whole = half;
    for (const auto& seed : half) {
      Seed mirrored = seed;
      mirrored.cell[0] = -1 - seed.cell[0];
      mirrored.position[0] = 1.0 - seed.position[0];
      whole.push_back(mirrored);
    }
    SolverSettings mirrored = s;
    mirrored.bounds[0].lower = PlaneWall::slip;
    auto one = make_solver(mirrored, half), both = make_solver(s, whole);
    for (int i = 0; i < 200; ++i) {
      one->step(usual_step(s), {0.0, -9.81, 0.0});
      both->step(usual_step(s), {0.0, -9.81, 0.0});
    }
    Open a(*one, s), b(*both, s);
    std::vector<std::pair<double, std::array<double, 2>>> right, left, alone;
    for (std::size_t p = 0; p < b.size(); ++p) {
      const double x = b.position(0, p);
      (x > 0.0 ? right : left).push_back({b.mass()[p], {std::abs(x), b.position(1, p)}});
    }
    for (std::size_t p = 0; p < a.size(); ++p)
      alone.push_back({a.mass()[p], {a.position(0, p), a.position(1, p)}});
    ASSERT_EQ(right.size(), alone.size());
    ASSERT_EQ(left.size(), alone.size());
    for (auto* side : {&right, &left, &alone}) std::sort(side->begin(), side->end());
    double farthest = 0.0;
    for (std::size_t i = 0; i < alone.size(); ++i)
      for (std::size_t x = 0; x < 2; ++x) {
        ASSERT_NEAR(right[i].second[x], alone[i].second[x], 1e-9) << "axis " << x;
        ASSERT_NEAR(left[i].second[x], alone[i].second[x], 1e-9) << "axis " << x;
        farthest = std::max(farthest, alone[i].second[0]);
      }
    EXPECT_GT(farthest, 0.055) << "the column did not spread";
  }
}

TEST(Solver, EmptySpaceBetweenBodiesCostsNothing) {
  const SolverSettings s = concrete({3, false, Transfer::quadratic_apic, true});
  const auto bytes = [&](int apart) {
    auto seeds = block(s, {0, 0, 0}, {4, 4, 4}, 2);
    for (auto& seed : block(s, {apart, apart, apart}, {apart + 4, apart + 4, apart + 4}, 2))
      seeds.push_back(seed);
    auto solver = make_solver(s, seeds);
    solver->step(1e-4, weightless);
    EXPECT_EQ(solver->occupied_cells(), 128u);
    return solver->bytes();
  };
  EXPECT_EQ(bytes(800), bytes(800000));
  EXPECT_LT(bytes(800000), 2u << 20);
}

TEST(Solver, DropsOfAFewParticlesSwingWithWhatTheyHaveWhereverTheyLieInACell) {
  // Slightly compressed, weightless, at a Courant number of 0.75.
  for (const auto& v : every_variant()) {
    if (v.transfer != Transfer::quadratic_apic || v.single_precision) continue;
    SolverSettings s = concrete(v);
    s.state = {1e5 / 0.3, 1e5 / 2.9, 7.0};
    s.flow.yield_stress = 5.0;
    const double step = usual_step(s) * 0.75 / 0.7;
    const double share = s.dimension == 3 ? 0.125 : 1.0 / 9.0;
    for (const int count : {1, 2, 4})
      for (const double place : {0.01, 0.25, 0.5, 0.95}) {
        Random random(3);
        std::vector<Seed> seeds;
        for (int i = 0; i < count; ++i) {
          Seed seed;
          seed.cell = {30, 30, s.dimension == 3 ? 30 : 0};
          for (std::size_t a = 0; a < static_cast<std::size_t>(s.dimension); ++a) {
            const double beside = i == 0 ? 0.0 : random.between(-0.3, 0.3);
            seed.position[a] = std::clamp((a == 1 ? 1.0 - place : place) + beside, 0.01, 0.99);
          }
          seed.volume = share * std::pow(s.cell, s.dimension) *
                        (s.axisymmetric ? 2.0 * std::numbers::pi * 30.5 * s.cell : 1.0);
          seed.volume_ratio = 0.999;
          seeds.push_back(seed);
        }
        auto solver = make_solver(s, seeds);
        solver->set_apic_relaxation_time(0.02);
        double farthest = 0.0;
        for (int i = 0; i < 2000; ++i) {
          solver->step(step, weightless);
          Open drop(*solver, s);
          for (const double ratio : drop.volume_ratio()) farthest = std::max(farthest, std::abs(ratio - 1.0));
        }
        EXPECT_LT(farthest, 0.002) << name_of(v) << ", " << count << " at " << place;
      }
  }
}

TEST(Solver, AParticleThatLeapsOverCellsIsAnError) {
  for (const auto& v : every_variant()) {
    const SolverSettings s = concrete(v);
    auto seeds = block(s, {5, 5, 5}, {8, 8, 8}, 2);
    for (auto& seed : seeds) seed.velocity[0] = 1e4;
    auto solver = make_solver(s, seeds);
    try {
      solver->step(1e-3, weightless);
      FAIL() << name_of(v) << ": nothing was thrown";
    } catch (const runs::NumericsError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("moved further than one cell")) << name_of(v);
    }
  }
}

TEST(Solver, WhatIsNotFiniteIsAnError) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& v : every_variant()) {
    const SolverSettings s = concrete(v);
    auto seeds = block(s, {5, 5, 5}, {8, 8, 8}, 2);
    seeds[7].velocity[1] = nan;
    EXPECT_THROW(make_solver(s, seeds)->step(1e-4, weightless), runs::NumericsError)
        << name_of(v) << ", velocity";
    seeds[7].velocity[1] = 0.0;
    auto solver = make_solver(s, seeds);
    EXPECT_NO_THROW(solver->step(1e-4, weightless)) << name_of(v);
    Open open(*solver, s);
    open.deviator(1)[3] = nan;
    EXPECT_THROW(make_solver(s, open.state)->step(1e-4, weightless), runs::NumericsError)
        << name_of(v) << ", stress";
    EXPECT_THROW(solver->step(1e-4, {nan, 0.0, 0.0}), runs::NumericsError) << name_of(v) << ", acceleration";
  }
}

TEST(DensityCorrection, TakesBackAnOverlapByItsShareOfTheStrainAndLeavesAFullBodyAlone) {
  // Bodies that fill a box between walls, with particles of the right volume and of a tenth more than there
  // is room for. The bound is what the particles' slightly different volumes leave.
  for (Variant v : every_variant()) {
    for (const double overlap : {0.0, 0.1}) {
      SolverSettings s = concrete(v);
      const CellIndex last = {4, 4, v.dimension == 3 ? 4 : 0};
      for (std::size_t a = 0; a < static_cast<std::size_t>(v.dimension); ++a)
        s.bounds[a] = {PlaneWall::slip, PlaneWall::slip, 0, 4, false};
      s.bounds[1].lower = PlaneWall::no_slip;
      s.density_correction = 0.5;
      auto seeds = block(s, {0, 0, 0}, last, 2);
      for (auto& seed : seeds) seed.volume *= 1.0 + overlap;
      auto solver = make_solver(s, seeds);
      Open still(*solver, s);
      for (double& rate : still.rate()) rate = 4.0;
      solver = make_solver(s, still.state);
      const double step = 1e-4;
      solver->step(step, {0.0, 0.0, 0.0});
      Open end(*solver, s);
      const double expected = 1.0 - 0.5 * 4.0 * step * overlap;
      for (const double ratio : end.volume_ratio())
        ASSERT_NEAR(ratio, expected, 2e-6) << name_of(v) << ", overlap " << overlap;
    }
  }
}
