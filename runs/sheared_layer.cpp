#include "runs/sheared_layer.h"

#include <algorithm>
#include <cmath>

#include "runs/bins.h"

namespace flowrest::runs {

namespace {

constexpr double bins_per_extent = 4.0;

}  // namespace

void LayerMeter::add(const ShearSample& s) {
  if (!std::isfinite(s.distance)) return;
  volume_ += s.volume;
  volume_rate_ += s.volume * s.rate;
  const double weight = s.volume * s.rate * s.rate;
  if (!(weight > 0.0)) return;
  if (width_ == 0.0) width_ = s.extent / bins_per_extent;
  const double low = std::max(0.0, s.distance - 0.5 * s.extent) / width_,
               high = std::max(0.5 * s.extent, s.distance + 0.5 * s.extent) / width_;
  if (const auto last = static_cast<std::size_t>(high); last >= bins_.size()) bins_.resize(last + 1);
  for_each_bin(low, high, [&](long i, double overlap) {
    const double part = weight * overlap / (high - low);
    Bin& bin = bins_[static_cast<std::size_t>(i)];
    bin.weight += part;
    bin.cells_per_metre += part / s.cell;
  });
}

/// A bin that holds nothing has the cells of the one before.
double LayerMeter::cells_within(double thickness) const {
  double cells = 0.0, density = 0.0;
  for (std::size_t i = 0; width_ * static_cast<double>(i) < thickness; ++i) {
    if (i < bins_.size() && bins_[i].weight > 0.0) density = bins_[i].cells_per_metre / bins_[i].weight;
    cells += density * std::min(width_, thickness - width_ * static_cast<double>(i));
  }
  return cells;
}

ShearedLayer LayerMeter::layer() const {
  double total = 0.0;
  for (const Bin& bin : bins_) total += bin.weight;
  ShearedLayer layer;
  if (!(total > 0.0)) return layer;
  layer.mean_rate = volume_rate_ / volume_;
  double below = 0.0;
  std::size_t i = 0;
  while (i + 1 < bins_.size() && below + bins_[i].weight < share * total) below += bins_[i++].weight;
  const double within =
      bins_[i].weight > 0.0 ? std::min(1.0, (share * total - below) / bins_[i].weight) : 1.0;
  const double of_linear_layer = 1.0 - std::cbrt(1.0 - share);
  layer.thickness = width_ * (static_cast<double>(i) + within) / of_linear_layer;
  layer.cells = cells_within(layer.thickness);
  return layer;
}

}  // namespace flowrest::runs
