#include "mpm/boundary/scene_walls.h"

#include <cmath>
#include <numbers>

namespace flowrest::mpm {

namespace {

using scenes::Dimension;

/// Thickness of walls that real ones do not have, so that nothing finds itself behind them. m
constexpr double thickness = 0.04;
/// Of an L-box's gate, m: what has run under it must find room behind it.
constexpr double gate_thickness = 0.006;

Contact contact_of(const scenes::WallContact& c) {
  if (c.law == scenes::Wall::friction) return Contact::friction;
  return c.law == scenes::Wall::slip ? Contact::slip : Contact::stick;
}

PlaneWall plane_wall_of(scenes::Wall law) {
  switch (law) {
    case scenes::Wall::no_slip:
      return PlaneWall::no_slip;
    case scenes::Wall::slip:
      return PlaneWall::slip;
    case scenes::Wall::friction:
      return PlaneWall::friction;
  }
  return PlaneWall::none;
}

class Builder {
 public:
  Builder(const scenes::Scene& scene, double cell)
      : scene_(scene),
        cell_(cell),
        dim_(scene.spatial_dimension()),
        up_(static_cast<std::size_t>(dim_ - 1)) {}

  SceneWalls build() {
    switch (scene_.kind) {
      case scenes::Kind::slump:
        slump();
        break;
      case scenes::Kind::duct:
        duct();
        break;
      case scenes::Kind::l_box:
        l_box();
        break;
      case scenes::Kind::v_funnel:
        v_funnel();
        break;
      case scenes::Kind::dam_break:
        dam_break();
        break;
    }
    return std::move(made_);
  }

 private:
  /// The axis of symmetry and planes of symmetry mirror the body: what a slip wall does.
  void mirror(std::size_t axis) { made_.bounds[axis].lower = PlaneWall::slip; }

  Wall wall(const std::string& name, std::shared_ptr<const WallShape> shape) const {
    Wall w;
    w.name = name;
    w.shape = std::move(shape);
    w.contact = contact_of(scene_.base);
    w.friction = scene_.base.friction;
    return w;
  }

  /// Everything beyond `place` along an axis, seen from below or above. A plane along the grid is held by the
  /// grid itself.
  void plane(const std::string& name, std::size_t axis, bool upper, double place, const Extent& extent) {
    const double cells = place / cell_;
    const bool on_grid = std::abs(cells - std::round(cells)) < 1e-6;
    if (on_grid) {
      AxisBounds& bounds = made_.bounds[axis];
      (upper ? bounds.upper : bounds.lower) = plane_wall_of(scene_.base.law);
      (upper ? bounds.upper_cell : bounds.lower_cell) = static_cast<int>(std::lround(cells));
      (upper ? bounds.upper_friction : bounds.lower_friction) = scene_.base.friction;
      return;
    }
    Vector at{}, normal{};
    at[axis] = place;
    normal[axis] = upper ? -1.0 : 1.0;
    made_.walls.push_back(wall(name, std::make_shared<HalfSpace>(dim_, at, normal, extent)));
  }

  void slump() {
    const auto& g = scene_.slump();
    if (scene_.geometry.dimension != Dimension::full)
      for (std::size_t a = 0; a < up_; ++a) mirror(a);
    Extent reach;
    for (std::size_t a = 0; a < up_; ++a) {
      reach.lower[a] = scene_.geometry.dimension == Dimension::full ? -g.domain_radius : 0.0;
      reach.upper[a] = g.domain_radius;
    }
    plane("base", up_, false, 0.0, reach);
    if (g.mould_lift_velocity) mould(*g.mould_lift_velocity);
  }

  /// A steel cone open at both ends.
  void mould(double velocity) {
    const auto& g = scene_.slump();
    const Outline section = {{{g.cone_radius_bottom, 0.0},
                              {g.cone_radius_bottom + 0.5 * thickness, 0.0},
                              {g.cone_radius_top + 0.5 * thickness, g.cone_height},
                              {g.cone_radius_top, g.cone_height}},
                             {true, false, false, true}};
    const double turn =
        scene_.geometry.dimension == Dimension::full ? 2.0 * std::numbers::pi : 0.5 * std::numbers::pi;
    Wall w =
        wall("mould", std::make_shared<Prism>(
                          section, Prism::Swept{dim_ == 3 ? Sweep::revolved : Sweep::none, 2, 0.0, turn}));
    if (scene_.mould) {
      w.contact = contact_of(*scene_.mould);
      w.friction = scene_.mould->friction;
    }
    lift(std::move(w), velocity, g.cone_height);
  }

  /// A wall of that height that goes up from the start and is gone once it is clear of what it held.
  void lift(Wall w, double velocity, double height) {
    w.motion.velocity[up_] = velocity;
    w.opens_at = height / velocity;
    made_.walls.push_back(std::move(w));
  }

  void duct() {
    const PlaneWall held = plane_wall_of(scene_.base.law);
    const int layers = static_cast<int>(std::lround(scene_.duct().height / cell_));
    made_.bounds[0] = {PlaneWall::none, PlaneWall::none, 0, block_edge, true};
    made_.bounds[1] = {held, held, 0, layers, false};
  }

  /// A body whose section lies in the plane of the first axis and the vertical, as deep as the scene.
  std::shared_ptr<Prism> upright(Outline section, double from, double to) const {
    return std::make_shared<Prism>(std::move(section),
                                   Prism::Swept{dim_ == 3 ? Sweep::extruded : Sweep::none, 1, from, to});
  }

