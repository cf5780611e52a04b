#include "foamCases/apparatus/printing.h"

#include <fmt/format.h>

namespace flowrest::foam {

std::unique_ptr<ApparatusCase> case_of(const scenes::Printing&, const scenes::Scene& scene) {
  throw scenes::SceneError(
      fmt::format("{}: printing is not computed in OpenFOAM; allowed: flowrest mpm", scene.path.string()));
}

}  // namespace flowrest::foam
