#include "elements/flow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "elements/test_problems.h"

using namespace flowrest::elements;
using namespace flowrest::elements::test;

namespace {

/// The flow of one step in the shape of a problem's cone.
struct Scene {
  Problem problem;
  Topology topology;
  Mesh mesh{make_mesh(topology, Surface::of_cone(problem, 1400))};
  Flow flow{topology, problem, Fluid(problem.flow, 1e-4)};
  FlowTask task{1.0 / 0.005, Field::Zero(2, topology.nodes()),
                std::vector<char>(static_cast<std::size_t>(2 * topology.nodes()), 0)};
  Field velocity{Field::Zero(2, topology.nodes())};

  explicit Scene(const Problem& p, Topology t = {20, 4}) : problem(p), topology(t) {
    EXPECT_TRUE(flow.set_positions(mesh, mesh.position));
  }
  void hold(int node, int component) { task.held[static_cast<std::size_t>(2 * node + component)] = 1; }
  void hold_axis_and_floor() {
    for (int node = 0; node < topology.nodes(); ++node) {
      if (mesh.position(0, node) < 1e-12) hold(node, 0);
      if (mesh.position(1, node) > 1e-12) continue;
      hold(node, 0);
      hold(node, 1);
    }
  }
  FlowOutcome minimise() { return flow.minimise(task, velocity); }
};

}  // namespace

TEST(Flow, WhatNothingHoldsFallsAsOneBody) {
  Scene scene(roussel());
  for (int node = 0; node < scene.topology.nodes(); ++node)
    if (scene.mesh.position(0, node) < 1e-12) scene.hold(node, 0);
  ASSERT_TRUE(scene.minimise().converged);
  EXPECT_LT(scene.velocity.row(0).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((scene.velocity.row(1).array() + 9.81 * 0.005).abs().maxCoeff(), 1e-9);
}

TEST(Flow, WhatIsHeldFromTheSidesIsPressedByItsWeight) {
  Problem problem = roussel();
  problem.radius_top = problem.radius_bottom;
  Scene scene(problem);
  scene.hold_axis_and_floor();
  for (int node = 0; node < scene.topology.nodes(); ++node) scene.hold(node, 0);
  ASSERT_TRUE(scene.minimise().converged);
  EXPECT_LT(scene.velocity.cwiseAbs().maxCoeff(), 1e-6);
  for (int row = 0; row < scene.topology.rows; ++row) {
    const Point middle = scene.mesh.element(3, row).col(4);
    // The upper edge lies within a side of an element, which rounds it: 1 % of the pressure at the floor.
    EXPECT_NEAR(scene.flow.pressure(3, row, middle), 2300.0 * 9.81 * (0.3 - middle.y()), 68.0);
  }
}

TEST(Flow, AStepOfAConeConservesVolumeAndEnergy) {
  for (const auto law : flowrest::laws::every_law) {
    Problem problem = roussel();
    problem.flow.law = law;
    Scene scene(problem);
    scene.hold_axis_and_floor();
    const FlowOutcome outcome = scene.minimise();
    ASSERT_TRUE(outcome.converged) << flowrest::laws::name_of(law);
    EXPECT_LT(outcome.divergence, 1e-8) << flowrest::laws::name_of(law);
    EXPECT_NEAR((outcome.dissipated + outcome.inertia) / outcome.gravity, 1.0, 1e-6)
        << flowrest::laws::name_of(law);
  }
}

TEST(Flow, BinghamFallsBetweenPlatesAsExactlyKnown) {
  // Half a channel, upright, open at both ends: its weight drives it, the plate holds it where the surface
  // is.
  Problem problem = roussel();
  problem.symmetry = Symmetry::plane;
  problem.radius_top = problem.radius_bottom = 0.1;
  const double force = problem.density * problem.gravity, width = problem.radius_bottom,
               yield = 0.4 * force * width;
  problem.flow.parameters.yield_stress = yield;
  Scene scene(problem, {40, 6});
  scene.task.rate = 0.0;
  for (int node = 0; node < scene.topology.nodes(); ++node) {
    scene.hold(node, 0);
    if (scene.mesh.position(0, node) > width - 1e-9) scene.hold(node, 1);
  }
  const FlowOutcome outcome = scene.minimise();
  ASSERT_TRUE(outcome.converged);
  const double sheared = width - yield / force;
  const double plug = force * sheared * sheared / (2.0 * problem.flow.parameters.plastic_viscosity);
  EXPECT_NEAR(-scene.velocity.row(1).minCoeff() / plug, 1.0, 1e-2);
  // gravity's power is force times the flow over the height
  const double flow_rate = plug * (width - sheared / 3.0);
  EXPECT_NEAR(outcome.gravity / (force * 0.3 * flow_rate), 1.0, 1e-2);
}

TEST(Flow, AConeThatItsYieldStressHoldsOnlyCreeps) {
  Problem problem = roussel();
  problem.flow.parameters.yield_stress = 5000.0;
  Scene scene(problem);
  scene.hold_axis_and_floor();
  scene.task.rate = 0.0;
  ASSERT_TRUE(scene.minimise().converged);
  EXPECT_LT(scene.velocity.cwiseAbs().maxCoeff(), 1e-4 * 0.3) << "faster than its rounding lets it";
}
