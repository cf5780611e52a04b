#include "compare/apparatus/arrested_slump.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>

#include "compare/exact/solution_run.h"
#include "runs/earlier_run.h"

namespace flowrest::compare::exact {

using runs::DepthColumns;
using runs::MaterialState;
using scenes::Dimension;
using scenes::Scene;

namespace {

/// A scene and which of its solutions is meant.
struct Asked {
  Scene scene;
  std::string solution;
  std::optional<double> flocculation;
};

Asked asked_by(const std::string& from, const Scene& scene) {
  const runs::StateName name = runs::state_name(from);
  if (name.time)
    throw runs::RunError(
        fmt::format("--from {}: an arrested shape has no time; allowed: {}", from, name.run));
  const std::filesystem::path path(name.run);
  Asked asked{scene, path.filename().string(), std::nullopt};
  if (std::filesystem::exists(path / "run.json")) {
    const runs::EarlierRun run = runs::read_earlier_run(path, "exact");
    asked.scene = run.scene;
    if (const auto given = run.info.find("flocculation"); given != run.info.end() && given->is_number())
      asked.flocculation = given->get<double>();
  }
  if (asked.solution != "second-order" && asked.solution != "leading-order")
    throw runs::RunError(
        fmt::format("--from {}: is no arrested shape; allowed: exact/second-order, "
                    "exact/leading-order",
                    from));
  return asked;
}

/// A shape by its depth over the distance from the middle, and the plug's pull over the yield stress's share.
struct Shape {
  std::function<double(double)> depth;  ///< m
  double edge = 0.0;                    ///< m
  double volume = 0.0;                  ///< m3, of a plane m3 to a metre
  bool plug_pulls = false;
};

Shape shape_of(const Asked& asked, const Bingham& material, const std::string& from) {
  const double gravity = asked.scene.forces.gravity;
  const auto& cone = asked.scene.slump();
  const bool second = asked.solution == "second-order";
  if (asked.scene.geometry.dimension == Dimension::plane) {
    if (second)
      throw runs::RunError(fmt::format(
          "--from {}: a plane slump has no solution of second order here; allowed: exact/leading-order",
          from));
    const double half_area = 0.5 * (cone.cone_radius_top + cone.cone_radius_bottom) * cone.cone_height;
    const ArrestedPlaneSlump slump = plane_slump(material, gravity, half_area);
    return {[slump](double x) { return slump.depth(x); }, slump.half_width, 2.0 * half_area, false};
  }
  const ArrestedSlump slump = second ? second_order_slump(material, gravity, cone.volume())
                                     : leading_order_slump(material, gravity, cone.volume());
  return {[slump](double r) { return slump.depth(r); }, slump.radius, cone.volume(), second};
}

DepthColumns::Plan plan_of(Dimension dimension) {
  if (dimension == Dimension::axisymmetric) return DepthColumns::Plan::rings;
  return dimension == Dimension::plane ? DepthColumns::Plan::strips : DepthColumns::Plan::squares;
}

/// Its depth over columns, so that they hold its volume.
DepthColumns columns_of(const Shape& shape, DepthColumns::Plan plan) {
  constexpr int rings = 400, squares = 100, points = 8;
  const bool in_space = plan == DepthColumns::Plan::squares;
  DepthColumns columns;
  columns.plan = plan;
  columns.along_x = in_space ? squares : rings;
  columns.along_y = in_space ? squares : 1;
  columns.width = shape.edge / columns.along_x;
  double held = 0.0;
  for (int j = 0; j < columns.along_y; ++j)
    for (int i = 0; i < columns.along_x; ++i) {
      double sum = 0.0, plan_area = 0.0;
      for (int b = 0; b < (in_space ? points : 1); ++b)
        for (int a = 0; a < points; ++a) {
          const double west = (i + static_cast<double>(a) / points) * columns.width,
                       part = columns.width / points;
          const double south = in_space ? (j + static_cast<double>(b) / points) * columns.width : 0.0;
          const double area = DepthColumns::area(plan, west, west + part, south, south + part);
          sum += area * shape.depth(std::hypot(west + 0.5 * part, in_space ? south + 0.5 * part : 0.0));
          plan_area += area;
        }
      columns.depth.push_back(sum / plan_area);
      held += sum;
    }
  for (double& depth : columns.depth) depth *= shape.volume / held;
  return columns;
}

/// The deviator at a share of the depth over the base, by components along the radius, around and upwards, as
/// seen at an angle to x.
std::array<double, 6> stress_at(double share, double angle, double yield_stress, bool plug_pulls) {
  const double shear = yield_stress * (1.0 - share);
  const double pull =
      plug_pulls ? std::sqrt(3.0 * std::max(0.0, yield_stress * yield_stress - shear * shear)) : 0.0;
  return {pull / 3.0, 0.0, shear * std::cos(angle), pull / 3.0, shear * std::sin(angle), -2.0 * pull / 3.0};
}

void add_column(const DepthColumns& columns, int i, int j, double yield_stress, bool plug_pulls,
                MaterialState& state) {
  constexpr int levels = 32;
  const bool in_space = columns.plan == DepthColumns::Plan::squares;
  const double depth = columns.depth[static_cast<std::size_t>(i + columns.along_x * j)];
  if (!(depth > 0.0)) return;
  const double west = i * columns.width, south = in_space ? j * columns.width : 0.0;
  const double east = west + columns.width, north = in_space ? south + columns.width : 0.0;
  const double angle = in_space ? std::atan2(south + north, west + east) : 0.0;
  const double volume = depth * DepthColumns::area(columns.plan, west, east, south, north) / levels;
  for (int level = 0; level < levels; ++level) {
    runs::Parcel parcel;
    parcel.low = {west, south, depth * level / levels};
    parcel.high = {east, north, depth * (level + 1) / levels};
    parcel.volume = volume;
    parcel.stress = stress_at((level + 0.5) / levels, angle, yield_stress, plug_pulls);
    parcel.flocculation = 0.0;
    state.parcels.push_back(parcel);
  }
}

}  // namespace

void check_arrests(const Scene& scene, const Bingham& material) {
  const auto& cone = scene.slump();
  if (scene.base.law != scenes::Wall::no_slip)
    refuse(scene, "the arrested profiles hold on a base without slip");
  if (!(material.yield_stress > 0.0)) refuse(scene, "without a yield stress the material spreads for ever");
  if (!(scene.forces.gravity > 0.0)) refuse(scene, "without gravity nothing slumps");
  const bool plane_flow = scene.geometry.dimension == Dimension::plane;
  const double half_area = 0.5 * (cone.cone_radius_top + cone.cone_radius_bottom) * cone.cone_height;
  const double foot = std::numbers::pi * cone.cone_radius_bottom * cone.cone_radius_bottom;
  const double base_stress = material.density * scene.forces.gravity *
                             (plane_flow ? half_area / cone.cone_radius_bottom : cone.volume() / foot);
  // Uniaxial compression yields at sqrt(3) tau0, plane compression at 2 tau0 (von Mises).
  if (base_stress < (plane_flow ? 2.0 : std::numbers::sqrt3) * material.yield_stress)
    refuse(scene,
           fmt::format(
               "the yield stress is so high that the cone stands: its weight over its foot, {:.0f} Pa, is "
               "less than makes it yield",
               base_stress));
}

MaterialState arrested_state(const std::string& from, const Scene& scene) {
  const Asked asked = asked_by(from, scene);
  MaterialState state;
  state.from = from;
  state.solver = "exact";
  state.model = asked.solution;
  state.run = fmt::format("{}, arrested shape of {}", asked.scene.name,
                          asked.solution == "second-order" ? "second order" : "leading order");
  state.kind = scenes::name_of(asked.scene.geometry.apparatus);
  state.dimension = asked.scene.geometry.dimension;
  state.density = asked.scene.material.density;
  if (!runs::can_be_handed_over(asked.scene)) return state;  // it is refused by what it is
  const Bingham material = material_of(asked.scene, asked.flocculation);
  check_arrests(asked.scene, material);
  const Shape shape = shape_of(asked, material, from);
  state.columns = columns_of(shape, plan_of(state.dimension));
  for (int j = 0; j < state.columns.along_y; ++j)
    for (int i = 0; i < state.columns.along_x; ++i)
      add_column(state.columns, i, j, material.yield_stress, shape.plug_pulls, state);
  if (asked.flocculation) {
    state.flocculates = true;
    for (runs::Parcel& parcel : state.parcels) parcel.flocculation = *asked.flocculation;
  }
  return state;
}

}  // namespace flowrest::compare::exact
