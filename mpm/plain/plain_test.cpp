// The kernels held to the plain step, and derivatives through it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "laws/test_dual.h"
#include "mpm/plain/solver.h"
#include "mpm/plain/step.h"
#include "mpm/sampling/feed.h"
#include "mpm/solver/test_bodies.h"

namespace flowrest::mpm {
namespace {

using test::Open;
using test::Random;
using test::Variant;

constexpr int steps = 200;
constexpr double allowed = 2e-11;
/// The sweeps of walls of any shape end at a tolerance of their own, and carry round-off from point to point.
constexpr double allowed_in_contact = 1e-10;
constexpr double gravity = 9.81;

std::string words(const SolverSettings& s) {
  return std::string(s.dimension == 3 ? "3D, "
                     : s.axisymmetric ? "axisymmetric, "
                                      : "plane, ") +
         laws::name_of(s.law) + (s.thixotropic ? ", thixotropic" : "");
}

/// Both ways to compute one body, side by side. Sums are ordered differently (the kernels add up a cell's
/// particles and then blocks, in registers of several), so that the two agree to round-off and what 200 steps
/// make of it.
class Pair {
 public:
  Pair(const SolverSettings& s, const std::vector<Seed>& seeds)
      : settings_(s), kernels_(make_solver(s, seeds)), plain_(plain::make_solver(s, seeds)) {}

  void step(double step, const std::array<double, 3>& acceleration) {
    results_ = {kernels_->step(step, acceleration), plain_->step(step, acceleration)};
    for (std::size_t w = 0; w < settings_.walls.size(); ++w)
      for (std::size_t a = 0; a < 3; ++a) {
        const double push = kernels_->wall_force(w)[a];
        largest_push_ = std::max(largest_push_, std::abs(push));
        pushes_apart_ = std::max(pushes_apart_, std::abs(push - plain_->wall_force(w)[a]));
      }
  }
  double largest_push() const { return largest_push_; }          ///< of walls of any shape, N
  double difference_of_pushes() const { return pushes_apart_; }  ///< N
  template <class Use>
  void both(const Use& use) {
    use(*kernels_);
    use(*plain_);
  }
  Solver& plain() { return *plain_; }

  /// Largest difference of what particles carry, each quantity over its largest value (stresses over the
  /// largest of them all), and of what a step tells.
  double difference() {
    Open a(*kernels_, settings_), b(*plain_, settings_);
    const auto of_a = a.by_mass(), of_b = b.by_mass();
    double worst = 0.0;
    const auto compare = [&](const std::vector<std::pair<std::vector<double>*, std::vector<double>*>>& of) {
      double scale = 0.0, apart = 0.0;
      for (const auto& [x, y] : of)
        for (std::size_t i = 0; i < of_a.size(); ++i) {
          scale = std::max(scale, std::abs((*x)[of_a[i]]));
          apart = std::max(apart, std::abs((*x)[of_a[i]] - (*y)[of_b[i]]));
        }
      if (scale > 0.0) worst = std::max(worst, apart / scale);
      if (!(apart <= scale)) worst = 1.0;
    };
    std::vector<std::pair<std::vector<double>*, std::vector<double>*>> velocities, stresses;
    for (int axis = 0; axis < settings_.dimension; ++axis) {
      for (std::size_t i = 0; i < of_a.size(); ++i)
        worst =
            std::max(worst, std::abs(a.position(axis, of_a[i]) - b.position(axis, of_b[i])) / settings_.cell);
      velocities.emplace_back(&a.velocity(axis), &b.velocity(axis));
      for (int other = 0; other < settings_.dimension; ++other)
        velocities.emplace_back(&a.affine(axis, other), &b.affine(axis, other));
    }
    for (int c = 0; c < a.components(); ++c) stresses.emplace_back(&a.deviator(c), &b.deviator(c));
    stresses.emplace_back(&a.pressure(), &b.pressure());
    compare(velocities);
    compare(stresses);
    compare({{&a.volume_ratio(), &b.volume_ratio()}});
    compare({{&a.rate(), &b.rate()}});
    if (settings_.thixotropic) compare({{&a.state.arrays.back(), &b.state.arrays.back()}});
    const auto tell = [&](double StepResult::*what) {
      const double x = results_[0].*what, y = results_[1].*what;
      if (x != y) worst = std::max(worst, std::abs(x - y) / std::max(std::abs(x), std::abs(y)));
    };
    tell(&StepResult::largest_speed);
    tell(&StepResult::largest_pressure);
    tell(&StepResult::dissipated);
    return worst;
  }

