#include "elements/problem.h"

#include <fmt/format.h>

#include <variant>

#include "runs/errors.h"

namespace flowrest::elements {

namespace {

[[noreturn]] void refuse(const scenes::Scene& scene, const std::string& what, const std::string& allowed) {
  throw runs::RunError(fmt::format("{}: the finite elements do not compute {}; allowed: {}",
                                   scene.path.string(), what, allowed));
}

/// The cone, which is all that they compute.
const scenes::Slump& cone_of(const scenes::Scene& scene) {
  const auto* cone = std::get_if<scenes::Slump>(&scene.geometry.apparatus);
  if (!cone)
    refuse(scene, fmt::format("kind = \"{}\"", scenes::name_of(scene.geometry.apparatus)),
           fmt::format("\"{}\"", scenes::Slump::name));
  const auto dimension = scene.geometry.dimension;
  if (dimension != scenes::Dimension::axisymmetric && dimension != scenes::Dimension::plane)
    refuse(scene, fmt::format("geometry.dimension = \"{}\"", scenes::to_string(dimension)),
           "\"axisymmetric\" or \"plane\"");
  if (cone->mould_lift_velocity)
    refuse(scene, "a mould that is lifted (geometry.mould_lift_velocity)",
           "a cone released at once, without that key");
  return *cone;
}

void check_walls_and_forces(const scenes::Scene& scene) {
  if (scene.base.law == scenes::Wall::friction)
    refuse(scene, fmt::format("a floor of friction {:g} (walls.base)", scene.base.friction),
           "\"no-slip\" or \"slip\"");
  if (!(scene.forces.gravity > 0.0)) refuse(scene, "forces.gravity = 0", "above 0");
  if (!scene.forces.body_force.empty()) refuse(scene, "forces.body_force", "gravity alone");
}

void check_material(const scenes::Scene& scene) {
  if (!(scene.material.plastic_viscosity > 0.0)) refuse(scene, "material.plastic_viscosity = 0", "above 0");
  if (scene.thixotropy &&
      (scene.thixotropy->flocculation_rate != 0.0 || scene.thixotropy->deflocculation_coefficient != 0.0 ||
       scene.thixotropy->ageing_rate != 0.0))
    refuse(scene, "structure that grows or breaks down ([thixotropy])",
           "no [thixotropy], or one with thixotropy.flocculation_rate = 0, "
           "thixotropy.deflocculation_coefficient = 0 and thixotropy.ageing_rate = 0, whose structure stays "
           "what it is at the start");
}

}  // namespace

Problem problem_of(const scenes::Scene& scene) {
  const auto& cone = cone_of(scene);
  check_walls_and_forces(scene);
  check_material(scene);
  Problem problem;
  problem.symmetry =
      scene.geometry.dimension == scenes::Dimension::plane ? Symmetry::plane : Symmetry::about_axis;
  problem.floor = scene.base.law == scenes::Wall::slip ? Floor::slip : Floor::no_slip;
  problem.height = cone.cone_height;
  problem.radius_top = cone.cone_radius_top;
  problem.radius_bottom = cone.cone_radius_bottom;
  problem.domain_radius = cone.domain_radius;
  problem.density = scene.material.density;
  problem.gravity = scene.forces.gravity;
  problem.flow = scene.material.flow_curve();
  if (scene.thixotropy) problem.flow.parameters.yield_stress *= 1.0 + scene.thixotropy->initial_flocculation;
  problem.end = scene.time.end;
  problem.spread_depth = scene.gauges.spread_depth;
  problem.history_interval = scene.output.history_interval;
  problem.profile_interval = scene.output.profile_interval;
  problem.field_interval = scene.output.snapshot_interval;
  return problem;
}

}  // namespace flowrest::elements
