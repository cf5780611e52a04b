#include "mpm/gauges/gauges.h"

#include <algorithm>

#include "mpm/solver/settings.h"
#include "runs/quantile.h"

namespace flowrest::mpm {

namespace {

/// Sums that every body has.
class Sums {
 public:
  Sums(const scenes::Scene& scene, double factor, const runs::Rest& rest, std::size_t particles, double time)
      : gravity_(scene.forces.gravity),
        density_(scene.material.density),
        factor_(factor),
        grown_(scene.grown_over_yield_stress(time)),
        rest_(rest) {
    rates_.reserve(particles);
    // Without flocculation the overstress of all is in proportion to their shear rate.
    flocculates_ = scene.thixotropy && rest.can_rest();
    if (flocculates_) overstresses_.reserve(particles);
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
      rates_.emplace_back(b.rate[i], b.mass[i]);
      if (!b.flocculation.empty()) flocculation_ += b.mass[i] * b.flocculation[i];
      if (flocculates_)
        overstresses_.emplace_back(rest_.overstress(b.rate[i], b.flocculation[i] + grown_), b.mass[i]);
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
    m.flocculation_mean = flocculation_ / mass_;
    m.highest = highest_;
    m.shear_rate_p99 = runs::quantile(rates_, 0.99);
    m.overstress_p99 =
        flocculates_ ? runs::quantile(overstresses_, 0.99) : rest_.overstress(m.shear_rate_p99);
    return m;
  }

 private:
  double gravity_, density_, factor_;
  double grown_;  ///< with age, over tau0
  const runs::Rest& rest_;
  bool flocculates_ = false;
  double kinetic_ = 0.0, potential_ = 0.0, elastic_ = 0.0, mass_ = 0.0, volume_ = 0.0, flocculation_ = 0.0;
  double highest_ = 0.0;
  std::vector<runs::Weighted> rates_, overstresses_;
};

/// The layer along the walls that is sheared: no list of particles, only bins over the distance.
class Layer {
 public:
  Layer(const scenes::Scene& scene, const runs::HeldWalls& walls, double cell)
      : walls_(walls), cell_(cell), extent_(cell / scene.mpm.particles_per_cell.back()) {}

  void add(const ParticleBatch& b, std::size_t vertical) {
    if (!walls_.any()) return;
    for (std::size_t i = 0; i < b.count; ++i) {
      const double across = vertical == 2 ? b.position[1][i] : 0.0;
      meter_.add({walls_.distance(b.position[0][i], across, b.position[vertical][i]), extent_, cell_,
                  b.volume[i], b.rate[i]});
    }
  }
  runs::ShearedLayer finish() const { return meter_.layer(); }

 private:
  const runs::HeldWalls& walls_;
  double cell_, extent_;  ///< m, of a cell and of what a particle takes up of it
  runs::LayerMeter meter_;
};

}  // namespace

Gauges::Gauges(const scenes::Scene& scene, const scenes::Pieces& pieces)
    : scene_(scene),
      pieces_(pieces),
      rest_(scene),
      held_walls_(pieces, scene.spatial_dimension()),
      cell_(cell_size(scene)) {}

Measures Gauges::measure(Solver& solver, double time) const {
  const auto vertical = static_cast<std::size_t>(vertical_axis(scene_));
  Layer layer(scene_, held_walls_, cell_);
  const auto gauge = body_gauge({scene_, pieces_, cell_, vertical, time});
  gauge->begin(solver);
  Sums sums(scene_, pieces_.whole_over_computed, rest_, solver.particle_count(), time);
  solver.visit([&](const ParticleBatch& b) {
    sums.add(b, vertical);
    layer.add(b, vertical);
    gauge->add(b);
  });
  Measures m = sums.finish();
  if (laws::has_yield_stress(scene_.material.model))
    m.yield_stress_mean = scene_.local_yield_stress(m.flocculation_mean, time);
  m.body = gauge->finish();
  m.layer = layer.finish();
  return m;
}

runs::Row Gauges::row(double time, double step, const Measures& m, const runs::Row& layer) const {
  using namespace runs::column;
  const Energies& e = m.energies;
  runs::Row row;
  row.add(runs::column::time, time)
      .add(m.body.columns)
      .add(volume, m.volume)
      .add(volume_at_rest, m.volume_at_rest)
      .add(kinetic_energy, e.kinetic)
      .add(potential_energy, e.potential)
      .add(elastic_energy, e.elastic)
      .add(dissipated_energy, e.dissipated)
      .add(numerical_energy, e.numerical)
      .add(shear_rate, m.shear_rate_p99)
      .add(layer)
      .add(time_step, step);
  if (scene_.thixotropy) row.add(flocculation, m.flocculation_mean).add(yield_stress, m.yield_stress_mean);
  return row;
}

}  // namespace flowrest::mpm