 private:
  SolverSettings settings_;
  std::unique_ptr<Solver> kernels_, plain_;
  std::array<StepResult, 2> results_;
  double largest_push_ = 0.0, pushes_apart_ = 0.0;
};

/// A power of the rate comes with a consistency (Pa s^n) that keeps the material about as thick.
SolverSettings with_law(SolverSettings s, laws::Law law, bool thixotropic, double flow_index = 1.0) {
  s.law = law;
  s.thixotropic = thixotropic;
  if (thixotropic) s.structure = {.growth = 0.4, .breakdown = 0.2};
  if (!laws::has_yield_stress(law)) s.flow.yield_stress = 0.0;
  s.flow.flow_index = flow_index;
  if (flow_index != 1.0) s.flow.plastic_viscosity = 150.0;
  return s;
}

/// A column that slumps on a floor that holds it, beside an axis or a plane of symmetry.
struct Slump {
  SolverSettings settings;
  std::vector<Seed> seeds;

  explicit Slump(SolverSettings s) : settings(std::move(s)) {
    const auto up = static_cast<std::size_t>(settings.dimension - 1);
    for (std::size_t a = 0; a < up; ++a) settings.bounds[a].lower = PlaneWall::slip;
    settings.bounds[up].lower = PlaneWall::no_slip;
    settings.density_correction = 1.0;
    Random random(5);
    const int wide = settings.dimension == 3 ? 3 : 5;
    seeds = test::block(settings, {0, 0, 0}, {wide, settings.dimension == 3 ? wide : 7, 5}, 3);
    for (Seed& seed : seeds) {
      if (settings.thixotropic) seed.flocculation = random.between(0.0, 1.0);
      for (std::size_t a = 0; a <= up; ++a) {
        seed.position[a] += random.between(-0.05, 0.05);
        seed.velocity[a] = random.between(-0.02, 0.02);
      }
    }
  }
  std::array<double, 3> driving() const {
    std::array<double, 3> g{};
    g[static_cast<std::size_t>(settings.dimension - 1)] = -gravity;
    return g;
  }
};

/// Steps a pair and returns the largest difference at any step of a few.
double largest_difference(Pair& pair, double step, const std::array<double, 3>& driving,
                          double apic_relaxation_time) {
  pair.both([&](Solver& solver) { solver.set_apic_relaxation_time(apic_relaxation_time); });
  double worst = 0.0;
  for (int i = 1; i <= steps; ++i) {
    pair.both([&](Solver& solver) { solver.set_time((i - 1) * step); });
    pair.step(step, driving);
    if (i == 1 || i % 50 == 0) worst = std::max(worst, pair.difference());
  }
  return worst;
}

const Variant dimensions[] = {{2, false}, {2, true}, {3, false}};

}  // namespace

TEST(Plain, SlumpsAsTheKernelsDoInEveryDimensionAndLaw) {
  for (const Variant& v : dimensions)
    for (const laws::Law law : laws::every_law)
      for (const bool thixotropic : {false, true})
        for (const double index : {1.0, 0.6, 1.4}) {
          if (thixotropic && !laws::has_yield_stress(law)) continue;
          if (index != 1.0 && !laws::needs(law, laws::Parameter::flow_index)) continue;
          const Slump slump(with_law(test::concrete(v), law, thixotropic, index));
          Pair pair(slump.settings, slump.seeds);
          const double step = 0.5 * test::usual_step(slump.settings);
          const double worst = largest_difference(pair, step, slump.driving(), 2.0 * step);
          std::printf("    %s, n = %g: %.2g\n", words(slump.settings).c_str(), index, worst);
          EXPECT_LT(worst, allowed) << words(slump.settings) << ", n = " << index;
        }
}

/// Breakdown by a power of the rate, and growth with age, which is felt within these few steps.
TEST(Plain, SlumpsAsTheKernelsDoWithEveryStructure) {
  for (const Variant& v : dimensions)
    for (const laws::Law law : laws::every_law)
      for (const double exponent : {0.5, 1.0, 1.6}) {
        if (!laws::has_yield_stress(law)) continue;
        SolverSettings s = with_law(test::concrete(v), law, true);
        s.structure.exponent = exponent;
        s.ageing = {.rate = 400.0, .per_time = 2.0, .initial_age = 0.1};
        const Slump slump(s);
        Pair pair(slump.settings, slump.seeds);
        const double step = 0.5 * test::usual_step(slump.settings);
        const double worst = largest_difference(pair, step, slump.driving(), 2.0 * step);
        std::printf("    %s, m = %g: %.2g\n", words(slump.settings).c_str(), exponent, worst);
        EXPECT_LT(worst, allowed) << words(slump.settings) << ", m = " << exponent;
      }
}

TEST(Plain, TakesTheChoicesOfTheScheme) {
  for (const Variant& v : dimensions)
    for (const int choice : {0, 1, 2, 3, 4}) {
      SolverSettings s = test::concrete(v);
      s.flow.regularisation_time = 0.5;
      if (choice == 0) s.dilatation = Dilatation::cell_average;
      if (choice == 1 || choice == 2 || choice == 4) {  // explicit fluids
        s = with_law(s,
                     choice == 1   ? laws::Law::papanastasiou
                     : choice == 2 ? laws::Law::bi_viscous
                                   : laws::Law::herschel_bulkley,
                     choice == 2, choice == 4 ? 0.6 : 1.0);
        s.explicit_fluid = true;
        s.flow.plastic_viscosity = 5.0;
        s.flow.critical_shear_rate = 4.0;
      }
      const Slump slump(s);
      Pair pair(slump.settings, slump.seeds);
      // Choice 3: APIC as published, whose transfer acts in every step.
      const double step = 0.5 * test::usual_step(slump.settings);
      EXPECT_LT(largest_difference(pair, step, slump.driving(), choice == 3 ? 0.0 : 5.0 * step), allowed)
          << words(slump.settings) << ", choice " << choice;
    }
}

/// A periodic duct: cells that are full, their dilatation averaged over particles.
TEST(Plain, FlowsBetweenPlatesAsTheKernelsDo) {
  for (const laws::Law law : laws::every_law) {
    SolverSettings s = with_law(test::concrete({2, false}), law, false);
    s.dilatation = Dilatation::cell_average;
    s.free_surface = false;
    s.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 8, true};
    s.bounds[1] = {PlaneWall::no_slip, PlaneWall::no_slip, 0, 6, false};
    Random random(9);
    const auto seeds = test::block(s, {0, 0, 0}, {8, 6, 0}, 3, &random);
    Pair pair(s, seeds);
    const double step = test::usual_step(s);
    EXPECT_LT(largest_difference(pair, step, {20.0, 0.0, 0.0}, step), allowed) << words(s);
  }
}

