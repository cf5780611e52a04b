// Plane walls along the grid with friction: bodies slide, stick and leave as Coulomb says, and a wall that
// always holds is a wall of no slip.
#include "mpm/boundary/plane_friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "mpm/output/test_runs.h"
#include "mpm/verification/known_motions.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;
using namespace flowrest::mpm::known;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// A wall across one of the solver's axes.
struct Side {
  int axis = 0;
  bool upper = false;
};

std::string name_of(const Variant& v, const Side& side) {
  return test::name_of(v) + (side.upper ? ", upper" : ", lower") + " wall of axis " +
         std::to_string(side.axis);
}

/// An elastic slab, 12 cells long and 2 high (in space 4 across), on a wall of friction.
struct Slab {
  Slab(const Variant& v, const Side& side, double friction) : settings(concrete(v)), along{}, into{} {
    settings.flow.yield_stress = 1e9;
    const int face = 20, way = (side.axis + 1) % v.dimension;
    AxisBounds& bounds = settings.bounds[static_cast<std::size_t>(side.axis)];
    (side.upper ? bounds.upper : bounds.lower) = PlaneWall::friction;
    (side.upper ? bounds.upper_cell : bounds.lower_cell) = face;
    (side.upper ? bounds.upper_friction : bounds.lower_friction) = friction;
    CellIndex first = {30, 30, 30}, last = {34, 34, 34};
    first[static_cast<std::size_t>(way)] = 24;
    last[static_cast<std::size_t>(way)] = 36;
    first[static_cast<std::size_t>(side.axis)] = side.upper ? face - 2 : face;
    last[static_cast<std::size_t>(side.axis)] = side.upper ? face : face + 2;
    solver = make_solver(settings, even_block(settings, first, last, 3));
    along[static_cast<std::size_t>(way)] = 1.0;
    into[static_cast<std::size_t>(side.axis)] = side.upper ? 1.0 : -1.0;
  }

  /// Lets it move for `time` s under gravity that pulls `slope` off the wall's normal.
  double advance(double slope, double time) {
    const double dt = usual_step(settings);
    const int steps = static_cast<int>(std::ceil(time / dt));
    std::array<double, 3> pull{};
    for (std::size_t a = 0; a < 3; ++a)
      pull[a] = gravity * (std::sin(slope) * along[a] + std::cos(slope) * into[a]);
    for (int i = 0; i < steps; ++i) solver->step(dt, pull);
    return steps * dt;
  }

  /// Mean acceleration along the wall over `time` s once it has settled on a slope, m/s2.
  double acceleration(double slope, double time) {
    advance(0.0, 0.3);
    advance(slope, 0.3);
    const double early = mean_velocity(*solver, along);
    const double span = advance(slope, time);
    return (mean_velocity(*solver, along) - early) / span;
  }

  SolverSettings settings;
  Vector along, into;
  std::unique_ptr<Solver> solver;
};

std::vector<Variant> variants() {
  return {{2, false, Transfer::quadratic_apic, false},
          {2, false, Transfer::linear_flip, false},
          {2, false, Transfer::quadratic_apic, true},
          {3, false, Transfer::quadratic_apic, false}};
}

std::vector<Side> sides(int dimension) {
  if (dimension == 3) return {{0, true}, {1, false}, {2, false}};
  return {{0, false}, {0, true}, {1, false}, {1, true}};
}

class PlaneFrictionRun : public RunTest {
 protected:
  /// A slump's last spread on a base given as in a scene, mm.
  double spread(const std::string& base, std::vector<std::string> settings) {
    settings.push_back("walls.base=" + base);
    const auto made = run_and_read(tiny_slump(settings), "run" + std::to_string(++runs_));
    return made.history.at("spread_mm").back();
  }
  int runs_ = 0;
};

}  // namespace

TEST(PlaneFriction, ASlabSlidesAsCoulombSaysOnEverySideOfTheGrid) {
  const double slope = 30.0 * degree, friction = 0.3;
  const double exact = gravity * (std::sin(slope) - friction * std::cos(slope));
  for (const Variant& v : variants())
    for (const Side& side : sides(v.dimension)) {
      const double a = Slab(v, side, friction).acceleration(slope, 0.2);
      std::printf("    %s: %.4f of g (sin - mu cos)\n", name_of(v, side).c_str(), a / exact);
      EXPECT_NEAR(a / exact, 1.0, 0.01) << name_of(v, side);
    }
}

