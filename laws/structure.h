#pragma once

#include <cmath>

#include "laws/parameters.h"

namespace flowrest::laws {

/// Roussel's structure of a thixotropic material at rest and in flow, Yu et al. 2026, Eqs. 11 and 12: the
/// local yield stress is (1 + lambda) tau0, and d lambda / dt = A_thix / tau0 - alpha rate^m lambda. Theirs
/// breaks down in proportion to the rate, m = 1; another power is what breakdown under steps of the rate asks
/// for. The rate is counted in 1/s.
template <class T>
struct Structure {
  T growth{};     ///< A_thix / tau0, 1/s
  T breakdown{};  ///< alpha, s^(m - 1)
  T exponent{1};  ///< m

  bool is_linear() const { return !(exponent < T(1) || exponent > T(1)); }
  /// rate^m, by which breakdown goes.
  T flow(const T& rate) const {
    using std::pow;
    if (is_linear()) return rate;
    return rate > T(0) ? pow(rate, exponent) : T(0);
  }
  /// Its derivative at a rate above 0.
  T flow_slope(const T& rate) const { return is_linear() ? T(1) : exponent * flow(rate) / rate; }

  /// lambda after a time at a steady shear rate, in closed form.
  T after(const T& lambda, const T& rate, const T& time) const {
    using std::expm1;
    const T decay = breakdown * flow(rate);
    if (!(decay > T(0))) return lambda + growth * time;
    const T lost = expm1(-decay * time);
    return lambda + lost * (lambda - growth / decay);
  }

  /// lambda after a step that breaks down what there is at its end: never below 0, whatever the step (Eqs. 38
  /// and 45).
  T stepped(const T& lambda, const T& rate, const T& step) const {
    return (lambda + growth * step) / (T(1) + step * breakdown * flow(rate));
  }
};

/// Growth of the yield stress with the age of the concrete, which flow does not undo: Perrot et al. 2016,
/// tau0(t) = tau00 + A t_c (exp(t / t_c) - 1), linear (A t) for ages far below t_c.
///
/// It comes on top of what flocs hold: the local yield stress is (1 + lambda) tau0 + A t_c (exp(t / t_c) - 1),
/// and not (1 + lambda) times an aged tau0. A sum keeps both rates what they were measured as, in Pa/s: at rest
/// the yield stress gains A_thix by flocculation at every age, and what strong shear leaves is tau0 and what
/// has grown. A product would let A_thix grow with age, and flocculation speed up ageing.
template <class T>
struct Ageing {
  T rate{};         ///< A, Pa/s
  T per_time{};     ///< 1 / t_c, 1/s; 0: linear
  T initial_age{};  ///< s, when time is 0

  /// What has come to the yield stress by a time in s, Pa.
  T grown(const T& time) const {
    using std::expm1;
    if (!(rate > T(0))) return T(0);  // whatever its time, which may be so short that the power overflows
    const T age = initial_age + time;
    return per_time > T(0) ? rate * (expm1(per_time * age) / per_time) : rate * age;
  }
};

}  // namespace flowrest::laws
