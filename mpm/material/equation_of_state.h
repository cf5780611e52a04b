#pragma once

#include "mpm/simd/math.h"

namespace flowrest::mpm {

/// Weakly compressible equation of state, Yu et al. 2026, Eqs. 6, 18 and 31, with the volumetric strain e = J
/// - 1.
template <class T>
struct EquationOfState {
  T bulk_modulus{};   ///< K0, Pa
  T shear_modulus{};  ///< G0, Pa
  T exponent{};       ///< gamma

  struct State {
    T pressure;  ///< Pa, positive in compression
    T shear;     ///< G, Pa: keeps its ratio to K
  };
  FLOWREST_INLINE State at(T volume_ratio) const {
    const T stiffening = exponential(-exponent * (volume_ratio - T(1)));
    return {bulk_modulus / exponent * (stiffening - T(1)), shear_modulus * stiffening};
  }
  /// Energy stored by compression per initial volume, the integral of p over -J. J/m3
  FLOWREST_INLINE T energy(T volume_ratio) const {
    const T strain = volume_ratio - T(1);
    return bulk_modulus / exponent * ((exponential(-exponent * strain) - T(1)) / exponent + strain);
  }
};

}  // namespace flowrest::mpm