/// Floors that let go at a limit, low, middling and too high to be reached, alone, in a corner with a wall of
/// friction, and beside a wall of any shape.
TEST(Plain, RubsOnPlaneWallsAsTheKernelsDo) {
  for (const Variant& v : dimensions)
    for (const double friction : {0.05, 0.4, 10.0})
      for (const int beside : {0, 1, 2}) {
        SolverSettings s = test::concrete(v);
        if (beside == 1 && s.axisymmetric) continue;
        Slump slump(s);
        SolverSettings& of = slump.settings;
        const auto up = static_cast<std::size_t>(of.dimension - 1);
        of.bounds[up].lower = PlaneWall::friction;
        of.bounds[up].lower_friction = friction;
        if (beside == 1) {
          of.bounds[0].lower = PlaneWall::friction;
          of.bounds[0].lower_friction = 0.3;
        }
        if (beside == 2) {
          Vector place{}, normal{};
          place[0] = 5.5 * of.cell;
          normal[0] = -1.0;
          Extent extent;
          extent.upper = {0.2, 0.2, 0.2};
          Wall wall;
          wall.shape = std::make_shared<HalfSpace>(of.dimension, place, normal, extent);
          wall.contact = Contact::friction;
          wall.friction = 0.4;
          of.walls.push_back(wall);
        }
        Pair pair(of, slump.seeds);
        const double step = 0.5 * test::usual_step(of);
        EXPECT_LT(largest_difference(pair, step, slump.driving(), 2.0 * step),
                  beside == 2 ? allowed_in_contact : allowed)
            << words(of) << ", friction " << friction << ", beside " << beside;
      }
}

