#include "foamCases/vessel_gauge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foamCases/concrete_rates.h"
#include "foamCases/vessel.h"
#include "runs/depth.h"
#include "runs/quantile.h"

namespace flowrest::foam {

namespace {

/// Cells with more air than this show the air's shear rate, not the concrete's.
constexpr double nearly_full = 0.9;

/// Equal bins from 0 to a length.
struct Bins {
  Bins(double length, double cell)
      : value(static_cast<std::size_t>(std::max(1.0, std::round(length / cell))), 0.0),
        width(length / static_cast<double>(value.size())) {}

  /// Shares an amount out by how much of [low, high] lies in each bin; what lies outside is left out.
  void add(double low, double high, double amount) {
    const auto last = static_cast<double>(value.size() - 1);
    const auto first = static_cast<std::size_t>(std::clamp(std::floor(low / width), 0.0, last));
    for (std::size_t i = first; i < value.size() && width * static_cast<double>(i) < high; ++i) {
      const double from = width * static_cast<double>(i);
      value[i] += amount * std::max(0.0, std::min(high, from + width) - std::max(low, from)) / (high - low);
    }
  }
  std::vector<double> centres() const {
    std::vector<double> centre(value.size());
    for (std::size_t i = 0; i < centre.size(); ++i) centre[i] = (static_cast<double>(i) + 0.5) * width;
    return centre;
  }

  std::vector<double> value;
  double width;
};

/// The place that a share of what is in the bins does not pass, linearly within a bin; nothing of empty bins.
double quantile(const Bins& bins, double share) {
  double total = 0.0, below = 0.0;
  for (const double v : bins.value) total += v;
  for (std::size_t i = 0; i < bins.value.size(); ++i) {
    if (below + bins.value[i] >= share * total && bins.value[i] > 0.0)
      return bins.width * (static_cast<double>(i) + (share * total - below) / bins.value[i]);
    below += bins.value[i];
  }
  return runs::nothing;
}

}  // namespace

VesselGauge::VesselGauge(const scenes::Scene& scene, std::vector<MeshCell> cells)
    : scene_(scene),
      pieces_(scenes::pieces_of(scene)),
      walls_(pieces_, scene.spatial_dimension()),
      cells_(std::move(cells)),
      factor_(whole_over_mesh(scene)) {}

bool VesselGauge::floor_holds() const { return scene_.base.law != scenes::Wall::slip && !pieces_.runs_out; }

VesselGauges VesselGauge::measure(const VesselFields& fields) const {
  VesselGauges gauges;
  const double density = scene_.material.density;
  const bool held = floor_holds();
  ConcreteRates inside(scene_.material.flow_index);
  std::vector<runs::Weighted> at_floor;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const MeshCell& cell = cells_[i];
    const double concrete = factor_ * fields.fraction[i] * cell.volume;
    const double* u = &fields.velocity[3 * i];
    gauges.volume += concrete;
    gauges.kinetic_energy += 0.5 * density * concrete * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    gauges.potential_energy += density * scene_.forces.gravity * concrete * cell.centre()[2];
    if (fields.fraction[i] < nearly_full) continue;
    if (!fields.shear_rate.empty()) {
      inside.add(fields.shear_rate[i], concrete, fields.structure, i);
      const auto at = cell.centre();
      // Cells over an outlet narrow towards it; those of other vessels are cubes.
      const double size = pieces_.runs_out ? cell.high[0] - cell.low[0] : scene_.foam.cell;
      gauges.layer.add({walls_.distance(at[0], at[1], at[2]), size, size, concrete, fields.shear_rate[i]});
    }
    const double height = cell.high[2] - cell.low[2];
    if (held && cell.low[2] < 1e-6 * scene_.foam.cell)
      at_floor.emplace_back(std::hypot(u[0], u[1]) / (0.5 * height), cell.volume / height);
  }
  gauges.shear_rate_p99 = inside.percentile();
  gauges.overstressing_rate_p99 = inside.overstressing_percentile();
  gauges.base_shear_rate_p99 = held ? runs::percentile_99(std::move(at_floor)) : 0.0;
  if (const auto* outlet = std::get_if<scenes::OutletGauge>(&pieces_.gauged))
    measure_outlet(fields, *outlet, gauges);
  else
    measure_channel(fields, std::get<scenes::ChannelGauge>(pieces_.gauged), gauges);
  return gauges;
}

void VesselGauge::measure_channel(const VesselFields& fields, const scenes::ChannelGauge& channel,
                                  VesselGauges& gauges) const {
  Bins volume(channel.length, scene_.foam.cell);
  for (std::size_t i = 0; i < cells_.size(); ++i)
    volume.add(cells_[i].low[0], cells_[i].high[0], factor_ * fields.fraction[i] * cells_[i].volume);
  gauges.place = volume.centres();
  gauges.depth = volume.value;
  for (double& depth : gauges.depth) depth /= volume.width * channel.width;
  gauges.front =
      runs::front(gauges.place, gauges.depth, channel.length, scene_.gauges.front_depth) - channel.begin;
  gauges.front_mass_995 = quantile(volume, 0.995) - channel.begin;
  const double over = scene_.gauges.end_length;
  gauges.end_height = runs::depth_at_end(gauges.depth, volume.width, runs::ChannelEnd::last, over);
  gauges.start_height = runs::depth_at_end(gauges.depth, volume.width, runs::ChannelEnd::first, over);
}

void VesselGauge::measure_outlet(const VesselFields& fields, const scenes::OutletGauge& outlet,
                                 VesselGauges& gauges) const {
  const double side = outlet.half_width, deep = outlet.half_depth;
  Bins volume(outlet.half_top, scene_.foam.cell);
  const Bins lines_across(side, scene_.foam.cell), lines_deep(deep, scene_.foam.cell);
  std::vector<Bins> sight(lines_deep.value.size(), lines_across);
  const double line_area = lines_across.width * lines_deep.width;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const MeshCell& cell = cells_[i];
    const double concrete = fields.fraction[i] * cell.volume;
    if (cell.centre()[2] < 0.0 || !(concrete > 0.0)) continue;
    gauges.over_outlet += factor_ * concrete;
    volume.add(cell.low[0], cell.high[0], concrete);
    Bins behind = lines_deep;
    behind.add(cell.low[1], cell.high[1], concrete);
    for (std::size_t row = 0; row < sight.size(); ++row)
      if (behind.value[row] > 0.0) sight[row].add(cell.low[0], cell.high[0], behind.value[row]);
  }
  gauges.place = volume.centres();
  gauges.depth = volume.value;
  for (double& depth : gauges.depth) depth /= volume.width * deep;
  double least = sight.front().value.front();
  for (const Bins& row : sight)
    least = std::min(least, *std::min_element(row.value.begin(), row.value.end()));
  gauges.thinnest_over_outlet = least / line_area;
}

double VesselGauge::mean_over_concrete(const std::vector<double>& fraction,
                                       const std::vector<double>& field) const {
  double volume = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    volume += fraction[i] * cells_[i].volume;
    sum += fraction[i] * cells_[i].volume * field[i];
  }
  return volume > 0.0 ? sum / volume : 0.0;
}

}  // namespace flowrest::foam
