#include "scenes/apparatus/boxes.h"

namespace flowrest::scenes {

Body box_body(const Scene& scene, double length, double width, double height) {
  const bool space = scene.spatial_dimension() == 3;
  const Point size = space ? Point{length, width, height} : Point{length, height, 0.0};
  Body body;
  body.upper = size;
  body.convex = true;
  body.volume = 1.0;
  for (const double edge : size)
    if (edge > 0.0) body.volume *= edge;
  body.extent = body.volume;
  body.outline = {{0.0, 0.0}, {length, 0.0}, {length, height}, {0.0, height}};
  body.contains = [size](const Point& x) {
    for (std::size_t a = 0; a < 3; ++a)
      if (x[a] < 0.0 || x[a] > size[a]) return false;
    return true;
  };
  return body;
}

void add_tank(const Scene& scene, const Tank& tank, Pieces& p) {
  const bool space = scene.spatial_dimension() == 3;
  const Point reach = {tank.length, space ? tank.width : tank.height, tank.height};
  const auto add = [&](const char* name, std::size_t axis, bool upper, double place) {
    const PlaneAcross shape{.axis = axis, .upper = upper, .place = place, .to = reach};
    p.walls.push_back({.name = name, .shape = shape, .contact = scene.base});
  };
  add("floor", space ? 2 : 1, false, 0.0);
  add("back", 0, false, 0.0);
  add("end", 0, true, tank.length);
  if (tank.halved) p.mirrored.push_back(1);
  if (!space) return;
  if (!tank.halved) add("left", 1, false, 0.0);
  add("right", 1, true, tank.width);
}

}  // namespace flowrest::scenes
