#include "mpm/output/hand_over.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <utility>

#include "mpm/output/hdf5_file.h"
#include "mpm/solver/settings.h"
#include "runs/bins.h"
#include "runs/depth.h"
#include "runs/earlier_run.h"
#include "runs/state_surface.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

namespace fs = std::filesystem;
using runs::Carried;
using runs::DepthColumns;
using runs::MaterialState;
using runs::Parcel;
using scenes::Dimension;

namespace {

/// A site with less than this share in it gets no particle of its own.
constexpr double smallest_share = 0.2;

DepthColumns::Plan plan_of(Dimension dimension) {
  if (dimension == Dimension::axisymmetric) return DepthColumns::Plan::rings;
  return dimension == Dimension::plane ? DepthColumns::Plan::strips : DepthColumns::Plan::squares;
}

runs::ParticleSites sites_of(const scenes::Scene& scene) {
  return {cell_size(scene), scene.mpm.particles_per_cell};
}

/// Volume over that at rest under a pressure (Yu et al. 2026, Eq. 6 solved for J).
double ratio_at(const scenes::Material& material, double pressure) {
  const double exponent = material.equation_of_state_exponent;
  return 1.0 - std::log1p(exponent * pressure / material.bulk_modulus()) / exponent;
}

/// The recorded times of a run and their files.
std::vector<std::pair<double, fs::path>> recorded(const fs::path& directory) {
  const fs::path folder = directory / "particles";
  std::ifstream file(folder / "particles.hdf.series");
  const auto series = nlohmann::json::parse(file, nullptr, false);
  std::vector<std::pair<double, fs::path>> states;
  if (series.is_discarded() || !series.contains("files")) return states;
  for (const auto& entry : series["files"])
    if (const fs::path state = folder / entry.value("name", ""); fs::is_regular_file(state))
      states.emplace_back(entry.value("time", 0.0), state);
  return states;
}

/// Reads one file of particles.
class SnapshotReader {
 public:
  SnapshotReader(const fs::path& path, const scenes::Scene& scene)
      : file_(Hdf5File::open(path)), scene_(scene), factor_(scenes::pieces_of(scene).whole_over_computed) {}

  std::vector<Parcel> parcels() const {
    const auto points = file_.read_doubles("/VTKHDF/Points"), velocity = data("velocity"),
               volume = data("volume"), pressure = data("raw_pressure"), stress = data("stress"),
               rate = data("shear_rate");
    const auto flocculation = scene_.thixotropy ? data("flocculation") : std::vector<double>(volume.size());
    std::vector<Parcel> parcels(volume.size());
    for (std::size_t p = 0; p < parcels.size(); ++p) {
      Parcel& parcel = parcels[p];
      parcel.volume_ratio = ratio_at(scene_.material, pressure[p]);
      parcel.volume = factor_ * volume[p] / parcel.volume_ratio;
      place(parcel, &points[3 * p], volume[p]);
      std::copy_n(&velocity[3 * p], 3, parcel.velocity.begin());
      const double* const s = &stress[6 * p];  // XX, YY, ZZ, XY, YZ, XZ
      parcel.stress = {s[0], s[3], s[5], s[1], s[4], s[2]};
      parcel.shear_rate = rate[p];
      parcel.flocculation = flocculation[p];
    }
    return parcels;
  }

 private:
  std::vector<double> data(const char* name) const {
    return file_.read_doubles(std::string("/VTKHDF/PointData/") + name);
  }

  /// A box of the particle's volume about its place, square in its section.
  void place(Parcel& parcel, const double* point, double volume) const {
    const bool in_space = scene_.spatial_dimension() == 3;
    const bool ring = scene_.geometry.dimension == Dimension::axisymmetric;
    const double around = ring ? 2.0 * std::numbers::pi * std::max(point[0], 1e-12) : 1.0;
    const double half = 0.5 * (in_space ? std::cbrt(volume) : std::sqrt(volume / around));
    for (std::size_t a = 0; a < 3; ++a) {
      const double reach = a == 1 && !in_space ? 0.0 : half;
      parcel.low[a] = point[a] - reach;
      parcel.high[a] = point[a] + reach;
    }
  }

