#include "runs/depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace flowrest::runs {

namespace {

/// Area of ring i over pi spacing^2.
double ring_area(std::size_t ring) { return 2.0 * static_cast<double>(ring) + 1.0; }

}  // namespace

std::vector<double> RadialDepth::centres() const {
  std::vector<double> centre(depth.size());
  for (std::size_t i = 0; i < depth.size(); ++i) centre[i] = (static_cast<double>(i) + 0.5) * spacing;
  return centre;
}

double RadialDepth::volume() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < depth.size(); ++i) sum += depth[i] * ring_area(i);
  return sum * std::numbers::pi * spacing * spacing;
}

RadialDepthAccumulator::RadialDepthAccumulator(double spacing, double largest_radius) : spacing_(spacing) {
  if (!(spacing > 0.0) || !(largest_radius > 0.0) || !std::isfinite(largest_radius / spacing))
    throw std::invalid_argument("rings need a spacing and a largest radius above 0");
  volume_.assign(static_cast<std::size_t>(std::max(1.0, std::ceil(largest_radius / spacing - 1e-9))), 0.0);
}

void RadialDepthAccumulator::add(double radius, double volume) {
  if (!(radius >= 0.0)) throw std::invalid_argument("a radius is negative or not a number");
  const double position = radius / spacing_ - 0.5;
  const std::size_t last = volume_.size() - 1;
  if (position <= 0.0) {
    volume_.front() += volume;
    return;
  }
  if (position >= static_cast<double>(last)) {
    volume_.back() += volume;
    return;
  }
  const auto ring = static_cast<std::size_t>(position);
  const double u = position - static_cast<double>(ring);
  // A tent in r alone gives the innermost ring 1/12 too much of a uniform layer, and a tent in the area 1/12
  // too little; both are exact for every other ring, so their mean is exact for all.
  const double area = ring_area(ring);
  const double inner = 0.5 * (1.0 - u) * (1.0 + (area + u) / (area + 2.0 * u));
  volume_[ring] += inner * volume;
  volume_[ring + 1] += (1.0 - inner) * volume;
}

RadialDepth RadialDepthAccumulator::depth() const {
  RadialDepth result{spacing_, volume_};
  for (std::size_t i = 0; i < volume_.size(); ++i)
    result.depth[i] /= ring_area(i) * std::numbers::pi * spacing_ * spacing_;
  return result;
}

double spread(std::span<const double> radius, std::span<const double> depth, double threshold) {
  const std::size_t count = std::min(radius.size(), depth.size());
  for (std::size_t i = count; i-- > 0;) {
    if (!(depth[i] > threshold)) continue;
    if (i + 1 == count) return 2.0 * radius[i];
    const double fraction = (depth[i] - threshold) / (depth[i] - depth[i + 1]);
    return 2.0 * (radius[i] + fraction * (radius[i + 1] - radius[i]));
  }
  return nothing;
}

double front(std::span<const double> centre, std::span<const double> depth, double length,
             double front_depth) {
  if (!depth.empty() && depth.back() > front_depth) return length;
  for (std::size_t i = depth.size(); i-- > 1;)
    if (depth[i - 1] > front_depth)
      return std::lerp(centre[i - 1], centre[i], (depth[i - 1] - front_depth) / (depth[i - 1] - depth[i]));
  return nothing;
}

double depth_at_end(std::span<const double> depth, double bin_width, ChannelEnd end, double length) {
  if (depth.empty()) return nothing;
  const auto bins =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(length / bin_width)), 1, depth.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < bins; ++i) sum += depth[end == ChannelEnd::last ? depth.size() - 1 - i : i];
  return sum / static_cast<double>(bins);
}

double centre_depth(std::span<const double> radius, std::span<const double> depth, double spread_depth) {
  const std::size_t count = std::min(radius.size(), depth.size());
  if (count == 0) return nothing;
  if (count == 1) return depth[0];
  // Without a spread there is no window, and the innermost two rings are taken.
  const double window = 0.25 * 0.5 * spread(radius, depth, spread_depth);
  // Least squares of c + s r, rings counting by their area.
  double area = 0.0, first = 0.0, second = 0.0, value = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < count && (i < 2 || radius[i] <= window); ++i) {
    const double r = radius[i];
    area += r;
    first += r * r;
    second += r * r * r;
    value += r * depth[i];
    moment += r * r * depth[i];
  }
  return (value * second - moment * first) / (area * second - first * first);
}

}  // namespace flowrest::runs
