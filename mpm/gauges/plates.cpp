#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/gauges/body_gauge.h"
#include "runs/depth.h"

namespace flowrest::mpm {

namespace {

/// The velocity between two plates, over their distance. One bin a lattice row, so that a lattice's rows are
/// seen one by one and not smeared.
class Plates : public BodyGauge {
 public:
  Plates(const GaugeCase& of, const scenes::PlatesGauge& plates)
      : width_(of.cell / of.scene.mpm.particles_per_cell.back()),
        mass_(static_cast<std::size_t>(std::lround(plates.height / width_)), 0.0),
        height_(mass_.size(), 0.0),
        momentum_(mass_.size(), 0.0) {}

  void add(const ParticleBatch& b) override {
    for (std::size_t i = 0; i < b.count; ++i) {
      const auto bin = std::min(static_cast<std::size_t>(b.position[1][i] / width_), mass_.size() - 1);
      mass_[bin] += b.mass[i];
      height_[bin] += b.mass[i] * b.position[1][i];
      momentum_[bin] += b.mass[i] * b.velocity[0][i];
      all_mass_ += b.mass[i];
      all_momentum_ += b.mass[i] * b.velocity[0][i];
    }
  }

  BodyReading finish() override {
    BodyReading r;
    for (std::size_t i = 0; i < mass_.size(); ++i) {
      if (mass_[i] == 0.0) continue;
      r.coordinate.push_back(height_[i] / mass_[i]);
      r.value.push_back(momentum_[i] / mass_[i]);
    }
    // The plug is in the middle: the mean of the innermost two rows.
    const std::size_t middle = r.value.size() / 2;
    r.main = r.value.size() < 2 ? runs::nothing : 0.5 * (r.value[middle - 1] + r.value[middle]);
    r.columns.add(runs::column::plug_velocity, r.main);
    r.columns.add(runs::column::mean_velocity, all_momentum_ / all_mass_);
    r.words = fmt::format("plug {:.4f} m/s", r.main);
    return r;
  }

 private:
  double width_;  ///< m, of a bin
  std::vector<double> mass_, height_, momentum_;
  double all_mass_ = 0.0, all_momentum_ = 0.0;
};

}  // namespace

std::unique_ptr<BodyGauge> plates_gauge(const GaugeCase& of, const scenes::PlatesGauge& gauge) {
  return std::make_unique<Plates>(of, gauge);
}

}  // namespace flowrest::mpm
