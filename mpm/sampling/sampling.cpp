#include "mpm/sampling/sampling.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <random>

#include "mpm/sampling/gmsh_mesh.h"
#include "mpm/solver/settings.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

namespace {

using scenes::Body;
using scenes::Filling;
using scenes::Point;

/// Points per axis and site that decide how much of a site lies inside the body.
constexpr int probes = 4;
/// Sites with less than this inside are left out; the scaling makes up for their volume.
constexpr double smallest_share = 0.2;

/// Volume ratios of material under its own weight (Yu et al. 2026, Eq. 6 solved for J), against the depth
/// under its surface.
class WeightTable {
 public:
  explicit WeightTable(const scenes::Scene& scene)
      : thickness_(scene.body_height() / (entries - 1)),
        bulk_modulus_(scene.material.bulk_modulus()),
        exponent_(scene.material.equation_of_state_exponent) {
    // Downwards by the midpoint rule: dp = density / J g dz.
    const double weight = scene.material.density * scene.forces.gravity;
    double pressure = 0.0;
    for (int i = 0; i < entries; ++i) {
      ratio_.push_back(ratio_at(pressure));
      const double middle = pressure + 0.5 * thickness_ * weight / ratio_at(pressure);
      pressure += thickness_ * weight / ratio_at(middle);
    }
  }
  double ratio(double depth) const {
    const double place = std::clamp(depth / thickness_, 0.0, entries - 1.0);
    const auto i = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(entries - 2));
    return std::lerp(ratio_[i], ratio_[i + 1], place - static_cast<double>(i));
  }
  /// Height that a column of this height without weight takes under it, m.
  double settled(double height) const {
    double filled = 0.0, place = 0.0;
    const double slice = 1e-4 * height;
    while (filled < height) {
      filled += slice / ratio(place);
      place += slice;
    }
    return place - (filled - height) * ratio(place);
  }

 private:
  static constexpr int entries = 1001;
  double ratio_at(double pressure) const {
    return 1.0 - std::log1p(exponent_ * pressure / bulk_modulus_) / exponent_;
  }
  double thickness_, bulk_modulus_, exponent_;
  std::vector<double> ratio_;
};

/// A box of what was poured into it unburdened: as high as it stands under its own weight.
Body settled(Body body, std::size_t up, double height) {
  for (auto& corner : body.outline)
    if (corner[1] == body.upper[up]) corner[1] = height;
  body.upper[up] = height;
  body.volume = 1.0;
  for (std::size_t a = 0; a <= up; ++a) body.volume *= body.upper[a] - body.lower[a];
  return body;
}

/// Fills a body with particles, as often as it is asked to: that takes less than to remember them all.
class Sampler {
 public:
  Sampler(const scenes::Scene& scene, Body body)
      : scene_(scene), body_(std::move(body)), dim_(scene.spatial_dimension()), cell_(cell_size(scene)) {
    for (int a = 0; a < dim_; ++a) sites_[a] = scene.mpm.particles_per_cell.at(static_cast<std::size_t>(a));
    if (body_.filling != Filling::unburdened) weight_.emplace(scene);
    const auto up = static_cast<std::size_t>(vertical_axis(scene));
    if (body_.filling == Filling::poured_to_rest)
      body_ = settled(body_, up, weight_->settled(body_.upper[up]));
    if (scene.mpm.seeding == scenes::Seeding::gmsh) {
      const MeshedBody meshed{body_.outline, dim_, body_.turn, body_.lower[1], body_.upper[1]};
      const double sites = static_cast<double>(sites_[0]) * sites_[1] * sites_[2];
      elements_ = mesh_by_gmsh(meshed, std::pow(cell_, dim_) / sites);
    }
    double total = 0.0;
    fill([&](const Seed& seed) { total += seed.volume; });
    scale_ = body_.volume / total;
  }

  void sample(const std::function<void(const Seed&)>& use) {
    const auto up = static_cast<std::size_t>(vertical_axis(scene_));
    fill([&](Seed& seed) {
      seed.volume *= scale_;
      if (weight_) {
        seed.volume_ratio = weight_->ratio(body_.upper[up] - (seed.cell[up] + seed.position[up]) * cell_);
        seed.volume /= seed.volume_ratio;
      }
      use(seed);
    });
  }

 private:
  using Use = std::function<void(Seed&)>;

  /// Tells all seeds, with volumes as they come.
  void fill(const Use& use) {
    random_.seed(scene_.mpm.seed);
    if (scene_.mpm.seeding == scenes::Seeding::gmsh) {
      fill_with_elements(use);
    } else {
      fill_cells(use);
    }
  }

