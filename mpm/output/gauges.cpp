#include "mpm/output/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mpm/solver/settings.h"
#include "runs/depth.h"
#include "runs/gauges.h"

namespace flowrest::mpm {

namespace {

/// A value and the mass that has it.
using Weighted = std::pair<double, double>;

/// The value that `share` of the mass does not exceed; nothing without mass. Reorders the values.
double quantile(std::vector<Weighted>& values, double share) {
  std::sort(values.begin(), values.end());
  double total = 0.0;
  for (const auto& v : values) total += v.second;
  double sum = 0.0;
  for (const auto& v : values)
    if ((sum += v.second) >= share * total) return v.first;
  return values.empty() ? runs::nothing : values.back().first;
}

/// The value of particles (`value_of(batch, particle)`, of their motion) that `share` of the mass does not
/// exceed. Looked at alone, so that no more than one list of all particles is in memory at a time.
template <class ValueOf>
double quantile_of_motion(Solver& solver, double share, const ValueOf& value_of) {
  std::vector<Weighted> values;
  values.reserve(solver.particle_count());
  solver.visit_motion([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) values.emplace_back(value_of(b, i), b.mass[i]);
  });
  return quantile(values, share);
}

/// Sums common to every kind of scene.
class Sums {
 public:
  Sums(const scenes::Scene& scene, double factor, const Solver& solver)
      : gravity_(scene.forces.gravity), density_(scene.material.density), factor_(factor) {
    rates_.reserve(solver.particle_count());
  }

  void add(const ParticleBatch& b, std::size_t vertical) {
    for (std::size_t i = 0; i < b.count; ++i) {
      double speed_squared = 0.0;
      for (const auto& v : b.velocity) speed_squared += v[i] * v[i];
      kinetic_ += 0.5 * b.mass[i] * speed_squared;
      potential_ += b.mass[i] * gravity_ * b.position[vertical][i];
      elastic_ += b.elastic_energy[i];
      mass_ += b.mass[i];
      volume_ += b.volume[i];
      momentum_ += b.mass[i] * b.velocity[0][i];
      if (!b.flocculation.empty()) flocculation_ += b.mass[i] * b.flocculation[i];
      rates_.emplace_back(b.rate[i], b.mass[i]);
      highest_ = std::max(highest_, b.position[vertical][i]);
    }
  }

  Measures finish() {
    Measures m;
    m.energies.kinetic = factor_ * kinetic_;
    m.energies.potential = factor_ * potential_;
    m.energies.elastic = factor_ * elastic_;
    m.volume = factor_ * volume_;
    m.volume_at_rest = factor_ * mass_ / density_;
    m.mean_velocity = momentum_ / mass_;
    m.flocculation_mean = flocculation_ / mass_;
    m.highest = highest_;
    m.shear_rate_p99 = quantile(rates_, 0.99);
    return m;
  }

 private:
  double gravity_, density_, factor_;
  double kinetic_ = 0.0, potential_ = 0.0, elastic_ = 0.0, mass_ = 0.0, volume_ = 0.0, momentum_ = 0.0,
         flocculation_ = 0.0;
  double highest_ = 0.0;
  std::vector<Weighted> rates_;
};

}  // namespace

Gauges::Gauges(const scenes::Scene& scene)
    : scene_(scene), factor_(whole_body_factor(scene)), cell_(cell_size(scene)) {}

Measures Gauges::measure(Solver& solver) const {
  switch (scene_.kind()) {
    case scenes::Kind::slump:
      return measure_slump(solver);
    case scenes::Kind::duct:
      return measure_duct(solver);
    case scenes::Kind::l_box:
    case scenes::Kind::dam_break:
      return measure_channel(solver);
    case scenes::Kind::v_funnel:
      return measure_v_funnel(solver);
  }
  throw std::logic_error("a kind of scene without gauges");
}

Measures Gauges::measure_slump(Solver& solver) const {
  const auto vertical = static_cast<std::size_t>(vertical_axis(scene_));
  double farthest = 0.0;
  const auto radius_of = [&](const ParticleBatch& b, std::size_t i) {
    return vertical == 2 ? std::hypot(b.position[0][i], b.position[1][i]) : std::abs(b.position[0][i]);
  };
  const double spread_mass_995 =
      2.0 * quantile_of_motion(solver, 0.995, [&](const ParticleBatch& b, std::size_t i) {
        const double radius = radius_of(b, i);
        farthest = std::max(farthest, radius);
        return radius;
      });
  Sums sums(scene_, factor_, solver);
  // A plane column's depth is volume per length and unit width on either side of the middle.
  const bool plane = scene_.geometry.dimension == scenes::Dimension::plane;
  std::vector<double> depth(plane ? static_cast<std::size_t>(farthest / cell_) + 2 : 0, 0.0);
  runs::RadialDepthAccumulator rings(cell_, farthest + 2.0 * cell_);
  solver.visit([&](const ParticleBatch& b) {
    sums.add(b, vertical);
    for (std::size_t i = 0; i < b.count; ++i) {
      const double radius = radius_of(b, i);
      if (plane)
        depth[static_cast<std::size_t>(radius / cell_)] += b.volume[i] / cell_;
      else
        rings.add(radius, factor_ * b.volume[i]);
    }
  });
  Measures m = sums.finish();
  m.farthest = farthest;
  m.spread_mass_995 = spread_mass_995;
  m.coordinate = plane ? std::vector<double>{} : rings.depth().centres();
  m.value = plane ? depth : rings.depth().depth;
  for (std::size_t i = 0; i < depth.size(); ++i)
    m.coordinate.push_back((static_cast<double>(i) + 0.5) * cell_);
  return m;
}

