#include "foamCases/apparatus/dam_break.h"

#include "foamCases/vessel.h"

namespace flowrest::foam {

namespace {

/// A plane, one cell thick.
class DamBreakCase : public Vessel {
 public:
  DamBreakCase(const scenes::DamBreak& tank, const scenes::Scene& scene) : Vessel(scene), tank_(tank) {}

  bool slows() const override { return false; }
  double estimated_cells() const override {
    const double cell = scene().foam.cell;
    return estimated_over(tank_.tank_length, cell) * estimated_over(2.0 * tank_.column_height, cell);
  }
  std::array<Point, 2> initial_box() const override {
    return {Point{-far, -far, -far}, Point{tank_.column_length, far, tank_.column_height}};
  }

 protected:
  BlockLattice lattice() const override {
    check_dimension(scenes::Dimension::plane);
    const double cell = scene().foam.cell;
    const Line x = line_through({0.0, tank_.column_length, tank_.tank_length}, cell);
    const Line z = line_through({0.0, tank_.column_height, 2.0 * tank_.column_height}, cell);
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

 private:
  const scenes::DamBreak& tank_;
};

}  // namespace

std::unique_ptr<ApparatusCase> case_of(const scenes::DamBreak& tank, const scenes::Scene& scene) {
  return std::make_unique<DamBreakCase>(tank, scene);
}

}  // namespace flowrest::foam
