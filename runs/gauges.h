#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "runs/columns.h"
#include "runs/nose.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

/// What the gauges of a run are defined by: the depths, lengths and speeds of its scene, one place for
/// whoever reads a run.
namespace flowrest::runs {

/// As the run's settings say. Runs that do not, such as foreign ones, are read as the standard apparatus is.
scenes::Gauges gauges_of(const Run&);

/// What the columns of history.csv whose names do not say it are read at, for run.json:
/// {"spread_1p5_mm": {"depth_m": 0.0015}, ...}. Columns keep their names whatever the depth: `spread_1p5_mm`
/// and `spread_6_mm` are read at half and at twice the depth of `spread_mm`.
nlohmann::ordered_json gauge_definitions(const scenes::Scene&);

/// Whether a column of history.csv may have nothing to read in a run that is in order.
bool may_read_nothing(const std::string& column);

/// The columns of a depth about a middle: the spread at its depth, at half and at twice of it.
Row spread_columns(const DepthView&, const scenes::Gauges&);

/// The columns of a channel's ends, of the depth over bins of `bin_width` in m.
Row end_columns(std::span<const double> depth, double bin_width, const scenes::Gauges&);

/// A length in millimetres, with digits down to a thirtieth of the depth at which edges are read: "543.2 mm".
std::string millimetres(double metres, double depth);

/// A gauge that is a length, for progress: "spread 543.2 mm"; where there is nothing to read it says so.
std::string shown_length(const std::string& gauge, double metres, double depth);

}  // namespace flowrest::runs
