#include "compare/synthetic_runs.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "compare/exact/solutions.h"
#include "runs/depth.h"

namespace flowrest::compare::synthetic {

using std::numbers::pi;

double Slump::radius_at(double time) const {
  return radius - (radius - 0.1) / std::pow(1.0 + time / rate, 2) + 0.5 * creep * time;
}

void write(const Slump& slump, const std::filesystem::path& directory) {
  const double length = slump.size, pace = std::sqrt(slump.size);  // of lengths; of times and speeds
  scenes::Overrides overrides;
  overrides.model = slump.model;
  if (slump.size != 1.0) {
    const auto base = scenes::load_scene("roussel-slump");
    const auto& cone = base.slump();
    for (const auto& [key, value] :
         {std::pair{"geometry.cone_height", length * cone.cone_height},
          {"geometry.cone_radius_top", length * cone.cone_radius_top},
          {"geometry.cone_radius_bottom", length * cone.cone_radius_bottom},
          {"geometry.domain_radius", length * cone.domain_radius},
          {"geometry.domain_height", length * cone.domain_height},
          {"mpm.cell", length * base.mpm.cell},
          {"foam.cell", length * base.foam.cell},
          {"material.yield_stress", length * base.material.yield_stress},
          {"material.plastic_viscosity", length * pace * base.material.plastic_viscosity},
          {"material.youngs_modulus", length * base.material.youngs_modulus},
          {"material.regularisation_time", pace * *base.material.regularisation_time}})
      overrides.set.push_back(fmt::format("{}={:.17g}", key, value));
  }
  overrides.set.insert(overrides.set.end(), slump.set.begin(), slump.set.end());
  const auto scene = scenes::load_scene("roussel-slump", overrides);
  runs::RunWriter writer(directory, scene, slump.solver, runs::Replace::anything);
  writer.history_columns({"time_s", "spread_mm", "height_mm", "volume_m3", "shear_rate_p99_1_s"});
  const double volume = scene.slump().volume();
  const auto height_of = [&](double radius) { return 15.0 * volume / (8.0 * pi * radius * radius); };
  const auto depth_at = [&](double time) {
    const double radius = length * slump.radius_at(time);
    runs::DepthAccumulator rings(runs::About::axis, length * slump.cell, length * 0.45,
                                 0.1 * length * slump.cell);
    constexpr int shells = 4000;
    for (int i = 0; i < shells; ++i) {
      const double width = radius / shells, r = (i + 0.5) * width;
      rings.add(r, 2.0 * pi * r * width * height_of(radius) * std::sqrt(1.0 - r / radius));
    }
    return rings;
  };
  const int rows = static_cast<int>(std::lround(slump.end / 0.05));
  for (int i = 0; i <= rows; ++i) {
    const double time = 0.05 * i;
    const double radius = slump.radius_at(time);
    const double spread = 2.0 * radius + slump.noise * std::sin(37.0 * time);
    const double shear_rate = 20.0 / std::pow(1.0 + time / slump.rate, 3) + slump.creep / 0.05;
    writer.history(std::vector{pace * time, 1e3 * length * spread, 1e3 * height_of(length * radius),
                               volume * (1.0 - 1e-5 * time / slump.end), shear_rate / pace});
    if (i % 5 == 0) {
      const auto rings = depth_at(time);
      writer.profile(pace * time, rings.centres(), rings.depth());
    }
  }
  writer.info()["cpu_s"] = slump.cpu;
  writer.info()["wall_s"] = 0.6 * slump.cpu;
  writer.info()["steps"] = rows * 100;
  if (slump.status == runs::Status::at_rest) writer.info()["rest_time_s"] = pace * slump.end;
  writer.finish(slump.status, slump.reason, slump.verdict);
}

void write(const Duct& duct, const std::filesystem::path& directory) {
  scenes::Overrides overrides;
  overrides.model = duct.model;
  const auto scene = scenes::load_scene("poiseuille-step-down", overrides);
  const auto& material = scene.material;
  const double height = scene.duct().height;
  const exact::DuctFlow flow{
      {material.density, material.yield_stress, material.plastic_viscosity, material.flow_index},
      height,
      scene.forces.body_force.front().second};
  const double step = scene.forces.body_force.back().first;
  runs::RunWriter writer(directory, scene, "mpm", runs::Replace::anything);
  writer.history_columns({"time_s", "plug_velocity_m_s", "mean_velocity_m_s"});
  for (int i = 0; i <= 400; ++i) {
    const double time = 0.05 * i;
    double factor = 1.0 - std::exp(-3.0 * time);
    if (time > step)
      factor = std::max(1.0 - (time - step) / duct.decay, 0.0) + duct.creep / flow.plug_velocity();
    writer.history(std::vector{time, factor * flow.plug_velocity(), factor * flow.mean_velocity()});
    if (i % 10 != 0) continue;
    std::vector<double> y, velocity;
    for (int j = 0; j < 50; ++j) {
      y.push_back(height * ((j + 0.5) / 50 - (duct.from_plate ? 0.0 : 0.5)));
      velocity.push_back(factor * flow.velocity(height * ((j + 0.5) / 50 - 0.5)));
    }
    writer.profile(time, y, velocity);
  }
  writer.info()["cpu_s"] = 3.0;
  writer.finish(runs::Status::end_time, "", "sound");
}

void write(const Box& box, const std::filesystem::path& directory) {
  scenes::Overrides overrides;
  overrides.model = box.model;
  overrides.set = box.set;
  const auto scene = scenes::load_scene("mix-b-lbox-sf600", overrides);
  const auto& geometry = scene.l_box();
  runs::RunWriter writer(directory, scene, "mpm", runs::Replace::anything);
  writer.history_columns({"time_s", "front_mm", "end_height_mm", "start_height_mm", "flocculation_mean"});
  for (int i = 0; i * 0.05 <= box.end + 1e-9; ++i) {
    const double time = 0.05 * i;
    const double front = std::min(box.front * (1.0 - std::exp(-time)), geometry.channel_length);
    const double lambda = time < 2.0 ? 4.4 - time : 2.4 + box.recovery * (time - 2.0);
    const bool arrived = front >= geometry.channel_length;
    writer.history(std::vector{time, 1e3 * front, arrived ? 40.0 : 0.0, 600.0 - 100.0 * front, lambda});
    if (i % 10 != 0) continue;
    std::vector<double> x, depth;
    constexpr int strips = 70;
    for (int j = 0; j < strips; ++j) {
      x.push_back((j + 0.5) * geometry.length() / strips);
      depth.push_back(0.1 * std::max(0.0, 1.0 - x.back() / (geometry.reservoir_length + front)));
    }
    writer.profile(time, x, depth);
  }
  writer.info()["cpu_s"] = 30.0;
  if (box.status == runs::Status::at_rest) writer.info()["rest_time_s"] = box.end;
  if (!box.walls_differ.empty()) writer.info()["walls_differ"] = box.walls_differ;
  writer.finish(box.status, "", "sound");
}

void write(const Funnel& funnel, const std::filesystem::path& directory) {
  scenes::Overrides overrides;
  overrides.model = funnel.model;
  overrides.set = funnel.set;
  const auto scene = scenes::load_scene("mix-a-vfunnel-sf0", overrides);
  runs::RunWriter writer(directory, scene, "mpm", runs::Replace::anything);
  writer.history_columns({"time_s", "discharged_fraction", "thinnest_sight_mm"});
  for (int i = 0; i <= 80; ++i) {
    const double time = 0.05 * i, left = std::max(0.0, 1.0 - time / funnel.empty);
    writer.history(std::vector{time, 1.0 - left, 600.0 * left});
  }
  writer.info()["cpu_s"] = 20.0;
  writer.finish(runs::Status::end_time, "", "sound");
}

}  // namespace flowrest::compare::synthetic
