#include "mpm/sampling/feed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flowrest::mpm {

namespace {

constexpr double filled_cells = 2.0;  ///< above the mouth

}  // namespace

Feed::Feed(const Nozzle& nozzle, double cell, int per_axis, bool half, double flocculation)
    : nozzle_(nozzle),
      cell_(cell),
      thickness_(cell / per_axis),
      area_(std::numbers::pi * nozzle.bore * nozzle.bore * (half ? 0.5 : 1.0)),
      flocculation_(flocculation) {
  const int reach = static_cast<int>(std::ceil(nozzle.bore / thickness_));
  for (int i = -reach; i < reach; ++i)
    for (int j = half ? 0 : -reach; j < reach; ++j) {
      const Site site{(i + 0.5) * thickness_, (j + 0.5) * thickness_};
      if (std::hypot(site.x, site.y) < nozzle.bore) sites_.push_back(site);
    }
}

bool Feed::is_due(double time) const {
  return time >= nozzle_.begins_at && begin_of(discs_) < nozzle_.column &&
         begin_of(discs_) < nozzle_.extruded(time) + filled_cells * cell_;
}

void Feed::skip_to(double time) {
  while (is_due(time)) ++discs_;
}

std::vector<Seed> Feed::due(double time, double step) {
  std::vector<Seed> seeds;
  if (!is_due(time)) return seeds;
  const Vector mouth = nozzle_.mouth(time);
  const double extruded = nozzle_.extruded(time);
  Seed seed;
  seed.velocity = NozzleMotion(nozzle_, time, step, cell_).column();
  seed.flocculation = flocculation_;
  while (is_due(time)) {
    const double begin = begin_of(discs_), end = end_of(discs_);
    seed.volume = area_ * (end - begin) / static_cast<double>(sites_.size());
    for (const Site& site : sites_) {
      const Vector place = {mouth[0] + site.x, mouth[1] + site.y, mouth[2] + 0.5 * (begin + end) - extruded};
      for (std::size_t a = 0; a < 3; ++a) {
        const double cells = place[a] / cell_;
        seed.cell[a] = static_cast<std::int32_t>(std::floor(cells));
        seed.position[a] = cells - std::floor(cells);
      }
      seeds.push_back(seed);
    }
    ++discs_;
  }
  return seeds;
}

double Feed::volume() const { return discs_ == 0 ? 0.0 : area_ * end_of(discs_ - 1); }

Feeds::Feeds(const SolverSettings& settings, int per_axis, bool half, double flocculation) {
  for (const Nozzle& nozzle : settings.nozzles)
    feeds_.emplace_back(nozzle, settings.cell, per_axis, half, flocculation);
}

std::vector<Seed> Feeds::due(double time, double step) {
  std::vector<Seed> all;
  for (Feed& feed : feeds_) {
    const std::vector<Seed> seeds = feed.due(time, step);
    all.insert(all.end(), seeds.begin(), seeds.end());
  }
  return all;
}

void Feeds::skip_to(double time) {
  for (Feed& feed : feeds_) feed.skip_to(time);
}

double Feeds::volume() const {
  double sum = 0.0;
  for (const Feed& feed : feeds_) sum += feed.volume();
  return sum;
}

}  // namespace flowrest::mpm
