#include "scenes/step_limits.h"

#include <cmath>
#include <limits>

#include "scenes/test_scenes.h"

namespace flowrest::scenes::test {
namespace {

Scene slump(std::vector<std::string> set = {}) {
  return parse_scene(slump_text, "slump.toml", {std::move(set), {}});
}
Scene duct(std::vector<std::string> set = {}) {
  return parse_scene(duct_text, "duct.toml", {std::move(set), {}});
}

TEST(StepLimits, TheAcousticLimitCountsTheStiffeningUnderWeight) {
  const Scene scene = slump();
  // Yu et al. 2026, Eq. 6, differentiated numerically where p is the weight of the cone.
  const double bulk = scene.material.bulk_modulus();
  const double pressure = 2300.0 * 9.81 * 0.3;
  const auto pressure_at = [&](double strain) { return bulk / 7.0 * (std::exp(-7.0 * strain) - 1.0); };
  const double strain = -std::log(1.0 + 7.0 * pressure / bulk) / 7.0;
  ASSERT_NEAR(pressure_at(strain), pressure, 1e-9 * pressure);
  const double tangent = -(pressure_at(strain + 1e-6) - pressure_at(strain - 1e-6)) / 2e-6;
  const double shear = scene.material.shear_modulus() * tangent / bulk;
  const double speed = std::sqrt((tangent + 4.0 / 3.0 * shear) / 2300.0);
  EXPECT_NEAR(step_limits(scene).acoustic, 0.01 / speed, 1e-8 * 0.01 / speed);
  EXPECT_NEAR(volume_under_weight(scene), std::exp(strain), 1e-12);
}

TEST(StepLimits, ADuctHasNoWeight) {
  const Scene scene = duct();
  EXPECT_DOUBLE_EQ(pressure_at_rest(scene), 0.0);
  EXPECT_DOUBLE_EQ(volume_under_weight(scene), 1.0);
  EXPECT_DOUBLE_EQ(step_limits(scene).acoustic, 0.01 / scene.material.longitudinal_speed());
}

TEST(StepLimits, TheLargestCourantNumberFallsTowardsIncompressibility) {
  const auto cfl = [](const std::string& ratio) {
    return step_limits(slump({"material.poisson_ratio=" + ratio, "mpm.cfl=0.5"})).largest_cfl;
  };
  EXPECT_DOUBLE_EQ(cfl("0.1"), 1.15);
  EXPECT_DOUBLE_EQ(cfl("0.3"), 1.15);
  EXPECT_NEAR(cfl("0.395"), 1.075, 1e-12);
  EXPECT_DOUBLE_EQ(cfl("0.49"), 1.0);
  EXPECT_DOUBLE_EQ(cfl("0.4999"), 1.0);
}

TEST(StepLimits, OnlyAnExplicitFluidHasAViscousLimit) {
  constexpr double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(step_limits(slump()).viscous, none);
  EXPECT_EQ(step_limits(slump({"mpm.fluid_update=explicit"})).viscous, none);
  EXPECT_EQ(step_limits(slump({"material.model=papanastasiou"})).viscous, none);
  EXPECT_DOUBLE_EQ(step_limits(slump()).largest(), 1.15 * step_limits(slump()).acoustic);
}

TEST(StepLimits, TheViscousLimitFollowsTheLargestViscosityOfTheModel) {
  const auto limit = [](std::vector<std::string> set) {
    set.push_back("mpm.fluid_update=explicit");
    return step_limits(slump(set)).viscous;
  };
  const double inertia = 2300.0 * 1e-4 / 6.0;
  EXPECT_NEAR(limit({"material.model=papanastasiou"}), inertia / (50.0 + 100.0 * 50.0), 1e-15);
  EXPECT_NEAR(limit({"material.model=bi-viscous", "material.critical_shear_rate=0.5"}),
              inertia / (50.0 + 100.0), 1e-15);
  EXPECT_NEAR(limit({"material.model=newtonian"}), inertia / 50.0, 1e-15);
  EXPECT_NEAR(limit({"material.model=papanastasiou", "thixotropy.flocculation_rate=0.5",
                     "thixotropy.deflocculation_coefficient=0.1", "thixotropy.initial_flocculation=2"}),
              inertia / (50.0 + 100.0 * (50.0 * 3.0 + 0.5 * 60.0)), 1e-15);
  EXPECT_NEAR(
      limit({"material.model=papanastasiou", "thixotropy.flocculation_rate=0.5",
             "thixotropy.deflocculation_coefficient=0.1", "thixotropy.initial_flocculation=2",
             "thixotropy.ageing_rate=0.2", "thixotropy.ageing_time=300", "thixotropy.initial_age=90"}),
      inertia / (50.0 + 100.0 * (50.0 * 3.0 + 0.5 * 60.0 + 60.0 * (std::exp(0.5) - 1.0))), 1e-15);
}

TEST(EstimateMpm, CountsParticlesCellsAndSteps) {
  const MpmEstimate estimate = estimate_mpm(slump());
  EXPECT_NEAR(estimate.cells, 0.5 * (0.05 + 0.1) * 0.3 / 1e-4, 1.0);
  EXPECT_DOUBLE_EQ(estimate.particles, 9.0 * estimate.cells);
  EXPECT_NEAR(estimate.step, 0.75 * step_limits(slump()).acoustic, 1e-15);
  EXPECT_DOUBLE_EQ(estimate.steps, std::ceil(60.0 / estimate.step));

  const MpmEstimate quarter = estimate_mpm(slump({"geometry.dimension=quarter"}));
  EXPECT_NEAR(quarter.cells, 0.25 * 5.49779e-3 / 1e-6, 1.0);
  EXPECT_DOUBLE_EQ(quarter.particles, 27.0 * quarter.cells);
  EXPECT_NEAR(estimate_mpm(slump({"geometry.dimension=full"})).cells, 4.0 * quarter.cells, 4.0);
  EXPECT_DOUBLE_EQ(estimate_mpm(duct()).cells, 4.0 * 50.0);
}

TEST(EstimateMpm, AnEndBelowOneStepTakesOneStep) {
  EXPECT_DOUBLE_EQ(estimate_mpm(slump({"time.end=1e-9"})).steps, 1.0);
}

TEST(EstimateMpm, AStepThatFollowsFromCflObeysTheViscousLimit) {
  const Scene scene = slump({"material.model=papanastasiou", "mpm.fluid_update=explicit"});
  EXPECT_DOUBLE_EQ(estimate_mpm(scene).step, step_limits(scene).viscous);
}

TEST(FreeFallSpeed, IsThatOfTheBodysHeight) {
  EXPECT_DOUBLE_EQ(free_fall_speed(slump()), std::sqrt(2.0 * 9.81 * 0.3));
  EXPECT_EQ(free_fall_speed(load_scene("poiseuille-10", {})), 0.0);
  const Scene funnel = load_scene("mix-a-vfunnel-sf0", {});
  EXPECT_DOUBLE_EQ(free_fall_speed(funnel),
                   std::sqrt(2.0 * 9.81 * (funnel.body_height() + funnel.v_funnel().fall_height)));
}

TEST(FreeFallSpeed, MayPassThatOfSoundWhereOnlyOpenFoamRuns) {
  EXPECT_THROW(slump({"forces.gravity=981"}), SceneError);
  EXPECT_NO_THROW(slump({"forces.gravity=981", "runs.mpm=[]"}));
}

}  // namespace
}  // namespace flowrest::scenes::test
