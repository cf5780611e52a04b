#pragma once

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "compare/comparison.h"
#include "compare/report/page.h"

/// Tables with a row to each run of a comparison.
namespace flowrest::compare {

/// A column of a table of runs.
struct RunColumn {
  report::Column column;
  std::function<report::Table::Cell(const RunView&)> value;
};

inline report::Table::Cell cell(const std::optional<double>& value, double scale = 1.0) {
  return value ? report::Table::Cell(scale * *value) : report::Table::Cell();
}

inline RunColumn measure_column(const std::string& name, const std::string& unit, report::Format format,
                                std::optional<double> Measures::*member, double scale = 1.0) {
  return {{name, unit, format}, [=](const RunView& view) { return cell(view.measures.*member, scale); }};
}

/// A measure in another unit, for JSON; null where it is none.
inline nlohmann::ordered_json scaled(const std::optional<double>& value, double scale = 1.0) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value * scale) : nlohmann::ordered_json();
}

constexpr report::Format fixed(int digits) { return {report::Format::Kind::fixed, digits}; }
constexpr report::Format signed_fixed(int digits) { return {report::Format::Kind::signed_fixed, digits}; }
constexpr report::Format significant(int digits) { return {report::Format::Kind::significant, digits}; }
/// Lengths in mm as far as they are told, and `more` digits.
report::Format lengths(const Comparison&, int more = 0);
report::Format signed_lengths(const Comparison&);
/// Times with so many digits of the standard apparatus, more of what is over sooner.
report::Format times(const Comparison&, int digits);

}  // namespace flowrest::compare
