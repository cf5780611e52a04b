#include "foamCases/quarter_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "foamCases/concrete_rates.h"
#include "runs/depth.h"
#include "runs/quantile.h"
#include "scenes/pieces.h"

namespace flowrest::foam {

namespace {

constexpr double nearly_full = 0.9;
constexpr double half_full = 0.5;

/// What bounds a row of cells at its two ends: a plane through which nothing flows, along which the flow is
/// free (mirror), one to which it sticks (held), or one across which nothing changes (open).
enum class End { mirror, held, open };

/// Derivatives of one velocity component along one axis, cell by cell.
class Slope {
 public:
  Slope(const QuarterGrid& grid, const std::vector<double>& velocity, int component, int axis, bool slip)
      : grid_(grid), velocity_(velocity), component_(component), axis_(axis) {
    const bool across = component == axis;
    first_ = across ? End::held : End::open;
    last_ = first_;
    if (axis == 2) {
      first_ = across || !slip ? End::held : End::open;
      last_ = End::open;  // the atmosphere
    }
  }

  double at(std::array<int, 3> cell) const {
    const int count = axis_ == 2 ? grid_.rows() : grid_.side;
    const auto axis = static_cast<std::size_t>(axis_);
    const double here = value(cell);
    auto neighbour = cell;
    double low = first_ == End::held ? 0.0 : here;
    if (cell[axis] > 0) {
      --neighbour[axis];
      low = on_face(neighbour, cell);
    }
    neighbour = cell;
    double high = last_ == End::held ? 0.0 : here;
    if (cell[axis] + 1 < count) {
      ++neighbour[axis];
      high = on_face(cell, neighbour);
    }
    return (high - low) / size(cell);
  }

 private:
  double value(const std::array<int, 3>& cell) const {
    return velocity_[3 * grid_.index(cell[0], cell[1], cell[2]) + static_cast<std::size_t>(component_)];
  }
  double size(const std::array<int, 3>& cell) const {
    return axis_ == 2 ? grid_.row_height(cell[2]) : grid_.width;
  }
  double on_face(const std::array<int, 3>& a, const std::array<int, 3>& b) const {
    return (value(a) * size(b) + value(b) * size(a)) / (size(a) + size(b));
  }

  const QuarterGrid& grid_;
  const std::vector<double>& velocity_;
  int component_, axis_;
  End first_, last_;
};

template <class Visit>
void for_each_cell(const QuarterGrid& grid, Visit visit) {
  for (int row = 0; row < grid.rows(); ++row)
    for (int j = 0; j < grid.side; ++j)
      for (int i = 0; i < grid.side; ++i) visit(std::array<int, 3>{i, j, row});
}

double trapped_air(const QuarterGrid& grid, const std::vector<double>& fraction) {
  double air = 0.0;
  for (int j = 0; j < grid.side; ++j)
    for (int i = 0; i < grid.side; ++i) {
      double fullest = 0.0;
      for (int row = grid.rows() - 1; row >= 0; --row) {
        fullest = std::max(fullest, fraction[grid.index(i, j, row)]);
        air += (fullest - fraction[grid.index(i, j, row)]) * grid.cell_volume(row);
      }
    }
  return air;
}

/// Along x, as far as the base row is half full.
double front(const QuarterGrid& grid, const std::vector<double>& fraction) {
  for (int i = grid.side - 1; i >= 0; --i) {
    const double inner = fraction[grid.index(i, 0, 0)];
    if (inner <= half_full) continue;
    const double outer = i + 1 == grid.side ? inner : fraction[grid.index(i + 1, 0, 0)];
    const double share = outer < inner ? (inner - half_full) / (inner - outer) : 0.0;
    return 2.0 * (grid.centre(i) + share * grid.width);
  }
  return runs::nothing;
}

/// Depth over rings as wide as a cell, of the concrete in each column of the whole slump in m3: a ring gets
/// what of a column's plan it covers.
runs::RadialDepth depth_over_rings(const QuarterGrid& grid, const std::vector<double>& columns) {
  const double width = grid.width;
  runs::RadialDepth rings{width, std::vector<double>(static_cast<std::size_t>(grid.side), 0.0)};
  for (int j = 0; j < grid.side; ++j)
    for (int i = 0; i < grid.side; ++i) {
      const double concrete = columns[grid.index(i, j, 0)];
      if (!(concrete > 0.0)) continue;
      const auto within = [&](int ring) {  // share of the column's plan inside a ring's inner edge
        const double r = ring * width, west = i * width, south = j * width;
        return (disc_in_rectangle(r, west + width, south + width) -
                disc_in_rectangle(r, west, south + width) - disc_in_rectangle(r, west + width, south) +
                disc_in_rectangle(r, west, south)) /
               (width * width);
      };
      double inside = 0.0;
      const int last = grid.side - 1;
      for (int ring = std::min(last, static_cast<int>(std::hypot(i, j))); inside < 1.0; ++ring) {
        // What lies beyond the last ring counts to the last ring.
        const double further = ring < last ? std::min(1.0, within(ring + 1)) : 1.0;
        rings.depth[static_cast<std::size_t>(ring)] += (further - inside) * concrete;
        inside = further;
        if (ring == last) break;
      }
    }
  for (std::size_t ring = 0; ring < rings.depth.size(); ++ring)
    rings.depth[ring] /= std::numbers::pi * width * width * (2.0 * static_cast<double>(ring) + 1.0);
  return rings;
}

}  // namespace

QuarterGrid quarter_grid(const scenes::Scene& scene) {
  const double along = scenes::pieces_of(scene).domain->radius / scene.foam.cell;
  QuarterGrid grid;
  static_cast<SlumpRows&>(grid) = slump_rows(scene, along * along);
  grid.side = cells_along_radius(scene);
  grid.width = scenes::pieces_of(scene).domain->radius / grid.side;
  return grid;
}

double disc_in_rectangle(double radius, double x, double y) {
  if (!(x > 0.0 && y > 0.0 && radius > 0.0)) return 0.0;
  const double r2 = radius * radius;
  const double wide = std::min(x, radius);
  if (wide * wide + y * y <= r2) return wide * y;
  // Up to `flat` the arc lies above y; from there to `wide` it bounds the area from above.
  const double flat = y < radius ? std::sqrt(r2 - y * y) : 0.0;
  const auto under_arc = [&](double u) {
    return 0.5 * (u * std::sqrt(std::max(0.0, r2 - u * u)) + r2 * std::asin(std::min(1.0, u / radius)));
  };
  return flat * y + under_arc(wide) - under_arc(flat);
}

std::vector<double> shear_rate(const QuarterGrid& grid, const std::vector<double>& velocity, bool slip) {
  std::vector<Slope> slopes;
  for (int component = 0; component < 3; ++component)
    for (int axis = 0; axis < 3; ++axis) slopes.emplace_back(grid, velocity, component, axis, slip);
  std::vector<double> rate(grid.cells());
  for_each_cell(grid, [&](const std::array<int, 3>& cell) {
    std::array<double, 9> gradient{};
    for (std::size_t k = 0; k < 9; ++k) gradient[k] = slopes[k].at(cell);
    double sum = 0.0;  // 2 D:D
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const double strain = 0.5 * (gradient[3 * a + b] + gradient[3 * b + a]);
        sum += 2.0 * strain * strain;
      }
    rate[grid.index(cell[0], cell[1], cell[2])] = std::sqrt(sum);
  });
  return rate;
}

