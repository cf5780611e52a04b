#include "scenes/apparatus/dam_break.h"

#include <algorithm>

#include "scenes/apparatus/boxes.h"
#include "scenes/apparatus/keys.h"
#include "scenes/case.h"
#include "scenes/pieces.h"

namespace flowrest::scenes {

std::vector<Key> DamBreak::keys() {
  std::vector<Key> keys;
  keys.push_back(length_key("width", kept<&DamBreak::width>, "width across the flow"));
  keys.push_back(length_key("column_length", kept<&DamBreak::column_length>, "length of the column"));
  keys.push_back(length_key("column_height", kept<&DamBreak::column_height>, "height of the column"));
  keys.push_back(length_key("tank_length", kept<&DamBreak::tank_length>, "length of the tank"));
  return keys;
}

void DamBreak::check(const Case& c) const {
  if (!c.usable({"geometry.column_length", "geometry.column_height", "geometry.tank_length", "mpm.cell"}))
    return;
  if (column_length > tank_length)
    c.fault("geometry.column_length",
            fmt::format(
                "the column of {:g} m does not fit the tank of {:g} m; allowed: at most the tank's length",
                column_length, tank_length));
  c.check_cell("mpm.cell", c.scene().mpm.cell, "column", std::min(column_length, column_height));
}

void DamBreak::check_gauges(const Case& c) const {
  const Gauges& gauges = c.scene().gauges;
  c.check_gauge("gauges.front_depth", gauges.front_depth, "the column's height", body_height(),
                {"geometry.column_height"});
  c.check_gauge("gauges.end_length", gauges.end_length, "the tank's length", tank_length,
                {"geometry.tank_length"});
}

std::optional<Load> DamBreak::load(const Scene& scene) const { return standing_load(scene, "the column"); }

Pieces DamBreak::pieces(const Scene& scene) const {
  Pieces p;
  p.bodies.push_back(box_body(scene, column_length, width, column_height));
  add_tank(scene, {.length = tank_length, .width = width, .height = 2.0 * column_height}, p);
  p.drop = column_height;
  p.gauged = ChannelGauge{.length = tank_length, .width = scene.spatial_dimension() == 2 ? 1.0 : width};
  p.profile = {ProfileAxis::Of::depth, "x_m"};
  return p;
}

}  // namespace flowrest::scenes
