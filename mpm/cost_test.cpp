#include "mpm/cost.h"

#include "scenes/test_scenes.h"

namespace flowrest::mpm {
namespace {

scenes::Cost cost_with(const std::vector<std::string>& set) {
  return cost(scenes::parse_scene(scenes::test::slump_text, "slump.toml", {set, std::nullopt}));
}

TEST(Cost, GrowsWithWhatIsComputed) {
  EXPECT_NEAR(cost_with({"time.end=120"}).cpu_seconds / cost_with({}).cpu_seconds, 2.0, 1e-3);
  EXPECT_LT(cost_with({"mpm.precision=float"}).memory, cost_with({}).memory);
}

}  // namespace
}  // namespace flowrest::mpm
