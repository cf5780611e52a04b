#pragma once

#include <limits>
#include <string>

namespace flowrest::scenes {

/// An interval of numbers, each end included or not.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_included = true;
  bool high_included = true;

  bool holds(double) const;
  /// In words: "greater than 0, at most 1e+06".
  std::string text() const;
};

inline Range above(double low, double high) { return {low, high, false, true}; }
inline Range from(double low, double high) { return {low, high, true, true}; }
inline Range between(double low, double high) { return {low, high, false, false}; }

}  // namespace flowrest::scenes
