#include "scenes/check.h"

#include <fmt/format.h>

namespace flowrest::scenes {

Location place_of(const std::string& path, const Given& given) {
  if (const auto value = given.values.find(path); value != given.values.end()) return value->second.where;
  const auto section = given.sections.find(path.substr(0, path.find('.')));
  return section == given.sections.end() ? given.start : section->second;
}

namespace {

void check_cone_fits(const Given& given, const SlumpGeometry& shape, Faults& faults) {
  if (shape.cone_radius_bottom >= shape.domain_radius) {
    faults.add(place_of("geometry.domain_radius", given),
               fmt::format("the cone, {:g} m in radius, does not fit the domain, {:g} m in radius",
                           shape.cone_radius_bottom, shape.domain_radius));
  }
}

}  // namespace

void check(const Given& given, const Scene& scene, Faults& faults) {
  if (scene.kind == Kind::slump) check_cone_fits(given, scene.slump(), faults);
}

}  // namespace flowrest::scenes