SlumpGauges gauge_slump(const QuarterGrid& grid, const SlumpFields& fields, double density, bool slip) {
  SlumpGauges gauges;
  std::vector<double> columns(grid.columns(), 0.0);  // m3, of concrete
  const auto rate = fields.shear_rate.empty() ? shear_rate(grid, fields.velocity, slip) : fields.shear_rate;
  ConcreteRates inside(fields.flow_index);
  std::vector<runs::Weighted> at_base;
  for_each_cell(grid, [&](const std::array<int, 3>& cell) {
    const auto [i, j, row] = cell;
    const auto index = grid.index(i, j, row);
    const double concrete = fields.fraction[index] * grid.cell_volume(row);
    const double* u = &fields.velocity[3 * index];
    gauges.volume += concrete;
    gauges.kinetic_energy += 0.5 * density * concrete * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    columns[grid.index(i, j, 0)] += concrete;
    if (fields.fraction[index] < nearly_full) return;
    inside.add(rate[index], concrete, fields.structure, index);
    if (!slip)
      gauges.layer.add(
          {grid.row_centre(row), grid.row_height(row), grid.row_height(row), concrete, rate[index]});
    if (row == 0) at_base.emplace_back(std::hypot(u[0], u[1]) / (0.5 * grid.row_height(0)), 1.0);
  });
  const runs::RadialDepth depth = depth_over_rings(grid, columns);
  gauges.radius = depth.centres();
  gauges.depth = depth.depth;
  for (int k = 0; k < grid.side; ++k) {
    double column = 0.0;
    for (int row = 0; row < grid.rows(); ++row)
      column += std::max(fields.fraction[grid.index(grid.side - 1, k, row)],
                         fields.fraction[grid.index(k, grid.side - 1, row)]) *
                grid.row_height(row);
    gauges.rim_depth = std::max(gauges.rim_depth, column);
  }
  gauges.trapped_air = trapped_air(grid, fields.fraction);
  gauges.front = front(grid, fields.fraction);
  gauges.shear_rate_p99 = inside.percentile();
  gauges.overstressing_rate_p99 = inside.overstressing_percentile();
  gauges.base_shear_rate_p99 = slip ? 0.0 : runs::percentile_99(std::move(at_base));
  return gauges;
}

double mean_over_concrete(const QuarterGrid& grid, const std::vector<double>& fraction,
                          const std::vector<double>& field) {
  double volume = 0.0, sum = 0.0;
  for_each_cell(grid, [&](const std::array<int, 3>& cell) {
    const auto index = grid.index(cell[0], cell[1], cell[2]);
    const double concrete = fraction[index] * grid.cell_volume(cell[2]);
    volume += concrete;
    sum += concrete * field[index];
  });
  return sum / volume;
}

}  // namespace flowrest::foam
