#pragma once

#include <cmath>

namespace flowrest::laws {

/// The weakly compressible equation of state of Yu et al. 2026, Eqs. 6, 18 and 31, with the volumetric strain
/// e = J - 1.
template <class T>
struct EquationOfState {
  T bulk_modulus{};   ///< K0, Pa
  T shear_modulus{};  ///< G0, Pa
  T exponent{};       ///< gamma

  /// K / K0 = G / G0
  T stiffening(const T& volume_ratio) const {
    using std::exp;
    return exp(-exponent * (volume_ratio - T(1)));
  }
  /// Pa, positive in compression.
  T pressure(const T& volume_ratio) const {
    return bulk_modulus / exponent * (stiffening(volume_ratio) - T(1));
  }
  /// G, Pa
  T shear(const T& volume_ratio) const { return shear_modulus * stiffening(volume_ratio); }
  /// Energy stored by compression per initial volume, the integral of p over -J. J/m3
  T energy(const T& volume_ratio) const {
    const T strain = volume_ratio - T(1);
    return bulk_modulus / exponent * ((stiffening(volume_ratio) - T(1)) / exponent + strain);
  }
};

}  // namespace flowrest::laws