TEST(PlaneFriction, ASlabSticksBelowTheFrictionAngle) {
  // The friction angle of 0.3 is 16.7 degrees.
  for (const Variant& v : variants())
    for (const Side& side : sides(v.dimension)) {
      const double a = Slab(v, side, 0.3).acceleration(14.0 * degree, 0.2);
      EXPECT_NEAR(a, 0.0, 0.01 * gravity * std::sin(14.0 * degree)) << name_of(v, side);
    }
}

TEST(PlaneFriction, WhatIsPulledOffTheWallLeavesItAsIfTheWallWereNotThere) {
  for (const Variant& v : variants()) {
    Slab slab(v, {1, false}, 10.0);
    slab.advance(0.0, 0.3);
    const Vector off = {0.0, 1.0, 0.0};
    const double early = mean_velocity(*slab.solver, off);
    const double span = slab.advance(std::numbers::pi, 0.05);
    EXPECT_NEAR((mean_velocity(*slab.solver, off) - early) / span, gravity, 0.02 * gravity)
        << test::name_of(v);
  }
}

TEST_F(PlaneFrictionRun, AWallThatAlwaysHoldsIsAWallOfNoSlip) {
  const std::vector<std::vector<std::string>> scenes = {
      {"time.end=1"},
      {"time.end=0.6", "geometry.dimension=plane"},
      {"time.end=0.6", "mpm.scheme=linear-flip"},
      {"time.end=0.6", "mpm.precision=float"},
      {"time.end=0.6", "mpm.cfl=0.2"},
      {"time.end=0.6", "material.model=papanastasiou"},
      {"time.end=1", "material.model=newtonian"},
      {"time.end=0.4", "geometry.dimension=quarter", "mpm.particles_per_cell=8", "mpm.precision=float"}};
  for (const auto& scene : scenes) {
    const double held = spread("\"no-slip\"", scene), rough = spread("{ friction = 10 }", scene);
    std::printf("    %s: no-slip %.3f mm, friction 10 %.3f mm\n", scene.back().c_str(), held, rough);
    EXPECT_NEAR(rough / held, 1.0, 1e-3) << scene.back();
  }
}

TEST_F(PlaneFrictionRun, TheSpreadNeverRisesWithFriction) {
  const std::vector<std::string> settings = {"time.end=1.5"};
  double wider = std::numeric_limits<double>::infinity();
  for (const double friction : {0.1, 0.2, 0.3, 0.5, 1.0, 10.0}) {
    const double here = spread("{ friction = " + std::to_string(friction) + " }", settings);
    std::printf("    friction %g: %.2f mm\n", friction, here);
    EXPECT_LT(here, 1.002 * wider) << friction;
    wider = here;
  }
}

TEST_F(PlaneFrictionRun, FrictionMakesNoEnergy) {
  for (const std::string scheme : {"quadratic-apic", "linear-flip"})
    for (const std::string friction : {"0.1", "0.3", "1"}) {
      const auto run =
          run_and_read(tiny_slump({"walls.base={ friction = " + friction + " }", "mpm.scheme=" + scheme}),
                       "energy" + std::to_string(++runs_));
      const auto& made = run.history.at("numerical_energy_J");
      const double initial = run.history.at("potential_energy_J").front();
      EXPECT_GT(*std::min_element(made.begin(), made.end()), -0.01 * initial) << scheme << " " << friction;
    }
}

TEST(PlaneFriction, TheSameBitsForAnyNumberOfThreadsAndAfterAResumption) {
  SolverSettings s = concrete({2});
  s.bounds[1] = {PlaneWall::friction, PlaneWall::none, 20, 0, false, 0.3, 0.0};
  const auto advance = [&](Solver& solver, int steps) {
    for (int i = 0; i < steps; ++i) solver.step(usual_step(s), {2.0, -gravity, 0.0});
  };
  const auto seeds = even_block(s, {20, 20, 0}, {32, 26, 0}, 3);
  auto one = make_solver(s, seeds);
  s.threads = 2;
  auto two = make_solver(s, seeds);
  advance(*one, 40);
  auto resumed = make_solver(s, one->state());
  advance(*one, 40);
  advance(*two, 80);
  advance(*resumed, 40);
  EXPECT_EQ(one->state().arrays, two->state().arrays);
  EXPECT_EQ(one->state().arrays, resumed->state().arrays);
}