  Hdf5File file_;
  const scenes::Scene& scene_;
  double factor_;
};

/// Numbers of a file are kept to seven digits, and the body's volume is known.
void restore_volume(std::vector<Parcel>& parcels, const scenes::Scene& scene) {
  constexpr double rounding = 1e-5;
  const scenes::Pieces pieces = scenes::pieces_of(scene);
  double body = 0.0, held = 0.0;
  for (const auto& b : pieces.bodies) body += pieces.whole_over_computed * b.volume;
  for (const Parcel& parcel : parcels) held += parcel.volume;
  if (!(std::abs(held - body) <= rounding * body)) return;
  for (Parcel& parcel : parcels) parcel.volume *= body / held;
}

/// Depth as the gauge reads it: a particle is as wide as it was placed.
DepthColumns columns_of(const std::vector<Parcel>& parcels, const scenes::Scene& scene) {
  const double cell = cell_size(scene), grain = cell / scene.mpm.particles_per_cell.front();
  const auto centre = [](const Parcel& p, std::size_t a) { return 0.5 * (p.low[a] + p.high[a]); };
  double farthest = 0.0;
  for (const Parcel& p : parcels) farthest = std::max({farthest, centre(p, 0), centre(p, 1)});
  DepthColumns columns;
  columns.plan = plan_of(scene.geometry.dimension);
  columns.width = cell;
  columns.along_x = static_cast<int>(std::ceil((farthest + 2.0 * cell) / cell - 1e-9));
  if (columns.plan != DepthColumns::Plan::squares) {
    const bool rings = columns.plan == DepthColumns::Plan::rings;
    runs::DepthAccumulator depth(rings ? runs::About::axis : runs::About::plane, cell, farthest + 2.0 * cell,
                                 grain);
    for (const Parcel& p : parcels) depth.add(std::abs(centre(p, 0)), rings ? p.volume : 0.5 * p.volume);
    columns.depth = depth.depth();
    return columns;
  }
  const int side = columns.along_y = columns.along_x;
  columns.depth.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0.0);
  const auto mirrored = [&](long i) {
    return static_cast<std::size_t>(std::min<long>(i < 0 ? -1 - i : i, side - 1));
  };
  const double plan = DepthColumns::area(columns.plan, 0.0, cell, 0.0, cell), width = grain / cell;
  for (const Parcel& p : parcels) {
    const double x = centre(p, 0) / cell, y = centre(p, 1) / cell;
    runs::for_each_bin(x - 0.5 * width, x + 0.5 * width, [&](long i, double across) {
      runs::for_each_bin(y - 0.5 * width, y + 0.5 * width, [&](long j, double along) {
        columns.depth[mirrored(i) + static_cast<std::size_t>(side) * mirrored(j)] +=
            across * along / (width * width) * p.volume / plan;
      });
    });
  }
  return columns;
}

/// Fills the columns of the lattice's sites with what a state holds.
class Filling {
 public:
  Filling(const scenes::Scene& scene, const MaterialState& state)
      : scene_(scene),
        state_(state),
        cell_(cell_size(scene)),
        plan_(plan_of(scene.geometry.dimension)),
        vertical_(static_cast<std::size_t>(scene.spatial_dimension() - 1)),
        factor_(scenes::pieces_of(scene).whole_over_computed),
        surface_(state.columns, 0.1 * scene.gauges.spread_depth),
        field_(state) {
    for (std::size_t a = 0; a < 3; ++a)
      spacing_[a] =
          cell_ / scene.mpm.particles_per_cell[std::min(a, scene.mpm.particles_per_cell.size() - 1)];
    if (vertical_ == 1) spacing_[2] = cell_ / scene.mpm.particles_per_cell[1];
    along_x_ = sites_along(0);
    along_y_ = plan_ == DepthColumns::Plan::squares ? sites_along(1) : 1;
  }

