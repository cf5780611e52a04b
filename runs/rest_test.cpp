#include "runs/rest.h"

#include <gtest/gtest.h>

#include <cmath>

#include "runs/depth.h"
#include "runs/quantile.h"
#include "scenes/test_scenes.h"

namespace flowrest::runs {
namespace {

scenes::Scene slump(const std::string& model, const std::vector<std::string>& set = {}) {
  return scenes::load_scene("roussel-slump", {set, scenes::model_from_name(model)});
}

TEST(Rest, BoundsTheGrowthByTheOverstress) {
  Rest rest(slump("elasto-viscoplastic"));
  EXPECT_FALSE(rest.growth_to_come());
  EXPECT_DOUBLE_EQ(rest.overstress(0.1), 0.1) << "50 Pa s at 0.1 1/s is a tenth of 50 Pa";
  EXPECT_DOUBLE_EQ(rest.overstress(0.1, 1.0), 0.05) << "flocs as strong as the rest hold twice as much";
  rest.add(1.0, rest.overstress(0.1));
  EXPECT_DOUBLE_EQ(rest.growth_to_come().value(), 0.02);
  EXPECT_FALSE(rest.rest_time());
}

/// Structure of the part s holds K rate^n over (1 + s): at a rate that is less by (1 + s)^(1/n), not by 1 + s.
TEST(Rest, APowerOfTheRateFeelsStructureByItsRoot) {
  for (const double n : {0.5, 1.0, 1.5}) {
    auto scene = slump("elasto-viscoplastic");
    scene.material.flow_index = n;
    const Rest rest(scene);
    for (const double structure : {0.0, 0.3, 3.0}) {
      const double stress = 50.0 * std::pow(0.1, n);  // Pa, past yield
      EXPECT_NEAR(rest.overstress(0.1, structure), stress / (50.0 * (1.0 + structure)), 1e-15);
      EXPECT_NEAR(rest.overstress(overstressing_rate(0.1, structure, n)), rest.overstress(0.1, structure),
                  1e-14)
          << n << " " << structure;
    }
  }
  EXPECT_EQ(overstressing_rate(0.1, 0.3, 1.0), 0.1 / 1.3);
}

TEST(Rest, IsBelievedOnlyOnceItHasLasted) {
  Rest rest(slump("elasto-viscoplastic"));
  rest.add(0.05, 0.0);  // nothing has moved yet
  EXPECT_FALSE(rest.at_rest());
  rest.add(0.2, 3.0);
  for (const double time : {20.0, 20.3}) {
    rest.add(time, 0.02);
    EXPECT_FALSE(rest.at_rest()) << time;
  }
  rest.add(20.6, 0.02);
  EXPECT_TRUE(rest.at_rest());
  EXPECT_EQ(rest.rest_time(), 20.0);
  rest.add(20.7, 0.1);
  EXPECT_FALSE(rest.at_rest());
}

TEST(Rest, IsBelievedAfterTwiceTheFallOverTheBodysHeight) {
  const auto scene = slump("elasto-viscoplastic");
  EXPECT_DOUBLE_EQ(Rest(scene).patience(0.0), 2.0 * std::sqrt(2.0 * 0.3 / scene.forces.gravity));
}

TEST(Rest, CountsAnewWhereTheForceChanges) {
  auto scene = scenes::load_scene("poiseuille-step-down", {});
  scene.material.yield_stress = 100.0;
  scene.forces.body_force = {{0.0, 1000.0}, {5.0, 4000.0}, {9.0, 0.0}};
  scene.time.stop_at_rest = true;
  Rest rest(scene);
  const double height = scene.body_height(), density = scene.material.density;
  EXPECT_DOUBLE_EQ(rest.patience(1.0), 2.0 * std::sqrt(2.0 * height * density / 1000.0));
  EXPECT_DOUBLE_EQ(rest.patience(6.0), 2.0 * std::sqrt(2.0 * height * density / 4000.0));
  EXPECT_DOUBLE_EQ(rest.patience(10.0), rest.patience(6.0)) << "nothing drives: what has driven counts";
  rest.add(3.0, 0.0);
  rest.add(4.9, 0.0);
  rest.add(5.1, 0.0);
  EXPECT_EQ(rest.calm_since(), 5.1);
}

TEST(Rest, GoesOnFromWhereARunWasLeft) {
  const auto scene = slump("elasto-viscoplastic");
  Rest whole(scene), first(scene), second(scene);
  whole.add(20.0, 0.01);
  first.add(20.0, 0.01);
  second.restore(20.0, first.calm_since());
  for (Rest* rest : {&whole, &second}) rest->add(20.6, 0.01);
  EXPECT_EQ(second.rest_time(), whole.rest_time());
  EXPECT_EQ(second.growth_to_come(), whole.growth_to_come());
}

TEST(Rest, WhatCannotBeReadIsNoRest) {
  Rest rest(slump("elasto-viscoplastic"));
  for (const double time : {10.0, 20.0, 30.0}) rest.add(time, nothing);
  EXPECT_FALSE(rest.rest_time());
  EXPECT_FALSE(rest.growth_to_come());
  rest.add(40.0, 0.0);
  rest.add(50.0, 0.0);
  EXPECT_EQ(rest.rest_time(), 40.0);
}

TEST(Rest, AFluidNeverRestsAndASceneMayGoOn) {
  Rest fluid(slump("papanastasiou"));
  Rest told_to_go_on(slump("elasto-viscoplastic", {"time.stop_at_rest=false"}));
  for (const double time : {10.0, 20.0}) {
    fluid.add(time, 0.0);
    told_to_go_on.add(time, 0.0);
  }
  EXPECT_FALSE(fluid.rest_time());
  EXPECT_FALSE(fluid.growth_to_come());
  EXPECT_FALSE(told_to_go_on.at_rest());
  EXPECT_EQ(told_to_go_on.rest_time(), 10.0);
}

TEST(Percentile, LeavesOutOneOfAHundredPartsByWeight) {
  std::vector<std::pair<double, double>> values;
  for (int i = 0; i < 200; ++i) values.emplace_back(i, 1.0);
  EXPECT_EQ(percentile_99(values), 197.0);
  values.emplace_back(1000.0, 10.0);
  EXPECT_EQ(percentile_99(values), 1000.0) << "more than one part of a hundred";
  EXPECT_TRUE(std::isnan(percentile_99({})));
}

}  // namespace
}  // namespace flowrest::runs
