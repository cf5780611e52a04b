#include "mpm/simd/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mpm/test_random.h"

using namespace flowrest::mpm;

namespace {

/// Largest error of `exponential` against the long double function over [-reach, reach], in units of the last
/// place.
template <class T>
double largest_error_in_ulp(T reach, int samples) {
  test::Random random(7);
  double worst = 0.0;
  for (int i = 0; i < samples; ++i) {
    const T x = static_cast<T>(random.between(-reach, reach));
    const long double exact = std::exp(static_cast<long double>(x));
    const T nearest = static_cast<T>(exact);
    const T ulp = std::nextafter(nearest, std::numeric_limits<T>::infinity()) - nearest;
    const double error =
        static_cast<double>(std::abs(static_cast<long double>(exponential(x)) - exact) / ulp);
    worst = std::max(worst, error);
  }
  return worst;
}

}  // namespace

TEST(Exponential, IsTheStandardOneToTwoUnitsInTheLastPlace) {
  EXPECT_LE(largest_error_in_ulp<double>(690.0, 1000000), 2.0);
  EXPECT_LE(largest_error_in_ulp<double>(1e-3, 100000), 2.0);
  EXPECT_LE(largest_error_in_ulp<float>(86.0f, 1000000), 2.0);
  EXPECT_LE(largest_error_in_ulp<float>(1e-3f, 100000), 2.0);
}

TEST(Exponential, LessOneKeepsItsDigitsHoweverSmallTheArgument) {
  test::Random random(8);
  for (int i = 0; i < 1000000; ++i) {
    const double x = random.log_between(1e-30, 600.0) * (random.chance(0.5) ? 1.0 : -1.0);
    const long double exact = std::expm1(static_cast<long double>(x));
    ASSERT_LE(std::abs(exponential_minus_one(x) - exact), 6e-16L * std::abs(exact)) << "x = " << x;
    const auto single = static_cast<float>(x);
    if (std::abs(single) > 80.0f) continue;
    const long double single_exact = std::expm1(static_cast<long double>(single));
    ASSERT_LE(std::abs(exponential_minus_one(single) - single_exact), 3e-7L * std::abs(single_exact))
        << "x = " << x;
  }
  EXPECT_EQ(exponential_minus_one(0.0), 0.0);
  EXPECT_EQ(exponential_minus_one(-1e9), -1.0);
}

TEST(Exponential, IsExactlyOneAtZero) {
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(exponential(-0.0), 1.0);
  EXPECT_EQ(exponential(0.0f), 1.0f);
}

TEST(Exponential, ClampsWhatWouldOverflow) {
  EXPECT_EQ(exponential(1e300), exponential(700.0));
  EXPECT_EQ(exponential(-1e300), exponential(-700.0));
  EXPECT_GT(exponential(-1e300), 0.0);
  EXPECT_TRUE(std::isfinite(exponential(1e30f)));
  EXPECT_GT(exponential(-1e30f), 0.0f);
  EXPECT_LT(exponential(-1e30f), 1e-37f);
}

TEST(Logarithm, IsTheStandardOneHoweverNearItsRootOrFarFromIt) {
  test::Random random(9);
  for (int i = 0; i < 1000000; ++i) {
    const double x = random.chance(0.5) ? random.log_between(1e-300, 1e300) : random.between(0.5, 2.0);
    const long double exact = std::log(static_cast<long double>(x));
    ASSERT_LE(std::abs(logarithm(x) - exact), 5e-16L * std::abs(exact)) << "x = " << x;
    const auto single = static_cast<float>(x);
    if (!(single > 1e-37f && single < 1e38f)) continue;
    const long double single_exact = std::log(static_cast<long double>(single));
    ASSERT_LE(std::abs(logarithm(single) - single_exact), 3e-7L * std::abs(single_exact)) << "x = " << x;
  }
  EXPECT_EQ(logarithm(1.0), 0.0);
  EXPECT_EQ(logarithm(1.0f), 0.0f);
}

TEST(Power, IsTheStandardOneAndExactlyOneForNoPower) {
  test::Random random(10);
  for (int i = 0; i < 100000; ++i) {
    const double x = random.log_between(1e-30, 1e30), exponent = random.between(-0.5, 0.5);
    const long double exact = std::pow(static_cast<long double>(x), static_cast<long double>(exponent));
    ASSERT_LE(std::abs(power(x, exponent) - exact), 2e-14L * exact) << x << "^" << exponent;
    EXPECT_EQ(power(x, 0.0), 1.0);
  }
}

TEST(Exponential, NeverFallsAsItsArgumentRisesAcrossTheReductionsSeams) {
  // Where n changes by one the polynomial's other end takes over.
  for (int n = -20; n <= 20; ++n) {
    const double seam = (n + 0.5) * std::log(2.0);
    double before = exponential(seam - 1e-9);
    for (int i = -99; i <= 100; ++i) {
      const double here = exponential(seam + i * 1e-11);
      ASSERT_GE(here, before * (1.0 - 2e-16)) << "n " << n << ", step " << i;
      before = here;
    }
  }
}
