#pragma once

#include <cmath>
#include <limits>

namespace flowrest::laws::test {

/// A number and one derivative: enough to see that derivatives go through.
struct Dual {
  double v = 0.0, d = 0.0;
  constexpr Dual() = default;
  constexpr Dual(double value_, double derivative = 0.0) : v(value_), d(derivative) {}

  Dual& operator+=(const Dual& o) { return *this = {v + o.v, d + o.d}; }
  Dual& operator-=(const Dual& o) { return *this = {v - o.v, d - o.d}; }
  Dual& operator*=(const Dual& o) { return *this = {v * o.v, d * o.v + v * o.d}; }
  Dual& operator/=(const Dual& o) { return *this = {v / o.v, (d - v / o.v * o.d) / o.v}; }
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
  friend constexpr bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend constexpr bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend constexpr bool operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend constexpr bool operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
};

inline Dual sqrt(const Dual& a) {
  const double root = std::sqrt(a.v);
  return {root, a.d / (2.0 * root)};
}
inline Dual exp(const Dual& a) {
  const double e = std::exp(a.v);
  return {e, a.d * e};
}
inline Dual expm1(const Dual& a) { return {std::expm1(a.v), a.d * std::exp(a.v)}; }
inline Dual pow(const Dual& a, const Dual& b) {
  const double power = std::pow(a.v, b.v);
  return {power, power * (b.v / a.v * a.d + std::log(a.v) * b.d)};
}
inline double value(const Dual& a) { return a.v; }

}  // namespace flowrest::laws::test

template <>
struct std::numeric_limits<flowrest::laws::test::Dual> : std::numeric_limits<double> {};