  /// A particle at the centroid of every element of an unstructured mesh, with the element's own volume.
  void fill_with_elements(const Use& use) {
    for (const MeshElement& element : elements_) {
      CellIndex cell{};
      Point within{};
      for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a) {
        const double place = element.centroid[a] / cell_;
        cell[a] = static_cast<int>(std::floor(place));
        within[a] = place - cell[a];
      }
      add_seed(use, cell, within, element.size);
    }
  }

  void fill_cells(const Use& use) {
    std::array<int, 3> first{}, last{1, 1, 1};
    for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a) {
      // A face that lies on a multiple of the cell within round-off bounds no further cell.
      first[a] = static_cast<int>(std::floor(body_.lower[a] / cell_ + 1e-9));
      last[a] = static_cast<int>(std::ceil(body_.upper[a] / cell_ - 1e-9));
    }
    const bool first_time = filled_.empty();
    std::size_t number = 0;
    for (int i = first[0]; i < last[0]; ++i)
      for (int j = first[1]; j < last[1]; ++j)
        for (int k = first[2]; k < last[2]; ++k, ++number) {
          if (first_time)
            filled_.push_back(fill_cell(use, {i, j, k}));
          else if (filled_[number])
            fill_cell(use, {i, j, k});
        }
  }

  /// False where there is nothing to fill it with.
  bool fill_cell(const Use& use, const CellIndex& cell) {
    const int in_depth = dim_ == 3 ? sites_[2] : 1;
    const bool inside = lies_inside(cell);
    bool filled = false;
    for (int i = 0; i < sites_[0]; ++i)
      for (int j = 0; j < sites_[1]; ++j)
        for (int k = 0; k < in_depth; ++k)
          if (fill_site(use, cell, {i, j, k}, inside)) filled = true;
    return filled;
  }

  /// Whether all of a cell is certainly inside, so that none of its points need be asked for: its corners
  /// are, and so are those a little further out. Most cells of a large body are.
  bool lies_inside(const CellIndex& cell) const {
    constexpr double further = 1e-6;  // cells; far more than round-off
    bool inside = body_.convex;
    for (int corner = 0; inside && corner < 1 << dim_; ++corner) {
      Point within{};
      for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a)
        within[a] = corner >> a & 1 ? 1.0 + further : -further;
      inside = contains(global(cell, within));
    }
    return inside;
  }

  bool fill_site(const Use& use, const CellIndex& cell, const std::array<int, 3>& site, bool all_inside) {
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
          if (!all_inside && !contains(global(cell, within))) continue;
          ++inside;
          for (std::size_t a = 0; a < 3; ++a) centroid[a] += within[a];
        }
    const double share = static_cast<double>(inside) / (probes * probes * depth);
    if (share < smallest_share) return false;
    for (auto& c : centroid) c /= inside;
    if (scene_.mpm.seeding == scenes::Seeding::jittered) centroid = jittered(cell, lower, size, centroid);
    add_seed(use, cell, centroid, volume * share);
    return true;
  }

  bool contains(const Point& x) const {
    const auto up = static_cast<std::size_t>(dim_ - 1);
    return x[up] <= body_.upper[up] && body_.contains(x);
  }

  /// `size` is the area in the plane, also where that stands for a ring (Pappus: exact at a centroid).
  void add_seed(const Use& use, const CellIndex& cell, const Point& within, double size) {
    const bool axisymmetric = scene_.geometry.dimension == scenes::Dimension::axisymmetric;
    Seed seed;
    seed.cell = cell;
    seed.position = within;
    seed.volume = size * (axisymmetric ? 2.0 * std::numbers::pi * global(cell, within)[0] : 1.0);
    if (scene_.thixotropy) seed.flocculation = scene_.thixotropy->initial_flocculation;
    use(seed);
  }

  /// A random place in the site, inside the body; the centroid where a few tries find none.
  Point jittered(const CellIndex& cell, const Point& lower, const Point& size, const Point& centroid) {
    for (int attempt = 0; attempt < 16; ++attempt) {
      Point within{};
      for (std::size_t a = 0; a < static_cast<std::size_t>(dim_); ++a)
        within[a] = lower[a] + uniform() * size[a];
      if (contains(global(cell, within))) return within;
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

  scenes::Scene scene_;
  Body body_;
  int dim_;
  double cell_;
  int sites_[3] = {1, 1, 1};
  std::mt19937_64 random_;
  std::vector<MeshElement> elements_;  ///< where a mesh is asked for
  std::vector<bool> filled_;           ///< cells of the bounding box, once they have been seen
  std::optional<WeightTable> weight_;  ///< where the material carries its weight already
  double scale_ = 1.0;                 ///< of volumes, so that they sum to the body's
};

}  // namespace

SeedSource seeds_of(const scenes::Scene& scene) {
  std::vector<std::shared_ptr<Sampler>> samplers;
  for (const Body& body : scenes::pieces_of(scene).bodies)
    samplers.push_back(std::make_shared<Sampler>(scene, body));
  return [samplers](const std::function<void(const Seed&)>& use) {
    for (const auto& sampler : samplers) sampler->sample(use);
  };
}

std::vector<Seed> seed_particles(const scenes::Scene& scene) {
  std::vector<Seed> seeds;
  seeds_of(scene)([&](const Seed& seed) { seeds.push_back(seed); });
  return seeds;
}

}  // namespace flowrest::mpm
