#pragma once

#include "laws/parameters.h"
#include "laws/structure.h"

namespace flowrest::laws {

/// A law whose yield stress structure raises, and age: (1 + lambda) tau0 + grown (structure.h).
template <class Law>
struct Thixotropic {
  /// The law's parameters with the yield stress that lambda gives it; `grown` with age, Pa.
  template <class T>
  static Parameters<T> with_structure(Parameters<T> p, const T& lambda, const T& grown = T(0)) {
    p.yield_stress *= T(1) + lambda;  // Yu et al. 2026, Eq. 11
    p.yield_stress += grown;
    return p;
  }

  /// A step of `step` seconds. A solid's return map finds the rate of the step and what it leaves of the
  /// structure together. A fluid is staggered: first the structure, with the last step's rate, then the
  /// stress, with the structure held. `grown` is what has grown with age by the step's end, Pa.
  template <class T>
  static Relaxed<T> relax(const Parameters<T>& p, const Structure<T>& structure, const Trial<T>& trial,
                          const T& step, const T& lambda, const T& rate_before, const T& grown = T(0)) {
    if constexpr (Law::can_rest) {
      return Law::relax(p, structure, trial, step, lambda, grown);
    } else {
      const T flocculation = structure.stepped(lambda, rate_before, step);
      Relaxed<T> relaxed = Law::relax(with_structure(p, flocculation, grown), trial, rate_before);
      relaxed.flocculation = flocculation;
      return relaxed;
    }
  }
};

}  // namespace flowrest::laws
