#include "compare/exact/solution_run.h"

#include <fmt/format.h>

#include <cmath>

namespace flowrest::compare::exact {

using scenes::Scene;

void refuse(const Scene& scene, const std::string& why) {
  throw runs::RunError(
      fmt::format("{}: this scene has no exact solution here: {}", scene.path.string(), why));
}

Bingham material_of(const Scene& scene, std::optional<double> flocculation) {
  if (scene.thixotropy && !flocculation)
    refuse(
        scene,
        "a thixotropic yield stress changes with the flow's history; --flocculation gives what it is in the "
        "end, such as the last flocculation_mean of a run");
  if (scene.thixotropy && scene.thixotropy->ageing_rate != 0.0)
    refuse(
        scene,
        "its yield stress grows with age (thixotropy.ageing_rate), so that none is that of its end; allowed: "
        "thixotropy.ageing_rate = 0, and in material.yield_stress what has grown");
  if (flocculation && !scene.thixotropy)
    refuse(scene, "--flocculation is given, and its material is not thixotropic");
  if (flocculation && !(*flocculation >= 0.0 && std::isfinite(*flocculation)))
    refuse(scene, fmt::format("--flocculation {:g}; allowed: from 0", *flocculation));
  return {scene.material.density, scene.material.yield_stress * (1.0 + flocculation.value_or(0.0)),
          scene.material.plastic_viscosity, scene.material.flow_index};
}

runs::RunWriter open_run(const std::filesystem::path& directory, const Scene& scene,
                         std::optional<double> flocculation, runs::Replace replace) {
  auto beside = nlohmann::ordered_json::object();
  beside["flocculation"] = flocculation ? nlohmann::ordered_json(*flocculation) : nlohmann::ordered_json();
  return runs::RunWriter(runs::RunFolder(directory, scene, "exact", replace, beside));
}

std::vector<double> points_to(double edge) {
  constexpr int count = 200;
  std::vector<double> points;
  for (int i = count; i >= 0; --i) {
    const double x = static_cast<double>(i) / count;
    points.push_back(edge * (1.0 - x * x));
  }
  points.push_back(edge * (1.0 + 1e-9));
  return points;
}

}  // namespace flowrest::compare::exact
