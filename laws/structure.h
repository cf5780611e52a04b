#pragma once

#include <cmath>

namespace flowrest::laws {

/// Roussel's structure of a thixotropic material at rest and in flow, Yu et al. 2026, Eqs. 11 and 12: the
/// local yield stress is (1 + lambda) tau0, and d lambda / dt = A_thix / tau0 - alpha rate lambda.
template <class T>
struct Structure {
  T growth{};     ///< A_thix / tau0, 1/s
  T breakdown{};  ///< alpha

  /// lambda after a time at a steady shear rate, in closed form.
  T after(const T& lambda, const T& rate, const T& time) const {
    using std::expm1;
    const T decay = breakdown * rate;
    if (!(decay > T(0))) return lambda + growth * time;
    const T lost = expm1(-decay * time);
    return lambda + lost * (lambda - growth / decay);
  }

  /// lambda after a step that breaks down what there is at its end: never below 0, whatever the step (Eqs. 38
  /// and 45).
  T stepped(const T& lambda, const T& rate, const T& step) const {
    return (lambda + growth * step) / (T(1) + step * breakdown * rate);
  }
};

}  // namespace flowrest::laws
