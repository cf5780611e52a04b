#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// Arithmetic that a compiler can turn into SIMD code: no branch, no call, no error number. Loops over
/// particles use these in place of the standard functions; the standard ones remain the reference in the
/// tests.
namespace flowrest::mpm {

#define FLOWREST_INLINE inline __attribute__((always_inline))

template <class T>
FLOWREST_INLINE T select(bool condition, T yes, T no) {
  return condition ? yes : no;
}

template <class T>
FLOWREST_INLINE T maximum(T a, T b) {
  return a > b ? a : b;
}

template <class T>
FLOWREST_INLINE T minimum(T a, T b) {
  return a < b ? a : b;
}

FLOWREST_INLINE double square_root(double x) { return __builtin_sqrt(x); }
FLOWREST_INLINE float square_root(float x) { return __builtin_sqrtf(x); }

/// e^x = scale (1 + fraction), scale a power of two and |fraction| < 1/2.
template <class T>
struct ExponentialParts {
  T fraction, scale;
};

/// For |x| <= 700; beyond, the argument is clamped. Cody-Waite reduction to |r| <= ln(2)/2 and a Taylor
/// polynomial; 2^n is made in the exponent bits, where adding 1.5 * 2^52 has put n.
FLOWREST_INLINE ExponentialParts<double> exponential_parts(double x) {
  x = minimum(maximum(x, -700.0), 700.0);
  constexpr double shift = 0x1.8p52;
  const double shifted = x * 1.44269504088896340736 + shift;
  const double n = shifted - shift;
  const double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
  double sum = 1.0 / 6227020800.0;
  sum = sum * r + 1.0 / 479001600.0;
  sum = sum * r + 1.0 / 39916800.0;
  sum = sum * r + 1.0 / 3628800.0;
  sum = sum * r + 1.0 / 362880.0;
  sum = sum * r + 1.0 / 40320.0;
  sum = sum * r + 1.0 / 5040.0;
  sum = sum * r + 1.0 / 720.0;
  sum = sum * r + 1.0 / 120.0;
  sum = sum * r + 1.0 / 24.0;
  sum = sum * r + 1.0 / 6.0;
  sum = sum * r + 0.5;
  sum = sum * r + 1.0;
  return {sum * r, std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023u) << 52)};
}

/// As above for |x| <= 87.
FLOWREST_INLINE ExponentialParts<float> exponential_parts(float x) {
  x = minimum(maximum(x, -87.0f), 87.0f);
  constexpr float shift = 0x1.8p23f;
  const float shifted = x * 1.44269504f + shift;
  const float n = shifted - shift;
  const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  float sum = 1.0f / 5040.0f;
  sum = sum * r + 1.0f / 720.0f;
  sum = sum * r + 1.0f / 120.0f;
  sum = sum * r + 1.0f / 24.0f;
  sum = sum * r + 1.0f / 6.0f;
  sum = sum * r + 0.5f;
  sum = sum * r + 1.0f;
  return {sum * r, std::bit_cast<float>((std::bit_cast<std::uint32_t>(shifted) + 127u) << 23)};
}

/// e^x to about one unit in the last place.
template <class T>
FLOWREST_INLINE T exponential(T x) {
  const auto parts = exponential_parts(x);
  return (parts.fraction + T(1)) * parts.scale;
}

/// e^x - 1 to a few units in the last place, also where x is so small that e^x is one to round-off.
template <class T>
FLOWREST_INLINE T exponential_minus_one(T x) {
  const auto parts = exponential_parts(x);
  return parts.scale * parts.fraction + (parts.scale - T(1));
}

/// ln(2) in two parts of which the first has so few digits that its product with an exponent is exact.
template <class T>
struct LogarithmOfTwo;
template <>
struct LogarithmOfTwo<double> {
  static constexpr double high = 6.93147180369123816490e-01, low = 1.90821492927058770002e-10;
};
template <>
struct LogarithmOfTwo<float> {
  static constexpr float high = 0.693359375f, low = -2.12194440e-4f;
};

/// x = 2^exponent mantissa, the mantissa from sqrt(1/2) to sqrt(2), for a normal x above 0. The exponent is
/// shifted out with its bias, which keeps it positive, and read as a number off another number's digits.
template <class T>
struct LogarithmParts {
  T exponent, mantissa;
};
FLOWREST_INLINE LogarithmParts<double> logarithm_parts(double x) {
  constexpr std::uint64_t root = 0x3fe6a09e667f3bcdu, bias = 1023u;  // of sqrt(1/2)
  const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x) - root + (bias << 52);
  const std::uint64_t exponent = shifted >> 52, digits = shifted & 0x000fffffffffffffu;
  return {std::bit_cast<double>(exponent | 0x4330000000000000u) - (0x1p52 + 1023.0),
          std::bit_cast<double>(digits + root)};
}
FLOWREST_INLINE LogarithmParts<float> logarithm_parts(float x) {
  constexpr std::uint32_t root = 0x3f3504f3u, bias = 127u;
  const std::uint32_t shifted = std::bit_cast<std::uint32_t>(x) - root + (bias << 23);
  const std::uint32_t exponent = shifted >> 23, digits = shifted & 0x007fffffu;
  return {std::bit_cast<float>(exponent | 0x4b000000u) - (0x1p23f + 127.0f),
          std::bit_cast<float>(digits + root)};
}

/// The natural logarithm of a normal x above 0, to a few units in the last place: 2 artanh((x - 1) / (x + 1))
/// of the mantissa by its series, which within sqrt(1/2) to sqrt(2) ends after ten terms.
template <class T>
FLOWREST_INLINE T logarithm(T x) {
  const auto parts = logarithm_parts(x);
  const T s = (parts.mantissa - T(1)) / (parts.mantissa + T(1)), square = s * s;
  T sum = T(1.0 / 21.0);
  sum = sum * square + T(1.0 / 19.0);
  sum = sum * square + T(1.0 / 17.0);
  sum = sum * square + T(1.0 / 15.0);
  sum = sum * square + T(1.0 / 13.0);
  sum = sum * square + T(1.0 / 11.0);
  sum = sum * square + T(1.0 / 9.0);
  sum = sum * square + T(1.0 / 7.0);
  sum = sum * square + T(1.0 / 5.0);
  sum = sum * square + T(1.0 / 3.0);
  const T of_mantissa = T(2) * s + T(2) * s * square * sum;
  return parts.exponent * LogarithmOfTwo<T>::high + (of_mantissa + parts.exponent * LogarithmOfTwo<T>::low);
}

/// x^exponent for a normal x above 0, good to the logarithm's size in units of the last place; exactly 1 where
/// the exponent is 0.
template <class T>
FLOWREST_INLINE T power(T x, T exponent) {
  return exponential(exponent * logarithm(x));
}

}  // namespace flowrest::mpm