Measures Gauges::measure_duct(Solver& solver) const {
  Sums sums(scene_, factor_, solver);
  // One bin a lattice row, so that a lattice's rows are seen one by one and not smeared.
  const double width = cell_ / scene_.mpm.particles_per_cell.back();
  const auto bins = static_cast<std::size_t>(std::lround(scene_.duct().height / width));
  std::vector<double> mass(bins, 0.0), height(bins, 0.0), momentum(bins, 0.0);
  solver.visit([&](const ParticleBatch& b) {
    sums.add(b, 1);
    for (std::size_t i = 0; i < b.count; ++i) {
      const auto bin = std::min(static_cast<std::size_t>(b.position[1][i] / width), bins - 1);
      mass[bin] += b.mass[i];
      height[bin] += b.mass[i] * b.position[1][i];
      momentum[bin] += b.mass[i] * b.velocity[0][i];
    }
  });
  Measures m = sums.finish();
  for (std::size_t i = 0; i < bins; ++i) {
    if (mass[i] == 0.0) continue;
    m.coordinate.push_back(height[i] / mass[i]);
    m.value.push_back(momentum[i] / mass[i]);
  }
  return m;
}

Measures Gauges::measure_channel(Solver& solver) const {
  const double front_mass_995 = quantile_of_motion(
      solver, 0.995, [](const ParticleBatch& b, std::size_t i) { return b.position[0][i]; });
  Sums sums(scene_, factor_, solver);
  const bool box = scene_.kind() == scenes::Kind::l_box;
  const double length = box ? scene_.l_box().length() : scene_.dam_break().tank_length;
  const double begin = box ? scene_.l_box().reservoir_length : 0.0;
  const bool plane = scene_.spatial_dimension() == 2;
  const double width = plane ? 1.0 : box ? scene_.l_box().width : scene_.dam_break().width;
  const auto bins = static_cast<std::size_t>(std::max(1.0, std::round(length / cell_)));
  const double spacing = length / static_cast<double>(bins);
  std::vector<double> volume(bins, 0.0);
  const auto vertical = static_cast<std::size_t>(vertical_axis(scene_));
  solver.visit([&](const ParticleBatch& b) {
    sums.add(b, vertical);
    for (std::size_t i = 0; i < b.count; ++i) {
      const double x = b.position[0][i];
      volume[static_cast<std::size_t>(std::clamp(x / spacing, 0.0, static_cast<double>(bins - 1)))] +=
          b.volume[i];
    }
  });
  Measures m = sums.finish();
  for (std::size_t i = 0; i < bins; ++i) {
    m.coordinate.push_back((static_cast<double>(i) + 0.5) * spacing);
    m.value.push_back(factor_ * volume[i] / (spacing * width));
  }
  m.front = runs::front(m.coordinate, m.value, length, scene_.gauges.front_depth) - begin;
  m.front_mass_995 = front_mass_995 - begin;
  const double over = scene_.gauges.end_length;
  m.end_height = runs::depth_at_end(m.value, spacing, runs::ChannelEnd::last, over);
  m.start_height = runs::depth_at_end(m.value, spacing, runs::ChannelEnd::first, over);
  return m;
}

