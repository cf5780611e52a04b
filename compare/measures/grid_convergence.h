#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

/// What a series of grids says about the answer of an infinitely fine one, as plain functions.
namespace flowrest::compare {

/// How a quantity changes from grid to grid as the grid is refined.
enum class Convergence {
  monotone,               ///< changes shrink and keep their sign
  oscillatory,            ///< changes shrink and alternate
  diverging,              ///< changes grow and keep their sign
  oscillatory_diverging,  ///< changes grow and alternate
  unchanging              ///< the grids agree to round-off: there is nothing to extrapolate
};
std::string to_string(Convergence);

/// A quantity on one grid.
struct GridValue {
  double cell = 0.0;  ///< representative size of a cell, or of whatever is refined; any unit
  double value = 0.0;
};

/// The grid convergence index of three grids: Celik et al. 2008, "Procedure for estimation and reporting of
/// uncertainty due to discretization in CFD applications", J. Fluids Eng. 130, 078001, Eqs. 3 to 7.
struct GridConvergence {
  Convergence convergence = Convergence::unchanging;
  std::optional<double> order;           ///< p, observed; none where the changes grow or vanish
  std::optional<double> extrapolated;    ///< of the finest pair, Eq. 5
  double relative_change = 0.0;          ///< e_a^21, Eq. 6: of the finest value
  std::optional<double> relative_error;  ///< e_ext^21, Eq. 6: of the extrapolated value
  std::optional<double> fine_index;      ///< GCI_fine^21, Eq. 7, relative to the finest value
  double uncertainty = 0.0;              ///< of the finest value, absolute
  /// One sentence, for reports: the order, or why there is none.
  std::string words() const;
};

/// From three grids, in any order of their cells.
///
/// The uncertainty is that of the index with the order held between 0.5 and `formal_order` where the changes
/// shrink without alternating. Elsewhere an extrapolation has no ground: then it is three times the range of
/// the three values, as Eca and Hoekstra 2014 (J. Comput. Phys. 262, Eq. 16) have it.
/// @throws std::invalid_argument unless the cells are positive, finite and differ.
GridConvergence grid_convergence(GridValue, GridValue, GridValue, double formal_order = 2.0);

/// Order observed between two grids whose errors against an exact solution are known:
/// ln(coarse error / fine error) / ln(coarse cell / fine cell). None where an error is zero.
std::optional<double> observed_order(const GridValue& coarse, const GridValue& fine);

/// A quantity that tends to a limit as a parameter x grows: value = limit + c x^-q.
struct Limit {
  double value = 0.0;
  double uncertainty = 0.0;  ///< half the range of what other exponents and subsets of the points give
  double exponent = 0.0;     ///< q of the best fit
  double coefficient = 0.0;  ///< c
  double residual = 0.0;     ///< root mean square of the best fit
};

/// The limit for infinite x, by least squares in (limit, c) for every exponent q from 0.25 to 3; the best q
/// is the one of least residual. The uncertainty spans the limits of exponents 1/2, 1 and 2 that fit at most
/// twice as badly as the best, or than `scatter` (what each value is uncertain by), and those of the points
/// less their first or their last.
/// @throws std::invalid_argument with fewer than three points, or unless x are positive and distinct.
Limit limit_of_growing(std::span<const double> x, std::span<const double> value, double scatter = 0.0);

}  // namespace flowrest::compare
