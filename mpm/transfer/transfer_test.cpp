#include <gtest/gtest.h>

#include <limits>

#include "mpm/solver/particles.h"
#include "mpm/solver/test_bodies.h"
#include "mpm/transfer/shape.h"

using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

/// The particles-to-grid stage and the sum over nodes alone, on a body without walls.
struct GridSums {
  double mass = 0.0;
  std::array<double, 3> momentum{};
};

template <class T>
GridSums to_grid(const SolverSettings& s, const std::vector<Seed>& seeds, const std::string& set, double dt,
                 const std::array<double, 3>& acceleration) {
  const bool flip = s.transfer == Transfer::linear_flip;
  Particles<T> particles({s.dimension, !flip, flip, false});
  std::vector<CellIndex> cells;
  for (const auto& seed : seeds) cells.push_back(seed.cell);
  SparseBlocks blocks(s.dimension, s.bounds);
  const auto places = blocks.build(cells);
  particles.make_room(blocks.room());
  const ParticleView<T>& v = particles.view();
  for (std::size_t p = 0; p < seeds.size(); ++p) {
    const std::uint32_t at = places[p];
    for (std::size_t a = 0; a < static_cast<std::size_t>(s.dimension); ++a) {
      v.position[a][at] = static_cast<T>(seeds[p].position[a]);
      v.velocity[a][at] = static_cast<T>(seeds[p].velocity[a]);
    }
    v.mass[at] = static_cast<T>(seeds[p].volume * s.density);
    v.volume_ratio[at] = T(1);
    v.deviator[0][at] = T(100);
    v.pressure[at] = T(300);
  }
  const Kernels<T> stages = kernels<T>(set, s.dimension, s.axisymmetric, s.transfer);
  const std::size_t values = node_values;
  AlignedArray<T> arenas(blocks.slot_count() * static_cast<std::size_t>(power(arena_edge, s.dimension)) *
                         values);
  const auto nodes_per_block = static_cast<std::size_t>(power(block_edge, s.dimension));
  AlignedArray<T> nodes(blocks.slot_count() * nodes_per_block * values);
  AlignedArray<T> memory(static_cast<std::size_t>(workspace_arrays) * 96);
  const Workspace<T> workspace{memory.data(), 96};
  StepParameters<T> step;
  step.step = static_cast<T>(dt);
  step.cell = static_cast<T>(s.cell);
  step.density = static_cast<T>(s.density);
  for (std::size_t a = 0; a < 3; ++a) step.acceleration[a] = static_cast<T>(acceleration[a]);
  for (const auto slot : blocks.occupied())
    stages.particles_to_grid(step, v, blocks.view(slot), arenas.data(), nodes.data(), workspace);
  for (std::uint32_t slot = 0; slot < blocks.slot_count(); ++slot)
    stages.update_nodes(step, blocks.node_view(slot), arenas.data(), nodes.data());
  GridSums sums;
  for (std::size_t n = 0; n < blocks.slot_count() * nodes_per_block; ++n) {
    const T* node = nodes.data() + n * values;
    sums.mass += static_cast<double>(node[0]);
    for (std::size_t a = 0; a < static_cast<std::size_t>(s.dimension); ++a)
      sums.momentum[a] += static_cast<double>(node[0]) * static_cast<double>(node[1 + a]);
  }
  return sums;
}

template <class Shape>
void expect_partition_of_unity_and_linear_reproduction(double first_node) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const double x = i == 0 ? 0.0 : i == 1 ? std::nextafter(1.0, 0.0) : random.uniform();
    double sum = 0.0, place = 0.0, slopes = 0.0, slope_place = 0.0;
    for (int n = 0; n < Shape::nodes; ++n) {
      const double node = first_node + n, weight = Shape::weight(n, x), slope = Shape::slope(n, x);
      ASSERT_GE(weight, 0.0);
      sum += weight;
      place += weight * node;
      slopes += slope;
      slope_place += slope * node;
      const double d = 1e-6;
      ASSERT_NEAR(slope, (Shape::weight(n, x + d) - Shape::weight(n, x - d)) / (2.0 * d), 1e-9);
    }
    ASSERT_NEAR(sum, 1.0, 4e-16);
    ASSERT_NEAR(place, x, 4e-16);
    ASSERT_NEAR(slopes, 0.0, 4e-16);
    ASSERT_NEAR(slope_place, 1.0, 4e-16);
  }
}

}  // namespace

TEST(Shape, WeightsAreAPartitionOfUnityAndReproduceLinearFields) {
  expect_partition_of_unity_and_linear_reproduction<Linear>(0.0);
  expect_partition_of_unity_and_linear_reproduction<Quadratic>(-0.5);
}

TEST(Shape, QuadraticSecondMomentIsAQuarterCellSquared) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform();
    double moment = 0.0;
    for (int n = 0; n < 3; ++n) {
      EXPECT_DOUBLE_EQ(Quadratic::offset(n, x), n - 0.5 - x);
      moment += Quadratic::weight(n, x) * Quadratic::offset(n, x) * Quadratic::offset(n, x);
    }
    EXPECT_NEAR(moment * Quadratic::inverse_moment, 1.0, 1e-15);
  }
}

TEST(Shape, WeightsAndSlopesOfQuadraticsAreContinuousFromCellToCell) {
  // The node that is second in one cell is first in the next.
  for (int n = 1; n < 3; ++n) {
    EXPECT_DOUBLE_EQ(Quadratic::weight(n, 1.0), Quadratic::weight(n - 1, 0.0));
    EXPECT_DOUBLE_EQ(Quadratic::slope(n, 1.0), Quadratic::slope(n - 1, 0.0));
  }
  EXPECT_EQ(Quadratic::weight(0, 1.0), 0.0);
  EXPECT_EQ(Quadratic::weight(2, 0.0), 0.0);
}

TEST(ParticlesToGrid, TheGridHoldsTheParticlesMassAndMomentumAndTheStepsImpulse) {
  const std::array<double, 3> acceleration = {1.5, -9.81, 0.7};
  const double dt = 1e-3;
  for (const auto& set : instruction_sets())
    for (const auto& v : every_variant()) {
      SolverSettings s = concrete(v);
      s.bounds = {};
      Random random(3);
      const auto seeds = restless_block(s, random);
      double mass = 0.0, scale = 0.0;
      std::array<double, 3> momentum{};
      for (const auto& seed : seeds) {
        const double m = seed.volume * s.density;
        mass += m;
        scale += m;
        for (std::size_t a = 0; a < static_cast<std::size_t>(s.dimension); ++a)
          momentum[a] += m * (seed.velocity[a] + dt * acceleration[a]);
      }
      const GridSums sums = v.single_precision ? to_grid<float>(s, seeds, set, dt, acceleration)
                                               : to_grid<double>(s, seeds, set, dt, acceleration);
      const double unit = v.single_precision ? 1.2e-7 : 2.2e-16;
      EXPECT_NEAR(sums.mass, mass, 16.0 * unit * mass) << name_of(v) << ", " << set;
      for (std::size_t a = 0; a < static_cast<std::size_t>(s.dimension); ++a) {
        if (v.axisymmetric && a == 0) continue;  // the hoop stress pulls inwards
        EXPECT_NEAR(sums.momentum[a], momentum[a], 16.0 * unit * scale)
            << name_of(v) << ", " << set << ", axis " << a;
      }
    }
}
