#include "scenes/apparatus/printing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenes/apparatus/keys.h"
#include "scenes/case.h"
#include "scenes/pieces.h"

namespace flowrest::scenes {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
/// Room in front of the first strand and behind the last, in diameters of the nozzle.
constexpr double before_begin = 2.0;
/// Where a section is taken: behind the nozzle's axis, in diameters, and over which length. What comes out
/// has its final shape there (40 to 65 mm of a nozzle of 25 mm).
constexpr double station_behind = 1.6, station_length = 1.0;

/// The integral over time of what holds from given times on.
double integral(const Printing::Speeds& speeds, double from, double to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const double begin = std::max(from, speeds[i].first);
    const double end = std::min(to, i + 1 < speeds.size() ? speeds[i + 1].first : never);
    if (end > begin) sum += speeds[i].second * (end - begin);
  }
  return sum;
}

/// When the integral from a time on reaches a length; never where the speeds do not bring it there.
double time_of(const Printing::Speeds& speeds, double from, double length) {
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const double begin = std::max(from, speeds[i].first);
    const double end = i + 1 < speeds.size() ? speeds[i + 1].first : never;
    if (end <= begin) continue;
    const double speed = speeds[i].second;
    if (speed > 0.0 && length <= speed * (end - begin)) return begin + length / speed;
    if (end < never) length -= speed * (end - begin);
  }
  return never;
}

/// The middle of a cell next to a height.
double row_at(double height, double cell) {
  return cell * (std::max(1.0, std::round(height / cell - 0.5)) + 0.5);
}

}  // namespace

std::vector<Key> Printing::keys() {
  std::vector<Key> keys;
  keys.push_back(
      length_key("nozzle_diameter", kept<&Printing::nozzle_diameter>, "diameter of the nozzle's bore"));
  keys.push_back(length_key("nozzle_wall", kept<&Printing::nozzle_wall>, "thickness of the nozzle's wall"));
  keys.push_back(length_key(
      "nozzle_gap", kept<&Printing::nozzle_gap>,
      "distance from the bed to the nozzle's mouth; MPM takes the cell next to mpm.cell of which the gap has a "
      "whole number and a half"));
  keys.push_back(integer("geometry.layers", 1, 1000, kept<&Printing::layers>, "strands, one on the other"));
  keys.push_back(
      number("geometry.layer_height", "m", above(0.0, largest_length), kept<&Printing::layer_height>,
             "by how much the nozzle rises for each further layer; MPM rounds its heights to half cells")
          .otherwise("nozzle_gap"));
  keys.push_back(
      length_key("layer_length", kept<&Printing::layer_length>, "way of the nozzle's axis in a layer"));
  keys.push_back(
      choice("geometry.direction", kept<&Printing::direction>, "which way layers after the first are laid"));
  keys.push_back(
      steps("process.printing_velocity", "m/s", kept<&Printing::printing_velocity>,
            "speed of the nozzle along the strand: a constant, or pairs of the time from which it holds (s) "
            "and its value")
          .needed());
  keys.push_back(steps("process.extrusion_velocity", "m/s", kept<&Printing::extrusion_velocity>,
                       "mean speed of the material in the bore, likewise")
                     .needed());
  keys.push_back(number("process.pause", "s", from(0.0, largest_time), kept<&Printing::pause>,
                        "time between the end of a layer and the next one's begin"));
  return keys;
}

void Printing::check(const Case& c) const {
  for (const auto& [path, speeds] : {std::pair{"process.printing_velocity", &printing_velocity},
                                     std::pair{"process.extrusion_velocity", &extrusion_velocity}}) {
    if (!c.usable({path})) continue;
    double largest = 0.0;
    for (const auto& [time, speed] : *speeds) {
      if (speed < 0.0)
        c.fault(path, fmt::format("{} is {:g} m/s from {:g} s on; allowed: from 0", path, speed, time));
      largest = std::max(largest, speed);
    }
    if (!speeds->empty() && largest == 0.0)
      c.fault(path, fmt::format("{} is 0 at all times; allowed: greater than 0 at some", path));
  }
  if (c.usable({"geometry.nozzle_gap", "mpm.cell"}))
    c.check_cell("mpm.cell", c.scene().mpm.cell, "nozzle's gap", nozzle_gap / 1.5);
  if (c.usable({"geometry.nozzle_diameter", "mpm.cell"}))
    c.check_cell("mpm.cell", c.scene().mpm.cell, "nozzle's radius", 0.5 * nozzle_diameter);
  if (c.usable({"runs.foam"}) && !c.scene().runs.foam.empty())
    c.fault("runs.foam", "runs.foam is given, but printing is not computed in OpenFOAM; allowed: none");
  if (c.usable({"mpm.scheme"}) && c.scene().mpm.scheme != Scheme::quadratic_apic)
    c.fault("mpm.scheme", fmt::format("mpm.scheme is {}, which holds no nozzle; allowed: quadratic-apic",
                                      to_string(c.scene().mpm.scheme)));
}

double Printing::moved(double from, double to) const { return integral(printing_velocity, from, to); }
double Printing::extruded(double from, double to) const { return integral(extrusion_velocity, from, to); }

std::vector<Printing::Layer> Printing::strands(double end, double cell) const {
  std::vector<Layer> all;
  double time = 0.0;
  for (int l = 0; l < layers && time < end; ++l) {
    Layer layer;
    layer.begins_at = time;
    layer.ends_at = time_of(printing_velocity, time, layer_length);
    layer.extruded = layer.ends_at < never ? extruded(time, layer.ends_at) : never;
    layer.way = direction == PrintDirection::alternating && l % 2 == 1 ? -1.0 : 1.0;
    layer.from = before_begin * nozzle_diameter + (layer.way > 0.0 ? 0.0 : layer_length);
    layer.mouth = row_at(nozzle_gap + l * layer_height.value_or(nozzle_gap), cell);
    all.push_back(layer);
    time = layer.ends_at + pause;
  }
  return all;
}

Pieces Printing::pieces(const Scene& scene) const {
  Pieces p;
  p.half_cells_over = nozzle_gap;
  const bool half = scene.geometry.dimension == Dimension::half;
  if (half) {
    p.mirrored.push_back(1);
    p.whole_over_computed = 2.0;
  }
  const double length = layer_length + 2.0 * before_begin * nozzle_diameter;
  const double width = 4.0 * nozzle_diameter, height = body_height() + nozzle_diameter;
  const PlaneAcross bed{.axis = 2,
                        .upper = false,
                        .place = 0.0,
                        .from = {0.0, half ? 0.0 : -width, 0.0},
                        .to = {length, width, height}};
  p.walls.push_back({.name = "bed", .shape = bed, .contact = scene.base});
  for (const Layer& layer : strands(scene.time.end, cell_with_half(nozzle_gap, scene.mpm.cell)))
    p.feeds.push_back({.bore = 0.5 * nozzle_diameter,
                       .wall = nozzle_wall,
                       .mouth = [*this, layer](double time) -> Point {
                         return {layer.from + layer.way * moved(layer.begins_at, time), 0.0, layer.mouth};
                       },
                       .extruded = [*this, layer](double time) { return extruded(layer.begins_at, time); },
                       .column = layer.extruded,
                       .begins_at = layer.begins_at,
                       .gone_at = layer.ends_at});
  p.drop = body_height();
  p.gauged =
      SectionGauge{.behind = station_behind * nozzle_diameter, .length = station_length * nozzle_diameter};
  p.profile = {ProfileAxis::Of::depth, "y_m"};
  return p;
}

}  // namespace flowrest::scenes
