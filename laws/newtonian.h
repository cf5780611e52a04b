#pragma once

#include "laws/parameters.h"

namespace flowrest::laws {

/// The Newtonian fluid, tau = eta rate.
struct Newtonian {
  static constexpr const char* name = "newtonian";
  static constexpr Parameter needs[] = {Parameter::plastic_viscosity};
  static constexpr bool can_rest = false;
  static constexpr bool creeps = false;

  template <class T>
  static T stress(const Parameters<T>& p, const T& rate) {
    return p.plastic_viscosity * rate;
  }
  template <class T>
  static T tangent(const Parameters<T>& p, const T&) {
    return p.plastic_viscosity;
  }
  template <class T>
  static T viscosity(const Parameters<T>& p, const T&) {
    return p.plastic_viscosity;
  }
  template <class T>
  static T rate(const Parameters<T>& p, const T& stress) {
    return stress / p.plastic_viscosity;
  }
  template <class T>
  static T largest_viscosity(const Parameters<T>& p) {
    return p.plastic_viscosity;
  }
  template <class T>
  static T yielding_rate(const Parameters<T>&) {
    return T(0);
  }

  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Trial<T>& trial, const T& /*rate_before*/) {
    const T rate = trial.stress / (trial.shear + p.plastic_viscosity);
    return {trial.stress - trial.shear * rate, rate, T(0)};
  }
};

}  // namespace flowrest::laws
