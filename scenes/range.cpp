#include "scenes/range.h"

#include <fmt/format.h>

#include <cmath>

namespace flowrest::scenes {

bool Range::holds(double x) const {
  return std::isfinite(x) && (low_included ? x >= low : x > low) && (high_included ? x <= high : x < high);
}

std::string Range::text() const {
  return fmt::format("{} {:g}, {} {:g}", low_included ? "at least" : "greater than", low,
                     high_included ? "at most" : "less than", high);
}

}  // namespace flowrest::scenes