/// Walls of any shape: an inclined floor with friction, a lid that is lifted, a bar, beside planes that
/// mirror.
TEST(Plain, MeetsWallsOfAnyShapeAsTheKernelsDo) {
  for (const int dimension : {2, 3})
    for (const Contact contact : {Contact::friction, Contact::stick, Contact::slip}) {
      SolverSettings s = test::concrete({dimension, false});
      s.state = {5e4, 2e4, 7.0};
      s.density_correction = 1.0;
      s.bounds[0].lower = PlaneWall::slip;
      if (dimension == 3) s.bounds[1].lower = PlaneWall::slip;
      const double cell = s.cell, angle = 12.0 * std::numbers::pi / 180.0;
      const auto up = static_cast<std::size_t>(dimension - 1);
      Vector place{}, normal{};
      place[up] = 2.3 * cell;
      normal[0] = -std::sin(angle);
      normal[up] = std::cos(angle);
      Extent extent;
      extent.upper = {0.2, 0.2, 0.2};
      const auto wall = [&](std::shared_ptr<const WallShape> shape) {
        Wall w;
        w.shape = std::move(shape);
        w.contact = contact;
        w.friction = 0.3;
        s.walls.push_back(w);
        return &s.walls.back();
      };
      wall(std::make_shared<HalfSpace>(dimension, place, normal, extent));
      const double face = 5.0 * cell;
      const Outline plate = {{{face, 0.0}, {face + 0.05, 0.0}, {face + 0.05, 0.3}, {face, 0.3}},
                             {false, false, false, true}};
      const Prism::Swept swept = dimension == 2 ? Prism::Swept{} : Prism::Swept{Sweep::extruded, 1, 0.0, 0.2};
      wall(std::make_shared<Prism>(plate, swept))->motion = {[&] {
                                                               Vector lift{};
                                                               lift[up] = 0.3;
                                                               return lift;
                                                             }(),
                                                             0.005, 10.0};
      wall(std::make_shared<Cylinder>(dimension, Vector{2.2 * cell, 3.4 * cell, 0.0}, 0.8 * cell, 0.0, 0.2));
      Random random(6);
      auto seeds = test::block(s, {0, dimension == 3 ? 0 : 4, 4}, {5, dimension == 3 ? 4 : 9, 8}, 3, &random);
      std::erase_if(seeds, [&](const Seed& seed) {
        Vector x{};
        for (std::size_t a = 0; a < 3; ++a) x[a] = (seed.cell[a] + seed.position[a]) * cell;
        return std::any_of(s.walls.begin(), s.walls.end(),
                           [&](const Wall& w) { return w.distance(x, 0.0) < 0.0; });
      });
      Pair pair(s, seeds);
      std::array<double, 3> driving{};
      driving[up] = -gravity;
      const double step = test::usual_step(s), worst = largest_difference(pair, step, driving, 0.02);
      std::printf("    %dD, contact %d: %.2g\n", dimension, static_cast<int>(contact), worst);
      EXPECT_LT(worst, allowed_in_contact) << dimension << "D, contact " << static_cast<int>(contact);
      EXPECT_GT(pair.largest_push(), 0.0);
      EXPECT_LT(pair.difference_of_pushes(), 1e-9 * pair.largest_push());
    }
}

