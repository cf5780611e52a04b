#pragma once

#include <algorithm>
#include <cmath>

/// How much of a wall the concrete in the cell on it touches.
namespace flowrest::rheology {

/// A film thinner than this part of the cell is dust that the interface leaves behind; it wets in proportion.
constexpr double dust = 0.01;

/// Share of a wall that is wetted, in a square cell that concrete fills to the fraction `fraction`, its
/// surface a straight line across the fraction's gradient: `towards` the wall (positive where the concrete
/// lies on it) and `along` it, not negative, in any one unit. A thin layer touches the wall everywhere, a
/// front as far as it has come. Concrete over a cushion of air, which real air would leave, and a cell
/// without a gradient take `fraction`.
inline double wetted_share(double fraction, double towards, double along) {
  if (fraction <= 0.0) return 0.0;
  if (fraction >= 1.0) return 1.0;
  const double sum = towards + along;
  if (towards <= 0.0 || !(sum > 1e-12)) return fraction;
  // The surface is m1 x + m2 z = c over the unit square, z from the wall, m1 + m2 = 1; c follows from the
  // area below.
  const double m1 = along / sum, m2 = towards / sum;
  const double corner =
      0.5 * std::min(m1, m2) / std::max(m1, m2);  // the area at which a corner has been passed
  const double c = fraction < corner         ? std::sqrt(2.0 * m1 * m2 * fraction)
                   : fraction > 1.0 - corner ? 1.0 - std::sqrt(2.0 * m1 * m2 * (1.0 - fraction))
                                             : fraction * std::max(m1, m2) + 0.5 * std::min(m1, m2);
  const double wetted = c < m1 ? c / m1 : 1.0;
  return wetted * std::min(1.0, fraction / dust);
}

}  // namespace flowrest::rheology
