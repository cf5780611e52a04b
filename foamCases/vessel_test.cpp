#include "foamCases/vessel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foamCases/conservation.h"
#include "foamCases/cost.h"
#include "foamCases/vessel_gauge.h"
#include "scenes/scene.h"

namespace flowrest::foam {
namespace {

using ::testing::HasSubstr;

scenes::Scene scene_of(const std::string& name, std::vector<std::string> set = {}) {
  return scenes::load_scene(name, {std::move(set), std::nullopt});
}

/// The blocks of a scene's vessel.
BlockLattice vessel_mesh(const scenes::Scene& scene) {
  return dynamic_cast<const Vessel&>(*case_of(scene)).mesh();
}

/// A block of two by one by three cells, one corner pulled out.
TEST(BlockMesh, CellsFollowTheOrderOfBlockMeshAndFillTheBlock) {
  BlockLattice lattice;
  lattice.cells = {std::vector<int>{2, 1}, {1}, {3}};
  lattice.corner = [](int i, int j, int k) {
    return Point{1.0 * i, 2.0 * j, i == 2 && k == 1 ? 5.0 : 3.0 * k};
  };
  lattice.holds = [](int, int, int) { return true; };
  lattice.patch = [](int, int, int, Side side) { return side == Side::z_low ? "floor" : "rest"; };
  lattice.patch_types = {{"floor", "wall"}, {"rest", "patch"}, {"none", "wall"}};
  const auto cells = mesh_cells(lattice);
  ASSERT_EQ(cells.size(), 9U);
  EXPECT_EQ(cells[0].low, (Point{0.0, 0.0, 0.0}));
  EXPECT_EQ(cells[0].high, (Point{0.5, 2.0, 1.0}));
  EXPECT_EQ(cells[1].low[0], 0.5);
  EXPECT_EQ(cells[2].low[2], 1.0);
  EXPECT_EQ(cells[5].centre(), (Point{0.75, 1.0, 2.5}));
  EXPECT_NEAR(cells[0].volume, 1.0, 1e-14);
  // The second block's top rises from 3 to 5.
  double volume = 0.0;
  for (std::size_t i = 6; i < 9; ++i) volume += cells[i].volume;
  EXPECT_NEAR(volume, 8.0, 1e-12);
  const auto text = block_mesh_dictionary(lattice, "// What it is.");
  EXPECT_THAT(text, HasSubstr("// What it is.\nFoamFile"));
  EXPECT_THAT(text, HasSubstr("hex (0 1 2 3 4 5 6 7) (2 1 3) simpleGrading"));
  EXPECT_THAT(text, HasSubstr("hex (1 8 9 2 5 10 11 6) (1 1 3) simpleGrading"));
  EXPECT_THAT(text, HasSubstr("floor { type wall; faces ( (0 3 2 1) (1 2 9 8) ); }"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("none")));
}

/// The estimate is made before any mesh is laid out.
TEST(Cost, CountsAVesselsCellsToAFifth) {
  for (const char* name : {"mix-a-lbox-sf0", "mix-a-vfunnel-sf0", "dam-break"}) {
    for (const char* cell : {"foam.cell=0.02", "foam.cell=0.01"}) {
      const scenes::Scene scene = scene_of(name, {cell});
      const double cells = static_cast<double>(mesh_cells(vessel_mesh(scene)).size());
      EXPECT_NEAR(estimate(scene).cells, cells, 0.2 * cells) << name << " " << cell;
    }
  }
}

double volume_where(const scenes::Scene& scene, bool filled) {
  const auto [low, high] = dynamic_cast<const Vessel&>(*case_of(scene)).initial_box();
  double volume = 0.0;
  for (const auto& cell : mesh_cells(vessel_mesh(scene))) {
    const Point c = cell.centre();
    bool in = true;
    for (std::size_t a = 0; a < 3; ++a) in = in && c[a] > low[a] && c[a] < high[a];
    if (in || !filled) volume += cell.volume;
    EXPECT_GT(cell.volume, 0.0);
  }
  return volume * whole_over_mesh(scene);
}

TEST(VesselMesh, HoldsTheConcreteExactly) {
  for (const char* cell : {"foam.cell=0.02", "foam.cell=0.013"})
    for (const char* name : {"mix-a-lbox-sf0", "mix-a-vfunnel-sf0", "dam-break"}) {
      const auto scene = scene_of(name, {cell});
      EXPECT_NEAR(volume_where(scene, true) / initial_volume(scene), 1.0, 1e-12) << name << " " << cell;
    }
}

/// What the bars leave of the L-box: four cells across a bar make a body of sixteen corners, of which those
/// towards the reservoir lie on its face.
TEST(VesselMesh, BarsAreRound) {
  const auto scene = scene_of("mix-a-lbox-sf0");
  auto bare = scene_of("mix-a-lbox-sf0", {"geometry.rebars=0"});
  const auto& g = scene.l_box();
  const double bars = volume_where(bare, false) - volume_where(scene, false);
  const double round = g.rebars * M_PI * 0.25 * g.rebar_diameter * g.rebar_diameter * g.channel_height;
  EXPECT_NEAR(bars / round, 1.0007,
              1e-4);  // 0.9720 of the polygon in the circle, and the two corners' 0.0287
  const auto lattice = vessel_mesh(scene);
  int on_circle = 0;
  const double x = g.reservoir_length + g.rebar_distance, radius = 0.5 * g.rebar_diameter;
  for (std::size_t i = 0; i <= lattice.cells[0].size(); ++i)
    for (std::size_t j = 0; j <= lattice.cells[1].size(); ++j) {
      const Point p = lattice.corner(static_cast<int>(i), static_cast<int>(j), 0);
      for (const double y : {0.0, 0.25 * g.width})
        if (std::abs(std::hypot(p[0] - x, p[1] - y) - radius) < 1e-12) ++on_circle;
    }
  EXPECT_EQ(on_circle,
            8 + 14);  // half a bar on the plane of symmetry; the two corners on the face are not moved
}

/// Through one cell across the air behind the bars raced, and fresh Mix B's volume was lost.
TEST(VesselMesh, AGapBetweenBarsIsMoreThanOneCellWide) {
  for (const char* cell : {"0.02", "0.026667", "0.033", "0.1"}) {
    const auto scene = scene_of("mix-b-lbox-sf0", {std::string("foam.cell=") + cell});
    const auto lattice = vessel_mesh(scene);
    int gaps = 0;
    for (std::size_t j = 0; j < lattice.cells[1].size(); ++j) {
      const int side = static_cast<int>(j);
      const double width = lattice.corner(0, side + 1, 0)[1] - lattice.corner(0, side, 0)[1];
      if (width < scene.l_box().rebar_diameter) continue;  // a cell of a bar
      ++gaps;
      EXPECT_GE(lattice.cells[1][j], 2) << cell << " at " << lattice.corner(0, side, 0)[1];
    }
    EXPECT_EQ(gaps, 2) << cell;  // of the half: one to the bar beside the middle, one to the side
  }
}

TEST(VesselMesh, SaysWhatIsAllowed) {
  const auto refusal = [](const std::string& name, const std::vector<std::string>& set) -> std::string {
    try {
      vessel_mesh(scene_of(name, set));
    } catch (const scenes::SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("mix-a-lbox-sf0", {"geometry.dimension=full"}), HasSubstr("allowed: half"));
  EXPECT_THAT(refusal("mix-a-vfunnel-sf0", {"geometry.dimension=plane"}), HasSubstr("allowed: quarter"));
  EXPECT_THAT(refusal("dam-break", {"geometry.dimension=full", "mpm.particles_per_cell=8"}),
              HasSubstr("allowed: plane"));
  EXPECT_THAT(refusal("mix-a-lbox-sf0", {"geometry.rebar_distance=0.004"}),
              HasSubstr("allowed: 0.006 to 0.034"));
  EXPECT_THAT(refusal("mix-a-lbox-sf0", {"foam.cell=0.0003"}), HasSubstr("at most 5e+06 are allowed"));
  EXPECT_EQ(refusal("mix-a-lbox-sf0", {}), "accepted");
}

/// A wedge of concrete that runs out along the channel, moving.
TEST(VesselGauge, SeesAWedgeInTheChannel) {
  const auto scene = scene_of("mix-a-lbox-sf0", {"foam.cell=0.01", "geometry.rebars=0"});
  const auto cells = mesh_cells(vessel_mesh(scene));
  const VesselGauge gauge(scene, cells);
  VesselFields fields;
  const double height = 0.06, end = 0.5;  // m, falling linearly from the back wall
  for (const auto& cell : cells) {
    const double depth = height * std::max(0.0, 1.0 - cell.centre()[0] / end);
    fields.fraction.push_back(std::clamp((depth - cell.low[2]) / (cell.high[2] - cell.low[2]), 0.0, 1.0));
    fields.velocity.insert(fields.velocity.end(), {2.0, 0.0, 0.0});
    fields.shear_rate.push_back(3.0);
  }
  const auto gauges = gauge.measure(fields);
  const double volume = 0.5 * height * end * scene.l_box().width;
  EXPECT_NEAR(gauges.volume, volume, 1e-10);
  EXPECT_NEAR(gauges.kinetic_energy, 0.5 * scene.material.density * volume * 4.0, 1e-6);
  EXPECT_NEAR(gauges.potential_energy, scene.material.density * 9.81 * volume * height / 3.0,
              0.02 * gauges.potential_energy);
  EXPECT_NEAR(gauges.front, end * (1.0 - 0.003 / height) - 0.1, 1e-4);
  EXPECT_NEAR(gauges.front_mass_995, end * (1.0 - std::sqrt(0.005)) - 0.1, 1e-3);
  EXPECT_NEAR(gauges.start_height, height * (1.0 - 0.01 / end), 1e-10);
  EXPECT_EQ(gauges.end_height, 0.0);
  EXPECT_EQ(gauges.shear_rate_p99, 3.0);
  EXPECT_NEAR(gauges.base_shear_rate_p99, 2.0 / 0.005, 1e-9);
  EXPECT_NEAR(gauge.mean_over_concrete(fields.fraction, std::vector<double>(cells.size(), 0.7)), 0.7, 1e-12);
  EXPECT_EQ(gauges.place.size(), gauges.depth.size());
}

TEST(VesselGauge, ReadsTheFrontAndTheHeightsAsTheSceneDefinesThem) {
  const auto scene = scene_of("mix-a-lbox-sf0", {"foam.cell=0.01", "geometry.rebars=0",
                                                 "gauges.front_depth=0.012", "gauges.end_length=0.1"});
  const auto cells = mesh_cells(vessel_mesh(scene));
  const VesselGauge gauge(scene, cells);
  VesselFields fields, air;
  const double height = 0.06, end = 0.5;  // m, falling linearly from the back wall
  for (const auto& cell : cells) {
    const double depth = height * std::max(0.0, 1.0 - cell.centre()[0] / end);
    fields.fraction.push_back(std::clamp((depth - cell.low[2]) / (cell.high[2] - cell.low[2]), 0.0, 1.0));
    air.fraction.push_back(0.0);
  }
  fields.velocity = air.velocity = std::vector<double>(3 * cells.size(), 0.0);
  const auto gauges = gauge.measure(fields);
  EXPECT_NEAR(gauges.front, end * (1.0 - 0.012 / height) - 0.1, 1e-4);
  EXPECT_NEAR(gauges.start_height, height * (1.0 - 0.05 / end), 1e-10);
  // Without concrete there is no front, and none at the back wall either.
  const auto empty = gauge.measure(air);
  EXPECT_TRUE(std::isnan(empty.front));
  EXPECT_TRUE(std::isnan(empty.front_mass_995));
  EXPECT_TRUE(std::isnan(empty.shear_rate_p99));
  EXPECT_EQ(empty.end_height, 0.0);
}

TEST(VesselGauge, SeesWhatIsLeftInAFunnel) {
  const auto scene = scene_of("mix-a-vfunnel-sf0", {"foam.cell=0.01"});
  const auto cells = mesh_cells(vessel_mesh(scene));
  const VesselGauge gauge(scene, cells);
  const auto& g = scene.v_funnel();
  VesselFields fields;
  // Full up to the neck's top but for a hole along the middle: half of the width's cells.
  double held = 0.0;
  for (const auto& cell : cells) {
    const bool full = cell.centre()[2] > 0.0 && cell.centre()[2] < g.neck_height;
    fields.fraction.push_back(full ? 1.0 : 0.0);
    fields.velocity.insert(fields.velocity.end(), {0.0, 0.0, 0.0});
    if (full) held += 4.0 * cell.volume;
  }
  auto gauges = gauge.measure(fields);
  EXPECT_NEAR(held, g.neck_height * g.outlet_width * g.depth, 1e-12);
  EXPECT_NEAR(gauges.over_outlet, held, 1e-12);
  EXPECT_NEAR(gauges.thinnest_over_outlet, g.neck_height, 1e-12);
  EXPECT_NEAR(gauges.depth.front(), g.neck_height, 1e-12);
  // A film of 2 mm on the middle line of sight alone.
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (cells[i].low[0] < 0.25 * g.outlet_width)
      fields.fraction[i] = fields.fraction[i] > 0.0 ? 0.002 / 0.15 : 0.0;
  gauges = gauge.measure(fields);
  EXPECT_NEAR(gauges.thinnest_over_outlet, 0.002, 1e-12);
}

}  // namespace
}  // namespace flowrest::foam
