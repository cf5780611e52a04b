#include "scenes/apparatus/printing.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <tuple>

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

constexpr std::size_t most_places = 100000;

Complaint read_place(const Value& item, std::vector<Waypoint>& path) {
  const auto* numbers = std::get_if<std::vector<Value>>(&item.content);
  if (!numbers || numbers->size() != 4)
    return {"must hold places of four numbers, [time, x, y, height]", item.where};
  Waypoint place{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Value& number = (*numbers)[i];
    const Range range = i == 0   ? from(0.0, largest_time)
                        : i == 3 ? above(0.0, largest_length)
                                 : from(-largest_length, largest_length);
    const std::string wrong = read_number(number, range, place[i]);
    if (!wrong.empty()) return {"in a place " + wrong, number.where};
  }
  if (!path.empty() && place[0] <= path.back()[0])
    return {fmt::format("goes from {:g} s to {:g} s; allowed: ascending times", path.back()[0], place[0]),
            item.where};
  path.push_back(place);
  return {};
}

Key path_key() {
  Key key =
      plain_key("process.path", "s, m",
                "where the nozzle's mouth is, in place of layers: [time, x, y, height over the bed], linear "
                "in between",
                "array of two places or more with ascending times");
  key.read = [](const Value& value, Draft& draft) -> Complaint {
    auto& path = kept<&Printing::path>(draft);
    path.clear();
    const auto* places = std::get_if<std::vector<Value>>(&value.content);
    if (!places || places->size() < 2 || places->size() > most_places)
      return {fmt::format("must be an array of 2 to {} places, [time, x, y, height]", most_places),
              value.where};
    for (const Value& item : *places)
      if (Complaint wrong = read_place(item, path); !wrong.what.empty()) return wrong;
    return {};
  };
  key.write = [](Draft& draft) {
    const auto& path = kept<&Printing::path>(draft);
    return path.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(path);
  };
  return key;
}

/// What it says becomes a path, and a flow where it has E, so that a run's settings stand alone.
Key gcode_key() {
  Key key =
      plain_key("process.gcode", "",
                "file of a printer's G-code, beside the scene's: the path, and the flow where E counts cubic "
                "millimetres",
                "string");
  key.read = [](const Value& value, Draft& draft) -> Complaint {
    constexpr double cubic_millimetre = 1e-9;
    const auto* name = std::get_if<std::string>(&value.content);
    if (!name) return {"must be the name of a file, not " + value.what(), value.where};
    std::filesystem::path file = *name;
    if (file.is_relative() && value.where.line > 0)
      file = std::filesystem::path(value.where.source).parent_path() / file;
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in)
      return {fmt::format("is {}, which cannot be read; allowed: a file of G-code", quoted(*name)),
              value.where};
    const GcodeResult code = read_gcode(text.str(), cubic_millimetre);
    if (!code.path)
      return {
          fmt::format("is {}, of which something is not understood: {}", quoted(*name), joined(code.faults)),
          value.where};
    kept<&Printing::path>(draft) = code.path->places;
    if (!code.path->flow.empty()) kept<&Printing::flow>(draft) = code.path->flow;
    return {};
  };
  key.write = [](Draft&) { return nlohmann::ordered_json(); };
  return key;
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
            "and its value"));
  keys.push_back(steps("process.extrusion_velocity", "m/s", kept<&Printing::extrusion_velocity>,
                       "mean speed of the material in the bore, likewise"));
  keys.push_back(steps("process.flow", "m3/s", kept<&Printing::flow>,
                       "volume that comes out in a second, likewise, in place of extrusion_velocity")
                     .replaces("process.extrusion_velocity"));
  keys.push_back(number("process.pause", "s", from(0.0, largest_time), kept<&Printing::pause>,
                        "time between the end of a layer and the next one's begin"));
  keys.push_back(path_key());
  keys.push_back(gcode_key());
  return keys;
}

