#pragma once

#include <cmath>
#include <limits>

#include "laws/parameters.h"
#include "laws/root.h"

namespace flowrest::laws {

/// The fluid of Herschel and Bulkley (1926), its yield stress regularised as Papanastasiou's is:
///
///   tau = K rate (rate^2 + 1 / m^2)^((n - 1) / 2) + tau0 (1 - exp(-m rate)),
///
/// with the consistency K as plastic viscosity. With n = 1 it is Papanastasiou's law. The power's own viscosity,
/// K rate^(n-1), has no bound at rest where n < 1 and vanishes there where n > 1; taken at sqrt(rate^2 + 1 / m^2)
/// it has the limit K m^(1-n), so that one time says where the whole law stops being what it imitates. That form
/// is smooth, its stress rises with the rate for every n > 0, and it bends one way only (down for n < 1, up for
/// n > 1); at rates past a few 1 / m it differs from the power by (n - 1) / (2 m^2 rate^2).
struct HerschelBulkley {
  static constexpr const char* name = "herschel-bulkley";
  static constexpr Parameter needs[] = {Parameter::yield_stress, Parameter::plastic_viscosity,
                                        Parameter::regularisation_time, Parameter::flow_index};
  static constexpr bool can_rest = false;
  static constexpr bool creeps = true;

  /// Pa; expm1 is exact at creep rates.
  template <class T>
  static T stress(const Parameters<T>& p, const T& rate) {
    using std::expm1;
    return power(p, square(p, rate)) * rate - p.yield_stress * expm1(-p.regularisation_time * rate);
  }
  /// d stress / d rate, Pa s
  template <class T>
  static T tangent(const Parameters<T>& p, const T& rate) {
    using std::exp;
    return steepness(p, rate) + p.regularisation_time * p.yield_stress * exp(-p.regularisation_time * rate);
  }
  /// stress / rate, Pa s
  template <class T>
  static T viscosity(const Parameters<T>& p, const T& rate) {
    using std::expm1;
    const T x = p.regularisation_time * rate;
    // Only a rate whose product underflows needs the limit.
    const T yield_part = x > T(std::numeric_limits<T>::min()) ? -expm1(-x) / rate : p.regularisation_time;
    return power(p, square(p, rate)) + p.yield_stress * yield_part;
  }
  template <class T>
  static T rate(const Parameters<T>& p, const T& wanted) {
    return balanced(p, Trial<T>{wanted, T(0)}, T(0), T(8) * std::numeric_limits<T>::epsilon() * wanted,
                    std::numeric_limits<T>::max());
  }
  /// At rest, and where n > 1 as fast as concrete is ever sheared, Pa s.
  template <class T>
  static T largest_viscosity(const Parameters<T>& p) {
    const T fastest(1e3);  // 1/s
    const T at = p.flow_index > T(1) ? fastest : T(0);
    return power(p, square(p, at)) + p.regularisation_time * p.yield_stress;
  }
  /// About where it bends, 1/s.
  template <class T>
  static T yielding_rate(const Parameters<T>& p) {
    return T(1) / p.regularisation_time;
  }

  /// From the last step's rate.
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Trial<T>& trial, const T& rate_before) {
    const T tolerance = T(64) * std::numeric_limits<T>::epsilon() * trial.stress;
    const T rate = balanced(p, trial, rate_before, tolerance, most_of(trial));
    return {trial.stress - trial.shear * rate, rate, T(0)};
  }

 private:
  /// rate^2 + 1 / m^2
  template <class T>
  static T square(const Parameters<T>& p, const T& rate) {
    return rate * rate + T(1) / (p.regularisation_time * p.regularisation_time);
  }
  /// The power's share of the viscosity, Pa s.
  template <class T>
  static T power(const Parameters<T>& p, const T& square) {
    using std::pow;
    return p.plastic_viscosity * pow(square, T(0.5) * (p.flow_index - T(1)));
  }
  /// The power's share of the tangent, Pa s.
  template <class T>
  static T steepness(const Parameters<T>& p, const T& rate) {
    const T s = square(p, rate);
    return power(p, s) * (T(1) + (p.flow_index - T(1)) * rate * rate / s);
  }
  /// Where what the rate relaxes leaves its own stress.
  template <class T>
  static T balanced(const Parameters<T>& p, const Trial<T>& trial, const T& start, const T& tolerance,
                    const T& most) {
    return root_of(
        [&](const T& rate) {
          return Balance<T>{trial.stress - trial.shear * rate - stress(p, rate),
                            trial.shear + tangent(p, rate)};
        },
        start, tolerance, most);
  }
};

}  // namespace flowrest::laws
