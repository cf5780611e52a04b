#include "scenes/apparatus/load.h"

#include <numbers>

#include "scenes/scene.h"

namespace flowrest::scenes {

Load standing_load(const Scene& scene, const char* what) {
  return {what, "rho g h / sqrt(3)",
          scene.material.density * scene.forces.gravity * scene.body_height() / std::numbers::sqrt3};
}

}  // namespace flowrest::scenes
