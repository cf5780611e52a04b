#include "foamCases/vessel_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace flowrest::foam {

using scenes::Dimension;
using scenes::Kind;
using scenes::Scene;

namespace {

constexpr double most_cells = 5e6;
constexpr double far = 1e3;    // m
constexpr double same = 1e-9;  // m, places that are one
/// Cells of a bar's radius: four across a bar.
constexpr int cells_of_radius = 2;
/// Cells across a gap between bars. In one alone, air behind the bars turned at 30 m/s, on cells of 26.7 mm.
constexpr int fewest_between_bars = 2;
/// As of the material point method's front wall, m.
constexpr double wall_thickness = 0.04;
/// Rows of air over a channel's opening, and of cells under a funnel's outlet.
constexpr int air_rows = 2, outlet_rows = 4;

[[noreturn]] void refuse(const Scene& scene, const std::string& what) {
  throw scenes::SceneError(fmt::format("{}: {}", scene.path.string(), what));
}

void check_dimension(const Scene& scene, Dimension allowed) {
  if (scene.geometry.dimension != allowed)
    refuse(scene, fmt::format("geometry.dimension {}: OpenFOAM's case of a {} is {}; allowed: {}",
                              scenes::to_string(scene.geometry.dimension), scenes::to_string(scene.kind()),
                              allowed == Dimension::plane  ? "a plane one"
                              : allowed == Dimension::half ? "one half, cut along its middle"
                                                           : "one quarter",
                              scenes::to_string(allowed)));
}

int cells_over(double length, double cell) {
  return static_cast<int>(std::lround(std::clamp(length / cell, 1.0, most_cells)));
}

/// Places along an axis between which cells are laid.
struct Line {
  std::vector<double> at;
  std::vector<int> cells;
};

/// Lines through the given places, sorted and each once, with cells of about `cell` between them.
Line line_through(std::vector<double> places, double cell) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end(), [](double a, double b) { return b - a < same; }),
               places.end());
  Line line{places, {}};
  for (std::size_t i = 1; i < places.size(); ++i)
    line.cells.push_back(cells_over(places[i] - places[i - 1], cell));
  return line;
}

/// A bar seen from above.
struct Bar {
  double x, y, radius;
};

std::vector<Bar> bars_of(const Scene& scene) {
  const auto& g = scene.l_box();
  std::vector<Bar> bars;
  for (int i = 1; i <= g.rebars; ++i) {
    const double across = g.width * i / (g.rebars + 1) - 0.5 * g.width;
    if (across > -same)
      bars.push_back({g.reservoir_length + g.rebar_distance, across, 0.5 * g.rebar_diameter});
  }
  return bars;
}

