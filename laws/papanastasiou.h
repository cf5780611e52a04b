#pragma once

#include <cmath>
#include <limits>

#include "laws/parameters.h"

namespace flowrest::laws {

/// The Bingham fluid as Papanastasiou regularises it, tau = eta rate + tau0 (1 - exp(-m rate)), Yu et al.
/// 2026, Eqs. 10 and 13: below its yield stress it creeps with a viscosity of eta + m tau0.
struct Papanastasiou {
  static constexpr const char* name = "papanastasiou";
  static constexpr Parameter needs[] = {Parameter::yield_stress, Parameter::plastic_viscosity,
                                        Parameter::regularisation_time};
  static constexpr bool can_rest = false;
  static constexpr bool creeps = true;

  /// Pa; expm1 is exact at creep rates.
  template <class T>
  static T stress(const Parameters<T>& p, const T& rate) {
    using std::expm1;
    return p.plastic_viscosity * rate - p.yield_stress * expm1(-p.regularisation_time * rate);
  }
  /// d stress / d rate, Pa s
  template <class T>
  static T tangent(const Parameters<T>& p, const T& rate) {
    using std::exp;
    return p.plastic_viscosity + p.regularisation_time * p.yield_stress * exp(-p.regularisation_time * rate);
  }
  /// stress / rate, Pa s
  template <class T>
  static T viscosity(const Parameters<T>& p, const T& rate) {
    using std::expm1;
    const T x = p.regularisation_time * rate;
    // Only a rate whose product underflows needs the limit.
    const T yield_part = x > T(std::numeric_limits<T>::min()) ? -expm1(-x) / rate : p.regularisation_time;
    return p.plastic_viscosity + p.yield_stress * yield_part;
  }
  /// The flow curve is concave, so Newton's steps from zero approach the root from below and never pass it.
  template <class T>
  static T rate(const Parameters<T>& p, const T& wanted) {
    T rate(0);
    for (int i = 0; i < 200; ++i) {
      const T change = (wanted - stress(p, rate)) / tangent(p, rate);
      rate += change;
      if (!(larger(change, -change) > T(1e-14) * rate)) break;
    }
    return rate;
  }
  /// At rest, Pa s.
  template <class T>
  static T largest_viscosity(const Parameters<T>& p) {
    return p.plastic_viscosity + p.regularisation_time * p.yield_stress;
  }
  /// About where it bends, 1/s.
  template <class T>
  static T yielding_rate(const Parameters<T>& p) {
    return T(1) / p.regularisation_time;
  }

  /// Newton's method from the last step's rate, or from the Bingham solution where that is more. The balance
  /// falls and is convex in the rate, so that from below the root it is approached without overshoot; the
  /// Bingham solution lies below it. The balance and not the rate says when it is found: near yield a rate is
  /// known less well than a stress by orders of magnitude. The step taken from where it is found leaves
  /// nothing of the start's derivatives.
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Trial<T>& trial, const T& rate_before) {
    using std::expm1;
    constexpr int most_steps = 100;
    const T tolerance = T(64) * std::numeric_limits<T>::epsilon() * trial.stress;
    const T viscosity = trial.shear + p.plastic_viscosity;
    const T bingham = larger(trial.stress - p.yield_stress, T(0)) / viscosity;
    T rate = larger(rate_before, bingham);
    for (int i = 0; i < most_steps; ++i) {
      const T lost = expm1(-p.regularisation_time * rate);  // exp(-m x) - 1
      const T balance = trial.stress - viscosity * rate + p.yield_stress * lost;
      const T slope = viscosity + p.yield_stress * p.regularisation_time * (T(1) + lost);
      rate = larger(rate + balance / slope, bingham);
      if (!(larger(balance, -balance) > tolerance)) break;
    }
    return {trial.stress - trial.shear * rate, rate, T(0)};
  }
};

}  // namespace flowrest::laws
