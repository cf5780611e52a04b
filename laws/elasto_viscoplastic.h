#pragma once

#include <cmath>
#include <limits>

#include "laws/parameters.h"
#include "laws/root.h"
#include "laws/structure.h"

namespace flowrest::laws {

/// The elasto-viscoplastic Bingham solid of Yu et al. 2026: elastic below its yield stress, where its stress
/// needs no flow, so that it truly comes to rest; tau = tau0 + eta rate above, or with a flow index n other than 1
/// that of Herschel and Bulkley, tau = tau0 + K rate^n.
struct ElastoViscoplastic {
  static constexpr const char* name = "elasto-viscoplastic";
  static constexpr Parameter needs[] = {Parameter::yield_stress, Parameter::plastic_viscosity,
                                        Parameter::flow_index};
  static constexpr bool can_rest = true;
  static constexpr bool creeps = false;

  /// Pa, in flow; at rest any stress up to the yield stress is.
  template <class T>
  static T stress(const Parameters<T>& p, const T& rate) {
    using std::pow;
    return p.yield_stress + p.plastic_viscosity * (is_linear(p) ? rate : pow(rate, p.flow_index));
  }
  template <class T>
  static T tangent(const Parameters<T>& p, const T& rate) {
    using std::pow;
    return is_linear(p) ? p.plastic_viscosity
                        : p.flow_index * p.plastic_viscosity * pow(rate, p.flow_index - T(1));
  }
  template <class T>
  static T rate(const Parameters<T>& p, const T& stress) {
    using std::pow;
    const T linear = larger(stress - p.yield_stress, T(0)) / p.plastic_viscosity;
    return is_linear(p) ? linear : pow(linear, T(1) / p.flow_index);
  }
  /// Pa s, with a flow index that at 1 1/s. Below yield it is elastic, which limits no step by viscosity.
  template <class T>
  static T largest_viscosity(const Parameters<T>& p) {
    return p.plastic_viscosity;
  }
  /// 1/s: it yields at once.
  template <class T>
  static T yielding_rate(const Parameters<T>&) {
    return T(0);
  }

  /// The return map, in closed form where the flow index is 1 (Yu et al. 2026, Eq. 47).
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Trial<T>& trial, const T& /*rate_before*/) {
    const T excess = trial.stress - p.yield_stress;
    if (!(excess > T(0))) return {trial.stress, T(0), T(0)};
    if (!is_linear(p)) return by_power(p, Structure<T>{}, trial, T(0), T(0), T(0));
    const T rate = excess / (trial.shear + p.plastic_viscosity);
    return {trial.stress - trial.shear * rate, rate, T(0)};
  }

  /// The same with structure that the flow of the step breaks down, Yu et al. 2026, Eqs. 38 to 45; `p` has
  /// the yield stress without structure. The root of Eq. 43 is taken in a form that does not cancel for small
  /// alpha and holds for alpha = 0. Where breakdown is so strong that xi < 0, the balance has a second root
  /// at yield: below it nothing flows all the same. What has grown with age, `grown`, flow leaves as it is: the
  /// balance is that of a trial so much less.
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Structure<T>& structure, const Trial<T>& trial,
                          const T& step, const T& lambda, const T& grown = T(0)) {
    using std::sqrt;
    const T viscosity = trial.shear + p.plastic_viscosity;
    const T lambda_trial = lambda + structure.growth * step;            // Eq. 38
    const T carried = trial.stress - grown;                             // by flocs and flow
    const T excess = carried - (T(1) + lambda_trial) * p.yield_stress;  // Eq. 39
    if (!(excess > T(0))) return {trial.stress, T(0), lambda_trial};
    if (!is_linear(p) || !structure.is_linear())
      return by_power(p, structure, trial, lambda_trial, step * structure.breakdown, grown);
    const T xi = viscosity + step * structure.breakdown * (p.yield_stress - carried);  // Eq. 43
    const T zeta = T(2) * structure.breakdown * step * viscosity;
    const T root = sqrt(xi * xi + T(2) * zeta * excess);
    const T rate = xi < T(0) ? (root - xi) / zeta : T(2) * excess / (xi + root);
    return {trial.stress - trial.shear * rate, rate,
            lambda_trial / (T(1) + step * structure.breakdown * rate)};  // Eq. 45
  }

 private:
  template <class T>
  static bool is_linear(const Parameters<T>& p) {
    return !(p.flow_index < T(1) || p.flow_index > T(1));
  }

  /// Past yield, with a structure of which `broken` times the rate's power breaks down:
  ///
  ///   trial - G dt x = (1 + lambda_trial / (1 + broken x^m)) tau0 + grown + K x^n.
  ///
  /// The start lies below the root: G dt and K take at most half each of what the trial has past yield, and
  /// breakdown only adds to that. From 0, where the power of n < 1 is infinitely steep, no step would lead away.
  /// With m <= 1 and n >= 1 there is one root, for the logarithm of what the flocs' hold is to balance is
  /// concave in x. With m > 1 there is one where breakdown weakens less than the elastic solid unloads,
  /// lambda tau0 m broken^(1/m) <= G dt; past that several rates may balance, and the one found is as good.
  template <class T>
  static Relaxed<T> by_power(const Parameters<T>& p, const Structure<T>& structure, const Trial<T>& trial,
                             const T& lambda_trial, const T& broken, const T& grown) {
    using std::pow;
    const T carried = trial.stress - grown;
    const T half = T(0.5) * (carried - (T(1) + lambda_trial) * p.yield_stress);
    const T start = smaller(half / trial.shear, pow(half / p.plastic_viscosity, T(1) / p.flow_index));
    const T rate = root_of(
        [&](const T& x) {
          const T left = T(1) / (T(1) + broken * structure.flow(x));
          const T power = p.plastic_viscosity * pow(x, p.flow_index);
          return Balance<T>{
              carried - (T(1) + lambda_trial * left) * p.yield_stress - trial.shear * x - power,
              trial.shear + p.flow_index * power / x -
                  lambda_trial * p.yield_stress * broken * left * left * structure.flow_slope(x)};
        },
        start, T(64) * std::numeric_limits<T>::epsilon() * trial.stress, most_of(trial));
    return {trial.stress - trial.shear * rate, rate, lambda_trial / (T(1) + broken * structure.flow(rate))};
  }
};

}  // namespace flowrest::laws
