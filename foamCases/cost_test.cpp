#include "foamCases/cost.h"

#include <gtest/gtest.h>

#include <cmath>

#include "foamCases/step_rules.h"
#include "scenes/test_scenes.h"

namespace flowrest::foam {
namespace {

/// The cone and the cells that the runs below were measured with.
scenes::Scene slump(const std::vector<std::string>& set = {}) {
  return scenes::parse_scene(scenes::test::slump_text, "slump.toml", {set, std::nullopt});
}

double largest(const scenes::Scene& scene) { return largest_step(*case_of(scene)); }
double grown(const scenes::Scene& scene) { return grown_step(*case_of(scene)); }

TEST(Cost, IsThatOfRunsThatWereMeasured) {
  // The 10 mm wedge: 3,430 steps and 106 CPU s were measured of a fluid, 3,477 and 75 of the elastic
  // material; with OpenFOAM's own laws, whose steps do not grow, 12,033 steps. Rows of a quarter of a cell over the
  // deposit, 50 mm, add 12 to the 38 rows of then.
  const scenes::FoamEstimate fluid = estimate(slump({"material.model=papanastasiou"}));
  EXPECT_DOUBLE_EQ(fluid.cells, 45.0 * 50.0);
  EXPECT_DOUBLE_EQ(estimate(slump({"geometry.dimension=quarter"})).cells, 45.0 * 45.0 * 38.0);
  EXPECT_NEAR(fluid.steps, 3430.0, 100.0);
  EXPECT_NEAR(fluid.cost.cpu_seconds, 100.0, 25.0);
  EXPECT_NEAR(estimate(slump({"material.model=papanastasiou", "foam.laws=built-in"})).steps, 12033.0, 2000.0);
  const scenes::FoamEstimate solid = estimate(slump());
  EXPECT_NEAR(solid.steps, 3477.0, 100.0);
  EXPECT_NEAR(solid.cost.cpu_seconds, 75.0 * 50.0 / 38.0, 20.0);
  // Of funnels 3,900 to 4,140 steps were measured on 12.5 mm cells and 2,800 to 2,930 on 16.7 mm, of their
  // fluids three quarters of that.
  EXPECT_NEAR(estimate(scenes::load_scene("mix-a-vfunnel-sf0", {})).steps, 4000.0, 800.0);
  EXPECT_NEAR(estimate(scenes::load_scene("mix-a-vfunnel-sf0", {{"foam.cell=0.016667"}, {}})).steps, 2900.0,
              600.0);
  // L-boxes, 3 s: of solids 2,849 to 3,075 steps were measured on 20 and 26.7 mm cells, but of fresh Mix A,
  // the fastest, 4,823 and 3,416; of a fluid 3,037 with steps of 1 ms.
  EXPECT_NEAR(estimate(scenes::load_scene("mix-b-lbox-sf0", {{"time.end=3"}, {}})).steps, 3075.0, 600.0);
  EXPECT_NEAR(
      estimate(scenes::load_scene("mix-b-lbox-sf600", {{"foam.cell=0.026667", "time.end=3"}, {}})).steps,
      3020.0, 600.0);
  EXPECT_NEAR(
      estimate(scenes::load_scene("mix-a-lbox-sf600", {{"material.model=papanastasiou", "time.end=3"}, {}}))
          .steps,
      3000.0, 400.0);
}

TEST(LargestStep, FollowsTheFluidOrTheShearWaveButNoSampleIsSkipped) {
  EXPECT_DOUBLE_EQ(largest(slump({"material.model=papanastasiou"})), 0.0046);
  const scenes::Scene solid = slump();
  EXPECT_NEAR(largest(solid), 1.5 * 0.01 / std::sqrt(solid.material.shear_modulus() / solid.material.density),
              1e-15);
  EXPECT_DOUBLE_EQ(largest(slump({"material.plastic_viscosity=0", "runs.foam=[]"})), largest(solid));
  EXPECT_DOUBLE_EQ(largest(slump({"material.youngs_modulus=2e4", "output.history_interval=0.001"})), 0.001);
  // Between an L-box's bars cells are 3 mm wide.
  const scenes::Scene box = scenes::load_scene("mix-a-lbox-sf0", {{"material.model=papanastasiou"}, {}});
  EXPECT_DOUBLE_EQ(case_of(box)->smallest_cell(), 0.003);
  EXPECT_DOUBLE_EQ(largest(box), 0.003 * 0.003 * 2400.0 / 19.5);
  const scenes::Scene solid_box = scenes::load_scene("mix-a-lbox-sf0", {});
  EXPECT_NEAR(largest(solid_box), 1.5 * 0.003 / std::sqrt(solid_box.material.shear_modulus() / 2400.0),
              1e-15);
  EXPECT_DOUBLE_EQ(largest(slump({"foam.max_time_step=0.03"})), 0.03);
}

TEST(GrownStep, IsAMultipleThatSkipsNoSample) {
  const double first = largest(slump());
  EXPECT_DOUBLE_EQ(grown(slump({"foam.step_growth=2"})), 2.0 * first);
  EXPECT_DOUBLE_EQ(grown(slump()), 0.4 * 0.05);
  EXPECT_DOUBLE_EQ(grown(slump({"foam.step_growth=1"})), first);
  EXPECT_DOUBLE_EQ(grown(slump({"output.history_interval=0.004"})), first);
  EXPECT_DOUBLE_EQ(grown(slump({"foam.laws=built-in"})), first);
  EXPECT_DOUBLE_EQ(grown(slump({"foam.max_time_step=0.03"})), 0.03);
  const auto duct = scenes::parse_scene(scenes::test::duct_text, "duct.toml", {});
  EXPECT_DOUBLE_EQ(grown(duct), largest(duct));
}

}  // namespace
}  // namespace flowrest::foam
