#include "foamCases/wedge_gauge.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "foamCases/concrete_rates.h"
#include "runs/quantile.h"

namespace flowrest::foam {

namespace {

constexpr double half_full = 0.5;
/// Cells with more air than this show the air's shear rate, not the concrete's.
constexpr double nearly_full = 0.9;

/// One velocity component on the grid, with its values on faces.
class Component {
 public:
  Component(const WedgeGrid& grid, const std::vector<double>& velocity, std::size_t component)
      : grid_(grid), velocity_(velocity), component_(component) {}

  double at(int ring, int row) const { return velocity_[3 * grid_.index(ring, row) + component_]; }

  /// Derivative along the radius; `at_axis` and `at_rim` are the values on the outermost faces.
  double along_radius(int ring, int row, double at_axis, double at_rim) const {
    const double inner = ring == 0 ? at_axis : 0.5 * (at(ring - 1, row) + at(ring, row));
    const double outer = ring + 1 == grid_.rings ? at_rim : 0.5 * (at(ring, row) + at(ring + 1, row));
    return (outer - inner) / grid_.ring_width;
  }

  /// Derivative upwards; `at_base` is the value on the base; nothing changes across the open top.
  double upwards(int ring, int row, double at_base) const {
    const double below = row == 0 ? at_base : face_above(ring, row - 1);
    const double above = row + 1 == grid_.rows() ? at(ring, row) : face_above(ring, row);
    return (above - below) / grid_.row_height(row);
  }

 private:
  double face_above(int ring, int row) const {
    const double below = grid_.row_height(row);
    const double above = grid_.row_height(row + 1);
    return (at(ring, row) * above + at(ring, row + 1) * below) / (below + above);
  }

  const WedgeGrid& grid_;
  const std::vector<double>& velocity_;
  std::size_t component_;
};

/// Going down, air is trapped where a cell is less full than the fullest one above it; a flank that leans
/// inwards traps none.
double trapped_air_in_column(const WedgeGrid& grid, const std::vector<double>& fraction, int ring) {
  double fullest_above = 0.0;
  double air = 0.0;
  for (int row = grid.rows() - 1; row >= 0; --row) {
    fullest_above = std::max(fullest_above, fraction[grid.index(ring, row)]);
    air += (fullest_above - fraction[grid.index(ring, row)]) * grid.cell_volume(ring, row);
  }
  return air;
}

double front_diameter(const WedgeGrid& grid, const std::vector<double>& fraction) {
  for (int ring = grid.rings - 1; ring >= 0; --ring) {
    const double inner = fraction[grid.index(ring, 0)];
    if (inner <= half_full) continue;
    const double outer = ring + 1 == grid.rings ? inner : fraction[grid.index(ring + 1, 0)];
    const double share = outer < inner ? (inner - half_full) / (inner - outer) : 0.0;
    return 2.0 * (grid.ring_centre(ring) + share * grid.ring_width);
  }
  return runs::nothing;
}

/// The shear rates within the concrete, and the layer along the base in which it is sheared.
void gauge_shear_rates(const WedgeGrid& grid, const SlumpFields& fields, bool slip, SlumpGauges& gauges) {
  const auto rate = fields.shear_rate.empty() ? shear_rate(grid, fields.velocity, slip) : fields.shear_rate;
  ConcreteRates in_concrete(fields.flow_index);
  for (int row = 0; row < grid.rows(); ++row)
    for (int ring = 0; ring < grid.rings; ++ring) {
      const auto cell = grid.index(ring, row);
      if (fields.fraction[cell] < nearly_full) continue;
      const double concrete = fields.fraction[cell] * grid.cell_volume(ring, row);
      in_concrete.add(rate[cell], concrete, fields.structure, cell);
      if (!slip)
        gauges.layer.add(
            {grid.row_centre(row), grid.row_height(row), grid.row_height(row), concrete, rate[cell]});
    }
  gauges.shear_rate_p99 = in_concrete.percentile();
  gauges.overstressing_rate_p99 = in_concrete.overstressing_percentile();
}

/// Velocity over the base by the half cell that lies between: the rate that the wall's stress answers to.
double base_shear_rate(const WedgeGrid& grid, const SlumpFields& fields) {
  std::vector<runs::Weighted> under_concrete;
  for (int ring = 0; ring < grid.rings; ++ring) {
    const auto cell = grid.index(ring, 0);
    if (fields.fraction[cell] >= nearly_full)
      under_concrete.emplace_back(std::abs(fields.velocity[3 * cell]) / (0.5 * grid.row_height(0)),
                                  grid.ring_area(ring));
  }
  return runs::percentile_99(std::move(under_concrete));
}

}  // namespace

std::vector<double> shear_rate(const WedgeGrid& grid, const std::vector<double>& velocity, bool slip) {
  const Component radial(grid, velocity, 0);
  const Component vertical(grid, velocity, 2);
  std::vector<double> rate(grid.cells());
  for (int row = 0; row < grid.rows(); ++row)
    for (int ring = 0; ring < grid.rings; ++ring) {
      const double u = radial.at(ring, row);
      const double w = vertical.at(ring, row);
      // No flow crosses the axis, the rim and the base; along the rim and a slip base it is free.
      const double radial_strain = radial.along_radius(ring, row, 0.0, 0.0);
      const double hoop_strain = u / grid.ring_centre(ring);
      const double vertical_strain = vertical.upwards(ring, row, 0.0);
      const double shear = radial.upwards(ring, row, slip ? u : 0.0) + vertical.along_radius(ring, row, w, w);
      rate[grid.index(ring, row)] =
          std::sqrt(2.0 * (radial_strain * radial_strain + hoop_strain * hoop_strain +
                           vertical_strain * vertical_strain) +
                    shear * shear);
    }
  return rate;
}

SlumpGauges gauge_slump(const WedgeGrid& grid, const SlumpFields& fields, double density, bool slip) {
  SlumpGauges gauges;
  for (int ring = 0; ring < grid.rings; ++ring) {
    double depth = 0.0;
    for (int row = 0; row < grid.rows(); ++row) {
      const auto cell = grid.index(ring, row);
      const double* u = &fields.velocity[3 * cell];
      depth += fields.fraction[cell] * grid.row_height(row);
      gauges.kinetic_energy += 0.5 * density * fields.fraction[cell] * grid.cell_volume(ring, row) *
                               (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    }
    gauges.radius.push_back(grid.ring_centre(ring));
    gauges.depth.push_back(depth);
    gauges.volume += depth * grid.ring_area(ring);
    gauges.trapped_air += trapped_air_in_column(grid, fields.fraction, ring);
  }
  gauges.rim_depth = gauges.depth.back();
  gauges.front = front_diameter(grid, fields.fraction);
  gauge_shear_rates(grid, fields, slip, gauges);
  gauges.base_shear_rate_p99 = slip ? 0.0 : base_shear_rate(grid, fields);
  return gauges;
}

double mean_over_concrete(const WedgeGrid& grid, const std::vector<double>& fraction,
                          const std::vector<double>& field) {
  double volume = 0.0, sum = 0.0;
  for (int row = 0; row < grid.rows(); ++row)
    for (int ring = 0; ring < grid.rings; ++ring) {
      const double concrete = fraction[grid.index(ring, row)] * grid.cell_volume(ring, row);
      volume += concrete;
      sum += concrete * field[grid.index(ring, row)];
    }
  return sum / volume;
}

}  // namespace flowrest::foam
