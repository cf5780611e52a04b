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

}  // namespace flowrest::mpm
