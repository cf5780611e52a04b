#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/gauges/body_gauge.h"

namespace flowrest::mpm {

namespace {

/// What has run out through an outlet at height 0, and how much is left on each line of sight through it: one
/// a cell. All of it folds onto one quarter.
class Outlet : public BodyGauge {
 public:
  Outlet(const GaugeCase& of, const scenes::OutletGauge& outlet)
      : outlet_(outlet),
        up_(of.vertical),
        across_(lines(outlet.half_width, of.cell)),
        behind_(space() ? lines(outlet.half_depth, of.cell) : 1),
        sight_(across_ * behind_, 0.0),
        volume_(lines(outlet.half_top, of.cell), 0.0),
        spacing_(outlet.half_top / static_cast<double>(volume_.size())) {}

  void add(const ParticleBatch& b) override {
    const double side = outlet_.half_width, deep = outlet_.half_depth;
    const double line_area =
        side / static_cast<double>(across_) * (space() ? deep / static_cast<double>(behind_) : 1.0);
    for (std::size_t i = 0; i < b.count; ++i) {
      total_ += b.mass[i];
      if (b.position[up_][i] < 0.0) {
        below_ += b.mass[i];
        continue;
      }
      const double x = std::abs(b.position[0][i]), y = space() ? std::abs(b.position[1][i]) : 0.0;
      volume_[std::min(volume_.size() - 1, static_cast<std::size_t>(x / spacing_))] += b.volume[i];
      if (x >= side || y >= deep) continue;
      sight_[line(x, side, across_) * behind_ + (space() ? line(y, deep, behind_) : 0)] +=
          b.volume[i] / line_area;
    }
  }

  BodyReading finish() override {
    BodyReading r;
    for (std::size_t i = 0; i < volume_.size(); ++i) {
      r.coordinate.push_back((static_cast<double>(i) + 0.5) * spacing_);
      r.value.push_back(volume_[i] / outlet_.quarters / (spacing_ * (space() ? outlet_.half_depth : 1.0)));
    }
    const double discharged = below_ / total_;
    r.columns.add(runs::column::discharged, discharged);
    r.columns.add(runs::column::thinnest_sight,
                  *std::min_element(sight_.begin(), sight_.end()) / outlet_.quarters);
    r.main = 100.0 * discharged;
    r.words = fmt::format("discharged {:.1f} %", r.main);
    return r;
  }

 private:
  static std::size_t lines(double half, double cell) {
    return static_cast<std::size_t>(std::max(1.0, std::round(half / cell)));
  }
  static std::size_t line(double place, double half, std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(place / half * static_cast<double>(count)));
  }
  bool space() const { return up_ == 2; }

  scenes::OutletGauge outlet_;
  std::size_t up_, across_, behind_;
  std::vector<double> sight_;   ///< m on each line
  std::vector<double> volume_;  ///< m3 (plane: m2) over equal bins from the middle
  double spacing_;              ///< m
  double below_ = 0.0, total_ = 0.0;
};

}  // namespace

std::unique_ptr<BodyGauge> outlet_gauge(const GaugeCase& of, const scenes::OutletGauge& gauge) {
  return std::make_unique<Outlet>(of, gauge);
}

}  // namespace flowrest::mpm