Measures Gauges::measure_v_funnel(Solver& solver) const {
  const auto& g = scene_.v_funnel();
  Sums sums(scene_, factor_, solver);
  const auto up = static_cast<std::size_t>(vertical_axis(scene_));
  const bool full = scene_.geometry.dimension == scenes::Dimension::full, space = up == 2;
  // Lines of sight through the outlet, one a cell, and the profile over the whole width.
  const double side = 0.5 * g.outlet_width, deep = 0.5 * g.depth;
  const auto lines_of = [&](double half) {
    return static_cast<std::size_t>(std::max(1.0, std::round(half / cell_)));
  };
  const std::size_t across = lines_of(side), behind = space ? lines_of(deep) : 1;
  const double line_area =
      side / static_cast<double>(across) * (space ? deep / static_cast<double>(behind) : 1.0);
  std::vector<double> sight(across * behind, 0.0);
  const auto bins = lines_of(0.5 * g.top_width);
  const double spacing = 0.5 * g.top_width / static_cast<double>(bins);
  std::vector<double> volume(bins, 0.0);
  double below = 0.0, total = 0.0;
  solver.visit([&](const ParticleBatch& b) {
    sums.add(b, up);
    for (std::size_t i = 0; i < b.count; ++i) {
      total += b.mass[i];
      if (b.position[up][i] < 0.0) {
        below += b.mass[i];
        continue;
      }
      const double x = std::abs(b.position[0][i]), y = space ? std::abs(b.position[1][i]) : 0.0;
      volume[std::min(bins - 1, static_cast<std::size_t>(x / spacing))] += b.volume[i];
      if (x >= side || y >= deep) continue;
      const auto column =
          std::min(across - 1, static_cast<std::size_t>(x / side * static_cast<double>(across)));
      const auto row =
          space ? std::min(behind - 1, static_cast<std::size_t>(y / deep * static_cast<double>(behind))) : 0;
      sight[column * behind + row] += b.volume[i] / line_area;
    }
  });
  Measures m = sums.finish();
  // A whole funnel folds onto the lines of one quarter.
  const double folded = full ? 4.0 : 1.0;
  for (std::size_t i = 0; i < bins; ++i) {
    m.coordinate.push_back((static_cast<double>(i) + 0.5) * spacing);
    m.value.push_back(volume[i] / folded / (spacing * (space ? deep : 1.0)));
  }
  m.discharged = below / total;
  m.thinnest_over_outlet = *std::min_element(sight.begin(), sight.end()) / folded;
  return m;
}

std::vector<std::string> Gauges::columns() const {
  std::vector<std::string> names = {"time_s"};
  const auto add = [&](const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  switch (scene_.kind()) {
    case scenes::Kind::slump:
      add({"spread_mm", "spread_1p5_mm", "spread_6_mm", "spread_mass_995_mm", "height_mm"});
      break;
    case scenes::Kind::duct:
      add({"plug_velocity_m_s", "mean_velocity_m_s"});
      break;
    case scenes::Kind::l_box:
    case scenes::Kind::dam_break:
      add({"front_mm", "front_mass_995_mm", "end_height_mm", "start_height_mm"});
      break;
    case scenes::Kind::v_funnel:
      add({"discharged_fraction", "thinnest_sight_mm"});
      break;
  }
  names.insert(names.end(), {"volume_m3", "volume_at_rest_m3", "kinetic_energy_J", "potential_energy_J",
                             "elastic_energy_J", "dissipated_energy_J", "numerical_energy_J",
                             "shear_rate_p99_1_s", "time_step_s"});
  if (scene_.thixotropy) names.push_back("flocculation_mean");
  return names;
}

std::vector<double> Gauges::row(double time, double step, const Measures& m) const {
  std::vector<double> row = {time};
  switch (scene_.kind()) {
    case scenes::Kind::slump:
      for (const double times : {1.0, 0.5, 2.0})
        row.push_back(1e3 * runs::spread(m.coordinate, m.value, times * scene_.gauges.spread_depth));
      row.push_back(1e3 * m.spread_mass_995);
      row.push_back(1e3 * runs::centre_depth(m.coordinate, m.value, scene_.gauges.spread_depth));
      break;
    case scenes::Kind::duct:
      row.insert(row.end(), {headline_value(m), m.mean_velocity});
      break;
    case scenes::Kind::l_box:
    case scenes::Kind::dam_break:
      row.insert(row.end(),
                 {1e3 * m.front, 1e3 * m.front_mass_995, 1e3 * m.end_height, 1e3 * m.start_height});
      break;
    case scenes::Kind::v_funnel:
      row.insert(row.end(), {m.discharged, 1e3 * m.thinnest_over_outlet});
      break;
  }
  const Energies& e = m.energies;
  row.insert(row.end(), {m.volume, m.volume_at_rest, e.kinetic, e.potential, e.elastic, e.dissipated,
                         e.numerical, m.shear_rate_p99, step});
  if (scene_.thixotropy) row.push_back(m.flocculation_mean);
  return row;
}

double Gauges::headline_value(const Measures& m) const {
  if (scene_.kind() == scenes::Kind::slump)
    return 1e3 * runs::spread(m.coordinate, m.value, scene_.gauges.spread_depth);
  if (scene_.kind() == scenes::Kind::v_funnel) return 100.0 * m.discharged;
  if (scene_.kind() != scenes::Kind::duct) return 1e3 * m.front;
  // The plug is the middle of the duct: the mean of the innermost two rows.
  const std::size_t middle = m.value.size() / 2;
  return m.value.size() < 2 ? runs::nothing : 0.5 * (m.value[middle - 1] + m.value[middle]);
}

std::string Gauges::headline(const Measures& m) const {
  switch (scene_.kind()) {
    case scenes::Kind::slump:
      return runs::shown_length("spread", 1e-3 * headline_value(m), scene_.gauges.spread_depth);
    case scenes::Kind::duct:
      return fmt::format("plug {:.4f} m/s", headline_value(m));
    case scenes::Kind::v_funnel:
      return fmt::format("discharged {:.1f} %", headline_value(m));
    default:
      return runs::shown_length("front", 1e-3 * headline_value(m), scene_.gauges.front_depth);
  }
}

}  // namespace flowrest::mpm
