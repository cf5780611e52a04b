#include "studies/verification/verification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "runs/verdict.h"

using namespace flowrest::studies::verification;
using testing::HasSubstr;

namespace {

/// A finding whose errors go as `factor` h^`order`.
Finding made_up(double factor, double order, std::optional<double> largest, std::optional<double> least) {
  Finding f;
  f.of.name = "made up";
  f.of.largest_error = largest;
  f.of.least_order = least;
  for (const double h : {0.4, 0.2, 0.1}) {
    const double error = factor * std::pow(h, order);
    f.grids.push_back({h, Measured{error, 7.0 + error}, "", 0.0});
  }
  judge(f);
  return f;
}

}  // namespace

TEST(Judge, HoldsOrdersAndErrorsToTheirBounds) {
  const Finding good = made_up(1.0, 2.0, 0.011, 1.8);
  EXPECT_TRUE(good.passed) << good.verdict;
  ASSERT_EQ(good.orders.size(), 2u);
  EXPECT_NEAR(*good.orders[0], 2.0, 1e-9);
  EXPECT_NEAR(*good.convergence->extrapolated, 7.0, 1e-9);
  const Finding flat = made_up(0.01, 1.0, 0.011, 1.8);
  EXPECT_FALSE(flat.passed);
  EXPECT_THAT(flat.verdict, HasSubstr("the order is 1.00"));
  const Finding large = made_up(2.0, 2.0, 0.011, 1.8);
  EXPECT_FALSE(large.passed);
  EXPECT_THAT(large.verdict, HasSubstr("the error is 0.02"));
  EXPECT_FALSE(made_up(1.0, 2.0, {}, {}).judged);
}

TEST(Judge, SaysWhereTheFinestGridIsInDoubtByItsOwnVerdict) {
  Finding f = made_up(1.0, 2.0, 0.011, 1.8);
  f.grids.back().doubt = flowrest::runs::doubt_of("under-resolved: 3.3 cells over the sheared layer");
  judge(f);
  EXPECT_TRUE(f.passed);
  EXPECT_THAT(f.verdict, HasSubstr("its finest grid is under-resolved: 3.3 cells over the sheared layer"));
}

TEST(Judge, ACaseWithoutAResultFailsWithItsReason) {
  Finding f = made_up(1.0, 2.0, 1.0, {});
  f.grids[1].measured.reset();
  f.grids[1].trouble = "it blew up";
  judge(f);
  EXPECT_FALSE(f.passed);
  EXPECT_TRUE(f.judged);
  EXPECT_THAT(f.verdict, HasSubstr("it blew up"));
}

TEST(Cases, AreNamedOnceAndHaveThreeGridsOrMoreFromCoarseToFine) {
  std::set<std::string> names;
  for (const Case& c : all_cases()) {
    EXPECT_TRUE(names.insert(c.name + c.variant).second) << c.name << ", " << c.variant;
    ASSERT_GE(c.grids.size(), 3u) << c.name;
    for (std::size_t i = 1; i < c.grids.size(); ++i) EXPECT_LT(c.grids[i], c.grids[i - 1]) << c.name;
    EXPECT_FALSE(c.against.empty());
    EXPECT_FALSE(c.norm.empty());
  }
}

TEST(Verify, ComputesJudgesAndReportsOneCase) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("flowrest-verify-" + std::to_string(::getpid()));
  Options options;
  options.only = "Free fall";
  options.quiet = true;
  const auto findings = verify(body_cases(), folder, options);
  std::filesystem::remove_all(folder);
  ASSERT_EQ(findings.size(), 4u);
  for (const auto& f : findings) EXPECT_TRUE(f.passed) << f.of.variant << ": " << f.verdict;
  EXPECT_THAT(to_csv(findings), HasSubstr("Free fall"));
  const auto json = to_json(findings);
  EXPECT_EQ(json["cases"].size(), 4u);
  for (const auto& c : json["cases"])
    for (const auto& grid : c["grids"]) EXPECT_EQ(grid["trouble"], "") << "of what was computed";
  EXPECT_THAT(flowrest::report::render(page_of(findings)), HasSubstr("4 of 4 bounds hold"));
}
