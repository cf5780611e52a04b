#include "runs/columns.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <set>
#include <string>

#include "runs/depth.h"

namespace flowrest::runs {
namespace {

TEST(Columns, EachStandsOnceAndSaysWhatItIs) {
  std::set<std::string> names;
  for (const Column* column : every_column()) {
    EXPECT_TRUE(names.insert(column->name).second) << column->name;
    EXPECT_EQ(column_named(column->name), column);
    EXPECT_FALSE(std::string(column->meaning).empty()) << column->name;
    EXPECT_EQ(column->read_at == nullptr, column->threshold == nullptr) << column->name;
  }
  EXPECT_EQ(column_named("spread_furlongs"), nullptr);
}

TEST(Columns, EndInTheirUnit) {
  for (const Column* column : every_column()) {
    std::string unit = column->unit;
    for (char& c : unit)
      if (c == '/') c = '_';
    const std::string suffix = unit.empty() ? "" : "_" + unit;
    EXPECT_TRUE(std::string(column->name).ends_with(suffix)) << column->name << " in " << column->unit;
    EXPECT_EQ(column->per_si, unit == "mm" ? 1e3 : unit == "mm2" ? 1e6 : 1.0) << column->name;
  }
}

TEST(Row, HasValuesInTheColumnsUnits) {
  Row row;
  row.add(column::time, 2.0).add(Row().add(column::spread, 0.5).add(column::height, nothing));
  EXPECT_EQ(row.names(), (std::vector<std::string>{"time_s", "spread_mm", "height_mm"}));
  EXPECT_EQ(row.values()[1], 500.0);
  EXPECT_TRUE(std::isnan(row.values()[2]));
}

}  // namespace
}  // namespace flowrest::runs
