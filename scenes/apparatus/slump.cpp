#include "scenes/apparatus/slump.h"

#include <cmath>
#include <numbers>

#include "scenes/apparatus/keys.h"
#include "scenes/case.h"
#include "scenes/pieces.h"

namespace flowrest::scenes {

namespace {

/// Thickness of the mould: more than a real one has, so that nothing finds itself behind it. m
constexpr double mould_thickness = 0.04;

void check_domain(const Slump& shape, const Case& c) {
  const double radius = std::max(shape.cone_radius_top, shape.cone_radius_bottom);
  if (c.usable({"geometry.cone_radius_top", "geometry.cone_radius_bottom", "geometry.domain_radius"}) &&
      radius >= shape.domain_radius) {
    c.fault("geometry.domain_radius",
            fmt::format(
                "the cone does not fit the domain: its radius is {:g} m, geometry.domain_radius is {:g} m; "
                "allowed: a domain wider than the cone",
                radius, shape.domain_radius));
  }
  if (c.usable({"geometry.cone_height", "geometry.domain_height"}) &&
      shape.cone_height > shape.domain_height) {
    c.fault("geometry.domain_height",
            fmt::format(
                "the cone does not fit the domain: its height is {:g} m, geometry.domain_height is {:g} m; "
                "allowed: a domain at least as high as the cone",
                shape.cone_height, shape.domain_height));
  }
}

void check_cells(const Slump& shape, const Case& c) {
  if (!c.usable({"geometry.cone_height", "geometry.cone_radius_bottom", "mpm.cell", "foam.cell"})) return;
  const double smallest = std::min(shape.cone_height, shape.cone_radius_bottom);
  c.check_cell("mpm.cell", c.scene().mpm.cell, "cone", smallest);
  if (c.given.gives("foam.cell")) c.check_cell("foam.cell", c.scene().foam.cell, "cone", smallest);
}

void check_mesh(const Slump& shape, const Case& c) {
  if (!c.usable({"geometry.domain_radius", "geometry.domain_height", "foam.cell"})) return;
  const double cell = c.scene().foam.cell;
  const double cells = shape.domain_radius / cell * (shape.domain_height / cell);
  if (cells <= most_cells) return;
  c.fault(c.given.gives("foam.cell") ? "foam.cell" : "mpm.cell",
          fmt::format("the OpenFOAM mesh would have {:.3g} cells of {:g} m; allowed: at most {:g}", cells,
                      cell, most_cells));
}

Body cone(const Slump& g, const Scene& scene, double whole_over_computed) {
  const int dim = scene.spatial_dimension();
  const bool full = scene.geometry.dimension == Dimension::full;
  const double reach = std::max(g.cone_radius_bottom, g.cone_radius_top);
  Body body;
  for (int a = 0; a < dim - 1; ++a) {
    body.lower[static_cast<std::size_t>(a)] = full ? -reach : 0.0;
    body.upper[static_cast<std::size_t>(a)] = reach;
  }
  const auto up = static_cast<std::size_t>(dim - 1);
  body.upper[up] = g.cone_height;
  body.convex = true;
  body.contains = [g, dim, up](const Point& x) {
    if (x[up] < 0.0 || x[up] > g.cone_height) return false;
    const double radius =
        g.cone_radius_bottom + (g.cone_radius_top - g.cone_radius_bottom) * x[up] / g.cone_height;
    return (dim == 3 ? std::hypot(x[0], x[1]) : std::abs(x[0])) <= radius;
  };
  const double section = 0.5 * (g.cone_radius_bottom + g.cone_radius_top) * g.cone_height;
  body.volume = scene.geometry.dimension == Dimension::plane ? section : g.volume() / whole_over_computed;
  body.extent = dim == 3 ? body.volume : section;
  body.outline = {
      {0.0, 0.0}, {g.cone_radius_bottom, 0.0}, {g.cone_radius_top, g.cone_height}, {0.0, g.cone_height}};
  if (g.cone_radius_top == 0.0) body.outline.pop_back();
  if (g.cone_radius_bottom == 0.0) body.outline.erase(body.outline.begin() + 1);
  if (dim == 3) body.turn = full ? 2.0 * std::numbers::pi : 0.5 * std::numbers::pi;
  if (g.mould_lift_velocity) body.filling = Filling::settled;
  return body;
}

/// A steel cone open at both ends, lifted from the start and gone once it is clear of the concrete.
WallPiece mould(const Slump& g, const Scene& scene) {
  WallPiece wall;
  wall.name = "mould";
  wall.contact = scene.mould.value_or(scene.base);
  Profiled shape;
  shape.corners = {{g.cone_radius_bottom, 0.0},
                   {g.cone_radius_bottom + 0.5 * mould_thickness, 0.0},
                   {g.cone_radius_top + 0.5 * mould_thickness, g.cone_height},
                   {g.cone_radius_top, g.cone_height}};
  shape.touched = {true, false, false, true};
  shape.sweep = Profiled::Sweep::turned;
  shape.to = scene.geometry.dimension == Dimension::full ? 2.0 * std::numbers::pi : 0.5 * std::numbers::pi;
  wall.shape = shape;
  wall.lift_velocity = *g.mould_lift_velocity;
  wall.gone_at = g.cone_height / *g.mould_lift_velocity;
  return wall;
}

}  // namespace

double Slump::volume() const {
  return std::numbers::pi / 3.0 * cone_height *
         (cone_radius_top * cone_radius_top + cone_radius_top * cone_radius_bottom +
          cone_radius_bottom * cone_radius_bottom);
}

double Slump::body_size() const { return std::cbrt(volume()); }

std::vector<Key> Slump::keys() {
  std::vector<Key> keys;
  keys.push_back(
      length_key("cone_height", kept<&Slump::cone_height>, "height of the cone of material").needed());
  keys.push_back(number("geometry.cone_radius_top", "m", from(0.0, largest_length),
                        kept<&Slump::cone_radius_top>, "radius of the cone at its top")
                     .needed());
  keys.push_back(
      length_key("cone_radius_bottom", kept<&Slump::cone_radius_bottom>, "radius of the cone at the plate")
          .needed());
  keys.push_back(length_key("domain_radius", kept<&Slump::domain_radius>,
                            "radius of the OpenFOAM mesh; material that reaches it ends a run")
                     .needed());
  keys.push_back(length_key("domain_height", kept<&Slump::domain_height>,
                            "height of the OpenFOAM mesh; material that reaches it ends a run")
                     .needed());
  keys.push_back(number("geometry.mould_lift_velocity", "m/s", above(0.0, 1e3),
                        kept<&Slump::mould_lift_velocity>, "speed at which the mould is lifted off the cone")
                     .otherwise("the cone is released at once"));
  keys.push_back(wall(
                     "walls.mould", +[](Draft & draft) -> auto& { return draft.scene.mould; },
                     "how the mould of a slump holds the material")
                     .otherwise("as walls.base"));
  return keys;
}

void Slump::check(const Case& c) const {
  check_domain(*this, c);
  check_cells(*this, c);
  check_mesh(*this, c);
}

void Slump::check_gauges(const Case& c) const {
  c.check_gauge("gauges.spread_depth", c.scene().gauges.spread_depth, "the cone's height", body_height(),
                {"geometry.cone_height"});
}

std::optional<Load> Slump::load(const Scene& scene) const { return standing_load(scene, "the cone"); }

Pieces Slump::pieces(const Scene& scene) const {
  const Dimension dimension = scene.geometry.dimension;
  const bool full = dimension == Dimension::full;
  const auto up = static_cast<std::size_t>(scene.spatial_dimension() - 1);
  Pieces p;
  // Of a plane column half of the section is computed.
  p.whole_over_computed = dimension == Dimension::quarter ? 4.0 : dimension == Dimension::plane ? 2.0 : 1.0;
  p.bodies.push_back(cone(*this, scene, p.whole_over_computed));
  PlaneAcross base{.axis = up};
  for (std::size_t a = 0; a < up; ++a) {
    if (!full) p.mirrored.push_back(a);
    base.from[a] = full ? -domain_radius : 0.0;
    base.to[a] = domain_radius;
  }
  p.walls.push_back({.name = "base", .shape = base, .contact = scene.base});
  if (mould_lift_velocity) p.walls.push_back(mould(*this, scene));
  p.drop = cone_height;
  p.domain = Domain{domain_radius, domain_height};
  p.gauged = SpreadGauge{.about_axis = dimension != Dimension::plane};
  p.profile = {ProfileAxis::Of::depth, dimension == Dimension::plane ? "x_m" : "r_m"};
  return p;
}

}  // namespace flowrest::scenes
