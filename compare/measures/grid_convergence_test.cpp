#include "compare/measures/grid_convergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace flowrest::compare;

namespace {

/// Cells of grids of `count` cells in two dimensions, as Celik et al. 2008, Eq. 2, less a common factor.
double cell_of(double count) { return 1.0 / std::sqrt(count); }

}  // namespace

// Celik et al. 2008, Table 1: three quantities of one flow, with the digits that are printed there.
TEST(GridConvergence, GivesCeliksTableForAMonotoneQuantity) {
  const auto g = grid_convergence({cell_of(18000), 6.063}, {cell_of(8000), 5.972}, {cell_of(4500), 5.863});
  EXPECT_EQ(g.convergence, Convergence::monotone);
  EXPECT_NEAR(*g.order, 1.53, 0.005);
  EXPECT_NEAR(*g.extrapolated, 6.1685, 5e-4);
  EXPECT_NEAR(g.relative_change, 0.015, 5e-4);
  EXPECT_NEAR(*g.relative_error, 0.017, 5e-4);
  EXPECT_NEAR(*g.fine_index, 0.022, 5e-4);
}

TEST(GridConvergence, GivesCeliksTableForAnOrderBelowOne) {
  const auto g =
      grid_convergence({cell_of(18000), 10.7880}, {cell_of(4500), 10.7250}, {cell_of(980), 10.6050});
  EXPECT_EQ(g.convergence, Convergence::monotone);
  EXPECT_NEAR(*g.order, 0.75, 0.005);
  EXPECT_NEAR(*g.extrapolated, 10.8801, 5e-4);
  EXPECT_NEAR(g.relative_change, 0.006, 5e-4);
  EXPECT_NEAR(*g.relative_error, 0.009, 6e-4);  // 0.00847 from the printed extrapolate itself
  EXPECT_NEAR(*g.fine_index, 0.011, 5e-4);
}

TEST(GridConvergence, GivesCeliksTableForAnOscillatoryQuantityAndSaysThatItIsNotMonotone) {
  const auto g = grid_convergence({cell_of(18000), 6.0042}, {cell_of(4500), 5.9624}, {cell_of(980), 6.0909});
  EXPECT_EQ(g.convergence, Convergence::oscillatory);
  EXPECT_NEAR(*g.order, 1.51, 0.005);
  EXPECT_NEAR(*g.extrapolated, 6.0269, 5e-4);
  EXPECT_NEAR(g.relative_change, 0.007, 5e-4);
  EXPECT_NEAR(*g.relative_error, 0.004, 5e-4);
  EXPECT_NEAR(*g.fine_index, 0.005, 5e-4);
  EXPECT_NE(g.words().find("not monotone"), std::string::npos) << g.words();
  // No ground for an extrapolation: three times the range.
  EXPECT_NEAR(g.uncertainty, 3.0 * (6.0909 - 5.9624), 1e-12);
}

TEST(GridConvergence, RecoversTheOrderAndTheLimitOfAKnownErrorOnUnequalRefinements) {
  for (const double order : {1.0, 2.0}) {
    const auto value = [&](double h) { return 3.0 + 0.7 * std::pow(h, order); };
    const auto g = grid_convergence({0.4, value(0.4)}, {0.1, value(0.1)}, {0.15, value(0.15)});
    EXPECT_NEAR(*g.order, order, 1e-9);
    EXPECT_NEAR(*g.extrapolated, 3.0, 1e-9);
    EXPECT_NEAR(g.uncertainty, 1.25 * (value(0.1) - 3.0), 1e-9) << "a quarter more than the error itself";
  }
}

