#include "foamCases/apparatus/v_funnel.h"

#include <cmath>

#include "foamCases/vessel.h"

namespace flowrest::foam {

namespace {

/// Rows of cells under the outlet.
constexpr int outlet_rows = 4;

/// A quarter, with truly inclined faces, as many cells across at every height, and a short box under the outlet
/// through whose sides what flows out leaves.
class VFunnelCase : public Vessel {
 public:
  VFunnelCase(const scenes::VFunnel& funnel, const scenes::Scene& scene) : Vessel(scene), funnel_(funnel) {}

  bool leans() const override { return true; }
  double estimated_cells() const override {
    const double cell = scene().foam.cell;
    return estimated_over(0.5 * std::sqrt(funnel_.outlet_width * funnel_.top_width), cell) *
           estimated_over(0.5 * funnel_.depth, cell) * (estimated_over(funnel_.height(), cell) + 5.0);
  }
  /// Concrete falls out of it, and air behind, for as long as a run lasts, and leaves the mesh shortly below
  /// the outlet.
  std::optional<double> lasting_speed() const override { return fall_speed(); }
  std::array<Point, 2> initial_box() const override {
    return {Point{-far, -far, 0.0}, Point{far, far, funnel_.height()}};
  }
  /// They lie one over another.
  std::size_t slices() const override { return slices_along(2); }

 protected:
  BlockLattice lattice() const override {
    check_dimension(scenes::Dimension::quarter);
    const double cell = scene().foam.cell, outlet = 0.5 * funnel_.outlet_width,
                 wide = 0.5 * funnel_.top_width;
    const std::vector<double> heights{-outlet_rows * cell, 0.0, funnel_.neck_height, funnel_.height(),
                                      funnel_.height() + cell};
    const std::vector<double> widths{outlet, outlet, outlet, wide, wide};
    BlockLattice lattice;
    // As fine at the outlet as coarse at the top, beside the cells' size.
    lattice.cells = {std::vector<int>{cells_over(std::sqrt(outlet * wide), cell)},
                     {cells_over(0.5 * funnel_.depth, cell)},
                     line_through(heights, cell).cells};
    const double deep = 0.5 * funnel_.depth;
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
    lattice.patch_types = {{"slope", "wall"},
                           {"plate", "wall"},
                           {"middleX", "symmetryPlane"},
                           {"middleY", "symmetryPlane"},
                           {"outlet", "patch"},
                           {"atmosphere", "patch"}};
    return lattice;
  }

 private:
  const scenes::VFunnel& funnel_;
};

}  // namespace

std::unique_ptr<ApparatusCase> case_of(const scenes::VFunnel& funnel, const scenes::Scene& scene) {
  return std::make_unique<VFunnelCase>(funnel, scene);
}

}  // namespace flowrest::foam