class LBox {
 public:
  explicit LBox(const Scene& scene) : g_(scene.l_box()), bars_(bars_of(scene)) {
    const double cell = scene.foam.cell, side = 0.5 * g_.width;
    lip_back_ = g_.reservoir_length + std::min(wall_thickness, 0.5 * g_.channel_length);
    std::vector<double> x{0.0, g_.reservoir_length, lip_back_, g_.length()}, y{0.0, side};
    for (const Bar& bar : bars_) {
      if (bar.x - bar.radius < g_.reservoir_length - same || bar.x + bar.radius > lip_back_ + same)
        refuse(scene,
               fmt::format("geometry.rebar_distance is {:g} m: in OpenFOAM's case the bars stand under the "
                           "reservoir's front wall; allowed: {:g} to {:g}",
                           g_.rebar_distance, bar.radius, lip_back_ - g_.reservoir_length - bar.radius));
      for (int k = -cells_of_radius; k <= cells_of_radius; ++k) {
        const double offset = bar.radius * k / cells_of_radius;
        x.push_back(bar.x + offset);
        if (bar.y + offset > -same) y.push_back(std::max(0.0, bar.y + offset));
      }
    }
    x_ = line_through(x, cell);
    y_ = line_through(y, cell);
    for (std::size_t j = 0; g_.rebars > 0 && j < y_.cells.size(); ++j)
      if (y_.at[j + 1] - y_.at[j] > g_.rebar_diameter)
        y_.cells[j] = std::max(y_.cells[j], fewest_between_bars);
    const double top = g_.reservoir_height, air = g_.channel_height + air_rows * cell;
    if (air > top - same)
      refuse(
          scene,
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
    if (k > 1 || std::abs(p[0] - g_.reservoir_length) < same) return p;
    for (const Bar& bar : bars_) {
      const double dx = p[0] - bar.x, dy = p[1] - bar.y, away = std::hypot(dx, dy);
      if (away > 1.5 * bar.radius || away < same || !is_edge(i, j)) continue;
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
        return at(x_, i) < same ? "back" : k == 0 ? "bars" : "front";
      case Side::x_high:
        return at(x_, i + 1) > g_.length() - same ? "end" : k == 0 ? "bars" : "front";
      default:
        return "bars";
    }
  }

  std::string across(int j, Side side) const {
    if (side == Side::y_low && at(y_, j) < same) return "middle";
    if (side == Side::y_high && at(y_, j + 1) > 0.5 * g_.width - same) return "side";
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

BlockLattice l_box(const Scene& scene) {
  check_dimension(scene, Dimension::half);
  const auto box = std::make_shared<LBox>(scene);
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

BlockLattice v_funnel(const Scene& scene) {
  check_dimension(scene, Dimension::quarter);
  const auto& g = scene.v_funnel();
  const double cell = scene.foam.cell, outlet = 0.5 * g.outlet_width, wide = 0.5 * g.top_width;
  const std::vector<double> heights{-outlet_rows * cell, 0.0, g.neck_height, g.height(), g.height() + cell};
  const std::vector<double> widths{outlet, outlet, outlet, wide, wide};
  BlockLattice lattice;
  // As fine at the outlet as coarse at the top, beside the cells' size.
  lattice.cells = {std::vector<int>{cells_over(std::sqrt(outlet * wide), cell)},
                   {cells_over(0.5 * g.depth, cell)},
                   line_through(heights, cell).cells};
  const double deep = 0.5 * g.depth;
  lattice.corner = [=](int i, int j, int k) {
    const auto level = static_cast<std::size_t>(k);
    return Point{i * widths[level], j * deep, heights[level]};
  };
  lattice.holds = [](int, int, int) { return true; };
  lattice.patch = [](int, int, int k, Side side) -> std::string {
    switch (side) {
      case Side::x_low:
        return "middleX";
      case Side::y_low:
        return "middleY";
      case Side::z_low:
        return "outlet";
      case Side::z_high:
        return "atmosphere";
      case Side::x_high:
        return k == 0 ? "outlet" : "slope";
      default:
        return k == 0 ? "outlet" : "plate";
    }
  };
  lattice.patch_types = {
      {"slope", "wall"},   {"plate", "wall"},      {"middleX", "symmetryPlane"}, {"middleY", "symmetryPlane"},
      {"outlet", "patch"}, {"atmosphere", "patch"}};
  return lattice;
}

BlockLattice dam_break(const Scene& scene) {
  check_dimension(scene, Dimension::plane);
  const auto& g = scene.dam_break();
  const double cell = scene.foam.cell;
  const Line x = line_through({0.0, g.column_length, g.tank_length}, cell);
  const Line z = line_through({0.0, g.column_height, 2.0 * g.column_height}, cell);
  BlockLattice lattice;
  lattice.cells = {x.cells, {1}, z.cells};
  lattice.corner = [=](int i, int j, int k) {
    return Point{x.at[static_cast<std::size_t>(i)], j * cell, z.at[static_cast<std::size_t>(k)]};
  };
  lattice.holds = [](int, int, int) { return true; };
  lattice.patch = [](int, int, int, Side side) -> std::string {
    switch (side) {
      case Side::x_low:
        return "back";
      case Side::x_high:
        return "end";
      case Side::z_low:
        return "floor";
      case Side::z_high:
        return "atmosphere";
      default:
        return "sides";
    }
  };
  lattice.patch_types = {
      {"floor", "wall"}, {"back", "wall"}, {"end", "wall"}, {"sides", "empty"}, {"atmosphere", "patch"}};
  return lattice;
}

/// How many cells a mesh of these blocks has, before any is made.
double count_cells(const BlockLattice& lattice) {
  double product = 1.0;
  for (const auto& axis : lattice.cells) {
    double sum = 0.0;
    for (const int n : axis) sum += n;
    product *= sum;
  }
  return product;
}

}  // namespace

bool is_vessel(const Scene& scene) {
  return scene.kind() == Kind::l_box || scene.kind() == Kind::v_funnel || scene.kind() == Kind::dam_break;
}

BlockLattice vessel_mesh(const Scene& scene) {
  if (!(scene.foam.cell > 0.0))
    refuse(scene, "foam.cell is missing; `flowrest foam` needs a cell size above 0 m");
  const auto lattice = scene.kind() == Kind::l_box      ? l_box(scene)
                       : scene.kind() == Kind::v_funnel ? v_funnel(scene)
                                                        : dam_break(scene);
  if (const double cells = count_cells(lattice); cells > most_cells)
    refuse(scene, fmt::format("foam.cell = {:g} m gives {:.3g} cells; at most {:.0e} are allowed",
                              scene.foam.cell, cells, most_cells));
  return lattice;
}

std::array<Point, 2> initial_box(const Scene& scene) {
  switch (scene.kind()) {
    case Kind::l_box:
      return {Point{-far, -far, -far},
              Point{scene.l_box().reservoir_length, far, scene.l_box().reservoir_height}};
    case Kind::v_funnel:
      return {Point{-far, -far, 0.0}, Point{far, far, scene.v_funnel().height()}};
    default:
      return {Point{-far, -far, -far},
              Point{scene.dam_break().column_length, far, scene.dam_break().column_height}};
  }
}

std::optional<Gate> gate_of(const Scene& scene) {
  if (scene.kind() != Kind::l_box || !scene.l_box().gate_lift_velocity) return std::nullopt;
  const auto& g = scene.l_box();
  return Gate{{g.reservoir_length, 0.0, 0.0},
              {g.reservoir_length, 0.5 * g.width, g.channel_height},
              *g.gate_lift_velocity};
}

double whole_over_mesh(const Scene& scene) {
  switch (scene.kind()) {
    case Kind::l_box:
      return 2.0;
    case Kind::v_funnel:
      return 4.0;
    default:
      return 1.0 / scene.foam.cell;
  }
}

double initial_volume(const Scene& scene) {
  switch (scene.kind()) {
    case Kind::l_box:
      return scene.l_box().reservoir_length * scene.l_box().width * scene.l_box().reservoir_height;
    case Kind::v_funnel:
      return scene.v_funnel().volume();
    default:
      return scene.dam_break().column_length * scene.dam_break().column_height;
  }
}

}  // namespace flowrest::foam
