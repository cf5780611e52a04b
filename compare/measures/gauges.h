#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runs/run_directory.h"
#include "scenes/scene.h"

/// What is read off a run, by kind of scene: the quantities that reports draw against time, and the single
/// numbers they state. One definition for comparison and validation.
namespace flowrest::compare {

/// A column of history.csv and how a report speaks of it.
struct Gauge {
  std::string name;        ///< "spread"
  std::string key;         ///< of figures and files: "spread"
  std::string column;      ///< of history.csv: "spread_mm"
  std::string unit;        ///< of figures, tables and files: "mm"
  double si = 1.0;         ///< SI units in one unit of the column
  double shown = 1.0;      ///< units of the figures in one SI unit
  std::string more, less;  ///< how a run stands to another: "wider", "narrower"
  /// What it is, for figures; {depth} and {length} stand for what it is read at, in mm.
  std::string caption = {};
  std::string caption_for(const scenes::Gauges&, scenes::Kind) const;
  /// Of columns and JSON keys: "_mm", "_m_s", "_percent".
  std::string suffix() const;
};

/// The gauge by which runs of a kind are told apart.
const Gauge& gauge_of(scenes::Kind);

/// What else is worth a figure against time; a run need not have it.
const std::vector<Gauge>& further_gauges(scenes::Kind);

/// Whether the gauge is a length that grows until the material is at rest.
bool grows_to_rest(scenes::Kind);

/// A number read off a run.
struct Reading {
  std::string quantity;  ///< "arrival_s"
  std::string name;      ///< "arrival at the end wall"
  std::string unit;      ///< "s"
  std::string shown() const { return name + (unit.empty() ? "" : " (" + unit + ")"); }
};

/// The readings that say what a run of this kind came to.
const std::vector<Reading>& readings_of(scenes::Kind);

/// A quantity by its name, of whatever kind; a column of history.csv speaks for itself.
Reading reading_named(const std::string& quantity);

/// arrival_s: when the front reaches the end of channel or tank; light_s: when light is first seen through a
/// funnel (less than `gauges.light_depth` of material on some line of sight); rest_s: when the run declares
/// rest; any column of history.csv: its value at the end. Nothing where it never happens, where the run did
/// not come to its end, or where its last row reads nothing.
std::optional<double> read(const runs::Run&, const std::string& quantity);

/// How well a value on cells of `cell` is known by the same on cells of `other_cell`: their difference, taken
/// on to zero cell size at first order. Infinite where the cells are the same.
double grid_uncertainty(double value, double cell, double other_value, double other_cell);

}  // namespace flowrest::compare
