#pragma once

#include <cmath>

#include "laws/parameters.h"
#include "laws/structure.h"

namespace flowrest::laws {

/// The elasto-viscoplastic Bingham solid of Yu et al. 2026: elastic below its yield stress, where its stress
/// needs no flow, so that it truly comes to rest; tau = tau0 + eta rate above.
struct ElastoViscoplastic {
  static constexpr const char* name = "elasto-viscoplastic";
  static constexpr Parameter needs[] = {Parameter::yield_stress, Parameter::plastic_viscosity};
  static constexpr bool can_rest = true;
  static constexpr bool creeps = false;

  /// Pa, in flow; at rest any stress up to the yield stress is.
  template <class T>
  static T stress(const Parameters<T>& p, const T& rate) {
    return p.yield_stress + p.plastic_viscosity * rate;
  }
  template <class T>
  static T tangent(const Parameters<T>& p, const T&) {
    return p.plastic_viscosity;
  }
  template <class T>
  static T rate(const Parameters<T>& p, const T& stress) {
    return larger(stress - p.yield_stress, T(0)) / p.plastic_viscosity;
  }
  /// Pa s. Below yield it is elastic, which limits no step by viscosity.
  template <class T>
  static T largest_viscosity(const Parameters<T>& p) {
    return p.plastic_viscosity;
  }
  /// 1/s: it yields at once.
  template <class T>
  static T yielding_rate(const Parameters<T>&) {
    return T(0);
  }

  /// The return map in closed form, Yu et al. 2026, Eq. 47.
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Trial<T>& trial, const T& /*rate_before*/) {
    const T excess = trial.stress - p.yield_stress;
    if (!(excess > T(0))) return {trial.stress, T(0), T(0)};
    const T rate = excess / (trial.shear + p.plastic_viscosity);
    return {trial.stress - trial.shear * rate, rate, T(0)};
  }

  /// The same with structure that the flow of the step breaks down, Yu et al. 2026, Eqs. 38 to 45; `p` has
  /// the yield stress without structure. The root of Eq. 43 is taken in a form that does not cancel for small
  /// alpha and holds for alpha = 0. Where breakdown is so strong that xi < 0, the balance has a second root
  /// at yield: below it nothing flows all the same.
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Structure<T>& structure, const Trial<T>& trial,
                          const T& step, const T& lambda) {
    using std::sqrt;
    const T viscosity = trial.shear + p.plastic_viscosity;
    const T lambda_trial = lambda + structure.growth * step;                 // Eq. 38
    const T excess = trial.stress - (T(1) + lambda_trial) * p.yield_stress;  // Eq. 39
    if (!(excess > T(0))) return {trial.stress, T(0), lambda_trial};
    const T xi = viscosity + step * structure.breakdown * (p.yield_stress - trial.stress);  // Eq. 43
    const T zeta = T(2) * structure.breakdown * step * viscosity;
    const T root = sqrt(xi * xi + T(2) * zeta * excess);
    const T rate = xi < T(0) ? (root - xi) / zeta : T(2) * excess / (xi + root);
    return {trial.stress - trial.shear * rate, rate,
            lambda_trial / (T(1) + step * structure.breakdown * rate)};  // Eq. 45
  }
};

}  // namespace flowrest::laws
