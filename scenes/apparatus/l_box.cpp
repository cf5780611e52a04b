#include "scenes/apparatus/l_box.h"

#include <algorithm>

#include "scenes/apparatus/boxes.h"
#include "scenes/apparatus/keys.h"
#include "scenes/case.h"
#include "scenes/pieces.h"

namespace flowrest::scenes {

namespace {

/// Thickness of the front wall: more than a real one has, so that nothing finds itself behind it. m
constexpr double front_thickness = 0.04;
/// Of the gate, m: what has run under it must find room behind it.
constexpr double gate_thickness = 0.006;

/// A rectangle along the channel, as deep as the box.
Profiled upright(double face, double back, double low, double high, std::vector<bool> touched, double side) {
  Profiled shape;
  shape.corners = {{face, low}, {back, low}, {back, high}, {face, high}};
  shape.touched = std::move(touched);
  shape.to = side;
  return shape;
}

void add_bars(const LBox& g, const Scene& scene, Pieces& p) {
  const bool half = scene.geometry.dimension == Dimension::half;
  for (int i = 1; i <= g.rebars; ++i) {
    const double across = g.width * i / (g.rebars + 1) - (half ? 0.5 * g.width : 0.0);
    if (half && across < -1e-9) continue;
    const Bar bar{.centre = {g.reservoir_length + g.rebar_distance, across, 0.0},
                  .radius = 0.5 * g.rebar_diameter,
                  .from = 0.0,
                  .to = g.channel_height};
    p.walls.push_back({.name = "rebar " + std::to_string(i), .shape = bar, .contact = scene.base});
  }
}

}  // namespace

std::vector<Key> LBox::keys() {
  std::vector<Key> keys;
  const auto size = [&](const char* name, Access<double> at, const char* meaning) {
    keys.push_back(length_key(name, at, meaning));
  };
  size("reservoir_length", kept<&LBox::reservoir_length>, "length of the reservoir along the channel");
  size("reservoir_height", kept<&LBox::reservoir_height>, "height of the reservoir, filled to the brim");
  size("width", kept<&LBox::width>, "width across the flow");
  size("channel_length", kept<&LBox::channel_length>, "length of the channel behind the reservoir");
  size("channel_height", kept<&LBox::channel_height>,
       "height of the opening to the channel, and of the bars");
  keys.push_back(
      integer("geometry.rebars", 0, 100, kept<&LBox::rebars>, "upright bars, evenly across the width"));
  size("rebar_diameter", kept<&LBox::rebar_diameter>, "diameter of the bars");
  size("rebar_distance", kept<&LBox::rebar_distance>, "distance of the bars' axes from the reservoir");
  keys.push_back(number("geometry.gate_lift_velocity", "m/s", above(0.0, 1e3),
                        kept<&LBox::gate_lift_velocity>, "speed at which the gate of the reservoir is lifted")
                     .otherwise("the gate is gone at once"));
  return keys;
}

void LBox::check(const Case& c) const {
  if (!c.usable({"geometry.reservoir_height", "geometry.channel_height", "geometry.width", "geometry.rebars",
                 "geometry.rebar_diameter", "geometry.rebar_distance", "geometry.channel_length",
                 "mpm.cell"}))
    return;
  if (channel_height >= reservoir_height)
    c.fault(
        "geometry.channel_height",
        fmt::format("geometry.channel_height is {:g} m, the reservoir {:g} m high; allowed: less than the "
                    "reservoir's height",
                    channel_height, reservoir_height));
  if (rebars * rebar_diameter >= width)
    c.fault("geometry.rebars",
            fmt::format("{} bars of {:g} m fill the width of {:g} m; allowed: bars that leave gaps", rebars,
                        rebar_diameter, width));
  if (rebars > 0 && rebar_distance + 0.5 * rebar_diameter >= channel_length)
    c.fault(
        "geometry.rebar_distance",
        fmt::format("the bars at {:g} m do not stand in the channel of {:g} m; allowed: a shorter distance",
                    rebar_distance, channel_length));
  c.check_cell("mpm.cell", c.scene().mpm.cell, "channel", std::min(channel_height, 0.5 * width));
}

void LBox::check_gauges(const Case& c) const {
  const Gauges& gauges = c.scene().gauges;
  c.check_gauge("gauges.front_depth", gauges.front_depth, "the reservoir's height", body_height(),
                {"geometry.reservoir_height"});
  c.check_gauge("gauges.end_length", gauges.end_length, "the channel's length", channel_length,
                {"geometry.channel_length"});
}

std::optional<Load> LBox::load(const Scene& scene) const { return standing_load(scene, "the reservoir"); }

Pieces LBox::pieces(const Scene& scene) const {
  const Dimension dimension = scene.geometry.dimension;
  const bool half = dimension == Dimension::half, plane = dimension == Dimension::plane;
  const double side = half ? 0.5 * width : width;
  Pieces p;
  p.whole_over_computed = half ? 2.0 : 1.0;
  p.bodies.push_back(box_body(scene, reservoir_length, side, reservoir_height));
  p.bodies.back().filling = Filling::poured_to_rest;
  add_tank(scene, {.length = length(), .width = side, .height = reservoir_height, .halved = half}, p);
  const double face = reservoir_length, back = face + std::min(front_thickness, 0.5 * channel_length);
  p.walls.push_back(
      {.name = "front",
       .shape = upright(face, back, channel_height, 1.2 * reservoir_height, {true, false, false, true}, side),
       .contact = scene.base});
  if (!plane) add_bars(*this, scene, p);
  if (gate_lift_velocity)
    // A plate before the opening, which holds as the other walls do.
    p.walls.push_back({.name = "gate",
                       .shape = upright(face, face + gate_thickness, 0.0, channel_height,
                                        {false, false, false, true}, side),
                       .contact = scene.base,
                       .lift_velocity = *gate_lift_velocity,
                       .gone_at = channel_height / *gate_lift_velocity});
  p.drop = reservoir_height;
  if (scene.base.law != Wall::slip) p.passage = plane ? channel_height : std::min(channel_height, width);
  p.gauged = ChannelGauge{.begin = reservoir_length, .length = length(), .width = plane ? 1.0 : width};
  p.profile = {ProfileAxis::Of::depth, "x_m"};
  return p;
}

}  // namespace flowrest::scenes
