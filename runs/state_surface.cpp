#include "runs/state_surface.h"

#include <algorithm>
#include <cmath>

#include "runs/bins.h"
#include "runs/nose.h"

namespace flowrest::runs {

namespace {

using Plan = DepthColumns::Plan;

/// Into how many slips a column is cut: along its one axis, or along each of two.
constexpr std::size_t slips_of_a_ring = 32, slips_of_a_square = 8;

/// The steepest of slopes that makes no new high or low (van Leer's, monotonised).
double slope(double before, double here, double after) {
  const double back = here - before, on = after - here;
  if (!(back * on > 0.0)) return 0.0;
  return std::copysign(std::min({2.0 * std::abs(back), 2.0 * std::abs(on), 0.5 * std::abs(back + on)}), on);
}

}  // namespace

StateSurface::StateSurface(const DepthColumns& columns, double thinnest)
    : plan_(columns.plan),
      width_(columns.width /
             static_cast<double>(plan_ == Plan::squares ? slips_of_a_square : slips_of_a_ring)),
      along_x_(static_cast<std::size_t>(columns.along_x) *
               (plan_ == Plan::squares ? slips_of_a_square : slips_of_a_ring)),
      along_y_(plan_ == Plan::squares ? static_cast<std::size_t>(columns.along_y) * slips_of_a_square : 1),
      depth_(along_x_ * along_y_, 0.0) {
  if (plan_ == Plan::squares)
    draw_squares(columns);
  else
    draw_profile(columns, thinnest);
  for (std::size_t j = 0; j < along_y_; ++j)
    for (std::size_t i = 0; i < along_x_; ++i)
      if (depth_[i + along_x_ * j] > 0.0)
        reach_ = std::max(reach_, width_ * static_cast<double>(std::max(i, j) + 1));
}

double StateSurface::area(std::size_t i, std::size_t j) const {
  const auto x = static_cast<double>(i), y = static_cast<double>(j);
  return DepthColumns::area(plan_, x * width_, (x + 1.0) * width_, y * width_, (y + 1.0) * width_);
}

void StateSurface::draw_profile(const DepthColumns& columns, double thinnest) {
  const std::size_t count = columns.depth.size();
  std::vector<double> centre(count);
  for (std::size_t i = 0; i < count; ++i) centre[i] = (static_cast<double>(i) + 0.5) * columns.width;
  const auto about = plan_ == Plan::rings ? About::axis : About::plane;
  const double front = edge_of_depth({centre, columns.depth, about}, thinnest);
  for (std::size_t c = 0; c < count; ++c) {
    const double depth = columns.depth[c];
    if (!(depth > 0.0)) continue;
    const double before = columns.depth[c > 0 ? c - 1 : 0];
    const double steep = slope(before, depth, c + 1 < count ? columns.depth[c + 1] : 0.0);
    const double inner = static_cast<double>(c) * columns.width;
    const bool ends_here = front > inner && front < inner + columns.width;
    double drawn = 0.0, plan = 0.0;
    for (std::size_t s = 0; s < slips_of_a_ring; ++s) {
      const std::size_t i = c * slips_of_a_ring + s;
      const double along = (static_cast<double>(s) + 0.5) / static_cast<double>(slips_of_a_ring);
      const double to_front = front - inner - along * columns.width;
      depth_[i] =
          ends_here ? std::sqrt(std::max(0.0, to_front)) : std::max(0.0, depth + (along - 0.5) * steep);
      drawn += depth_[i] * area(i, 0);
      plan += area(i, 0);
    }
    for (std::size_t s = 0; s < slips_of_a_ring; ++s) {
      double& slip = depth_[c * slips_of_a_ring + s];
      slip = drawn > 0.0 ? slip * (depth * plan / drawn) : depth;
    }
  }
}

void StateSurface::draw_squares(const DepthColumns& columns) {
  const auto nx = static_cast<std::size_t>(columns.along_x), ny = static_cast<std::size_t>(columns.along_y);
  // What lies beyond a plane of symmetry is as on this side; beyond the last column there is nothing.
  const auto at = [&](long i, long j) {
    if (i >= static_cast<long>(nx) || j >= static_cast<long>(ny)) return 0.0;
    return columns
        .depth[static_cast<std::size_t>(std::max(i, 0L)) + nx * static_cast<std::size_t>(std::max(j, 0L))];
  };
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      const double depth = columns.depth[i + nx * j];
      if (!(depth > 0.0)) continue;
      const auto a = static_cast<long>(i), b = static_cast<long>(j);
      const double along_x = slope(at(a - 1, b), depth, at(a + 1, b)),
                   along_y = slope(at(a, b - 1), depth, at(a, b + 1));
      double drawn = 0.0;
      const auto each = [&](const auto& use) {
        for (std::size_t t = 0; t < slips_of_a_square; ++t)
          for (std::size_t s = 0; s < slips_of_a_square; ++s)
            use(depth_[i * slips_of_a_square + s + along_x_ * (j * slips_of_a_square + t)],
                (static_cast<double>(s) + 0.5) / slips_of_a_square - 0.5,
                (static_cast<double>(t) + 0.5) / slips_of_a_square - 0.5);
      };
      each([&](double& slip, double x, double y) {
        slip = std::max(0.0, depth + x * along_x + y * along_y);
        drawn += slip;
      });
      const double scale = depth * slips_of_a_square * slips_of_a_square / drawn;
      each([&](double& slip, double, double) { slip *= scale; });
    }
}

