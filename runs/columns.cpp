#include "runs/columns.h"

#include <array>

namespace flowrest::runs {

std::span<const Column* const> every_column() {
  static constexpr std::array all = {&column::time,
                                     &column::spread,
                                     &column::spread_at_half_depth,
                                     &column::spread_at_twice_depth,
                                     &column::spread_of_mass,
                                     &column::height,
                                     &column::spread_uncertainty,
                                     &column::spread_by_grid,
                                     &column::spread_by_rounding,
                                     &column::height_uncertainty,
                                     &column::plug_velocity,
                                     &column::mean_velocity,
                                     &column::front,
                                     &column::front_of_mass,
                                     &column::start_height,
                                     &column::end_height,
                                     &column::discharged,
                                     &column::suction,
                                     &column::thinnest_sight,
                                     &column::strand_width,
                                     &column::strand_height,
                                     &column::section_area,
                                     &column::base_width,
                                     &column::area_over_balance,
                                     &column::nozzle_drag,
                                     &column::nozzle_push,
                                     &column::volume,
                                     &column::volume_at_rest,
                                     &column::kinetic_energy,
                                     &column::potential_energy,
                                     &column::elastic_energy,
                                     &column::dissipated_energy,
                                     &column::numerical_energy,
                                     &column::shear_rate,
                                     &column::base_shear_rate,
                                     &column::sheared_layer,
                                     &column::sheared_layer_cells,
                                     &column::mean_shear_rate,
                                     &column::residual,
                                     &column::chatter,
                                     &column::courant,
                                     &column::time_step,
                                     &column::trapped_air,
                                     &column::volume_error,
                                     &column::flocculation,
                                     &column::yield_stress};
  return all;
}

const Column* column_named(const std::string& name) {
  for (const Column* column : every_column())
    if (name == column->name) return column;
  return nullptr;
}

std::vector<std::string> Row::names() const {
  std::vector<std::string> names;
  for (const Column* column : columns_) names.emplace_back(column->name);
  return names;
}

}  // namespace flowrest::runs
