#include "foamCases/rest_monitor.h"

#include <gtest/gtest.h>

#include "foamCases/test_scene.h"
#include "runs/depth.h"

namespace flowrest::foam {
namespace {

using testing::roussel_slump;

TEST(RestMonitor, BoundsTheGrowthByTheOverstress) {
  RestMonitor monitor(roussel_slump("elasto-viscoplastic"));
  EXPECT_FALSE(monitor.growth_to_come());
  monitor.add(1.0, 0.1);  // 50 Pa s at 0.1 1/s is a tenth of 50 Pa
  EXPECT_DOUBLE_EQ(monitor.growth_to_come().value(), 0.02);
  EXPECT_FALSE(monitor.rest_time());
}

TEST(RestMonitor, BelievesInRestOnlyOnceItHasLasted) {
  RestMonitor monitor(roussel_slump("elasto-viscoplastic"));
  monitor.add(0.05, 0.0);  // nothing has moved yet
  EXPECT_FALSE(monitor.at_rest());
  monitor.add(0.2, 3.0);
  monitor.add(20.0, 0.02);
  EXPECT_FALSE(monitor.at_rest());
  monitor.add(20.3, 0.02);
  EXPECT_FALSE(monitor.at_rest());
  monitor.add(20.6, 0.02);
  EXPECT_TRUE(monitor.at_rest());
  EXPECT_EQ(monitor.rest_time(), 20.0);
  monitor.add(20.7, 0.1);
  EXPECT_FALSE(monitor.at_rest());
}

TEST(RestMonitor, AShearRateThatCannotBeReadIsNoRest) {
  RestMonitor monitor(roussel_slump("elasto-viscoplastic"));
  for (const double time : {10.0, 20.0, 30.0}) monitor.add(time, runs::nothing);
  EXPECT_FALSE(monitor.rest_time());
  EXPECT_FALSE(monitor.growth_to_come());
  monitor.add(40.0, 0.0);
  monitor.add(50.0, 0.0);
  EXPECT_EQ(monitor.rest_time(), 40.0);
}

TEST(RestMonitor, AFluidNeverRestsAndASceneMayGoOn) {
  RestMonitor fluid(roussel_slump("papanastasiou"));
  RestMonitor told_to_go_on(roussel_slump("elasto-viscoplastic", {"time.stop_at_rest=false"}));
  for (const double time : {10.0, 20.0}) {
    fluid.add(time, 0.0);
    told_to_go_on.add(time, 0.0);
  }
  EXPECT_FALSE(fluid.rest_time());
  EXPECT_FALSE(fluid.growth_to_come());
  EXPECT_FALSE(told_to_go_on.at_rest());
  EXPECT_EQ(told_to_go_on.rest_time(), 10.0);
}

}  // namespace
}  // namespace flowrest::foam
