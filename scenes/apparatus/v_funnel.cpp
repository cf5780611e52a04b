#include "scenes/apparatus/v_funnel.h"

#include <algorithm>
#include <cmath>

#include "scenes/apparatus/keys.h"
#include "scenes/case.h"
#include "scenes/pieces.h"

namespace flowrest::scenes {

namespace {

/// Thickness of the plates, m: more than real ones have, so that nothing finds itself behind them.
constexpr double plate_thickness = 0.04;
/// By how much the walls reach above the brim and outwards, m.
constexpr double rim = 0.1;

Body funnel_body(const VFunnel& g, const Scene& scene, double whole_over_computed) {
  const int dim = scene.spatial_dimension();
  const auto up = static_cast<std::size_t>(dim - 1);
  const bool full = scene.geometry.dimension == Dimension::full;
  Body body;
  body.upper = {0.5 * g.top_width, dim == 3 ? 0.5 * g.depth : 0.0, 0.0};
  for (std::size_t a = 0; a < up; ++a) body.lower[a] = full ? -body.upper[a] : 0.0;
  body.upper[up] = g.height();
  body.contains = [g, up, lower = body.lower, upper = body.upper](const Point& x) {
    for (std::size_t a = 0; a <= up; ++a)
      if (x[a] < lower[a] || x[a] > upper[a]) return false;
    return std::abs(x[0]) <= 0.5 * g.width_at(x[up]);
  };
  body.volume = dim == 2 ? 0.5 * g.volume() / g.depth : g.volume() / whole_over_computed;
  body.extent = body.volume;
  const auto corner = [&](double height) { return std::array<double, 2>{0.5 * g.width_at(height), height}; };
  body.outline = {corner(0.0), corner(g.neck_height), corner(g.height())};
  if (g.neck_height <= 0.0) body.outline.erase(body.outline.begin());
  // The other side is the mirror image, or the middle.
  for (std::size_t i = body.outline.size(); i-- > 0;)
    if (full) body.outline.push_back({-body.outline[i][0], body.outline[i][1]});
  if (!full) {
    body.outline.push_back({0.0, g.height()});
    body.outline.push_back({0.0, 0.0});
  }
  body.filling = Filling::settled;
  return body;
}

}  // namespace

double VFunnel::width_at(double height) const {
  const double share = std::clamp((height - neck_height) / taper_height, 0.0, 1.0);
  return outlet_width + share * (top_width - outlet_width);
}

double VFunnel::volume() const {
  return depth * (neck_height * outlet_width + taper_height * 0.5 * (outlet_width + top_width));
}

std::vector<Key> VFunnel::keys() {
  std::vector<Key> keys;
  keys.push_back(length_key("top_width", kept<&VFunnel::top_width>, "width at the top"));
  keys.push_back(length_key("outlet_width", kept<&VFunnel::outlet_width>, "width of the outlet"));
  keys.push_back(length_key("depth", kept<&VFunnel::depth>, "distance between the plates"));
  keys.push_back(length_key("taper_height", kept<&VFunnel::taper_height>, "height of the sloping part"));
  keys.push_back(
      length_key("neck_height", kept<&VFunnel::neck_height>, "height of the neck over the outlet"));
  keys.push_back(
      length_key("fall_height", kept<&VFunnel::fall_height>, "height of the outlet over the floor"));
  return keys;
}

void VFunnel::check(const Case& c) const {
  if (!c.usable({"geometry.top_width", "geometry.outlet_width", "geometry.depth", "mpm.cell"})) return;
  if (outlet_width > top_width)
    c.fault("geometry.outlet_width",
            fmt::format(
                "geometry.outlet_width is {:g} m, wider than the top ({:g} m); allowed: at most the top's "
                "width",
                outlet_width, top_width));
  c.check_cell("mpm.cell", c.scene().mpm.cell, "half of the outlet", 0.5 * std::min(outlet_width, depth));
}

void VFunnel::check_gauges(const Case& c) const {
  c.check_gauge("gauges.light_depth", c.scene().gauges.light_depth, "the funnel's height", body_height(),
                {"geometry.taper_height", "geometry.neck_height"});
}

std::optional<Load> VFunnel::load(const Scene& scene) const {
  const Load squeezed = standing_load(scene, "the material in the funnel");
  if (scene.base.law != Wall::no_slip) return squeezed;
  // Walls that hold the material carry the neck, with the head of the taper over it, as plates at the nearer
  // pair's distance would; past others it must be squeezed through the taper by its weight.
  const bool plane = scene.geometry.dimension == Dimension::plane;
  const double gap = plane ? outlet_width : std::min(outlet_width, depth);
  const double force = scene.material.density * scene.forces.gravity * VFunnel::height() / neck_height;
  const Load carried = {squeezed.what, "rho g (h / neck height) (outlet / 2)", 0.5 * gap * force};
  return carried.stress < squeezed.stress ? carried : squeezed;
}

Pieces VFunnel::pieces(const Scene& scene) const {
  const Dimension dimension = scene.geometry.dimension;
  const bool full = dimension == Dimension::full, plane = dimension == Dimension::plane;
  const auto up = static_cast<std::size_t>(scene.spatial_dimension() - 1);
  const double deep = 0.5 * depth, outlet = 0.5 * outlet_width, wide = 0.5 * top_width;
  const double top = height() + rim, out = wide + rim;
  Pieces p;
  // Of a plane funnel half of the section is computed.
  p.whole_over_computed = dimension == Dimension::quarter ? 4.0 : plane ? 2.0 : 1.0;
  p.bodies.push_back(funnel_body(*this, scene, p.whole_over_computed));
  const auto add = [&](const char* wall, const auto& shape) {
    p.walls.push_back({.name = wall, .shape = shape, .contact = scene.base});
  };

  PlaneAcross floor{.axis = up, .place = -fall_height};
  for (std::size_t a = 0; a < up; ++a) {
    floor.from[a] = full ? -4.0 * wide : 0.0;
    floor.to[a] = 4.0 * wide;
  }
  floor.from[up] = -2.0 * fall_height;
  add("floor", floor);

  // Neck, slope and a rim above it; outwards and back below the outlet.
  Profiled right;
  right.corners = {{outlet, 0.0}, {out, 0.0},       {out, top},
                   {wide, top},   {wide, height()}, {outlet, neck_height}};
  right.touched = {true, false, false, true, true, true};
  right.from = full ? -deep : 0.0;
  right.to = deep;
  add("right slope", right);
  if (full) {
    Profiled left;
    for (auto c = right.corners.rbegin(); c != right.corners.rend(); ++c)
      left.corners.push_back({-(*c)[0], (*c)[1]});
    left.touched = {true, true, true, false, false, true};
    left.from = -deep;
    left.to = deep;
    add("left slope", left);
  } else {
    p.mirrored.push_back(0);
  }
  if (!plane) {
    if (!full) p.mirrored.push_back(1);
    // Plates across the depth, over the outlet's height and as wide as the funnel.
    const auto plate = [&](const char* wall, double from, double to, bool faces_up_the_axis) {
      Profiled shape;
      shape.corners = {{from, 0.0}, {to, 0.0}, {to, top}, {from, top}};
      shape.touched = {false, faces_up_the_axis, false, !faces_up_the_axis};
      shape.along = 0;
      shape.from = full ? -wide : 0.0;
      shape.to = wide;
      add(wall, shape);
    };
    plate("back plate", deep, deep + plate_thickness, false);
    if (full) plate("front plate", -deep - plate_thickness, -deep, true);
  }
  p.runs_out = true;
  p.drop = height() + fall_height;
  if (scene.base.law != Wall::slip) p.passage = plane ? outlet_width : std::min(outlet_width, depth);
  p.gauged =
      OutletGauge{.half_width = outlet, .half_depth = deep, .half_top = wide, .quarters = full ? 4.0 : 1.0};
  p.profile = {ProfileAxis::Of::depth, "x_m"};
  return p;
}

}  // namespace flowrest::scenes
