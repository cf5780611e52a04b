#include <algorithm>
#include <cmath>

#include "mpm/gauges/body_gauge.h"
#include "mpm/gauges/quantile.h"
#include "runs/depth.h"
#include "runs/gauges.h"

namespace flowrest::mpm {

namespace {

/// How far material has spread from the middle: depth over rings about the axis, or over equal bins on either
/// side of a plane.
class Spread : public BodyGauge {
 public:
  Spread(const GaugeCase& of, const scenes::SpreadGauge& gauge)
      : gauges_(of.scene.gauges),
        about_(gauge.about_axis ? runs::About::axis : runs::About::plane),
        vertical_(of.vertical),
        cell_(of.cell),
        grain_(of.cell / of.scene.mpm.particles_per_cell.front()),
        // A plane column's depth is volume per length and unit width on either side of the middle.
        factor_(gauge.about_axis ? of.pieces.whole_over_computed : 1.0) {}

  void begin(Solver& solver) override {
    of_mass_ = 2.0 * quantile_of_motion(solver, 0.995, [this](const ParticleBatch& b, std::size_t i) {
                 const double radius = radius_of(b, i);
                 farthest_ = std::max(farthest_, radius);
                 return radius;
               });
    depth_.emplace(about_, cell_, farthest_ + 2.0 * cell_, grain_);
  }

  void add(const ParticleBatch& b) override {
    for (std::size_t i = 0; i < b.count; ++i) depth_->add(radius_of(b, i), factor_ * b.volume[i]);
  }

  BodyReading finish() override {
    BodyReading r;
    r.farthest = farthest_;
    r.coordinate = depth_->centres();
    r.value = depth_->depth();
    const runs::DepthView profile{r.coordinate, r.value, about_};
    r.columns.add(runs::spread_columns(profile, gauges_));
    r.columns.add(runs::column::spread_of_mass, of_mass_);
    r.columns.add(runs::column::height, runs::centre_depth(profile, gauges_.spread_depth));
    const double spread = runs::spread(profile, gauges_.spread_depth);
    r.main = 1e3 * spread;
    r.words = runs::shown_length("spread", spread, gauges_.spread_depth);
    return r;
  }

 private:
  double radius_of(const ParticleBatch& b, std::size_t i) const {
    return vertical_ == 2 ? std::hypot(b.position[0][i], b.position[1][i]) : std::abs(b.position[0][i]);
  }

  const scenes::Gauges& gauges_;
  runs::About about_;
  std::size_t vertical_;
  double cell_, grain_, factor_;
  double farthest_ = 0.0, of_mass_ = 0.0;
  std::optional<runs::DepthAccumulator> depth_;
};

}  // namespace

std::unique_ptr<BodyGauge> spread_gauge(const GaugeCase& of, const scenes::SpreadGauge& gauge) {
  return std::make_unique<Spread>(of, gauge);
}

}  // namespace flowrest::mpm
