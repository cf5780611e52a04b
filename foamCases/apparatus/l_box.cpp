#include "foamCases/apparatus/l_box.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "foamCases/function_object.h"
#include "foamCases/vessel.h"

namespace flowrest::foam {

namespace {

/// Cells of a bar's radius: four across a bar.
constexpr int cells_of_radius = 2;
/// Cells across a gap between bars. In one alone, air behind the bars turned at 30 m/s, on cells of 26.7 mm.
constexpr int fewest_between_bars = 2;
/// Rows of air over the channel's opening.
constexpr int air_rows = 2;

using Refusal = std::function<void(const std::string&)>;

/// A bar seen from above.
struct Bar {
  double x, y, radius;
};

std::vector<Bar> bars_of(const scenes::LBox& g) {
  std::vector<Bar> bars;
  for (int i = 1; i <= g.rebars; ++i) {
    const double across = g.width * i / (g.rebars + 1) - 0.5 * g.width;
    if (across > -same_place)
      bars.push_back({g.reservoir_length + g.rebar_distance, across, 0.5 * g.rebar_diameter});
  }
  return bars;
}

/// The lattice of half of it, cut along its middle: round bars are rows of cells half a bar's radius wide, their
/// corners moved onto the circle.
class BoxLattice {
 public:
  BoxLattice(const scenes::LBox& box, double cell, const Refusal& refuse) : g_(box), bars_(bars_of(box)) {
    const double side = 0.5 * g_.width;
    lip_back_ = g_.reservoir_length + std::min(wall_thickness, 0.5 * g_.channel_length);
    std::vector<double> x{0.0, g_.reservoir_length, lip_back_, g_.length()}, y{0.0, side};
    for (const Bar& bar : bars_) {
      if (bar.x - bar.radius < g_.reservoir_length - same_place ||
          bar.x + bar.radius > lip_back_ + same_place)
        refuse(
            fmt::format("geometry.rebar_distance is {:g} m: in OpenFOAM's case the bars stand under the "
                        "reservoir's front wall; allowed: {:g} to {:g}",
                        g_.rebar_distance, bar.radius, lip_back_ - g_.reservoir_length - bar.radius));
      for (int k = -cells_of_radius; k <= cells_of_radius; ++k) {
        const double offset = bar.radius * k / cells_of_radius;
        x.push_back(bar.x + offset);
        if (bar.y + offset > -same_place) y.push_back(std::max(0.0, bar.y + offset));
      }
    }
    x_ = line_through(x, cell);
    y_ = line_through(y, cell);
    for (std::size_t j = 0; g_.rebars > 0 && j < y_.cells.size(); ++j)
      if (y_.at[j + 1] - y_.at[j] > g_.rebar_diameter)
        y_.cells[j] = std::max(y_.cells[j], fewest_between_bars);
    const double top = g_.reservoir_height, air = g_.channel_height + air_rows * cell;
    if (air > top - same_place)
      refuse(
          fmt::format("foam.cell is {:g} m: no room for {} rows of air between the channel ({:g} m) and the "
                      "reservoir's top; allowed: less",
                      cell, air_rows, g_.channel_height));
    z_ = line_through({0.0, g_.channel_height, air, top, top + cell}, cell);
  }

  bool holds(int i, int j, int k) const {
    const double x = middle(x_, i), y = middle(y_, j);
    if (k == 0) {
      for (const Bar& bar : bars_)
        if (std::hypot(x - bar.x, y - bar.y) < bar.radius) return false;
      return true;
    }
    return x < g_.reservoir_length || (k == 1 && x > lip_back_);
  }

