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

bool Feed::is_due(std::size_t disc, double time) const {
  return time >= nozzle_.begins_at && begin_of(disc) < nozzle_.column &&
         begin_of(disc) < nozzle_.extruded(time) + filled_cells * cell_;
}

std::size_t Feed::count_due(double time) const {
  std::size_t count = 0;
  while (is_due(discs_ + count, time)) ++count;
  return count;
}

void Feed::skip_to(double time) { discs_ += count_due(time); }

std::vector<Seed> Feed::due(double time, double step) { return next(count_due(time), time, step); }

std::vector<Seed> Feed::next(std::size_t count, double time, double step) {
  std::vector<Seed> seeds;
  if (count == 0) return seeds;
  const Vector mouth = nozzle_.mouth(time);
  const double extruded = nozzle_.extruded(time);
  Seed seed;
  seed.velocity = motion_of(nozzle_, time, step, cell_).column();
  seed.flocculation = flocculation_;
  for (const std::size_t last = discs_ + count; discs_ < last; ++discs_) {
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
  }
  return seeds;
}

double Feed::volume() const { return discs_ == 0 ? 0.0 : area_ * end_of(discs_ - 1); }

Feeds::Feeds(const SolverSettings& settings, int per_axis, bool half, double flocculation) {
  for (const Nozzle& nozzle : settings.nozzles)
    feeds_.emplace_back(nozzle, settings.cell, per_axis, half, flocculation);
}

std::vector<Seed> Feeds::due(double time, double step) { return next(count_due(time), time, step); }

void Feeds::pass_over(const std::vector<std::size_t>& counts) {
  for (std::size_t f = 0; f < feeds_.size(); ++f) feeds_[f].pass_over(counts[f]);
}

std::vector<std::size_t> Feeds::count_due(double time) const {
  std::vector<std::size_t> counts;
  for (const Feed& feed : feeds_) counts.push_back(feed.count_due(time));
  return counts;
}

std::vector<Seed> Feeds::next(const std::vector<std::size_t>& counts, double time, double step) {
  std::vector<Seed> all;
  for (std::size_t f = 0; f < feeds_.size(); ++f) {
    const std::vector<Seed> seeds = feeds_[f].next(counts[f], time, step);
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
