#include "mpm/sampling/sampling.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "mpm/solver/settings.h"

namespace flowrest::mpm {

namespace {

using Point = std::array<double, 3>;

/// Points per axis and site that decide how much of a site lies inside the body.
constexpr int probes = 4;
/// Sites with less than this inside are left out; the scaling makes up for their volume.
constexpr double smallest_share = 0.2;

/// A body to fill: its bounding box, whether a point is inside, and its volume.
struct Body {
  Point lower{}, upper{};
  std::function<bool(const Point&)> contains;
  double volume = 0.0;
};

Body cone(const scenes::Scene& scene) {
  const auto& g = scene.slump();
  const int dim = scene.spatial_dimension();
  const bool full = scene.geometry.dimension == scenes::Dimension::full;
  const double reach = std::max(g.cone_radius_bottom, g.cone_radius_top);
  Body body;
  for (int a = 0; a < dim - 1; ++a) {
    body.lower[static_cast<std::size_t>(a)] = full ? -reach : 0.0;
    body.upper[static_cast<std::size_t>(a)] = reach;
  }
  const auto up = static_cast<std::size_t>(dim - 1);
  body.upper[up] = g.cone_height;
  body.contains = [g, dim, up](const Point& x) {
    if (x[up] < 0.0 || x[up] > g.cone_height) return false;
    const double radius =
        g.cone_radius_bottom + (g.cone_radius_top - g.cone_radius_bottom) * x[up] / g.cone_height;
    return (dim == 3 ? std::hypot(x[0], x[1]) : std::abs(x[0])) <= radius;
  };
  body.volume = scene.geometry.dimension == scenes::Dimension::plane
                    ? 0.5 * (g.cone_radius_bottom + g.cone_radius_top) * g.cone_height
                    : g.volume() / whole_body_factor(scene);
  return body;
}

Body duct(const scenes::Scene& scene) {
  Body body;
  body.upper = {block_edge * cell_size(scene), scene.duct().height, 0.0};
  body.contains = [top = scene.duct().height](const Point& x) { return x[1] >= 0.0 && x[1] <= top; };
  body.volume = body.upper[0] * body.upper[1];
  return body;
}

class Sampler {
 public:
  Sampler(const scenes::Scene& scene, const Body& body)
      : scene_(scene),
        body_(body),
        dim_(scene.spatial_dimension()),
        cell_(cell_size(scene)),
        random_(scene.mpm.seed) {
    for (int a = 0; a < dim_; ++a) sites_[a] = scene.mpm.particles_per_cell.at(static_cast<std::size_t>(a));
  }

  std::vector<Seed> sample() {
    std::array<int, 3> first{}, last{1, 1, 1};
    for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a) {
      // A face that lies on a multiple of the cell within round-off bounds no further cell.
      first[a] = static_cast<int>(std::floor(body_.lower[a] / cell_ + 1e-9));
      last[a] = static_cast<int>(std::ceil(body_.upper[a] / cell_ - 1e-9));
    }
    for (int i = first[0]; i < last[0]; ++i)
      for (int j = first[1]; j < last[1]; ++j)
        for (int k = first[2]; k < last[2]; ++k) fill_cell({i, j, k});
    double total = 0.0;
    for (const auto& s : seeds_) total += s.volume;
    for (auto& s : seeds_) s.volume *= body_.volume / total;
    return std::move(seeds_);
  }

 private:
  void fill_cell(const CellIndex& cell) {
    const int in_depth = dim_ == 3 ? sites_[2] : 1;
    for (int i = 0; i < sites_[0]; ++i)
      for (int j = 0; j < sites_[1]; ++j)
        for (int k = 0; k < in_depth; ++k) fill_site(cell, {i, j, k});
  }

  void fill_site(const CellIndex& cell, const std::array<int, 3>& site) {
    Point lower{}, size{};
    double volume = 1.0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a) {
      size[a] = 1.0 / sites_[a];
      lower[a] = site[a] * size[a];
      volume *= size[a] * cell_;
    }
    const int depth = dim_ == 3 ? probes : 1;
    int inside = 0;
    Point centroid{};
    for (int i = 0; i < probes; ++i)
      for (int j = 0; j < probes; ++j)
        for (int k = 0; k < depth; ++k) {
          const Point within = {lower[0] + (i + 0.5) / probes * size[0],
                                lower[1] + (j + 0.5) / probes * size[1],
                                dim_ == 3 ? lower[2] + (k + 0.5) / probes * size[2] : 0.0};
          if (!body_.contains(global(cell, within))) continue;
          ++inside;
          for (std::size_t a = 0; a < 3; ++a) centroid[a] += within[a];
        }
    const double share = static_cast<double>(inside) / (probes * probes * depth);
    if (share < smallest_share) return;
    for (auto& c : centroid) c /= inside;
    if (scene_.mpm.seeding == scenes::Seeding::jittered) centroid = jittered(cell, lower, size, centroid);
    const bool axisymmetric = scene_.geometry.dimension == scenes::Dimension::axisymmetric;
    const double ring = axisymmetric ? 2.0 * std::numbers::pi * global(cell, centroid)[0] : 1.0;
    Seed seed;
    seed.cell = cell;
    seed.position = centroid;
    seed.volume = volume * share * ring;
    if (scene_.thixotropy) seed.flocculation = scene_.thixotropy->initial_flocculation;
    seeds_.push_back(seed);
  }

  /// A random place in the site, inside the body; the centroid where a few tries find none.
  Point jittered(const CellIndex& cell, const Point& lower, const Point& size, const Point& centroid) {
    for (int attempt = 0; attempt < 16; ++attempt) {
      Point within{};
      for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a)
        within[a] = lower[a] + uniform() * size[a];
      if (body_.contains(global(cell, within))) return within;
    }
    return centroid;
  }

  /// In [0, 1), the same on every platform for the same seed (standard distributions are not).
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  Point global(const CellIndex& cell, const Point& within) const {
    Point x{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a) x[a] = (cell[a] + within[a]) * cell_;
    return x;
  }

  const scenes::Scene& scene_;
  const Body& body_;
  int dim_;
  double cell_;
  int sites_[3] = {1, 1, 1};
  std::mt19937_64 random_;
  std::vector<Seed> seeds_;
};

}  // namespace

std::vector<Seed> seed_particles(const scenes::Scene& scene) {
  const Body body = scene.kind == scenes::Kind::duct ? duct(scene) : cone(scene);
  return Sampler(scene, body).sample();
}

}  // namespace flowrest::mpm