  std::vector<Seed> seeds() {
    const auto contents = contents_of_columns();
    for (std::size_t j = 0; j < along_y_; ++j)
      for (std::size_t i = 0; i < along_x_; ++i) fill(i, j, contents[i + along_x_ * j]);
    conserve(state_, received_);
    for (std::size_t p = 0; p < seeds_.size(); ++p) give(received_.carried[p], seeds_[p]);
    return seeds_;
  }

  /// The state's own particles.
  std::vector<Seed> as_they_are() {
    for (const Parcel& p : state_.parcels)
      add({0.5 * (p.low[0] + p.high[0]), 0.5 * (p.low[1] + p.high[1]), 0.5 * (p.low[2] + p.high[2])},
          p.volume, {p.velocity, p.stress, p.shear_rate, p.volume_ratio, p.flocculation});
    for (std::size_t p = 0; p < seeds_.size(); ++p) give(received_.carried[p], seeds_[p]);
    return seeds_;
  }

 private:
  std::size_t sites_along(std::size_t axis) const {
    return static_cast<std::size_t>(std::ceil(surface_.reach() / spacing_[axis]));
  }
  double west(std::size_t i) const { return static_cast<double>(i) * spacing_[0]; }
  double south(std::size_t j) const {
    return plan_ == DepthColumns::Plan::squares ? static_cast<double>(j) * spacing_[1] : 0.0;
  }
  double north(std::size_t j) const {
    return plan_ == DepthColumns::Plan::squares ? static_cast<double>(j + 1) * spacing_[1] : 0.0;
  }
  double area(std::size_t i, std::size_t j) const {
    return DepthColumns::area(plan_, west(i), west(i + 1), south(j), north(j));
  }

  /// What each column holds, m3. One too shallow for a particle hands its own on inwards.
  std::vector<double> contents_of_columns() const {
    std::vector<double> contents(along_x_ * along_y_);
    for (std::size_t j = 0; j < along_y_; ++j)
      for (std::size_t i = 0; i < along_x_; ++i)
        contents[i + along_x_ * j] = surface_.volume(west(i), west(i + 1), south(j), north(j));
    std::vector<std::size_t> outside_first(contents.size());
    std::iota(outside_first.begin(), outside_first.end(), std::size_t{0});
    std::stable_sort(outside_first.begin(), outside_first.end(), [&](std::size_t a, std::size_t b) {
      return steps_from_middle(a) > steps_from_middle(b);
    });
    for (const std::size_t c : outside_first) {
      const std::size_t i = c % along_x_, j = c / along_x_;
      if (c == 0 || contents[c] >= smallest_share * spacing_[2] * area(i, j)) continue;
      contents[i >= j && i > 0 ? c - 1 : c - along_x_] += std::exchange(contents[c], 0.0);
    }
    return contents;
  }
  std::size_t steps_from_middle(std::size_t column) const { return column % along_x_ + column / along_x_; }

  /// From the floor upwards, site by site.
  void fill(std::size_t i, std::size_t j, double content) {
    const double plan = area(i, j), height = spacing_[2];
    double left = content / plan, at_rest = 0.0, place = 0.0;  // m
    while (left > 0.0) {
      const double ratio =
          state_.knows_pressure
              ? field_.in_box({west(i), south(j), place}, {west(i + 1), north(j), place + height})
                    .volume_ratio
              : ratio_under(std::max(0.0, left - 0.5 * height));
      const double room = height / ratio;
      const double taken = left - room < smallest_share * room ? left : room;
      // What knows no pressure stands as if it had none.
      const double from = state_.knows_pressure ? place : at_rest;
      const double thick = state_.knows_pressure ? taken * ratio : taken;
      Carried carried = field_.in_box({west(i), south(j), from}, {west(i + 1), north(j), from + thick});
      carried.volume_ratio = ratio;
      add({0.5 * (west(i) + west(i + 1)), 0.5 * (south(j) + north(j)), place + 0.5 * taken * ratio},
          taken * plan, carried);
      left = taken == left ? 0.0 : left - taken;
      at_rest += taken;
      place += taken * ratio;
    }
  }
  double ratio_under(double depth) const {
    return ratio_at(scene_.material, scene_.material.density * scene_.forces.gravity * depth);
  }

