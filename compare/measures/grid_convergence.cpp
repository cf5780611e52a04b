#include "compare/measures/grid_convergence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace flowrest::compare {

namespace {

/// Celik et al. 2008, Eq. 7: the factor of safety of a study of three grids.
constexpr double safety = 1.25;
/// Below this order an extrapolation multiplies whatever noise there is.
constexpr double least_order = 0.5;

/// |eps32 / eps21| of an error that goes as h^p, or of one that alternates as it does: Celik et al. 2008, Eq.
/// 3, solved for the ratio. It grows with p.
double ratio_of(double r21, double r32, double p, double s) {
  return std::pow(r21, p) * (std::pow(r32, p) - s) / (std::pow(r21, p) - s);
}

/// No scheme is of a higher order; what seems to be is chance.
constexpr double largest_order = 20.0;

/// The order p of Eq. 3, by bisection: their fixed-point iteration runs away where r32 is larger than r21.
/// None where no positive order makes changes shrink as slowly as these.
std::optional<double> order_of(double r21, double r32, double ratio) {
  const double s = ratio < 0.0 ? -1.0 : 1.0, size = std::abs(ratio);
  const double at_zero = s > 0.0 ? std::log(r32) / std::log(r21) : 1.0;  // the limit for p to 0
  if (size <= at_zero) return std::nullopt;
  double low = 0.0, high = largest_order;
  for (int i = 0; i < 200; ++i) {
    const double p = 0.5 * (low + high);
    (ratio_of(r21, r32, p, s) < size ? low : high) = p;
  }
  return 0.5 * (low + high);
}

Convergence kind_of(double eps21, double eps32, double scale, bool has_order) {
  const double round_off = 64.0 * std::numeric_limits<double>::epsilon() * scale;
  if (std::abs(eps21) <= round_off && std::abs(eps32) <= round_off) return Convergence::unchanging;
  const bool alternates = eps21 * eps32 < 0.0;
  if (has_order) return alternates ? Convergence::oscillatory : Convergence::monotone;
  return alternates ? Convergence::oscillatory_diverging : Convergence::diverging;
}

struct Line {
  double limit = 0.0, slope = 0.0, residual = 0.0;
};

/// Least squares of value = limit + slope x^-q.
Line fitted(std::span<const double> x, std::span<const double> value, double q) {
  const auto n = static_cast<double>(x.size());
  double sz = 0.0, sv = 0.0, szz = 0.0, szv = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double z = std::pow(x[i], -q);
    sz += z;
    sv += value[i];
    szz += z * z;
    szv += z * value[i];
  }
  Line line;
  line.slope = (n * szv - sz * sv) / (n * szz - sz * sz);
  line.limit = (sv - line.slope * sz) / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = value[i] - line.limit - line.slope * std::pow(x[i], -q);
    line.residual += d * d / n;
  }
  line.residual = std::sqrt(line.residual);
  return line;
}

void check_limit(std::span<const double> x, std::span<const double> value) {
  if (x.size() != value.size() || x.size() < 3)
    throw std::invalid_argument("a limit needs three points or more, each with its value");
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0.0) || !std::isfinite(x[i]) || !std::isfinite(value[i]))
      throw std::invalid_argument("a limit needs finite values at positive parameters");
    for (std::size_t j = 0; j < i; ++j)
      if (x[i] == x[j]) throw std::invalid_argument("a limit needs parameters that differ");
  }
}

}  // namespace

std::string to_string(Convergence convergence) {
  switch (convergence) {
    case Convergence::monotone:
      return "monotone";
    case Convergence::oscillatory:
      return "oscillatory";
    case Convergence::diverging:
      return "diverging";
    case Convergence::oscillatory_diverging:
      return "oscillatory-diverging";
    case Convergence::unchanging:
      return "unchanging";
  }
  throw std::logic_error("a convergence without a name");
}