TEST(GridConvergence, RefusesToExtrapolateWhatDoesNotConverge) {
  const auto growing = grid_convergence({1.0, 5.0}, {2.0, 4.0}, {4.0, 3.5});
  EXPECT_EQ(growing.convergence, Convergence::diverging);
  EXPECT_FALSE(growing.extrapolated);
  EXPECT_DOUBLE_EQ(growing.uncertainty, 4.5);
  EXPECT_NE(growing.words().find("not converging"), std::string::npos);
  const auto swinging = grid_convergence({1.0, 5.0}, {2.0, 4.0}, {4.0, 4.5});
  EXPECT_EQ(swinging.convergence, Convergence::oscillatory_diverging);
  EXPECT_FALSE(swinging.order);
  const auto same = grid_convergence({1.0, 2.0}, {2.0, 2.0}, {4.0, 2.0});
  EXPECT_EQ(same.convergence, Convergence::unchanging);
  EXPECT_EQ(same.uncertainty, 0.0);
  EXPECT_THROW(grid_convergence({1.0, 2.0}, {1.0, 2.1}, {4.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(grid_convergence({0.0, 2.0}, {1.0, 2.1}, {4.0, 2.0}), std::invalid_argument);
}

TEST(GridConvergence, ChangesThatShrinkLessThanTheGridsDoHaveNoOrder) {
  // From 1.6 to 1 the cell changes 2.1 times as much, on a logarithmic scale, as from 1.25 to 1: a change
  // that is only 1.5 times as large does not shrink, though it is smaller.
  const auto slow = grid_convergence({0.005, 30.0}, {0.00625, 26.0}, {0.010, 20.0});
  EXPECT_EQ(slow.convergence, Convergence::diverging);
  EXPECT_FALSE(slow.order);
  EXPECT_DOUBLE_EQ(slow.uncertainty, 30.0);
  const auto value = [](double h) { return 5.0 + h; };
  const auto first =
      grid_convergence({0.005, value(0.005)}, {0.00625, value(0.00625)}, {0.010, value(0.010)});
  EXPECT_NEAR(*first.order, 1.0, 1e-9);
  const auto agreed = grid_convergence({1.0, 3.0}, {2.0, 3.0}, {4.0, 3.5});
  EXPECT_EQ(agreed.convergence, Convergence::monotone);
  EXPECT_DOUBLE_EQ(*agreed.extrapolated, 3.0);
}

TEST(GridConvergence, AnOrderAboveTheSchemesDoesNotShrinkTheUncertainty) {
  const auto value = [](double h) { return 1.0 + h * h * h * h; };
  const auto g = grid_convergence({0.5, value(0.5)}, {1.0, value(1.0)}, {2.0, value(2.0)});
  EXPECT_NEAR(*g.order, 4.0, 1e-9);
  EXPECT_NEAR(g.uncertainty, 1.25 * (value(1.0) - value(0.5)) / 3.0, 1e-12) << "as if of second order";
}

TEST(ObservedOrder, IsTheSlopeOfTheErrors) {
  EXPECT_NEAR(*observed_order({0.02, 4e-3}, {0.01, 1e-3}), 2.0, 1e-12);
  EXPECT_FALSE(observed_order({0.02, 4e-3}, {0.01, 0.0}));
}

TEST(LimitOfGrowing, FindsTheLimitWhateverTheExponent) {
  const std::vector<double> x = {20.0, 50.0, 200.0, 500.0};
  for (const double q : {0.5, 1.0, 1.7}) {
    std::vector<double> value;
    for (const double v : x) value.push_back(540.0 + 300.0 * std::pow(v, -q));
    const Limit limit = limit_of_growing(x, value);
    EXPECT_NEAR(limit.value, 540.0, 1e-6) << q;
    EXPECT_NEAR(limit.exponent, q, 1e-9);
    EXPECT_LT(limit.uncertainty, 1e-6);
  }
}

TEST(LimitOfGrowing, StatesAnUncertaintyThatHoldsTheTruthWhereTheValuesScatter) {
  const std::vector<double> x = {20.0, 50.0, 200.0, 500.0};
  const std::vector<double> noise = {1.0, -1.5, 1.2, -0.6};
  std::vector<double> value;
  for (std::size_t i = 0; i < x.size(); ++i) value.push_back(540.0 + 250.0 / x[i] + noise[i]);
  const Limit limit = limit_of_growing(x, value, 1.5);
  EXPECT_NEAR(limit.value, 540.0, limit.uncertainty);
  EXPECT_LT(limit.uncertainty, 10.0);
  EXPECT_THROW(limit_of_growing(std::vector{1.0, 2.0}, std::vector{1.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(limit_of_growing(std::vector{1.0, 2.0, 2.0}, std::vector{1.0, 2.0, 2.0}),
               std::invalid_argument);
}