void Printing::check_speeds(const Case& c) const {
  for (const auto& [key, speeds, unit] :
       {std::tuple{"process.printing_velocity", &printing_velocity, "m/s"},
        std::tuple{"process.extrusion_velocity", &extrusion_velocity, "m/s"},
        std::tuple{"process.flow", &flow, "m3/s"}}) {
    if (!c.usable({key})) continue;
    double largest = 0.0;
    for (const auto& [time, speed] : *speeds) {
      if (speed < 0.0)
        c.fault(key, fmt::format("{} is {:g} {} from {:g} s on; allowed: from 0", key, speed, unit, time));
      largest = std::max(largest, speed);
    }
    if (!speeds->empty() && largest == 0.0)
      c.fault(key, fmt::format("{} is 0 at all times; allowed: greater than 0 at some", key));
  }
  if (c.usable({"process.printing_velocity", "process.path", "process.gcode"}) && path.empty() &&
      printing_velocity.empty())
    c.fault(
        "process.printing_velocity",
        "process.printing_velocity is missing; needed: speed of the nozzle along the strand, or process.path "
        "or process.gcode");
  if (!c.usable({"process.extrusion_velocity", "process.flow", "process.gcode"})) return;
  if (extrusion_velocity.empty() && flow.empty())
    c.fault("process.extrusion_velocity",
            "process.extrusion_velocity is missing; needed: mean speed of the material in the bore, or "
            "process.flow");
  if (!extrusion_velocity.empty() && !flow.empty())
    c.fault(
        "process.extrusion_velocity",
        "process.extrusion_velocity is given beside a flow (process.flow, or E of process.gcode); allowed: one "
        "of them");
}

/// What a path says cannot be said otherwise.
void Printing::check_path(const Case& c) const {
  if (path.empty()) return;
  if (c.given.gives("process.path") && c.given.gives("process.gcode"))
    c.fault("process.gcode", "process.gcode is given beside process.path; allowed: one of them");
  // What a run keeps of its settings has these keys with what is usual.
  const Printing usual;
  for (const auto& [key, differs] : {std::pair{"process.printing_velocity", !printing_velocity.empty()},
                                     std::pair{"process.pause", pause != usual.pause},
                                     std::pair{"geometry.layers", layers != usual.layers},
                                     std::pair{"geometry.layer_height", layer_height.has_value()},
                                     std::pair{"geometry.layer_length", layer_length != usual.layer_length},
                                     std::pair{"geometry.direction", direction != usual.direction},
                                     std::pair{"geometry.nozzle_gap", nozzle_gap != usual.nozzle_gap}})
    if (c.given.gives(key) && differs)
      c.fault(key, fmt::format("{} is given beside a path, which says it; allowed: not with process.path or "
                               "process.gcode",
                               key));
  const bool half = c.scene().geometry.dimension == Dimension::half;
  const auto aside = std::find_if(path.begin(), path.end(), [](const Waypoint& w) { return w[2] != 0.0; });
  if (half && c.usable({"geometry.dimension"}) && aside != path.end())
    c.fault("geometry.dimension",
            fmt::format(
                "geometry.dimension is half, and the path goes aside to y = {:g} m at {:g} s; allowed: full",
                (*aside)[2], (*aside)[0]));
}

void Printing::check(const Case& c) const {
  check_speeds(c);
  check_path(c);
  if (c.usable({"geometry.nozzle_gap", "mpm.cell"}))
    c.check_cell("mpm.cell", c.scene().mpm.cell, "nozzle's gap", lowest_mouth() / 1.5);
  if (c.usable({"geometry.nozzle_diameter", "mpm.cell"}))
    c.check_cell("mpm.cell", c.scene().mpm.cell, "nozzle's radius", 0.5 * nozzle_diameter);
  if (c.usable({"runs.foam"}) && !c.scene().runs.foam.empty())
    c.fault("runs.foam", "runs.foam is given, but printing is not computed in OpenFOAM; allowed: none");
  if (c.usable({"mpm.scheme"}) && c.scene().mpm.scheme != Scheme::quadratic_apic)
    c.fault("mpm.scheme", fmt::format("mpm.scheme is {}, which holds no nozzle; allowed: quadratic-apic",
                                      to_string(c.scene().mpm.scheme)));
}

double Printing::moved(double from, double to) const { return integral(printing_velocity, from, to); }
double Printing::extruded(double from, double to) const {
  if (flow.empty()) return integral(extrusion_velocity, from, to);
  return integral(flow, from, to) / (0.25 * std::numbers::pi * nozzle_diameter * nozzle_diameter);
}

double Printing::lowest_mouth() const {
  double lowest = path.empty() ? nozzle_gap : never;
  for (const Waypoint& w : path) lowest = std::min(lowest, w[3]);
  return lowest;
}