  void add(const std::array<double, 3>& place, double volume, const Carried& carried) {
    Seed seed;
    for (std::size_t a = 0; a <= vertical_; ++a) {
      const double at = place[a == vertical_ ? 2 : a] / cell_;
      seed.cell[a] = static_cast<std::int32_t>(std::floor(at));
      seed.position[a] = at - std::floor(at);
    }
    seed.volume = volume / factor_;
    seeds_.push_back(seed);
    received_.mass.push_back(volume * state_.density);
    received_.carried.push_back(carried);
  }

  void give(const Carried& carried, Seed& seed) const {
    const auto& s = carried.stress;  // xx, xy, xz, yy, yz, zz
    seed.velocity =
        vertical_ == 2 ? carried.velocity : std::array{carried.velocity[0], carried.velocity[2], 0.0};
    seed.deviator =
        vertical_ == 2 ? std::array{s[0], s[3], s[1], s[2], s[4]} : std::array{s[0], s[5], s[2], 0.0, 0.0};
    seed.rate = carried.shear_rate;
    seed.volume_ratio = carried.volume_ratio;
    seed.flocculation = carried.flocculation;
  }

  const scenes::Scene& scene_;
  const MaterialState& state_;
  double cell_;
  DepthColumns::Plan plan_;
  std::size_t vertical_;  ///< axis of the solver
  double factor_;
  runs::StateSurface surface_;
  runs::ParcelField field_;
  std::array<double, 3> spacing_{};  ///< m, of sites along x, y and upwards
  std::size_t along_x_ = 0, along_y_ = 1;
  std::vector<Seed> seeds_;
  runs::Received received_;
};

}  // namespace

MaterialState read_state(const std::string& from) {
  const runs::StateName name = runs::state_name(from);
  const runs::EarlierRun run = runs::read_earlier_run(name.run, "mpm");
  const auto states = recorded(run.directory);
  std::vector<double> times;
  for (const auto& state : states) times.push_back(state.first);
  const std::size_t which = runs::recorded_time(name, times, 1e-9);
  MaterialState state;
  state.from = from;
  state.solver = "mpm";
  state.model = scenes::to_string(run.scene.material.model);
  state.run = fmt::format("{}, MPM {}", run.scene.name, state.model);
  state.kind = scenes::name_of(run.scene.geometry.apparatus);
  state.dimension = run.scene.geometry.dimension;
  state.time = times[which];
  state.density = run.scene.material.density;
  state.knows_pressure = true;
  state.flocculates = run.scene.thixotropy.has_value();
  if (!runs::can_be_handed_over(run.scene)) return state;  // it is refused by what it is
  try {
    state.parcels = SnapshotReader(states[which].second, run.scene).parcels();
  } catch (const runs::RunError& error) {
    throw runs::RunError(
        fmt::format("--from {}: its particles cannot be handed over, as those of versions before "
                    "0.2.0 have no stress: {}",
                    from, error.what()));
  }
  restore_volume(state.parcels, run.scene);
  state.columns = columns_of(state.parcels, run.scene);
  state.sites = sites_of(run.scene);
  return state;
}

std::vector<Seed> seeds_of_state(const scenes::Scene& scene, const MaterialState& state) {
  Filling filling(scene, state);
  return state.sites == sites_of(scene) ? filling.as_they_are() : filling.seeds();
}

}  // namespace flowrest::mpm
