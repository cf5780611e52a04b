#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "mpm/gauges/body_gauge.h"
#include "runs/bins.h"
#include "runs/depth.h"

namespace flowrest::mpm {

namespace {

/// Volume over equal bins along an axis, every particle shared out over the bins that its width covers.
class Bins {
 public:
  explicit Bins(double width) : width_(width) {}

  void add(double place, double extent, double volume) {
    const double from = (place - 0.5 * extent) / width_, to = (place + 0.5 * extent) / width_;
    runs::for_each_bin(from, to,
                       [&](long bin, double overlap) { volume_[bin] += volume * overlap / (to - from); });
  }
  const std::map<long, double>& volumes() const { return volume_; }
  double at(long bin) const {
    const auto found = volume_.find(bin);
    return found == volume_.end() ? 0.0 : found->second;
  }
  double largest() const {
    double largest = 0.0;
    for (const auto& [bin, volume] : volume_) largest = std::max(largest, volume);
    return largest;
  }
  double middle_of(long bin) const { return (static_cast<double>(bin) + 0.5) * width_; }

 private:
  double width_;
  std::map<long, double> volume_;
};

/// The section of a strand behind the nozzle: how wide its rows are, one cell high, and how high its columns,
/// one cell wide, by what they hold. Of a nozzle that has gone, the last section it has left.
class Section : public BodyGauge {
 public:
  Section(const GaugeCase& of, const scenes::SectionGauge& gauge)
      : feeds_(of.pieces.feeds),
        gauge_(gauge),
        time_(of.time),
        cell_(of.cell),
        factor_(of.pieces.whole_over_computed),
        rows_(of.cell),
        columns_(of.cell) {
    for (const scenes::Feed& feed : feeds_) look_behind(feed);
  }

  void begin(Solver& solver) override { force_ = solver.nozzle_force(); }

  void add(const ParticleBatch& b) override {
    if (!station_) return;
    for (std::size_t i = 0; i < b.count; ++i) {
      if (b.position[0][i] < station_->from || b.position[0][i] > station_->to) continue;
      const double extent = std::cbrt(b.volume[i]);
      volume_ += b.volume[i];
      rows_.add(b.position[2][i], extent, b.volume[i]);
      // Of a half, what a particle has beyond the plane of symmetry is its mirror image's.
      columns_.add(b.position[1][i], extent, b.volume[i]);
      if (factor_ > 1.0) columns_.add(-b.position[1][i], extent, b.volume[i]);
    }
  }

  BodyReading finish() override {
    BodyReading r;
    const double length = station_ ? station_->to - station_->from : runs::nothing;
    const double of_row = factor_ / (length * cell_), of_column = 1.0 / (length * cell_);
    const double area = factor_ * volume_ / length, width = of_row * rows_.largest();
    const double height = of_column * columns_.largest();
    for (const auto& [bin, volume] : columns_.volumes()) {
      r.coordinate.push_back(columns_.middle_of(bin));
      r.value.push_back(of_column * volume);
    }
    r.columns.add(runs::column::strand_width, width)
        .add(runs::column::strand_height, height)
        .add(runs::column::section_area, area)
        .add(runs::column::base_width, of_row * rows_.at(0))
        .add(runs::column::area_over_balance, station_ ? area / balance_ : runs::nothing)
        .add(runs::column::nozzle_drag, factor_ * force_[0])
        .add(runs::column::nozzle_push, -factor_ * force_[2]);
    r.main = 1e3 * width;
    r.words = station_ ? fmt::format("strand {:.2f} mm wide, {:.2f} mm high", 1e3 * width, 1e3 * height)
                       : std::string("no section yet");
    return r;
  }

 private:
  struct Station {
    double from, to;  ///< m along x
  };

  /// Takes the section behind a nozzle, if it has gone far enough, and adds what should be in it.
  void look_behind(const scenes::Feed& feed) {
    if (time_ <= feed.begins_at) return;
    const double until = std::min(time_, feed.gone_at);
    const double begin = feed.mouth(feed.begins_at)[0], axis = feed.mouth(until)[0];
    const double moved = std::abs(axis - begin);
    if (moved < gauge_.behind + gauge_.length) return;
    const double way = axis > begin ? 1.0 : -1.0;
    const double near = axis - way * gauge_.behind, far = near - way * gauge_.length;
    station_ = Station{std::min(near, far), std::max(near, far)};
    balance_ += std::numbers::pi * feed.bore * feed.bore * feed.extruded(until) / moved;
  }

  const std::vector<scenes::Feed>& feeds_;
  scenes::SectionGauge gauge_;
  double time_, cell_, factor_;
  std::optional<Station> station_;
  double balance_ = 0.0;  ///< m2
  double volume_ = 0.0;   ///< m3
  Bins rows_, columns_;   ///< by height, and across
  Vector force_{};
};

}  // namespace

std::unique_ptr<BodyGauge> section_gauge(const GaugeCase& of, const scenes::SectionGauge& gauge) {
  return std::make_unique<Section>(of, gauge);
}

}  // namespace flowrest::mpm
