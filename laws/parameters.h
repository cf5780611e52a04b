#pragma once

/// What the flow laws share: their parameters, and what a step of an implicit update gives and takes.
///
/// tau = sqrt(s:s / 2), s the deviatoric stress, and rate = sqrt(2 D:D) throughout. Every function is a
/// template over the scalar: double, float, or a number that carries derivatives and brings sqrt, exp,
/// expm1 and pow along.
namespace flowrest::laws {

/// Parameters of every law; what a law does not need it does not read. The yield stress is the local one:
/// structure (thixotropy.h) raises it.
template <class T>
struct Parameters {
  T yield_stress{};         ///< Pa, tau0
  T plastic_viscosity{};    ///< Pa s, eta; of a power law the consistency K, Pa s^n
  T regularisation_time{};  ///< s, m of Papanastasiou
  T critical_shear_rate{};  ///< 1/s, at which the bi-viscous law yields
  T flow_index{1};          ///< n, the power of the rate
};

/// One of them, as laws say which they need.
enum class Parameter {
  yield_stress,
  plastic_viscosity,
  regularisation_time,
  critical_shear_rate,
  flow_index
};
constexpr Parameter every_parameter[] = {Parameter::yield_stress, Parameter::plastic_viscosity,
                                         Parameter::regularisation_time, Parameter::critical_shear_rate,
                                         Parameter::flow_index};

/// Its key in a scene's [material].
constexpr const char* key_of(Parameter parameter) {
  switch (parameter) {
    case Parameter::yield_stress:
      return "yield_stress";
    case Parameter::plastic_viscosity:
      return "plastic_viscosity";
    case Parameter::regularisation_time:
      return "regularisation_time";
    case Parameter::critical_shear_rate:
      return "critical_shear_rate";
    case Parameter::flow_index:
      break;
  }
  return "flow_index";
}

/// Whether a scene may leave it out, whatever the law.
constexpr bool has_default(Parameter parameter) { return parameter == Parameter::flow_index; }

/// Empty for a number without unit.
constexpr const char* unit_of(Parameter parameter) {
  switch (parameter) {
    case Parameter::yield_stress:
      return "Pa";
    case Parameter::plastic_viscosity:
      return "Pa s";
    case Parameter::regularisation_time:
      return "s";
    case Parameter::critical_shear_rate:
      return "1/s";
    case Parameter::flow_index:
      break;
  }
  return "";
}

template <class T>
constexpr T Parameters<T>::*member_of(Parameter parameter) {
  switch (parameter) {
    case Parameter::yield_stress:
      return &Parameters<T>::yield_stress;
    case Parameter::plastic_viscosity:
      return &Parameters<T>::plastic_viscosity;
    case Parameter::regularisation_time:
      return &Parameters<T>::regularisation_time;
    case Parameter::critical_shear_rate:
      return &Parameters<T>::critical_shear_rate;
    case Parameter::flow_index:
      break;
  }
  return &Parameters<T>::flow_index;
}

/// The elastic trial of a step, which a law returns to its own stress at the rate x that balances
/// trial - G dt x = stress(x): no viscous limit on the step.
template <class T>
struct Trial {
  T stress{};  ///< Pa, tau of the stress that the step's strain alone would leave
  T shear{};   ///< Pa s, G dt
};

/// What a step leaves of the trial.
template <class T>
struct Relaxed {
  T stress{};        ///< Pa, tau after the step
  T rate{};          ///< 1/s, plastic shear rate of what can rest, total one of a fluid
  T flocculation{};  ///< lambda after the step; 0 without structure
};

template <class T>
constexpr T larger(const T& a, const T& b) {
  return a < b ? b : a;
}
template <class T>
constexpr T smaller(const T& a, const T& b) {
  return b < a ? b : a;
}

}  // namespace flowrest::laws