  void l_box() {
    const auto& g = scene_.l_box();
    const bool half = scene_.geometry.dimension == Dimension::half;
    const double side = half ? 0.5 * g.width : g.width;
    Extent reach;
    reach.upper = {g.length(), dim_ == 3 ? side : g.reservoir_height, g.reservoir_height};
    plane("floor", up_, false, 0.0, reach);
    plane("back", 0, false, 0.0, reach);
    plane("end", 0, true, g.length(), reach);
    if (half) mirror(1);
    if (dim_ == 3) {
      if (!half) plane("left", 1, false, 0.0, reach);
      plane("right", 1, true, side, reach);
    }
    const double face = g.reservoir_length, lip = g.channel_height, top = 1.2 * g.reservoir_height;
    const double back = face + std::min(thickness, 0.5 * g.channel_length);
    made_.walls.push_back(wall(
        "front", upright({{{face, lip}, {back, lip}, {back, top}, {face, top}}, {true, false, false, true}},
                         0.0, side)));
    if (dim_ == 3) rebars(half);
    if (g.gate_lift_velocity) gate(*g.gate_lift_velocity, side);
  }

  /// A plate before the opening, which holds as the other walls do.
  void gate(double velocity, double side) {
    const auto& g = scene_.l_box();
    const double face = g.reservoir_length, back = face + gate_thickness;
    lift(wall("gate", upright({{{face, 0.0}, {back, 0.0}, {back, g.channel_height}, {face, g.channel_height}},
                               {false, false, false, true}},
                              0.0, side)),
         velocity, g.channel_height);
  }

  void rebars(bool half) {
    const auto& g = scene_.l_box();
    for (int i = 1; i <= g.rebars; ++i) {
      const double across = g.width * i / (g.rebars + 1) - (half ? 0.5 * g.width : 0.0);
      if (half && across < -1e-9) continue;
      made_.walls.push_back(
          wall("rebar " + std::to_string(i),
               std::make_shared<Cylinder>(3, Vector{g.reservoir_length + g.rebar_distance, across, 0.0},
                                          0.5 * g.rebar_diameter, 0.0, g.channel_height)));
    }
  }

  void v_funnel() {
    const auto& g = scene_.v_funnel();
    const bool full = scene_.geometry.dimension == Dimension::full;
    const double deep = 0.5 * g.depth, outlet = 0.5 * g.outlet_width, wide = 0.5 * g.top_width;
    const double top = g.height() + 0.1, out = wide + 0.1;
    Extent catching;
    for (std::size_t a = 0; a < up_; ++a) {
      catching.lower[a] = full ? -4.0 * wide : 0.0;
      catching.upper[a] = 4.0 * wide;
    }
    catching.lower[up_] = -2.0 * g.fall_height;
    plane("floor", up_, false, -g.fall_height, catching);
    // Neck, slope and a rim above it; outwards and back below the outlet.
    const Outline right = {
        {{outlet, 0.0}, {out, 0.0}, {out, top}, {wide, top}, {wide, g.height()}, {outlet, g.neck_height}},
        {true, false, false, true, true, true}};
    made_.walls.push_back(wall("right slope", upright(right, full ? -deep : 0.0, deep)));
    if (full) {
      Outline left;
      for (auto c = right.corners.rbegin(); c != right.corners.rend(); ++c)
        left.corners.push_back({-(*c)[0], (*c)[1]});
      left.touched = {true, true, true, false, false, true};
      made_.walls.push_back(wall("left slope", upright(left, -deep, deep)));
    } else {
      mirror(0);
    }
    if (dim_ == 2) return;
    if (!full) mirror(1);
    plate("back plate", deep, deep + thickness, false, top);
    if (full) plate("front plate", -deep - thickness, -deep, true, top);
  }

  /// A plate across the depth, over the outlet's height and as wide as the funnel.
  void plate(const std::string& name, double from, double to, bool faces_up_the_axis, double top) {
    const auto& g = scene_.v_funnel();
    const double wide = 0.5 * g.top_width;
    const Outline section = {{{from, 0.0}, {to, 0.0}, {to, top}, {from, top}},
                             {false, faces_up_the_axis, false, !faces_up_the_axis}};
    const double begin = scene_.geometry.dimension == Dimension::full ? -wide : 0.0;
    made_.walls.push_back(
        wall(name, std::make_shared<Prism>(section, Prism::Swept{Sweep::extruded, 0, begin, wide})));
  }

  void dam_break() {
    const auto& g = scene_.dam_break();
    Extent reach;
    reach.upper = {g.tank_length, dim_ == 3 ? g.width : 2.0 * g.column_height, 2.0 * g.column_height};
    plane("floor", up_, false, 0.0, reach);
    plane("back", 0, false, 0.0, reach);
    plane("end", 0, true, g.tank_length, reach);
    if (dim_ == 2) return;
    plane("left", 1, false, 0.0, reach);
    plane("right", 1, true, g.width, reach);
  }

  const scenes::Scene& scene_;
  double cell_;
  int dim_;
  std::size_t up_;
  SceneWalls made_;
};

}  // namespace

SceneWalls walls_of(const scenes::Scene& scene, double cell) { return Builder(scene, cell).build(); }

}  // namespace flowrest::mpm
