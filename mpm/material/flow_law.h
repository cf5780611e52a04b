#pragma once

#include <limits>

#include "mpm/simd/math.h"

/// The flow laws, each as what happens to the shear stress invariant of the elastic trial within one step.
/// All laws share the trial (deviator.h) and the equation of state; they differ only in `relax`.
///
/// tau = sqrt(s:s / 2) and rate = sqrt(2 D:D) throughout.
namespace flowrest::mpm {

/// Parameters of every law, resolved from the scene; what a law does not use it does not read.
template <class T>
struct FlowParameters {
  T yield_stress{};         ///< Pa
  T plastic_viscosity{};    ///< Pa s; of a power law Pa s^n
  T regularisation_time{};  ///< s
  T critical_shear_rate{};  ///< 1/s
  T flocculation_growth{};  ///< A_thix / tau0, 1/s
  T deflocculation{};       ///< alpha
  T flow_index{1};          ///< n
  T breakdown_exponent{1};  ///< m
  T grown{};                ///< Pa that the yield stress has grown by with age, at the step's end
};

/// What a step leaves of the trial.
template <class T>
struct Relaxed {
  T stress{};  ///< Pa, the invariant after the step
  T rate{};    ///< 1/s, plastic (EVP) or total (fluid) shear rate
  T lambda{};  ///< flocculation state after the step
};

template <class T>
constexpr T smallest_normal = std::numeric_limits<T>::min();

/// A power of a rate, for rates that may vanish.
template <class T>
FLOWREST_INLINE T raised(T rate, T exponent) {
  return power(minimum(maximum(rate, smallest_normal<T>), std::numeric_limits<T>::max()), exponent);
}

/// rate^m, by which flocs break; `Power`: m is not 1.
template <bool Power, class T>
FLOWREST_INLINE T breaking_flow(const FlowParameters<T>& p, T rate) {
  if constexpr (!Power) return rate;
  const T flow = raised(rate, p.breakdown_exponent);
  return rate > T(0) ? flow : T(0);
}

/// lambda after a step at a rate: breakdown of what there is at its end.
template <bool Power, class T>
FLOWREST_INLINE T flocculated(const FlowParameters<T>& p, T dt, T lambda, T rate) {
  return (lambda + p.flocculation_growth * dt) /
         (T(1) + dt * p.deflocculation * breaking_flow<Power>(p, rate));
}

/// Elasto-viscoplastic Bingham solid: closed-form return map, Yu et al. 2026, Eqs. 38 to 47. What has grown
/// with age, which flow leaves as it is, is taken off the trial.
template <bool Thixotropic>
struct ElastoViscoplastic {
  static constexpr bool thixotropic = Thixotropic;
  static constexpr bool iterative = false;

  /// `trial` is tau of the elastic trial, Pa; `shear` is G dt, Pa s.
  template <class T>
  static FLOWREST_INLINE Relaxed<T> relax(const FlowParameters<T>& p, T trial, T shear, T dt, T lambda,
                                          T /*rate*/) {
    const T viscosity = shear + p.plastic_viscosity;
    if constexpr (!Thixotropic) {
      const T excess = maximum(trial - p.yield_stress, T(0));
      const T rate = excess / viscosity;  // Eq. 47
      return {trial - shear * rate, rate, T(0)};
    } else {
      const T carried = trial - p.grown;
      const T lambda_trial = lambda + p.flocculation_growth * dt;                        // Eq. 38
      const T excess = maximum(carried - (T(1) + lambda_trial) * p.yield_stress, T(0));  // Eq. 39
      // Eqs. 43 and 44. As printed the root cancels for small alpha; this form does not, and holds for alpha
      // = 0.
      const T xi = viscosity + dt * p.deflocculation * (p.yield_stress - carried);
      const T zeta = T(2) * p.deflocculation * dt * viscosity;
      const T root = square_root(xi * xi + T(2) * zeta * excess);
      const T flow = xi >= T(0) ? T(2) * excess / (xi + root) : (root - xi) / maximum(zeta, T(1e-30));
      // Where breakdown is so strong that xi < 0 the balance has a second root at yield: below it nothing
      // flows all the same.
      const T rate = excess > T(0) ? flow : T(0);
      return {trial - shear * rate, rate, lambda_trial / (T(1) + dt * p.deflocculation * rate)};  // Eq. 45
    }
  }
};

/// A fluid whose stress is found pointwise implicitly: tau_trial - G dt x = tau(x). No viscous limit on the
/// step. Thixotropy is staggered: lambda first, with the last step's rate, then the stress with lambda held.
template <bool Thixotropic, bool Power = false>
struct BiViscous {
  static constexpr bool thixotropic = Thixotropic;
  static constexpr bool iterative = false;

