#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenes/scene.h"

/// Every column of history.csv, once: its name, its unit, what it means, what it is read at. A solver gives
/// values by column, in SI units; a new column is an entry here.
namespace flowrest::runs {

struct Column {
  const char* name;     ///< "spread_mm"
  const char* unit;     ///< "mm"; empty for a share or a number
  const char* meaning;  ///< of the whole body, for readers
  double per_si = 1.0;  ///< of the column's unit in one SI unit
  /// Whether it may have nothing to read in a run that is in order.
  bool may_be_empty = false;
  /// What it is read at, in SI units, and the name of that in run.json's `gauges`; none where nothing is.
  const char* read_at = nullptr;
  double (*threshold)(const scenes::Gauges&) = nullptr;
};

namespace column {

// Lengths are read where there is enough material: all but the spread, which every slump has.
inline constexpr Column time = {.name = "time_s", .unit = "s", .meaning = "time since the release"};
inline constexpr Column spread = {
    .name = "spread_mm",
    .unit = "mm",
    .meaning = "twice the radius at which the depth falls through gauges.spread_depth",
    .per_si = 1e3,
    .read_at = "depth_m",
    .threshold = [](const scenes::Gauges& g) { return g.spread_depth; }};
inline constexpr Column spread_at_half_depth = {
    .name = "spread_1p5_mm",
    .unit = "mm",
    .meaning = "the spread at half of gauges.spread_depth",
    .per_si = 1e3,
    .may_be_empty = true,
    .read_at = "depth_m",
    .threshold = [](const scenes::Gauges& g) { return 0.5 * g.spread_depth; }};
inline constexpr Column spread_at_twice_depth = {
    .name = "spread_6_mm",
    .unit = "mm",
    .meaning = "the spread at twice gauges.spread_depth",
    .per_si = 1e3,
    .may_be_empty = true,
    .read_at = "depth_m",
    .threshold = [](const scenes::Gauges& g) { return 2.0 * g.spread_depth; }};
inline constexpr Column spread_of_mass = {.name = "spread_mass_995_mm",
                                          .unit = "mm",
                                          .meaning = "twice the radius that holds 99.5 % of the mass",
                                          .per_si = 1e3,
                                          .may_be_empty = true};
inline constexpr Column height = {
    .name = "height_mm", .unit = "mm", .meaning = "depth at the centre", .per_si = 1e3, .may_be_empty = true};
// Of a solution that knows how well it knows its lengths:
inline constexpr Column spread_uncertainty = {.name = "spread_uncertainty_mm",
                                              .unit = "mm",
                                              .meaning = "how well the spread is known, plus or minus",
                                              .per_si = 1e3};
inline constexpr Column spread_by_grid = {.name = "spread_by_grid_mm",
                                          .unit = "mm",
                                          .meaning = "the part of that uncertainty that grid and step have",
                                          .per_si = 1e3};
inline constexpr Column spread_by_rounding = {
    .name = "spread_by_rounding_mm",
    .unit = "mm",
    .meaning = "the part of it that the rounding of the flow law at small rates has",
    .per_si = 1e3};
inline constexpr Column height_uncertainty = {
    .name = "height_uncertainty_mm",
    .unit = "mm",
    .meaning = "how well the depth at the centre is known, plus or minus",
    .per_si = 1e3};
inline constexpr Column plug_velocity = {
    .name = "plug_velocity_m_s", .unit = "m/s", .meaning = "velocity in the middle between the plates"};
inline constexpr Column mean_velocity = {
    .name = "mean_velocity_m_s", .unit = "m/s", .meaning = "mean velocity along the plates"};
inline constexpr Column front = {
    .name = "front_mm",
    .unit = "mm",
    .meaning =
        "place, from the gate or the tank's corner, at which the depth falls through "
        "gauges.front_depth; of a slump in OpenFOAM twice the radius at which the lowest row of cells "
        "is half full",
    .per_si = 1e3,
    .may_be_empty = true,
    .read_at = "depth_m",
    .threshold = [](const scenes::Gauges& g) { return g.front_depth; }};
inline constexpr Column front_of_mass = {.name = "front_mass_995_mm",
                                         .unit = "mm",
                                         .meaning = "the place that 99.5 % of the mass has not passed",
                                         .per_si = 1e3,
                                         .may_be_empty = true};
inline constexpr Column start_height = {.name = "start_height_mm",
                                        .unit = "mm",
                                        .meaning = "mean depth over gauges.end_length at the back wall",
                                        .per_si = 1e3,
                                        .may_be_empty = true,
                                        .read_at = "length_m",
                                        .threshold = [](const scenes::Gauges& g) { return g.end_length; }};
inline constexpr Column end_height = {.name = "end_height_mm",
                                      .unit = "mm",
                                      .meaning = "mean depth over gauges.end_length at the far end",
                                      .per_si = 1e3,
                                      .may_be_empty = true,
                                      .read_at = "length_m",
                                      .threshold = [](const scenes::Gauges& g) { return g.end_length; }};
inline constexpr Column discharged = {
    .name = "discharged_fraction", .unit = "", .meaning = "share of the material that has left the outlet"};
inline constexpr Column suction = {
    .name = "suction_max_Pa", .unit = "Pa", .meaning = "the largest tension in a funnel's neck so far"};
inline constexpr Column thinnest_sight = {
    .name = "thinnest_sight_mm",
    .unit = "mm",
    .meaning =
        "material on the thinnest line of sight through the outlet; light is seen below "
        "gauges.light_depth",
    .per_si = 1e3,
    .may_be_empty = true,
    .read_at = "light_below_m",
    .threshold = [](const scenes::Gauges& g) { return g.light_depth; }};
// Of the section behind a nozzle, once it has gone so far:
inline constexpr Column strand_width = {
    .name = "strand_width_mm",
    .unit = "mm",
    .meaning = "width of the strand's section behind the nozzle, the largest of its rows",
    .per_si = 1e3,
    .may_be_empty = true};
inline constexpr Column strand_height = {.name = "strand_height_mm",
                                         .unit = "mm",
                                         .meaning = "height of that section, the largest of its columns",
                                         .per_si = 1e3,
                                         .may_be_empty = true};
inline constexpr Column section_area = {
    .name = "section_area_mm2", .unit = "mm2", .meaning = "its area", .per_si = 1e6, .may_be_empty = true};
inline constexpr Column base_width = {.name = "base_width_mm",
                                      .unit = "mm",
                                      .meaning = "width of its lowest row, on the bed",
                                      .per_si = 1e3,
                                      .may_be_empty = true};
inline constexpr Column area_over_balance = {
    .name = "area_over_balance",
    .unit = "",
    .meaning = "its area over what the nozzle has fed per length of its way, over all layers",
    .may_be_empty = true};
inline constexpr Column nozzle_drag = {
    .name = "nozzle_drag_N", .unit = "N", .meaning = "force of the nozzle on the material, along the bed"};
inline constexpr Column nozzle_push = {
    .name = "nozzle_push_N", .unit = "N", .meaning = "force of the nozzle on the material, downwards"};
inline constexpr Column volume = {.name = "volume_m3", .unit = "m3", .meaning = "volume of the material"};
inline constexpr Column volume_at_rest = {
    .name = "volume_at_rest_m3", .unit = "m3", .meaning = "volume that its mass fills without pressure"};
inline constexpr Column kinetic_energy = {
    .name = "kinetic_energy_J", .unit = "J", .meaning = "kinetic energy of the material"};
inline constexpr Column potential_energy = {.name = "potential_energy_J",
                                            .unit = "J",
                                            .meaning = "energy of its weight, over the floor or the outlet"};
inline constexpr Column elastic_energy = {
    .name = "elastic_energy_J", .unit = "J", .meaning = "energy stored by elastic strain and compression"};
inline constexpr Column dissipated_energy = {
    .name = "dissipated_energy_J", .unit = "J", .meaning = "energy that flow has dissipated so far"};
inline constexpr Column numerical_energy = {
    .name = "numerical_energy_J",
    .unit = "J",
    .meaning = "energy that the discretisation has lost (positive) or made (negative) so far"};
inline constexpr Column shear_rate = {.name = "shear_rate_p99_1_s",
                                      .unit = "1/s",
                                      .meaning = "shear rate that one per cent of the mass exceeds",
                                      .may_be_empty = true};
inline constexpr Column sheared_layer = {
    .name = "sheared_layer_mm",
    .unit = "mm",
    .meaning = "thickness of the layer along walls that hold in which the material is sheared",
    .per_si = 1e3,
    .may_be_empty = true};
inline constexpr Column sheared_layer_cells = {.name = "sheared_layer_cells",
                                               .unit = "",
                                               .meaning = "cells over the sheared layer",
                                               .may_be_empty = true};
inline constexpr Column mean_shear_rate = {.name = "shear_rate_mean_1_s",
                                           .unit = "1/s",
                                           .meaning = "shear rate, the mean over the material",
                                           .may_be_empty = true};
inline constexpr Column base_shear_rate = {
    .name = "base_shear_rate_p99_1_s",
    .unit = "1/s",
    .meaning = "shear rate at the floor that one per cent of the covered area exceeds",
    .may_be_empty = true};
inline constexpr Column residual = {
    .name = "initial_residual_U",
    .unit = "",
    .meaning = "largest initial residual of the momentum equation since the last row"};
inline constexpr Column chatter = {
    .name = "velocity_chatter",
    .unit = "",
    .meaning = "largest share of the velocity's change that the step before did not foretell"};
inline constexpr Column courant = {
    .name = "courant_max", .unit = "", .meaning = "largest Courant number since the last row"};
inline constexpr Column time_step = {.name = "time_step_s", .unit = "s", .meaning = "the last step"};
inline constexpr Column trapped_air = {
    .name = "trapped_air_m3", .unit = "m3", .meaning = "air with fuller cells above it"};
inline constexpr Column volume_error = {
    .name = "volume_error", .unit = "", .meaning = "relative change of the volume since the start"};
inline constexpr Column flocculation = {
    .name = "flocculation_mean", .unit = "", .meaning = "mean flocculation lambda, by mass"};
inline constexpr Column yield_stress = {
    .name = "yield_stress_mean_Pa",
    .unit = "Pa",
    .meaning = "mean local yield stress, with flocculation and what has grown with age, by mass"};

}  // namespace column

/// Every column, in an order for readers.
std::span<const Column* const> every_column();
/// The column of a name; null where flowrest writes none of that name.
const Column* column_named(const std::string& name);

/// A row of history.csv as a solver gives it: values by column.
class Row {
 public:
  /// Adds a value in SI units; `nothing` where there is none to read.
  Row& add(const Column& column, double si) {
    columns_.push_back(&column);
    values_.push_back(column.per_si * si);
    return *this;
  }
  Row& add(const Row& more) {
    columns_.insert(columns_.end(), more.columns_.begin(), more.columns_.end());
    values_.insert(values_.end(), more.values_.begin(), more.values_.end());
    return *this;
  }
  std::vector<std::string> names() const;
  const std::vector<double>& values() const { return values_; }  ///< in the columns' units

 private:
  std::vector<const Column*> columns_;
  std::vector<double> values_;
};

}  // namespace flowrest::runs
