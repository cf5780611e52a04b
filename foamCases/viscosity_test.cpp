#include "foamCases/viscosity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flowrest::foam {
namespace {

scenes::Material material(double yield_stress, double plastic_viscosity, double m) {
  scenes::Material result;
  result.density = 2300.0;
  result.yield_stress = yield_stress;
  result.plastic_viscosity = plastic_viscosity;
  result.regularisation_time = m;
  result.critical_shear_rate = 1.0 / m;
  return result;
}

/// As OpenFOAM reads a table: linear between rows, held beyond the last.
double interpolated(const std::vector<TablePoint>& table, double rate) {
  if (rate >= table.back().shear_rate) return table.back().kinematic_viscosity;
  const auto above = std::upper_bound(table.begin(), table.end(), rate,
                                      [](double r, const TablePoint& point) { return r < point.shear_rate; });
  const auto below = above - 1;
  const double share = (rate - below->shear_rate) / (above->shear_rate - below->shear_rate);
  return below->kinematic_viscosity + share * (above->kinematic_viscosity - below->kinematic_viscosity);
}

class PapanastasiouTable : public ::testing::TestWithParam<scenes::Material> {};

TEST_P(PapanastasiouTable, FollowsTheLawToOneInAThousand) {
  const auto& concrete = GetParam();
  const auto table = regularised_table(concrete);
  ASSERT_EQ(table.front().shear_rate, 0.0);
  // From far below the first row to ten times past the last one that matters.
  for (double rate = 1e-9; rate < 1e5; rate *= 1.0137) {
    const double exact =
        (concrete.plastic_viscosity +
         concrete.yield_stress * (1.0 - std::exp(-*concrete.regularisation_time * rate)) / rate) /
        concrete.density;
    // 1 - exp loses digits at small rates; the law's own limit is taken there.
    const double law =
        rate * *concrete.regularisation_time > 1e-6 ? exact : regularised_viscosity(concrete, 0.0);
    ASSERT_NEAR(interpolated(table, rate) / law, 1.0, 1e-3) << "at " << rate << " 1/s";
  }
}

INSTANTIATE_TEST_SUITE_P(Materials, PapanastasiouTable,
                         ::testing::Values(material(50, 50, 100), material(50, 50, 20),
                                           material(50, 50, 1000), material(200, 5, 1e4),
                                           material(1, 500, 100), material(10, 0.5, 10)));

TEST(PapanastasiouTable, AscendsEvenWithoutPlasticViscosity) {
  const auto table = regularised_table(material(50, 0, 100));
  for (std::size_t i = 1; i < table.size(); ++i) {
    ASSERT_GT(table[i].shear_rate, table[i - 1].shear_rate);
    ASSERT_LT(table[i].kinematic_viscosity, table[i - 1].kinematic_viscosity);
  }
}

TEST(HerschelBulkleyTable, FollowsThePowerToOneInAThousand) {
  for (const double n : {0.3, 0.7, 1.3, 1.5}) {
    auto concrete = material(50, 30, 100);
    concrete.flow_index = n;
    const auto table = regularised_table(concrete);
    for (double rate = 1e-9; rate < 1e5; rate *= 1.0137) {
      const double yield_part = -std::expm1(-100.0 * rate) / rate * 50.0;
      const double power = 30.0 * std::pow(std::hypot(rate, 0.01), n - 1.0);
      ASSERT_NEAR(interpolated(table, rate) * concrete.density / (yield_part + power), 1.0, 1e-3)
          << "n = " << n << " at " << rate << " 1/s";
    }
  }
}

TEST(BiViscous, BranchesMeetAtTheCriticalShearRate) {
  auto concrete = material(50, 50, 100);
  concrete.model = scenes::Model::bi_viscous;
  const double rate = *concrete.critical_shear_rate;
  const double flowing = (concrete.yield_stress / rate + concrete.plastic_viscosity) / concrete.density;
  EXPECT_DOUBLE_EQ(viscosity_at_rest(concrete), flowing);
}

}  // namespace
}  // namespace flowrest::foam
