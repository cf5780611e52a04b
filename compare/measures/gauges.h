#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runs/run_directory.h"
#include "scenes/scene.h"

/// What is read off a run: the quantities that reports draw against time, and the single
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
  std::string caption_for(const scenes::Gauges&, scenes::MainGauge) const;
  /// Of columns and JSON keys: "_mm", "_m_s", "_percent".
  std::string suffix() const;
  /// In JSON keys, before what it is read for and its suffix: "spread", "plug_velocity".
  std::string json_name() const;
};

/// A gauge that is a length in millimetres.
Gauge millimetres(const std::string& name, const std::string& column, const std::string& more,
                  const std::string& less, const std::string& caption);
/// The mean state of flocculation, of whatever is thixotropic.
const Gauge& flocculation();
/// What is worth a figure beside the front of what runs along a channel.
const std::vector<Gauge>& channel_gauges();

/// A number read off a run.
struct Reading {
  std::string quantity;  ///< "arrival_s"
  std::string name;      ///< "arrival at the end wall"
  std::string unit;      ///< "s"
  std::string shown() const { return name + (unit.empty() ? "" : " (" + unit + ")"); }
};

/// A quantity by its name, of whatever apparatus; a column of history.csv speaks for itself.
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
