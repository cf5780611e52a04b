#pragma once

namespace flowrest::scenes {

struct Scene;

/// What a yield stress holds, and the largest shear stress that can come over it, Pa.
struct Load {
  const char* what;     ///< "the cone"
  const char* rule;     ///< how the stress follows
  double stress = 0.0;  ///< Pa; a yield stress as large holds it for certain
};

/// A body whose weight rests on its foot yields where rho g h, pressing, brings sqrt(J2) = rho g h / sqrt(3)
/// about.
Load standing_load(const Scene&, const char* what);

}  // namespace flowrest::scenes