  template <class T>
  static FLOWREST_INLINE Relaxed<T> relax(const FlowParameters<T>& p, T trial, T shear, T dt, T lambda,
                                          T rate_before) {
    T yield = p.yield_stress;
    if constexpr (Thixotropic) {
      lambda = flocculated<Power>(p, dt, lambda, rate_before);
      yield = yield * (T(1) + lambda) + p.grown;
    }
    const T stiff = p.plastic_viscosity + yield / p.critical_shear_rate;
    const T slow = trial / (shear + stiff);
    const T fast = (trial - yield) / (shear + p.plastic_viscosity);
    const T rate = slow <= p.critical_shear_rate ? slow : fast;
    return {trial - shear * rate, rate, lambda};
  }
};

/// Newtonian: the same with no yield stress.
struct Newtonian {
  static constexpr bool thixotropic = false;
  static constexpr bool iterative = false;

  template <class T>
  static FLOWREST_INLINE Relaxed<T> relax(const FlowParameters<T>& p, T trial, T shear, T, T, T) {
    const T rate = trial / (shear + p.plastic_viscosity);
    return {trial - shear * rate, rate, T(0)};
  }
};

/// Papanastasiou-regularised Bingham fluid, tau(x) = eta x + yield (1 - exp(-m x)), Yu et al. 2026, Eqs. 10
/// and 13. The balance falls and is convex in x, so Newton's method approaches the root from below without
/// overshoot once it is below it; the Bingham solution is such a start. `iterative`: the loop over particles
/// calls `iterate` until all balance.
template <bool Thixotropic>
struct Papanastasiou {
  static constexpr bool thixotropic = Thixotropic;
  static constexpr bool iterative = true;

  /// The balance at a rate, Pa, and Newton's next one, never below the Bingham solution. The balance and not
  /// the rate says when to stop: near yield a rate is known less well than a stress by orders of magnitude.
  template <class T>
  struct Iterate {
    T residual, rate;
  };
  template <class T>
  static FLOWREST_INLINE Iterate<T> iterate(const FlowParameters<T>& p, T yield, T trial, T shear, T rate) {
    const T viscosity = shear + p.plastic_viscosity;
    const T floor = maximum(trial - yield, T(0)) / viscosity;
    const T lost =
        exponential_minus_one(-p.regularisation_time * rate);  // exp(-m x) - 1, exact at creep rates too
    const T residual = trial - viscosity * rate + yield * lost;
    const T slope = viscosity + yield * p.regularisation_time * (T(1) + lost);
    return {residual, maximum(rate + residual / slope, floor)};
  }
};

/// What a balance leaves at a rate, Pa, and how steeply it falls there, Pa s.
template <class T>
struct Balance {
  T residual, slope;
};

/// Herschel and Bulkley's fluid with its yield stress as Papanastasiou has it, and the power's viscosity taken
/// at sqrt(x^2 + 1 / m^2): tau(x) = K x (x^2 + 1 / m^2)^((n - 1) / 2) + yield (1 - exp(-m x)). Where n > 1 the
/// power bends against the yield stress, so that no start is safe for Newton's method alone: the loop over
/// particles keeps the root between two rates.
template <bool Thixotropic, bool Power = false>
struct HerschelBulkley {
  static constexpr bool thixotropic = Thixotropic;
  static constexpr bool iterative = true;

