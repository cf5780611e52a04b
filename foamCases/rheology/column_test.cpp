#include "foamCases/rheology/column.h"

#include <gtest/gtest.h>

#include <numeric>

namespace flowrest::rheology {
namespace {

double concrete(const Column& column) {
  return std::inner_product(column.fraction.begin(), column.fraction.end(), column.volume.begin(), 0.0);
}

TEST(Column, AirUnderConcreteIsTrappedAndAirOverItIsNot) {
  const Column column{{0.2, 1.0, 0.5, 0.0}, {1.0, 2.0, 2.0, 2.0}};
  EXPECT_EQ(trapped_air(column), (std::vector<double>{0.8, 0.0, 0.0, 0.0}));
}

TEST(Column, AThinLipTrapsNothing) {
  const Column column{{0.0, 0.6, 0.0}, {1.0, 1.0, 1.0}};
  EXPECT_EQ(trapped_air(column), (std::vector<double>{0.0, 0.0, 0.0}));
}

TEST(Column, RisingAirMakesConcreteComeDownAndLosesNone) {
  Column column{{0.2, 0.7, 1.0, 0.3, 0.0}, {1.0, 2.0, 2.0, 1.0, 1.0}};
  const double before = concrete(column);
  EXPECT_DOUBLE_EQ(let_air_rise(column, 0.5), 0.5 * (0.8 + 0.6));
  EXPECT_NEAR(concrete(column), before, 1e-15);
  EXPECT_DOUBLE_EQ(column.fraction[0], 0.6);
  EXPECT_DOUBLE_EQ(column.fraction[1], 0.85);
  EXPECT_DOUBLE_EQ(column.fraction[3], 0.0);  // first what lies on top
  EXPECT_DOUBLE_EQ(column.fraction[2], 0.8);
}

TEST(Column, AFullColumnAndAnEmptyOneStay) {
  for (const double fraction : {0.0, 1.0}) {
    Column column{{fraction, fraction}, {1.0, 1.0}};
    EXPECT_EQ(let_air_rise(column, 1.0), 0.0);
    EXPECT_EQ(column.fraction, (std::vector<double>{fraction, fraction}));
  }
}

}  // namespace
}  // namespace flowrest::rheology
