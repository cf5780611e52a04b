#include "compare/exact/exact_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "compare/exact/channel.h"
#include "compare/exact/film.h"
#include "compare/exact/solutions.h"
#include "runs/depth.h"
#include "runs/gauges.h"
#include "runs/run_directory.h"

namespace flowrest::compare::exact {

namespace {

using runs::RunError;
using scenes::Scene;

[[noreturn]] void refuse(const Scene& scene, const std::string& why) {
  throw RunError(fmt::format("{}: this scene has no exact solution here: {}", scene.path.string(), why));
}

/// The scene's material with the yield stress that its structure gives it (Yu et al. 2026, Eq. 11).
Bingham material_of(const Scene& scene, std::optional<double> flocculation = std::nullopt) {
  if (scene.thixotropy && !flocculation)
    refuse(
        scene,
        "a thixotropic yield stress changes with the flow's history; --flocculation gives what it is in the "
        "end, such as the last flocculation_mean of a run");
  if (flocculation && !scene.thixotropy)
    refuse(scene, "--flocculation is given, and its material is not thixotropic");
  if (flocculation && !(*flocculation >= 0.0 && std::isfinite(*flocculation)))
    refuse(scene, fmt::format("--flocculation {:g}; allowed: from 0", *flocculation));
  return {scene.material.density, scene.material.yield_stress * (1.0 + flocculation.value_or(0.0)),
          scene.material.plastic_viscosity, scene.material.flow_index};
}

/// Opens the folder of a solution. What it takes besides the scene stands in its run.json.
runs::RunWriter open_run(const std::filesystem::path& directory, const Scene& scene,
                         std::optional<double> flocculation, runs::Replace replace) {
  auto beside = nlohmann::ordered_json::object();
  beside["flocculation"] = flocculation ? nlohmann::ordered_json(*flocculation) : nlohmann::ordered_json();
  return runs::RunWriter(runs::RunFolder(directory, scene, "exact", replace, beside));
}

/// Points from the middle to the edge, closer towards the edge where the depth falls steeply, and one just
/// beyond it.
std::vector<double> points_to(double edge) {
  constexpr int count = 200;
  std::vector<double> points;
  for (int i = count; i >= 0; --i) {
    const double x = static_cast<double>(i) / count;
    points.push_back(edge * (1.0 - x * x));
  }
  points.push_back(edge * (1.0 + 1e-9));
  return points;
}

runs::Row slump_row(double time, double spread, double height, double volume) {
  return runs::Row()
      .add(runs::column::time, time)
      .add(runs::column::spread, spread)
      .add(runs::column::height, height)
      .add(runs::column::volume, volume);
}

template <class Profile>
ExactRun write_slump(const Scene& scene, const std::filesystem::path& directory, const Profile& profile,
                     double edge, double volume, const std::string& label, const std::string& source,
                     std::optional<double> flocculation, runs::Replace replace) {
  runs::RunWriter writer = open_run(directory, scene, flocculation, replace);
  std::vector<double> coordinate = points_to(edge), depth;
  for (const double r : coordinate) depth.push_back(profile.depth(r));
  const double spread_depth = scene.gauges.spread_depth, spread = profile.spread(spread_depth);
  writer.info()["model"] = "bingham";
  writer.info()["label"] = label;
  writer.info()["source"] = source;
  writer.info()["radius_m"] = edge;
  writer.history(slump_row(scene.time.end, spread, profile.depth(0.0), volume));
  writer.profile(scene.time.end, coordinate, depth);
  writer.finish(runs::Status::at_rest, "the arrested shape, reached without inertia", "sound");
  return {directory, fmt::format("{}: {} at {:g} mm depth ({} at its foot), {}", label,
                                 runs::shown_length("spread", spread, spread_depth), 1000.0 * spread_depth,
                                 runs::millimetres(2.0 * edge, spread_depth),
                                 runs::shown_length("centre", profile.depth(0.0), spread_depth))};
}

std::vector<ExactRun> write_slumps(const Scene& scene, const std::filesystem::path& directory,
                                   std::optional<double> flocculation, runs::Replace replace) {
  const Bingham material = material_of(scene, flocculation);
  const auto& cone = scene.slump();
  if (scene.base.law != scenes::Wall::no_slip)
    refuse(scene, "the arrested profiles hold on a base without slip");
  if (!(material.yield_stress > 0.0)) refuse(scene, "without a yield stress the material spreads for ever");
  if (!(scene.forces.gravity > 0.0)) refuse(scene, "without gravity nothing slumps");
  const bool plane_flow = scene.geometry.dimension == scenes::Dimension::plane;
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
  const auto must_spread = [&](double radius) {
    if (radius < cone.cone_radius_bottom)
      refuse(scene,
             fmt::format(
                 "the slender profile (radius {:.0f} mm) would be narrower than the cone (foot {:.0f} mm)",
                 1000.0 * radius, 1000.0 * cone.cone_radius_bottom));
  };
  if (plane_flow) {
    const auto plane = plane_slump(material, scene.forces.gravity, half_area);
    must_spread(plane.half_width);
    return {write_slump(scene, directory / "leading-order", plane, plane.half_width, 2.0 * half_area,
                        "exact, leading order (plane)", "h^2 = 2 tau0 (X - x)/(rho g)", flocculation,
                        replace)};
  }
  const auto leading = leading_order_slump(material, scene.forces.gravity, cone.volume());
  const auto second = second_order_slump(material, scene.forces.gravity, cone.volume());
  must_spread(leading.radius);
  return {
      write_slump(scene, directory / "leading-order", leading, leading.radius, leading.volume(),
                  "exact, leading order", "Yu et al. 2026, Eq. 51, with h = sqrt(2 tau0 (R - r)/(rho g))",
                  flocculation, replace),
      write_slump(scene, directory / "second-order", second, second.radius, second.volume(),
                  "exact, second order", "h = a + sqrt(a^2 + 2 tau0 (R - r)/(rho g)), a = 1.36 tau0/(rho g)",
                  flocculation, replace)};
}

std::vector<ExactRun> write_duct(const Scene& scene, const std::filesystem::path& directory,
                                 std::optional<double> flocculation, runs::Replace replace) {
  const Bingham material = material_of(scene, flocculation);
  const double height = scene.duct().height;
  if (scene.base.law != scenes::Wall::no_slip)
    refuse(scene, "the steady profile holds between plates without slip");
  if (!(material.plastic_viscosity > 0.0))
    refuse(scene, "without a plastic viscosity the flow has no steady state");
  if (scene.forces.body_force.empty()) refuse(scene, "no body force drives the duct");

  runs::RunWriter writer = open_run(directory / "steady", scene, flocculation, replace);
  const bool power = material.flow_index != 1.0;
  writer.info()["model"] = power ? "herschel-bulkley, not regularised" : "bingham";
  writer.info()["label"] = "exact, steady";
  writer.info()["source"] = power ? "Herschel and Bulkley's law over the linear stress between the plates"
                                  : "Yu et al. 2026, Eqs. 48-50";
  std::vector<double> coordinate, velocity;
  constexpr int points = 401;
  for (int i = 0; i < points; ++i)
    coordinate.push_back(height * (static_cast<double>(i) / (points - 1) - 0.5));
  std::string summary = "exact, steady:";
  const auto& force = scene.forces.body_force;
  double norm = 0.0;
  for (std::size_t stage = 0; stage < force.size(); ++stage) {
    const double end =
        stage + 1 < force.size() ? std::min(force[stage + 1].first, scene.time.end) : scene.time.end;
    if (!(end > force[stage].first)) break;
    const DuctFlow flow{material, height, force[stage].second};
    velocity.clear();
    for (const double y : coordinate) velocity.push_back(flow.velocity(y));
    // The steady state of a stage stands at the stage's end: how it comes about has no closed form.
    writer.history(runs::Row()
                       .add(runs::column::time, end)
                       .add(runs::column::plug_velocity, flow.plug_velocity())
                       .add(runs::column::mean_velocity, flow.mean_velocity()));
    writer.profile(end, coordinate, velocity);
    summary += fmt::format("{} plug {:.6f} m/s, mean {:.6f} m/s under {:g} N/m3", stage == 0 ? "" : ";",
                           flow.plug_velocity(), flow.mean_velocity(), force[stage].second);
    const double bound = stopping_time_bound(material, height, force[stage].second, norm);
    if (norm > 0.0 && std::isfinite(bound)) {
      writer.info()["stopping_time_bound_s"] = bound;
      summary += fmt::format(", at rest within {:.2f} s", bound);
    }
    norm = flow.l2_norm();
  }
  writer.finish(runs::Status::end_time, "the steady state of each stage, at its end", "sound");
  return {{directory / "steady", summary}};
}

std::vector<ExactRun> write_channel(const Scene& scene, const std::filesystem::path& directory,
                                    std::optional<double> flocculation, runs::Replace replace) {
  const Bingham material = material_of(scene, flocculation);
  const auto& box = scene.l_box();
  if (scene.base.law == scenes::Wall::slip)
    refuse(scene, "walls without friction hold nothing: the concrete levels out");
  if (!(material.yield_stress > 0.0)) refuse(scene, "without a yield stress the material levels out");
  if (!(scene.forces.gravity > 0.0)) refuse(scene, "without gravity nothing leaves the reservoir");
  const double friction = scene.base.law == scenes::Wall::friction ? scene.base.friction
                                                                   : std::numeric_limits<double>::infinity();
  const double volume = box.reservoir_length * box.width * box.reservoir_height;
  const ArrestedChannel shape(material, scene.forces.gravity, {box.width, box.length(), friction}, volume);
  if (shape.depth(box.reservoir_length) > box.channel_height)
    refuse(scene,
           fmt::format("it would fill the opening ({:.0f} mm), whose upper wall the solution does not have: "
                       "it stands at {:.0f} mm there",
                       1e3 * box.channel_height, 1e3 * shape.depth(box.reservoir_length)));
  const double front_depth = scene.gauges.front_depth;
  const double front = shape.reach(front_depth) - box.reservoir_length;
  const double end = shape.end_height(), start = shape.start_height();
  const std::string label =
      flocculation ? fmt::format("exact, arrested, flocculation {:g}", *flocculation) : "exact, arrested";
  runs::RunWriter writer = open_run(directory / "arrested", scene, flocculation, replace);
  writer.info()["model"] = "bingham";
  writer.info()["label"] = label;
  writer.info()["source"] =
      "yield stress on floor and side walls against the weight (Nguyen, Roussel and Coussot 2006), no bars";
  writer.history(runs::Row()
                     .add(runs::column::time, scene.time.end)
                     .add(runs::column::front, front)
                     .add(runs::column::end_height, end)
                     .add(runs::column::start_height, start)
                     .add(runs::column::volume, volume));
  std::vector<double> coordinate = points_to(shape.front()), depth;
  for (const double x : coordinate) depth.push_back(shape.depth(x));
  writer.profile(scene.time.end, coordinate, depth);
  writer.finish(runs::Status::at_rest, "the arrested shape, reached without inertia", "sound");
  const auto mm = [&](double length) { return runs::millimetres(length, front_depth); };
  return {{directory / "arrested",
           end > 0.0
               ? fmt::format("{}: reaches the end, {} high there, {} at the start", label, mm(end), mm(start))
               : fmt::format("{}: {}, {} high at the start", label,
                             runs::shown_length("front", front, front_depth), mm(start))}};
}

}  // namespace

void check_film(const Scene& scene) {
  if (scene.kind() != scenes::Kind::slump || scene.geometry.dimension == scenes::Dimension::plane)
    refuse(scene, "a thin film spreads from a slump about its axis");
  if (scene.thixotropy || scene.base.law != scenes::Wall::no_slip || !(scene.forces.gravity > 0.0) ||
      !(scene.material.yield_stress > 0.0) || !(scene.material.plastic_viscosity > 0.0) ||
      scene.material.flow_index != 1.0)
    refuse(scene,
           "the film is of Bingham material without thixotropy, under gravity, on a base without slip");
}

ExactRun write_film_run(const Scene& scene, const std::filesystem::path& directory, bool plug_pulls,
                        runs::Replace replace) {
  check_film(scene);
  constexpr int rings = 225;
  const Bingham material = material_of(scene);
  const auto& cone = scene.slump();
  const double gravity = scene.forces.gravity;
  SpreadingFilm film = bingham_film(material, gravity, cone.cone_radius_bottom, cone.volume(),
                                    cone.domain_radius, rings, plug_pulls);
  runs::RunWriter writer = open_run(directory, scene, std::nullopt, replace);
  writer.info()["model"] = "bingham";
  const std::string label = plug_pulls ? "thin film under its plug's pull, Bingham" : "thin film, Bingham";
  writer.info()["label"] = label;
  writer.info()["source"] = "lubrication of a yield-stress film (Liu and Mei 1989), solved numerically";
  const auto& output = scene.output;
  const auto rows = static_cast<int>(std::ceil(scene.time.end / output.history_interval * (1.0 - 1e-12)));
  const int rows_per_profile =
      std::max(1, static_cast<int>(std::lround(output.profile_interval / output.history_interval)));
  const double spread_depth = scene.gauges.spread_depth;
  double spread = 0.0, height = 0.0;
  for (int row = 0; row <= rows; ++row) {
    film.advance_to(std::min(row * output.history_interval, scene.time.end));
    const auto& state = film.state();
    const auto radius = state.centres();
    spread = runs::spread(radius, state.depth, spread_depth);
    height = runs::centre_depth(radius, state.depth, spread_depth);
    writer.history(slump_row(state.time, spread, height, state.volume()));
    if (row % rows_per_profile == 0 || row == rows) writer.profile(state.time, radius, state.depth);
  }
  writer.finish(runs::Status::end_time, "", "sound");
  return {directory, fmt::format("{}: {} at {:g} s, still growing; {}", label,
                                 runs::shown_length("spread", spread, spread_depth), scene.time.end,
                                 runs::shown_length("centre", height, spread_depth))};
}

std::vector<ExactRun> write_exact_runs(const Scene& scene, const std::filesystem::path& directory,
                                       std::optional<double> flocculation, runs::Replace replace) {
  if (std::filesystem::exists(directory / "run.json"))
    throw RunError(fmt::format("{}: is itself a run; name the folder that shall hold the exact runs",
                               directory.string()));
  switch (scene.kind()) {
    case scenes::Kind::slump:
      return write_slumps(scene, directory, flocculation, replace);
    case scenes::Kind::duct:
      return write_duct(scene, directory, flocculation, replace);
    case scenes::Kind::l_box:
      return write_channel(scene, directory, flocculation, replace);
    default:
      break;
  }
  refuse(scene, "none is known for this kind of scene");
}

}  // namespace flowrest::compare::exact