/// A strand begins to be printed: half a tube moves over a floor, fed while it goes, and some of it is taken out.
TEST(Plain, PrintsAsTheKernelsDo) {
  SolverSettings s = with_law(test::concrete({3, false}), laws::Law::elasto_viscoplastic, true);
  s.cell = 0.0125 / 2.5;
  s.bounds[1].lower = PlaneWall::slip;
  s.bounds[2].lower = PlaneWall::no_slip;
  s.density_correction = 1.0;
  Nozzle nozzle;
  nozzle.bore = 0.0125;
  nozzle.wall = 0.004;
  nozzle.mouth = [](double time) -> Vector { return {0.02 + 0.3 * time, 0.0, 0.0125}; };
  nozzle.extruded = [](double time) { return 0.34 * time; };
  s.nozzles = {nozzle};
  Feed feed(nozzle, s.cell, 2, true, 0.3);
  // Each particle's volume tells it apart.
  std::size_t number = 0;
  const auto due = [&](double time) {
    auto seeds = feed.due(time, 1e-3);
    for (Seed& seed : seeds) seed.volume *= 1.0 + 1e-6 * static_cast<double>(++number);
    return seeds;
  };
  Pair pair(s, due(0.0));
  const double step = 0.5 * test::usual_step(s);
  double worst = 0.0, apart = 0.0, force = 0.0, taken[2] = {};
  for (int i = 0; i < steps; ++i) {
    const double time = i * step;
    pair.both([&](Solver& solver) { solver.set_time(time); });
    pair.step(step, {0.0, 0.0, -gravity});
    const auto come = due(time + step);
    int which = 0;
    double forces[2] = {};
    pair.both([&](Solver& solver) {
      forces[which] = solver.nozzle_force()[0];
      const bool take = i == steps / 2;
      if (take || !come.empty())
        solver.exchange([&](const Vector& x) { return take && x[0] < 0.03; },
                        [&](const ParticleBatch& batch) {
                          for (const double m : batch.mass) taken[which] += m;
                        },
                        come);
      ++which;
    });
    force = std::max(force, std::abs(forces[0]));
    apart = std::max(apart, std::abs(forces[0] - forces[1]));
    if (i % 20 == 19) worst = std::max(worst, pair.difference());
  }
  EXPECT_GT(number, 300U);
  EXPECT_GT(taken[0], 0.0);
  EXPECT_NEAR(taken[0], taken[1], 1e-12 * taken[0]);
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(apart, 1e-9 * force);
}

TEST(Plain, GoesOnFromItsOwnStateAndFromTheKernels) {
  const Slump slump(with_law(test::concrete({2, true}), laws::Law::papanastasiou, true));
  const double step = test::usual_step(slump.settings);
  const auto advance = [&](Solver& solver, int count) {
    for (int i = 0; i < count; ++i) solver.step(step, slump.driving());
  };
  auto whole = plain::make_solver(slump.settings, slump.seeds);
  advance(*whole, 20);
  auto resumed = plain::make_solver(slump.settings, whole->state());
  auto kernels = make_solver(slump.settings, whole->state());
  advance(*whole, 20);
  advance(*resumed, 20);
  advance(*kernels, 20);
  EXPECT_EQ(whole->state().arrays, resumed->state().arrays);
  Open a(*whole, slump.settings), b(*kernels, slump.settings);
  const auto of_a = a.by_mass(), of_b = b.by_mass();
  for (std::size_t i = 0; i < of_a.size(); ++i)
    ASSERT_NEAR(a.velocity(0)[of_a[i]], b.velocity(0)[of_b[i]], 1e-12);
}

