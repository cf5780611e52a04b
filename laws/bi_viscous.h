#pragma once

#include "laws/parameters.h"

namespace flowrest::laws {

/// The bi-viscous fluid, tau = eta rate + tau0 min(rate / critical rate, 1): below its critical rate it
/// creeps with a viscosity of eta + tau0 / critical rate.
struct BiViscous {
  static constexpr const char* name = "bi-viscous";
  static constexpr Parameter needs[] = {Parameter::yield_stress, Parameter::plastic_viscosity,
                                        Parameter::critical_shear_rate};
  static constexpr bool can_rest = false;
  static constexpr bool creeps = true;

  /// Pa
  template <class T>
  static T stress(const Parameters<T>& p, const T& rate) {
    return p.plastic_viscosity * rate + p.yield_stress * smaller(rate / p.critical_shear_rate, T(1));
  }
  /// d stress / d rate, Pa s
  template <class T>
  static T tangent(const Parameters<T>& p, const T& rate) {
    return rate < p.critical_shear_rate ? largest_viscosity(p) : p.plastic_viscosity;
  }
  /// stress / rate, Pa s
  template <class T>
  static T viscosity(const Parameters<T>& p, const T& rate) {
    return p.plastic_viscosity + p.yield_stress / larger(rate, p.critical_shear_rate);
  }
  template <class T>
  static T rate(const Parameters<T>& p, const T& stress) {
    return stress > largest_viscosity(p) * p.critical_shear_rate
               ? (stress - p.yield_stress) / p.plastic_viscosity
               : stress / largest_viscosity(p);
  }
  /// At rest, Pa s.
  template <class T>
  static T largest_viscosity(const Parameters<T>& p) {
    return p.plastic_viscosity + p.yield_stress / p.critical_shear_rate;
  }
  /// Where it bends, 1/s.
  template <class T>
  static T yielding_rate(const Parameters<T>& p) {
    return p.critical_shear_rate;
  }

  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Trial<T>& trial, const T& /*rate_before*/) {
    const T slow = trial.stress / (trial.shear + largest_viscosity(p));
    const T rate = slow > p.critical_shear_rate
                       ? (trial.stress - p.yield_stress) / (trial.shear + p.plastic_viscosity)
                       : slow;
    return {trial.stress - trial.shear * rate, rate, T(0)};
  }
};

}  // namespace flowrest::laws