  /// Corners between what is a bar and what is not lie on its circle, but for those on the reservoir's face.
  Point corner(int i, int j, int k) const {
    Point p{at(x_, i), at(y_, j), at(z_, k)};
    if (k > 1 || std::abs(p[0] - g_.reservoir_length) < same_place) return p;
    for (const Bar& bar : bars_) {
      const double dx = p[0] - bar.x, dy = p[1] - bar.y, away = std::hypot(dx, dy);
      if (away > 1.5 * bar.radius || away < same_place || !is_edge(i, j)) continue;
      p[0] = bar.x + dx * bar.radius / away;
      p[1] = bar.y + dy * bar.radius / away;
    }
    return p;
  }

  std::string patch(int i, int, int k, Side side) const {
    switch (side) {
      case Side::z_low:
        return k == 0 ? "floor" : "front";
      case Side::z_high:
        return k == 0 ? "front" : "atmosphere";
      case Side::x_low:
        return at(x_, i) < same_place ? "back" : k == 0 ? "bars" : "front";
      case Side::x_high:
        return at(x_, i + 1) > g_.length() - same_place ? "end" : k == 0 ? "bars" : "front";
      default:
        return "bars";
    }
  }

  std::string across(int j, Side side) const {
    if (side == Side::y_low && at(y_, j) < same_place) return "middle";
    if (side == Side::y_high && at(y_, j + 1) > 0.5 * g_.width - same_place) return "side";
    return "bars";
  }

  const Line& x() const { return x_; }
  const Line& y() const { return y_; }
  const Line& z() const { return z_; }

 private:
  static double at(const Line& line, int i) { return line.at[static_cast<std::size_t>(i)]; }
  static double middle(const Line& line, int i) { return 0.5 * (at(line, i) + at(line, i + 1)); }

  /// Whether a corner in plan has both bar and room around it.
  bool is_edge(int i, int j) const {
    bool bar = false, room = false;
    for (int a = i - 1; a <= i; ++a)
      for (int b = j - 1; b <= j; ++b) {
        if (a < 0 || b < 0 || a >= static_cast<int>(x_.cells.size()) ||
            b >= static_cast<int>(y_.cells.size()))
          continue;
        (holds(a, b, 0) ? room : bar) = true;
      }
    return bar && room;
  }

  const scenes::LBox& g_;
  std::vector<Bar> bars_;
  double lip_back_ = 0.0;
  Line x_, y_, z_;
};

class LBoxCase : public Vessel {
 public:
  LBoxCase(const scenes::LBox& box, const scenes::Scene& scene) : Vessel(scene), box_(box) {}

  bool leans() const override { return true; }
  double estimated_cells() const override {
    // Those along and across that a mesh has for its bars more than its cell asks for.
    constexpr double of_bars_along = 4.0, of_bars_across = 5.0;
    const double cell = scene().foam.cell;
    const double bars = box_.rebars > 0 ? 1.0 : 0.0;
    const double channel = (estimated_over(box_.length(), cell) + bars * of_bars_along) *
                           (estimated_over(box_.channel_height, cell) + 2.0);
    const double reservoir = estimated_over(box_.reservoir_length, cell) *
                             estimated_over(box_.reservoir_height - box_.channel_height, cell);
    return (estimated_over(0.5 * box_.width, cell) + bars * of_bars_across) * (channel + reservoir);
  }
  /// Between the bars, half a radius wide.
  double smallest_cell() const override {
    const double cell = scene().foam.cell;
    return box_.rebars > 0 ? std::min(cell, box_.rebar_diameter / 4.0) : cell;
  }
  /// What passes between the bars does so at a share of the fall's speed that was measured of the
  /// elasto-viscoplastic law; a fluid's steps are smaller than that asks for.
  std::optional<double> lasting_speed() const override {
    constexpr double between_bars = 0.15;
    return laws::can_rest(scene().material.model) ? std::optional(between_bars * fall_speed()) : std::nullopt;
  }
  std::array<Point, 2> initial_box() const override {
    return {Point{-far, -far, -far}, Point{box_.reservoir_length, far, box_.reservoir_height}};
  }
  std::vector<CaseFile> files() const override {
    auto files = Vessel::files();
    if (box_.gate_lift_velocity) files.push_back({"system/createBafflesDict", gate_baffles()});
    return files;
  }
  std::vector<Utility> utilities() const override {
    auto all = Vessel::utilities();
    if (box_.gate_lift_velocity) all.insert(all.begin(), Utility{"createBaffles", {"-overwrite"}});
    return all;
  }
  /// The plate that createBafflesDict lays between the cells.
  std::string function_objects(bool) const override {
    if (!box_.gate_lift_velocity) return "";
    constexpr double edge = 0.0;  // m, of the gate, shut: the floor
    return function_object(
        "liftedGate", fmt::format("        walls           (gateBehind gateBefore);\n"
                                  "        openings        (openingBehind openingBefore);\n"
                                  "        velocity        {};  // m/s\n        edge            {};  // m\n",
                                  *box_.gate_lift_velocity, edge));
  }

