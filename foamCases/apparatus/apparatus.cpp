#include "foamCases/apparatus/apparatus.h"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "foamCases/apparatus/dam_break.h"
#include "foamCases/apparatus/duct.h"
#include "foamCases/apparatus/l_box.h"
#include "foamCases/apparatus/printing.h"
#include "foamCases/apparatus/slump.h"
#include "foamCases/apparatus/v_funnel.h"

namespace flowrest::foam {

std::unique_ptr<ApparatusCase> case_of(const scenes::Scene& scene) {
  return std::visit([&](const auto& apparatus) { return case_of(apparatus, scene); },
                    scene.geometry.apparatus);
}

std::string ApparatusCase::folder() const { return scenes::name_of(scene_.geometry.apparatus); }

std::string ApparatusCase::force_parameters() const {
  const auto& base = scene_.base;
  std::string condition = base.law == scenes::Wall::slip ? "{ type slip; }" : "{ type noSlip; }";
  // OpenFOAM's own slip is wrong on walls that lean, as forces are (rheology/inclined_cells.h).
  if (base.law == scenes::Wall::slip && leans()) condition = "{ type coulombFriction; friction 0; }";
  if (base.law == scenes::Wall::friction)
    condition = fmt::format("{{ type coulombFriction; friction {}; }}", base.friction);
  return fmt::format(
      "\n// Forces and walls.\n"
      "gravity             (0 0 {});  // m/s2\n"
      "baseWall            {}\n",
      -scene_.forces.gravity, condition);
}

double ApparatusCase::fall_speed() const {
  return std::sqrt(2.0 * scene_.forces.gravity * scene_.body_height());
}

void ApparatusCase::refuse(const std::string& what) const {
  throw scenes::SceneError(fmt::format("{}: {}", scene_.path.string(), what));
}

}  // namespace flowrest::foam
