#include "scenes/apparatus/duct.h"

#include <algorithm>
#include <cmath>

#include "scenes/apparatus/keys.h"
#include "scenes/case.h"
#include "scenes/pieces.h"

namespace flowrest::scenes {

namespace {

/// Cells along a duct that repeats itself: enough for the widest shape function to see itself only once.
constexpr double columns = 4.0;

}  // namespace

std::vector<Key> Duct::keys() {
  std::vector<Key> keys;
  keys.push_back(
      length_key("height", kept<&Duct::height>, "distance between the plates, a whole number of cells")
          .needed());
  keys.push_back(
      steps(
          "forces.body_force", "N/m3", +[](Draft & draft) -> auto& { return draft.scene.forces.body_force; },
          "force along the duct: a constant, or pairs of the time from which it holds (s) and its value")
          .needed());
  return keys;
}

/// The plates lie on grid lines, where a wall is exact.
void Duct::check(const Case& c) const {
  if (!c.usable({"geometry.height", "mpm.cell"})) return;
  if (c.scene().base.law == Wall::friction)
    c.fault("walls.base", "walls.base has friction, which does not suit a duct; allowed: no-slip, slip");
  const double cells = height / c.scene().mpm.cell;
  constexpr double tolerance = 1e-6;
  c.check_cell("mpm.cell", c.scene().mpm.cell, "duct", height);
  if (cells >= 1.0 && cells < most_cells && std::abs(cells - std::round(cells)) > tolerance * cells) {
    c.fault("mpm.cell",
            fmt::format(
                "the duct is {:g} cells high; allowed: a whole number of cells, for example mpm.cell = {:g}",
                cells, height / std::round(cells)));
  }
}

std::optional<Load> Duct::load(const Scene& scene) const {
  if (scene.base.law != Wall::no_slip) return std::nullopt;
  double force = 0.0;
  for (const auto& [time, value] : scene.forces.body_force) force = std::max(force, std::abs(value));
  return Load{"the duct", "F h / 2", 0.5 * force * height};
}

Pieces Duct::pieces(const Scene& scene) const {
  const double cell = height / std::max(1.0, std::round(height / scene.mpm.cell));
  Pieces p;
  Body body;
  body.upper = {columns * cell, height, 0.0};
  body.contains = [top = height](const Point& x) { return x[1] >= 0.0 && x[1] <= top; };
  body.volume = body.upper[0] * body.upper[1];
  body.extent = columns * height * scene.mpm.cell;
  body.outline = {{0.0, 0.0}, {body.upper[0], 0.0}, {body.upper[0], height}, {0.0, height}};
  p.bodies.push_back(body);
  for (const bool upper : {false, true}) {
    const PlaneAcross plate{.axis = 1, .upper = upper, .place = upper ? height : 0.0, .to = body.upper};
    p.walls.push_back({.name = upper ? "upper plate" : "lower plate", .shape = plate, .contact = scene.base});
  }
  p.periodic = 0;
  p.free_surface = false;
  p.whole_cells_over = height;
  if (scene.base.law != Wall::slip) p.passage = height;
  p.gauged = PlatesGauge{.height = height};
  p.profile = {ProfileAxis::Of::velocity, "y_m"};
  return p;
}

}  // namespace flowrest::scenes
