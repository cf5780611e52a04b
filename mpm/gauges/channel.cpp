#include <algorithm>
#include <cmath>

#include "mpm/gauges/body_gauge.h"
#include "mpm/gauges/quantile.h"
#include "runs/depth.h"
#include "runs/gauges.h"

namespace flowrest::mpm {

namespace {

/// How far material has run along a channel, and how deep it stands at either end.
class Channel : public BodyGauge {
 public:
  Channel(const GaugeCase& of, const scenes::ChannelGauge& channel)
      : gauges_(of.scene.gauges),
        channel_(channel),
        factor_(of.pieces.whole_over_computed),
        spacing_(channel.length / std::max(1.0, std::round(channel.length / of.cell))),
        depth_(runs::About::plane, spacing_, channel.length,
               std::min(spacing_, of.cell / of.scene.mpm.particles_per_cell.front())) {}

  void begin(Solver& solver) override {
    front_of_mass_ = quantile_of_motion(
        solver, 0.995, [](const ParticleBatch& b, std::size_t i) { return b.position[0][i]; });
  }

  void add(const ParticleBatch& b) override {
    for (std::size_t i = 0; i < b.count; ++i)
      depth_.add(std::max(0.0, b.position[0][i]), factor_ * b.volume[i] / channel_.width);
  }

  BodyReading finish() override {
    BodyReading r;
    r.coordinate = depth_.centres();
    r.value = depth_.depth();
    const double front =
        runs::front(r.coordinate, r.value, channel_.length, gauges_.front_depth) - channel_.begin;
    r.columns.add(runs::column::front, front);
    r.columns.add(runs::column::front_of_mass, front_of_mass_ - channel_.begin);
    r.columns.add(runs::end_columns(r.value, spacing_, gauges_));
    r.main = 1e3 * front;
    r.words = runs::shown_length("front", front, gauges_.front_depth);
    return r;
  }

 private:
  const scenes::Gauges& gauges_;
  scenes::ChannelGauge channel_;
  double factor_;
  double spacing_;  ///< m, of the strips along x
  runs::DepthAccumulator depth_;
  double front_of_mass_ = 0.0;
};

}  // namespace

std::unique_ptr<BodyGauge> channel_gauge(const GaugeCase& of, const scenes::ChannelGauge& gauge) {
  return std::make_unique<Channel>(of, gauge);
}

}  // namespace flowrest::mpm
