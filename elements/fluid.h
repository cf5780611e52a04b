#pragma once

#include <cmath>
#include <type_traits>

#include "laws/law.h"

namespace flowrest::elements {

/// What a material answers to a shear rate, both in Pa s.
struct Response {
  double viscosity = 0.0;  ///< stress over rate
  double tangent = 0.0;    ///< d stress / d rate
};

/// The flow law as the minimisation needs it, with a viscosity at every rate. A law that can rest is rounded
/// at rest: tau = (eta + tau0 / sqrt(rate^2 + rounding^2)) rate, which is Bingham's in the limit; with a flow
/// index n the consistency K takes eta's place times (rate^2 + rounding^2)^((n - 1) / 2).
class Fluid {
 public:
  /// `rounding` in 1/s; laws that cannot rest do not read it.
  Fluid(const laws::FlowCurve& flow, double rounding) : flow_(flow), rounding_(rounding) {}

  Response at(double rate) const {
    return laws::visit(flow_.law, [&](auto own) -> Response {
      const auto& p = flow_.parameters;
      if constexpr (decltype(own)::can_rest) {
        if (!(p.yield_stress > 0.0) && p.flow_index == 1.0) return {p.plastic_viscosity, p.plastic_viscosity};
        const double square = rate * rate + rounding_ * rounding_;
        const double plastic = p.yield_stress / std::sqrt(square), above = p.flow_index - 1.0;
        const double viscous = p.plastic_viscosity * std::pow(square, 0.5 * above);
        return {viscous + plastic,
                viscous * (1.0 + above * rate * rate / square) + plastic * rounding_ * rounding_ / square};
      } else {
        return {own.viscosity(p, rate), own.tangent(p, rate)};
      }
    });
  }
  /// At rest, Pa s.
  double largest_viscosity() const { return at(0.0).viscosity; }

 private:
  laws::FlowCurve flow_;
  double rounding_;
};

}  // namespace flowrest::elements
