#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

/// These are the innermost operations of all: a call costs more than they do.
#define FLOWREST_DUAL [[gnu::always_inline]]

/// Numbers that carry derivatives.
namespace flowrest::mpm::derivatives {

/// A number and its derivatives by N inputs: forward differentiation, exact to round-off. Whatever is a template
/// over its scalar computes with it. Comparisons are those of the values, so that a branch is taken as the run
/// takes it.
///
/// A product costs 1 + 2 N multiplications, a sum 1 + N additions, over arrays of fixed length that the compiler
/// puts into registers of several.
template <int N>
struct Dual {
  double v = 0.0;
  std::array<double, N> d{};

  constexpr Dual() = default;
  constexpr Dual(double value_) : v(value_) {}  // NOLINT: a number is one without derivatives

  /// A number that derivatives are by: the input numbered `which`.
  static Dual input(double value, std::size_t which) {
    Dual x(value);
    x.d[which] = 1.0;
    return x;
  }

  FLOWREST_DUAL friend Dual operator+(const Dual& a, const Dual& b) {
    Dual x(a.v + b.v);
    for (int i = 0; i < N; ++i) x.d[i] = a.d[i] + b.d[i];
    return x;
  }
  FLOWREST_DUAL friend Dual operator-(const Dual& a, const Dual& b) {
    Dual x(a.v - b.v);
    for (int i = 0; i < N; ++i) x.d[i] = a.d[i] - b.d[i];
    return x;
  }
  FLOWREST_DUAL friend Dual operator*(const Dual& a, const Dual& b) {
    Dual x(a.v * b.v);
    for (int i = 0; i < N; ++i) x.d[i] = a.d[i] * b.v + a.v * b.d[i];
    return x;
  }
  FLOWREST_DUAL friend Dual operator/(const Dual& a, const Dual& b) {
    Dual x(a.v / b.v);
    const double per = 1.0 / b.v;
    for (int i = 0; i < N; ++i) x.d[i] = (a.d[i] - x.v * b.d[i]) * per;
    return x;
  }
  FLOWREST_DUAL Dual& operator+=(const Dual& o) { return *this = *this + o; }
  FLOWREST_DUAL Dual& operator-=(const Dual& o) { return *this = *this - o; }
  FLOWREST_DUAL Dual& operator*=(const Dual& o) { return *this = *this * o; }
  FLOWREST_DUAL Dual& operator/=(const Dual& o) { return *this = *this / o; }
  friend Dual operator-(const Dual& a) { return scaled(-1.0, -a.v, a); }
  friend constexpr bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend constexpr bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend constexpr bool operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend constexpr bool operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
  friend constexpr bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }

  /// A function of one number: its value, and its slope there times the derivatives.
  static Dual scaled(double slope, double value, const Dual& of) {
    Dual x(value);
    for (int i = 0; i < N; ++i) x.d[i] = slope * of.d[i];
    return x;
  }
};

template <int N>
Dual<N> sqrt(const Dual<N>& a) {
  const double root = std::sqrt(a.v);
  return Dual<N>::scaled(0.5 / root, root, a);
}
template <int N>
Dual<N> exp(const Dual<N>& a) {
  const double e = std::exp(a.v);
  return Dual<N>::scaled(e, e, a);
}
template <int N>
Dual<N> expm1(const Dual<N>& a) {
  return Dual<N>::scaled(std::exp(a.v), std::expm1(a.v), a);
}
template <int N>
Dual<N> pow(const Dual<N>& a, const Dual<N>& b) {
  const double power = std::pow(a.v, b.v), by_base = power * b.v / a.v, by_exponent = power * std::log(a.v);
  Dual<N> x(power);
  for (int i = 0; i < N; ++i) x.d[i] = by_base * a.d[i] + by_exponent * b.d[i];
  return x;
}
template <int N>
double value(const Dual<N>& a) {
  return a.v;
}

}  // namespace flowrest::mpm::derivatives

template <int N>
struct std::numeric_limits<flowrest::mpm::derivatives::Dual<N>> : std::numeric_limits<double> {};