std::string GridConvergence::words() const {
  switch (convergence) {
    case Convergence::monotone:
      return fmt::format("converges monotonically, observed order {:.2f}", *order);
    case Convergence::oscillatory:
      return fmt::format("not monotone: it oscillates as it converges (apparent order {:.2f})", *order);
    case Convergence::diverging:
      return "not converging: the change does not shrink as the grid is refined";
    case Convergence::oscillatory_diverging:
      return "not monotone and not converging: the change alternates and does not shrink as the grid is "
             "refined";
    case Convergence::unchanging:
      return "the same on every grid to round-off";
  }
  throw std::logic_error("a convergence without words");
}

GridConvergence grid_convergence(GridValue a, GridValue b, GridValue c, double formal_order) {
  std::array<GridValue, 3> grid = {a, b, c};
  std::sort(grid.begin(), grid.end(), [](const auto& x, const auto& y) { return x.cell < y.cell; });
  for (const auto& g : grid)
    if (!(g.cell > 0.0) || !std::isfinite(g.cell) || !std::isfinite(g.value))
      throw std::invalid_argument("a grid needs a positive cell and a finite value");
  if (grid[0].cell == grid[1].cell || grid[1].cell == grid[2].cell)
    throw std::invalid_argument("three grids need three cells that differ");
  const double f1 = grid[0].value, f2 = grid[1].value, f3 = grid[2].value;
  const double r21 = grid[1].cell / grid[0].cell, r32 = grid[2].cell / grid[1].cell;
  const double eps21 = f2 - f1, eps32 = f3 - f2;
  const auto [least, most] = std::minmax({f1, f2, f3});

  GridConvergence result;
  // Two finer grids that agree exactly leave nothing to extrapolate.
  const auto p = eps21 == 0.0 ? std::optional(std::numeric_limits<double>::infinity())
                              : order_of(r21, r32, eps32 / eps21);
  result.convergence = kind_of(eps21, eps32, std::max(std::abs(least), std::abs(most)), p.has_value());
  result.relative_change = f1 != 0.0 ? std::abs(eps21 / f1) : 0.0;
  result.uncertainty = 3.0 * (most - least);
  if (result.convergence == Convergence::unchanging) return result;
  if (!p) return result;
  const double order = *p, growth = std::pow(r21, order) - 1.0;
  result.order = order;
  result.extrapolated = f1 - eps21 / growth;  // Eq. 5: (r21^p f1 - f2) / (r21^p - 1)
  if (*result.extrapolated != 0.0)
    result.relative_error = std::abs((*result.extrapolated - f1) / *result.extrapolated);
  if (f1 != 0.0) result.fine_index = safety * result.relative_change / growth;
  if (result.convergence == Convergence::monotone) {
    const double held = std::clamp(order, least_order, formal_order);
    result.uncertainty = safety * std::abs(eps21) / (std::pow(r21, held) - 1.0);
  }
  return result;
}

std::optional<double> observed_order(const GridValue& coarse, const GridValue& fine) {
  if (!(std::abs(coarse.value) > 0.0) || !(std::abs(fine.value) > 0.0)) return std::nullopt;
  return std::log(std::abs(coarse.value / fine.value)) / std::log(coarse.cell / fine.cell);
}

Limit limit_of_growing(std::span<const double> x, std::span<const double> value, double scatter) {
  check_limit(x, value);
  Limit best;
  best.residual = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 275; ++i) {
    const double q = 0.25 + 0.01 * i;
    const Line line = fitted(x, value, q);
    if (line.residual < best.residual) best = {line.limit, 0.0, q, line.slope, line.residual};
  }
  double low = best.value, high = best.value;
  const auto include = [&](double limit) {
    low = std::min(low, limit);
    high = std::max(high, limit);
  };
  for (const double q : {0.5, 1.0, 2.0}) {
    const Line line = fitted(x, value, q);
    if (line.residual <= std::max(2.0 * best.residual, scatter)) include(line.limit);
  }
  if (x.size() > 3) {
    include(fitted(x.subspan(1), value.subspan(1), best.exponent).limit);
    include(fitted(x.first(x.size() - 1), value.first(value.size() - 1), best.exponent).limit);
  }
  best.uncertainty = std::hypot(0.5 * (high - low), scatter);
  return best;
}

}  // namespace flowrest::compare
