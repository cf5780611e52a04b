#include "runs/depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "runs/bins.h"

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

DepthAccumulator::DepthAccumulator(About about, double spacing, double extent, double grain)
    : about_(about), spacing_(spacing), grain_(grain) {
  if (!(spacing > 0.0) || !(extent > 0.0) || !std::isfinite(extent / spacing))
    throw std::invalid_argument("rings need a spacing and an extent above 0");
  if (!(grain > 0.0) || !(grain <= spacing))
    throw std::invalid_argument("a grain is wider than 0 and no wider than a ring");
  volume_.assign(static_cast<std::size_t>(std::max(1.0, std::ceil(extent / spacing - 1e-9))), 0.0);
}

void DepthAccumulator::add(double place, double volume) {
  if (!(place >= 0.0)) throw std::invalid_argument("a distance from the middle is negative or not a number");
  const double low = (place - 0.5 * grain_) / spacing_, high = (place + 0.5 * grain_) / spacing_;
  // Shared by length alone, a uniform layer sampled about an axis leaves 1/24 of a grain squared too much in the
  // innermost ring, shared by area as much too little; both are exact for every other ring, so their mean is
  // exact for all. What reaches beyond the middle is mirrored there.
  const double inner = std::max(0.0, low);
  const double all = (high - inner) * (high + inner);
  for_each_bin(low, high, [&](long ring, double overlap) {
    double share = overlap / (high - low);
    if (about_ == About::axis) {
      const double from = std::max(inner, static_cast<double>(ring));
      const double to = std::min(high, static_cast<double>(ring) + 1.0);
      share = 0.5 * (share + (to > from ? (to - from) * (to + from) / all : 0.0));
    }
    add_to(ring, share * volume);
  });
}

void DepthAccumulator::add_to(long ring, double volume) {
  const auto mirrored = static_cast<std::size_t>(ring < 0 ? -1 - ring : ring);
  volume_[std::min(mirrored, volume_.size() - 1)] += volume;
}

double DepthAccumulator::area(std::size_t ring) const {
  return about_ == About::plane ? spacing_ : ring_area(ring) * std::numbers::pi * spacing_ * spacing_;
}

std::vector<double> DepthAccumulator::depth() const {
  std::vector<double> depth(volume_.size());
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = volume_[i] / area(i);
  return depth;
}

std::vector<double> DepthAccumulator::centres() const { return RadialDepth{spacing_, volume_}.centres(); }

double spread(const DepthView& view, double threshold) { return 2.0 * edge_of_depth(view, threshold); }

double front(std::span<const double> centre, std::span<const double> depth, double length,
             double front_depth) {
  if (!depth.empty() && depth.back() > front_depth) return length;
  return edge_of_depth({centre, depth, About::plane}, front_depth);
}

double depth_at_end(std::span<const double> depth, double bin_width, ChannelEnd end, double length) {
  if (depth.empty()) return nothing;
  const auto bins =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(length / bin_width)), 1, depth.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < bins; ++i) sum += depth[end == ChannelEnd::last ? depth.size() - 1 - i : i];
  return sum / static_cast<double>(bins);
}

double centre_depth(const DepthView& view, double spread_depth) {
  const auto& [radius, depth, about] = view;
  const std::size_t count = std::min(radius.size(), depth.size());
  if (count == 0) return nothing;
  if (count == 1) return depth[0];
  // Without a spread there is no window, and the innermost two rings are taken.
  const double edge = 0.5 * spread(view, spread_depth), window = 0.25 * edge, widest = 0.4 * edge;
  constexpr std::size_t wanted = 4;  // coarse rings are each held by few particles
  // Least squares of c + s r, rings counting by their area.
  double area = 0.0, first = 0.0, second = 0.0, value = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < count && (i < 2 || radius[i] <= (i < wanted ? widest : window)); ++i) {
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
