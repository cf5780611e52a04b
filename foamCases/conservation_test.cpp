#include "foamCases/conservation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foamCases/test_scene.h"

namespace flowrest::foam {
namespace {

using ::testing::HasSubstr;

constexpr double volume = 0.012;  // m3

TEST(Conservation, AVolumeThatIsKeptRaisesNoDoubt) {
  Conservation box(scenes::load_scene("mix-b-lbox-sf0"), volume);
  box.add(0.0, 1.01 * volume, 0.0);
  box.add(1.0, 1.01 * volume * (1.0 - 1e-4), 2.0);
  EXPECT_NEAR(box.initial_error(), 0.01, 1e-12);
  EXPECT_NEAR(box.error(), -1e-4, 1e-12);
  EXPECT_EQ(box.doubt(), "");
  EXPECT_EQ(box.fault(), "");
}

/// As fresh Mix B between bars on 26.7 mm cells, whose noise monitor had nothing to say.
TEST(Conservation, AVolumeThatIsLostIsInDoubtFromThenOn) {
  Conservation box(scenes::load_scene("mix-b-lbox-sf0"), volume);
  box.add(0.0, volume, 0.0);
  box.add(0.9, volume, 2.0);
  box.add(1.0, volume * (1.0 - 1.4e-3), 2.0);
  box.add(1.1, volume, 2.0);
  EXPECT_EQ(box.doubt(), "the volume of concrete is off by 0.14 % since 1 s, where 0.02 % are allowed");
  EXPECT_NEAR(box.largest_error(), 1.4e-3, 1e-12);
  EXPECT_EQ(box.error(), 0.0);
  EXPECT_EQ(box.fault(), "");
}

TEST(Conservation, WhatIsLostBeforeAnInterruptIsNotForgotten) {
  Conservation box(scenes::load_scene("mix-b-lbox-sf0"), volume);
  runs::Table history;
  history.names = {"time_s", "volume_m3", "kinetic_energy_J", "volume_error"};
  history.columns = {{0.0, 0.5, 1.0}, {volume, 0.999 * volume, volume}, {0.0, 2.0, 3.0}, {0.0, -1e-3, 0.0}};
  box.continue_from(history);
  EXPECT_THAT(box.doubt(), HasSubstr("off by 0.1 % since 0.5 s"));
  EXPECT_EQ(box.first_volume(), volume);
  box.add(1.5, volume, 3.0);
  EXPECT_THAT(box.doubt(), HasSubstr("off by 0.1 % since 0.5 s"));
}

TEST(Conservation, AVolumeFarOffOrNoNumberEndsTheRun) {
  for (const double wrong : {0.85 * volume, 1.2 * volume, std::numeric_limits<double>::quiet_NaN()}) {
    Conservation box(scenes::load_scene("mix-b-lbox-sf0"), volume);
    box.add(0.0, volume, 0.0);
    box.add(1.0, wrong, 2.0);
    box.add(1.1, volume, 2.0);
    EXPECT_THAT(box.fault(), HasSubstr("the flow diverges")) << wrong;
  }
}

TEST(Conservation, AFunnelMayRunOutButNotGain) {
  Conservation funnel(scenes::load_scene("mix-a-vfunnel-sf0"), volume);
  funnel.add(0.0, volume, 0.0);
  funnel.add(1.0, 0.1 * volume, 1.0);
  EXPECT_EQ(funnel.error(), 0.0);
  EXPECT_EQ(funnel.doubt(), "");
  EXPECT_EQ(funnel.fault(), "");
  funnel.add(1.1, 1.2 * volume, 1.0);
  EXPECT_THAT(funnel.fault(), HasSubstr("off by 20 % at 1.1 s"));
}

TEST(Conservation, NothingMovesFasterThanItsWeightCanMakeIt) {
  const auto scene = scenes::load_scene("mix-b-lbox-sf0");
  const double fall = scene.material.density * scene.forces.gravity * volume * scene.body_height();
  Conservation box(scene, volume);
  box.add(0.0, volume, 0.99 * fall);
  EXPECT_EQ(box.fault(), "");
  box.add(1.0, volume, 1.01 * fall);
  EXPECT_THAT(box.fault(), HasSubstr("all its weight can give is"));
}

}  // namespace
}  // namespace flowrest::foam
