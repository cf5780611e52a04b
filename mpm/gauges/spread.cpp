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
        about_axis_(gauge.about_axis),
        vertical_(of.vertical),
        cell_(of.cell),
        factor_(of.pieces.whole_over_computed) {}

  void begin(Solver& solver) override {
    of_mass_ = 2.0 * quantile_of_motion(solver, 0.995, [this](const ParticleBatch& b, std::size_t i) {
                 const double radius = radius_of(b, i);
                 farthest_ = std::max(farthest_, radius);
                 return radius;
               });
    if (about_axis_) {
      rings_.emplace(cell_, farthest_ + 2.0 * cell_);
    } else {
      // A plane column's depth is volume per length and unit width on either side of the middle.
      depth_.assign(static_cast<std::size_t>(farthest_ / cell_) + 2, 0.0);
    }
  }

  void add(const ParticleBatch& b) override {
    for (std::size_t i = 0; i < b.count; ++i) {
      const double radius = radius_of(b, i);
      if (about_axis_)
        rings_->add(radius, factor_ * b.volume[i]);
      else
        depth_[static_cast<std::size_t>(radius / cell_)] += b.volume[i] / cell_;
    }
  }

  BodyReading finish() override {
    BodyReading r;
    r.farthest = farthest_;
    if (about_axis_) {
      const runs::RadialDepth depth = rings_->depth();
      r.coordinate = depth.centres();
      r.value = depth.depth;
    } else {
      r.value = depth_;
      for (std::size_t i = 0; i < depth_.size(); ++i)
        r.coordinate.push_back((static_cast<double>(i) + 0.5) * cell_);
    }
    r.columns.add(runs::spread_columns(r.coordinate, r.value, gauges_));
    r.columns.add(runs::column::spread_of_mass, of_mass_);
    r.columns.add(runs::column::height, runs::centre_depth(r.coordinate, r.value, gauges_.spread_depth));
    const double spread = runs::spread(r.coordinate, r.value, gauges_.spread_depth);
    r.main = 1e3 * spread;
    r.words = runs::shown_length("spread", spread, gauges_.spread_depth);
    return r;
  }

 private:
  double radius_of(const ParticleBatch& b, std::size_t i) const {
    return vertical_ == 2 ? std::hypot(b.position[0][i], b.position[1][i]) : std::abs(b.position[0][i]);
  }

  const scenes::Gauges& gauges_;
  bool about_axis_;
  std::size_t vertical_;
  double cell_, factor_;
  double farthest_ = 0.0, of_mass_ = 0.0;
  std::optional<runs::RadialDepthAccumulator> rings_;
  std::vector<double> depth_;
};

}  // namespace

std::unique_ptr<BodyGauge> spread_gauge(const GaugeCase& of, const scenes::SpreadGauge& gauge) {
  return std::make_unique<Spread>(of, gauge);
}

}  // namespace flowrest::mpm
