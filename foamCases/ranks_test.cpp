#include "foamCases/ranks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foamCases/test_scene.h"

namespace flowrest::foam {
namespace {

using ::testing::HasSubstr;
using testing::roussel_slump;

scenes::Scene coarse_wedge() {
  return roussel_slump("papanastasiou", {"foam.cell=0.03", "foam.base_rows=1"});
}

std::string refusal(const scenes::Scene& scene, int ranks) {
  try {
    check_ranks(scene, ranks, 4);
  } catch (const scenes::SceneError& error) {
    return error.what();
  }
  return "";
}

TEST(Ranks, AMeshIsCutBetweenItsSlices) {
  const Divisible wedge = divisible(coarse_wedge());
  EXPECT_EQ(wedge.slices, 15U);
  EXPECT_EQ(wedge.cells % wedge.slices, 0U);
  const auto quarter = roussel_slump("papanastasiou", {"foam.cell=0.03", "geometry.dimension=quarter"});
  EXPECT_EQ(divisible(quarter).slices, 15U);
  const auto dam =
      scenes::load_scene("dam-break", {{"foam.cell=0.04", "geometry.tank_length=2.4"}, std::nullopt});
  EXPECT_EQ(divisible(dam).slices, 60U);
}

TEST(Ranks, MoreThanAMeshCanFeedAreRefusedWithWhatWouldBeSensible) {
  const auto scene = coarse_wedge();
  EXPECT_EQ(refusal(scene, 2), "");
  EXPECT_EQ(refusal(scene, 16), "");
  EXPECT_THAT(refusal(scene, 300),
              ::testing::AllOf(HasSubstr("--ranks 300: the mesh has 180 cells, 0.6 to a rank"),
                               HasSubstr("allowed: at most 18"), HasSubstr("sensible: 1 (")));
  EXPECT_THAT(refusal(scenes::load_scene("poiseuille-step-down"), 2), HasSubstr("allowed: 1"));
}

TEST(Ranks, MoreThanSlicesOrCoresAreWarnedOf) {
  const auto scene = coarse_wedge();
  EXPECT_EQ(too_many_ranks(scene, 1, 1), "");
  EXPECT_EQ(too_many_ranks(scene, 4, 4), "");
  EXPECT_THAT(too_many_ranks(scene, 6, 4), HasSubstr("--ranks 6 are more than the 4 cores of this machine"));
  EXPECT_THAT(too_many_ranks(scene, 18, 32), HasSubstr("--ranks 18 are more than the 15 slices of cells"));
  EXPECT_THAT(too_many_ranks(scene, 18, 1), HasSubstr("and than the 1 core of this machine"));
}

TEST(Ranks, SensibleAreThoseThatARankRepays) {
  EXPECT_EQ(sensible_ranks({180, 15}, 8), 1);
  EXPECT_EQ(sensible_ranks({20000, 60}, 8), 8);
  EXPECT_EQ(sensible_ranks({20000, 60}, 64), 10);
  EXPECT_EQ(sensible_ranks({200000, 60}, 128), 60);
}

}  // namespace
}  // namespace flowrest::foam