double StateSurface::volume(double west, double east, double south, double north) const {
  double sum = 0.0;
  const auto row = [&](std::size_t j, double from, double to) {
    for_each_bin(west / width_, east / width_, [&](long i, double overlap) {
      if (i < 0 || i >= static_cast<long>(along_x_) || !(overlap > 0.0)) return;
      const double low = std::max(west, static_cast<double>(i) * width_),
                   high = std::min(east, static_cast<double>(i + 1) * width_);
      sum +=
          depth_[static_cast<std::size_t>(i) + along_x_ * j] * DepthColumns::area(plan_, low, high, from, to);
    });
  };
  if (plan_ != Plan::squares) {
    row(0, 0.0, 0.0);
    return sum;
  }
  for_each_bin(south / width_, north / width_, [&](long j, double overlap) {
    if (j < 0 || j >= static_cast<long>(along_y_) || !(overlap > 0.0)) return;
    row(static_cast<std::size_t>(j), std::max(south, static_cast<double>(j) * width_),
        std::min(north, static_cast<double>(j + 1) * width_));
  });
  return sum;
}

ParcelField::ParcelField(const MaterialState& state) : parcels_(state.parcels) {
  low_.fill(1e300);
  high_.fill(-1e300);
  for (const Parcel& parcel : parcels_)
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], parcel.low[a]);
      high_[a] = std::max(high_[a], parcel.high[a]);
    }
  for (std::size_t a = 0; a < 3; ++a) {
    const double extent = high_[a] - low_[a];
    bins_[a] = static_cast<std::size_t>(std::clamp(std::ceil(extent / state.columns.width), 1.0, 2000.0));
    width_[a] = extent > 0.0 ? extent / static_cast<double>(bins_[a]) : 1.0;
  }
  of_bin_.resize(bins_[0] * bins_[1] * bins_[2]);
  for (std::size_t p = 0; p < parcels_.size(); ++p) {
    const auto first = bin(parcels_[p].low), last = bin(parcels_[p].high);
    for (std::size_t k = first[2]; k <= last[2]; ++k)
      for (std::size_t j = first[1]; j <= last[1]; ++j)
        for (std::size_t i = first[0]; i <= last[0]; ++i)
          of_bin_[i + bins_[0] * (j + bins_[1] * k)].push_back(static_cast<std::uint32_t>(p));
  }
}

std::array<std::size_t, 3> ParcelField::bin(const std::array<double, 3>& place) const {
  std::array<std::size_t, 3> at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double bins = std::floor((place[a] - low_[a]) / width_[a]);
    at[a] = static_cast<std::size_t>(std::clamp(bins, 0.0, static_cast<double>(bins_[a] - 1)));
  }
  return at;
}

bool ParcelField::add_up(const std::array<double, 3>& low, const std::array<double, 3>& high,
                         Carried& carried) const {
  double weights = 0.0;
  std::vector<std::uint32_t> near;
  const auto first = bin(low), last = bin(high);
  for (std::size_t k = first[2]; k <= last[2]; ++k)
    for (std::size_t j = first[1]; j <= last[1]; ++j)
      for (std::size_t i = first[0]; i <= last[0]; ++i) {
        const auto& there = of_bin_[i + bins_[0] * (j + bins_[1] * k)];
        near.insert(near.end(), there.begin(), there.end());
      }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  carried = {};
  carried.volume_ratio = 0.0;
  for (const std::uint32_t p : near) {
    const Parcel& parcel = parcels_[p];
    double weight = parcel.volume;
    for (std::size_t a = 0; a < 3; ++a) {
      const double extent = parcel.high[a] - parcel.low[a];
      if (!(extent > 0.0)) continue;  // a section has no width across
      weight *= std::max(0.0, std::min(high[a], parcel.high[a]) - std::max(low[a], parcel.low[a])) / extent;
    }
    if (!(weight > 0.0)) continue;
    weights += weight;
    for (std::size_t a = 0; a < 3; ++a) carried.velocity[a] += weight * parcel.velocity[a];
    for (std::size_t c = 0; c < 6; ++c) carried.stress[c] += weight * parcel.stress[c];
    carried.shear_rate += weight * parcel.shear_rate;
    carried.volume_ratio += weight * parcel.volume_ratio;
    carried.flocculation += weight * parcel.flocculation;
  }
  if (!(weights > 0.0)) return false;
  for (double& v : carried.velocity) v /= weights;
  for (double& s : carried.stress) s /= weights;
  carried.shear_rate /= weights;
  carried.volume_ratio /= weights;
  carried.flocculation /= weights;
  return true;
}

Carried ParcelField::in_box(const std::array<double, 3>& low, const std::array<double, 3>& high) const {
  auto from = low, to = high;
  Carried carried;
  double further = 0.25 * std::max(high[0] - low[0], high[2] - low[2]);
  while (!add_up(from, to, carried)) {
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] -= further;
      to[a] += further;
    }
    further *= 1.5;
  }
  return carried;
}

void conserve(const MaterialState& state, Received& received) {
  const auto wanted = state.momentum();
  for (std::size_t a = 0; a < 3; ++a) {
    double sum = 0.0, moving = 0.0;
    for (std::size_t i = 0; i < received.mass.size(); ++i) {
      sum += received.mass[i] * received.carried[i].velocity[a];
      moving += received.mass[i] * std::abs(received.carried[i].velocity[a]);
    }
    if (!(moving > 0.0)) continue;
    const double change = (wanted[a] - sum) / moving;
    for (Carried& carried : received.carried) carried.velocity[a] += change * std::abs(carried.velocity[a]);
  }
  double mass = 0.0, flocculated = 0.0;
  for (std::size_t i = 0; i < received.mass.size(); ++i) {
    mass += received.mass[i];
    flocculated += received.mass[i] * received.carried[i].flocculation;
  }
  if (!(flocculated > 0.0)) return;
  const double scale = state.flocculation() * state.volume() * state.density / flocculated;
  for (Carried& carried : received.carried) carried.flocculation *= scale;
}

}  // namespace flowrest::runs