double Printing::highest_mouth() const {
  double highest = path.empty() ? nozzle_gap + (layers - 1) * layer_height.value_or(nozzle_gap) : 0.0;
  for (const Waypoint& w : path) highest = std::max(highest, w[3]);
  return highest;
}

bool Printing::path_is_straight() const {
  for (std::size_t i = 1; i < path.size(); ++i)
    if (path[i][2] != path[0][2] || path[i][3] != path[0][3] ||
        (path[i][1] - path[i - 1][1]) * (path.back()[1] - path[0][1]) < 0.0)
      return false;
  return true;
}

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
  const double cell = cell_with_half(lowest_mouth(), scene.mpm.cell);
  Pieces p = path.empty() ? pieces_of_layers(scene, cell) : pieces_of_path(scene, cell);
  p.half_cells_over = lowest_mouth();
  if (scene.geometry.dimension == Dimension::half) {
    p.mirrored.push_back(1);
    p.whole_over_computed = 2.0;
  }
  p.drop = body_height();
  p.profile = {ProfileAxis::Of::depth, "y_m"};
  return p;
}

Pieces Printing::pieces_of_layers(const Scene& scene, double cell) const {
  Pieces p;
  const bool half = scene.geometry.dimension == Dimension::half;
  const double length = layer_length + 2.0 * before_begin * nozzle_diameter;
  const double width = 4.0 * nozzle_diameter, height = body_height() + nozzle_diameter;
  const PlaneAcross bed{.axis = 2,
                        .upper = false,
                        .place = 0.0,
                        .from = {0.0, half ? 0.0 : -width, 0.0},
                        .to = {length, width, height}};
  p.walls.push_back({.name = "bed", .shape = bed, .contact = scene.base});
  for (const Layer& layer : strands(scene.time.end, cell))
    p.feeds.push_back({.bore = 0.5 * nozzle_diameter,
                       .wall = nozzle_wall,
                       .mouth = [*this, layer](double time) -> Point {
                         return {layer.from + layer.way * moved(layer.begins_at, time), 0.0, layer.mouth};
                       },
                       .extruded = [*this, layer](double time) { return extruded(layer.begins_at, time); },
                       .column = layer.extruded,
                       .begins_at = layer.begins_at,
                       .gone_at = layer.ends_at});
  p.gauged =
      SectionGauge{.behind = station_behind * nozzle_diameter, .length = station_length * nozzle_diameter};
  return p;
}

Pieces Printing::pieces_of_path(const Scene& scene, double cell) const {
  Pieces p;
  std::vector<Waypoint> places = path;
  Point low = {never, never, 0.0}, high = {-never, -never, body_height() + nozzle_diameter};
  for (Waypoint& w : places) {
    for (std::size_t a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], w[1 + a] - 4.0 * nozzle_diameter);
      high[a] = std::max(high[a], w[1 + a] + 4.0 * nozzle_diameter);
    }
    w[3] = row_at(w[3], cell);
  }
  if (scene.geometry.dimension == Dimension::half) low[1] = 0.0;
  const PlaneAcross bed{.axis = 2, .upper = false, .place = 0.0, .from = low, .to = high};
  p.walls.push_back({.name = "bed", .shape = bed, .contact = scene.base});
  const double begin = places.front()[0], end = places.back()[0];
  p.feeds.push_back({.bore = 0.5 * nozzle_diameter,
                     .wall = nozzle_wall,
                     .mouth = [places](double time) -> Point {
                       const auto next = std::find_if(places.begin() + 1, places.end() - 1,
                                                      [&](const Waypoint& w) { return w[0] >= time; });
                       const Waypoint &from = *(next - 1), &to = *next;
                       const double part = std::clamp((time - from[0]) / (to[0] - from[0]), 0.0, 1.0);
                       return {std::lerp(from[1], to[1], part), std::lerp(from[2], to[2], part),
                               std::lerp(from[3], to[3], part)};
                     },
                     .extruded = [*this, begin](double time) { return extruded(begin, time); },
                     .column = extruded(begin, end),
                     .begins_at = begin,
                     .gone_at = end});
  // A path with corners has no section behind it.
  p.gauged = SectionGauge{.behind = path_is_straight() ? station_behind * nozzle_diameter : never,
                          .length = station_length * nozzle_diameter};
  return p;
}

}  // namespace flowrest::scenes