 protected:
  BlockLattice lattice() const override {
    check_dimension(scenes::Dimension::half);
    const auto box = std::make_shared<BoxLattice>(box_, scene().foam.cell,
                                                  [this](const std::string& what) { refuse(what); });
    BlockLattice lattice;
    lattice.cells = {box->x().cells, box->y().cells, box->z().cells};
    lattice.corner = [box](int i, int j, int k) { return box->corner(i, j, k); };
    lattice.holds = [box](int i, int j, int k) { return box->holds(i, j, k); };
    lattice.patch = [box](int i, int j, int k, Side side) {
      return side == Side::y_low || side == Side::y_high ? box->across(j, side) : box->patch(i, j, k, side);
    };
    lattice.patch_types = {{"floor", "wall"},
                           {"back", "wall"},
                           {"end", "wall"},
                           {"side", "wall"},
                           {"front", "wall"},
                           {"bars", "wall"},
                           {"middle", "symmetryPlane"},
                           {"atmosphere", "patch"}};
    return lattice;
  }

 private:
  /// The createBafflesDict that lays the gate before the opening: a rectangle across x, lifted from the floor.
  std::string gate_baffles() const {
    // A little before the faces it stands for: walls in the same plane are walls already.
    constexpr double before = 1e-5, beyond = 1e-3;  // m
    const Point low = {box_.reservoir_length, 0.0, 0.0},
                high = {box_.reservoir_length, 0.5 * box_.width, box_.channel_height};
    return fmt::format(
        "// The gate of the scene '{}': `flowrest foam` writes this. Each of its faces becomes a wall to "
        "either "
        "side and a\n// pair of openings upon it, which liftedGate gives their areas.\n\n"
        "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       dictionary;\n"
        "    object      createBafflesDict;\n}}\n\n"
        "internalFacesOnly   false;\nnoFields            true;\n\n"
        "baffles\n{{\n    gate\n    {{\n        type        searchableSurface;\n"
        "        surface     searchablePlate;\n        origin      ({:g} {:g} {:g});\n        span        "
        "({:g} {:g} "
        "{:g});\n"
        "        patches\n        {{\n"
        "            behind         {{ name gateBehind; type wall; }}\n"
        "            before         {{ name gateBefore; type wall; }}\n"
        "            openingBehind  {{ name openingBehind; type cyclic; neighbourPatch openingBefore; }}\n"
        "            openingBefore  {{ name openingBefore; type cyclic; neighbourPatch openingBehind; }}\n"
        "        }}\n    }}\n}}\n",
        scene().name, low[0] + before, low[1] - beyond, low[2] - beyond, 0.0, high[1] - low[1] + 2.0 * beyond,
        high[2] - low[2] + beyond);
  }

  const scenes::LBox& box_;
};

}  // namespace

std::unique_ptr<ApparatusCase> case_of(const scenes::LBox& box, const scenes::Scene& scene) {
  return std::make_unique<LBoxCase>(box, scene);
}

}  // namespace flowrest::foam
