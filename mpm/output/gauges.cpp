#include "mpm/output/gauges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/solver/settings.h"
#include "runs/depth.h"

namespace flowrest::mpm {

namespace {

/// A value and the mass that has it.
using Weighted = std::pair<double, double>;

/// The value that `share` of the mass does not exceed. Reorders the values.
double quantile(std::vector<Weighted>& values, double share) {
  std::sort(values.begin(), values.end());
  double total = 0.0;
  for (const auto& v : values) total += v.second;
  double sum = 0.0;
  for (const auto& v : values)
    if ((sum += v.second) >= share * total) return v.first;
  return values.empty() ? 0.0 : values.back().first;
}

/// Sums common to every kind of scene.
class Sums {
 public:
  Sums(const scenes::Scene& scene, double factor)
      : gravity_(scene.forces.gravity), density_(scene.material.density), factor_(factor) {}

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
  return scene_.kind == scenes::Kind::duct ? measure_duct(solver) : measure_slump(solver);
}

Measures Gauges::measure_slump(Solver& solver) const {
  Sums sums(scene_, factor_);
  std::vector<Weighted> radii;
  std::vector<std::pair<double, double>> volumes;
  const auto vertical = static_cast<std::size_t>(vertical_axis(scene_));
  double farthest = 0.0;
  solver.visit([&](const ParticleBatch& b) {
    sums.add(b, vertical);
    for (std::size_t i = 0; i < b.count; ++i) {
      const double radius =
          vertical == 2 ? std::hypot(b.position[0][i], b.position[1][i]) : std::abs(b.position[0][i]);
      farthest = std::max(farthest, radius);
      radii.emplace_back(radius, b.mass[i]);
      volumes.emplace_back(radius, b.volume[i]);
    }
  });
  Measures m = sums.finish();
  m.farthest = farthest;
  runs::RadialDepthAccumulator rings(cell_, farthest + 2.0 * cell_);
  if (scene_.geometry.dimension == scenes::Dimension::plane) {
    // A plane column's depth is volume per length and unit width on either side of the middle.
    const auto bins = static_cast<std::size_t>(farthest / cell_) + 2;
    std::vector<double> depth(bins, 0.0);
    for (const auto& [x, volume] : volumes) depth[static_cast<std::size_t>(x / cell_)] += volume / cell_;
    m.value = depth;
    for (std::size_t i = 0; i < bins; ++i) m.coordinate.push_back((static_cast<double>(i) + 0.5) * cell_);
  } else {
    for (const auto& [radius, volume] : volumes) rings.add(radius, factor_ * volume);
    const runs::RadialDepth depth = rings.depth();
    m.coordinate = depth.centres();
    m.value = depth.depth;
  }
  m.spread_mass_995 = 2.0 * quantile(radii, 0.995);
  return m;
}

Measures Gauges::measure_duct(Solver& solver) const {
  Sums sums(scene_, factor_);
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

std::vector<std::string> Gauges::columns() const {
  std::vector<std::string> names = {"time_s"};
  if (scene_.kind == scenes::Kind::duct) {
    names.insert(names.end(), {"plug_velocity_m_s", "mean_velocity_m_s"});
  } else {
    names.insert(names.end(),
                 {"spread_mm", "spread_1p5_mm", "spread_6_mm", "spread_mass_995_mm", "height_mm"});
  }
  names.insert(names.end(), {"volume_m3", "volume_at_rest_m3", "kinetic_energy_J", "potential_energy_J",
                             "elastic_energy_J", "dissipated_energy_J", "numerical_energy_J",
                             "shear_rate_p99_1_s", "time_step_s"});
  if (scene_.thixotropy) names.push_back("flocculation_mean");
  return names;
}

std::vector<double> Gauges::row(double time, double step, const Measures& m) const {
  std::vector<double> row = {time};
  if (scene_.kind == scenes::Kind::duct) {
    row.insert(row.end(), {headline_value(m), m.mean_velocity});
  } else {
    for (const double threshold : {0.003, 0.0015, 0.006})
      row.push_back(1e3 * runs::spread(m.coordinate, m.value, threshold));
    row.push_back(1e3 * m.spread_mass_995);
    row.push_back(1e3 * runs::centre_depth(m.coordinate, m.value));
  }
  const Energies& e = m.energies;
  row.insert(row.end(), {m.volume, m.volume_at_rest, e.kinetic, e.potential, e.elastic, e.dissipated,
                         e.numerical, m.shear_rate_p99, step});
  if (scene_.thixotropy) row.push_back(m.flocculation_mean);
  return row;
}

double Gauges::headline_value(const Measures& m) const {
  if (scene_.kind != scenes::Kind::duct) return 1e3 * runs::spread(m.coordinate, m.value);
  // The plug is the middle of the duct: the mean of the innermost two rows.
  const std::size_t middle = m.value.size() / 2;
  return m.value.size() < 2 ? 0.0 : 0.5 * (m.value[middle - 1] + m.value[middle]);
}

std::string Gauges::headline(const Measures& m) const {
  return scene_.kind == scenes::Kind::duct ? fmt::format("plug {:.4f} m/s", headline_value(m))
                                           : fmt::format("spread {:.1f} mm", headline_value(m));
}

}  // namespace flowrest::mpm