TEST(Plain, ShowsItsParticlesAsTheKernelsDo) {
  const Slump slump(with_law(test::concrete({2, true}), laws::Law::elasto_viscoplastic, true));
  Pair pair(slump.settings, slump.seeds);
  for (int i = 0; i < 20; ++i) pair.step(test::usual_step(slump.settings), slump.driving());
  std::vector<std::array<double, 9>> sums;
  pair.both([&](Solver& solver) {
    auto& sum = sums.emplace_back();
    solver.visit([&](const ParticleBatch& b) {
      for (std::size_t i = 0; i < b.count; ++i) {
        const double m = b.mass[i];
        const double of[] = {
            m * b.position[0][i],  m * b.velocity[1][i],  m * b.volume[i],          m * b.rate[i],
            m * b.shear_stress[i], m * b.raw_pressure[i], m * b.acting_pressure[i], m * b.flocculation[i],
            b.elastic_energy[i]};
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += of[k];
      }
    });
    sums.back()[0] += static_cast<double>(solver.occupied_cells());
  });
  for (std::size_t k = 0; k < sums[0].size(); ++k)
    EXPECT_NEAR(sums[1][k], sums[0][k], 1e-11 * std::abs(sums[0][k])) << k;
}

TEST(Plain, RefusesWhatItDoesNotServe) {
  SolverSettings s = test::concrete({2, false});
  EXPECT_EQ(plain::not_served(s), "");
  s.transfer = Transfer::linear_flip;
  EXPECT_NE(plain::not_served(s), "");
  EXPECT_THROW(plain::make_solver(s, std::vector<Seed>{}), std::invalid_argument);
}

/// How fast a slump of each law falls, by its yield stress and viscosity: over numbers that carry
/// derivatives, and by central differences.
TEST(Plain, DerivativesGoThroughTheStep) {
  using laws::test::Dual;
  for (const laws::Law law : {laws::Law::elasto_viscoplastic, laws::Law::papanastasiou}) {
    const auto height_of_mass = [&](auto yield, auto viscosity) {
      using T = decltype(yield);
      plain::Material<T> material;
      material.density = T(2300.0);
      material.state = {T(5e4), T(2e4), T(7.0)};
      material.law = law;
      material.parameters = {yield, viscosity, T(5.0), T(0.2)};
      plain::Numerics numerics;
      numerics.cell = 0.01;
      numerics.bounds[0].lower = PlaneWall::slip;
      numerics.bounds[1].lower = PlaneWall::no_slip;
      numerics.density_correction = 1.0;
      std::vector<plain::Particle<T, 2>> particles;
      for (int i = 0; i < 12; ++i)
        for (int k = 0; k < 15; ++k) {
          plain::Particle<T, 2> p;
          p.cell = {i / 3, k / 3};
          p.place = {T((i % 3 + 0.5) / 3.0), T((k % 3 + 0.5) / 3.0)};
          p.mass = T(2300.0 * 1e-4 / 9.0);
          particles.push_back(p);
        }
      plain::Body<T, 2> body(material, numerics, nullptr, particles);
      for (int i = 0; i < 150; ++i) body.step(0.0, T(5e-4), {T(0), T(-gravity)}, T(0.5));
      T sum(0);
      for (const auto& p : body.particles()) sum += T(p.cell[1]) + p.place[1];
      return sum;
    };
    const double yield = 30.0, viscosity = 10.0;
    const double by_yield = height_of_mass(Dual{yield, 1.0}, Dual{viscosity}).d;
    const double by_viscosity = height_of_mass(Dual{yield}, Dual{viscosity, 1.0}).d;
    const auto central = [&](double of_yield, double of_viscosity) {
      return (height_of_mass(yield + of_yield, viscosity + of_viscosity) -
              height_of_mass(yield - of_yield, viscosity - of_viscosity)) /
             (2.0 * (of_yield + of_viscosity));
    };
    EXPECT_GT(by_yield, 0.0);
    EXPECT_NEAR(by_yield, central(1e-4, 0.0), 1e-6 * by_yield) << laws::name_of(law);
    EXPECT_NEAR(by_viscosity, central(0.0, 1e-4), 1e-6 * by_viscosity) << laws::name_of(law);
  }
}

}  // namespace flowrest::mpm