  /// Where the search for the rate starts, with the lambda it is made with.
  template <class T>
  static FLOWREST_INLINE Relaxed<T> start(const FlowParameters<T>& p, T /*trial*/, T /*shear*/, T dt,
                                          T lambda, T rate_before) {
    if constexpr (!Thixotropic) return {T(0), rate_before, T(0)};
    return {T(0), rate_before, flocculated<Power>(p, dt, lambda, rate_before)};
  }
  /// lambda at the rate that is found.
  template <class T>
  static FLOWREST_INLINE T lambda_at(const FlowParameters<T>&, T /*dt*/, T lambda, T /*rate*/) {
    return lambda;
  }
  template <class T>
  static FLOWREST_INLINE Balance<T> balance(const FlowParameters<T>& p, T trial, T shear, T /*dt*/, T lambda,
                                            T rate) {
    const T yield = Thixotropic ? p.yield_stress * (T(1) + lambda) + p.grown : p.yield_stress;
    const T time = p.regularisation_time, above = p.flow_index - T(1);
    const T square = rate * rate + T(1) / (time * time);
    const T viscosity = p.plastic_viscosity * power(square, T(0.5) * above);
    const T lost = exponential_minus_one(-time * rate);
    return {trial - (shear + viscosity) * rate + yield * lost,
            shear + viscosity * (T(1) + above * rate * rate / square) + yield * time * (T(1) + lost)};
  }
};

/// The elasto-viscoplastic solid with a power of the rate, tau0 + K x^n, and breakdown within the step as
/// above, by a power of its own where `Power`.
template <bool Thixotropic, bool Power = false>
struct ElastoViscoplasticPower {
  static constexpr bool thixotropic = Thixotropic;
  static constexpr bool iterative = true;

  /// Below the root: either of what resists takes half of what the trial has past yield. Below yield 0, where
  /// nothing is left to balance.
  template <class T>
  static FLOWREST_INLINE Relaxed<T> start(const FlowParameters<T>& p, T trial, T shear, T dt, T lambda,
                                          T /*rate_before*/) {
    const T lambda_trial = Thixotropic ? lambda + p.flocculation_growth * dt : T(0);
    const T carried = Thixotropic ? trial - p.grown : trial;
    const T half = T(0.5) * (carried - (T(1) + lambda_trial) * p.yield_stress);
    const T viscous = raised(half / maximum(p.plastic_viscosity, smallest_normal<T>), T(1) / p.flow_index);
    return {T(0), half > T(0) ? minimum(half / shear, viscous) : T(0), lambda_trial};
  }
  template <class T>
  static FLOWREST_INLINE T lambda_at(const FlowParameters<T>& p, T dt, T lambda, T rate) {
    return lambda / (T(1) + dt * p.deflocculation * breaking_flow<Power>(p, rate));
  }
  template <class T>
  static FLOWREST_INLINE Balance<T> balance(const FlowParameters<T>& p, T trial, T shear, T dt, T lambda,
                                            T rate) {
    const T power_part = p.plastic_viscosity * raised(rate, p.flow_index);
    const T slope = shear + p.flow_index * power_part / maximum(rate, smallest_normal<T>);
    if constexpr (!Thixotropic)
      return {rate > T(0) ? trial - p.yield_stress - shear * rate - power_part : T(0), slope};
    const T flow = breaking_flow<Power>(p, rate), carried = trial - p.grown;
    const T broken = dt * p.deflocculation, left = T(1) / (T(1) + broken * flow);
    T weakening = lambda * p.yield_stress * broken * left * left;
    if constexpr (Power) weakening *= p.breakdown_exponent * flow / maximum(rate, smallest_normal<T>);
    return {
        rate > T(0) ? carried - (T(1) + lambda * left) * p.yield_stress - shear * rate - power_part : T(0),
        slope - weakening};
  }
};

/// Shear stress of a fluid at a given rate: the explicit update, and the reference of the implicit one. Pa.
template <class T>
FLOWREST_INLINE T herschel_bulkley_stress(FlowParameters<T> p, T yield, T rate) {
  p.yield_stress = yield;
  return -HerschelBulkley<false>::balance(p, T(0), T(0), T(0), T(0), rate).residual;
}

template <class T>
FLOWREST_INLINE T papanastasiou_stress(const FlowParameters<T>& p, T yield, T rate) {
  return p.plastic_viscosity * rate - yield * exponential_minus_one(-p.regularisation_time * rate);
}

template <class T>
FLOWREST_INLINE T bi_viscous_stress(const FlowParameters<T>& p, T yield, T rate) {
  return p.plastic_viscosity * rate + yield * minimum(rate / p.critical_shear_rate, T(1));
}

}  // namespace flowrest::mpm
