#include "foamCases/field_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "foamCases/test_scene.h"

namespace flowrest::foam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string header(const std::string& format) {
  return "FoamFile\n{\n    version 2.0;\n    format " + format +
         ";\n    class volScalarField;\n    object f;\n}\n" +
         "dimensions [0 0 0 0 0 0 0];\n\ninternalField   ";
}

std::string bytes_of(const std::vector<double>& values) {
  std::string bytes(values.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

TEST(FieldFile, ReadsLabelsInTextAndAsBytes) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "cellProcAddressing";
  const std::string head =
      "/* banner */\nFoamFile\n{\n    format      FORMAT;\n    class labelList;\n}\n// * * //\n\n\n3\n(";
  auto text = head;
  std::ofstream(path) << text.replace(text.find("FORMAT"), 6, "ascii") << "4\n0\n7\n)\n";
  EXPECT_EQ(read_labels(path), (std::vector<int>{4, 0, 7}));
  auto bytes = head;
  bytes.replace(bytes.find("FORMAT"), 6, "binary");
  for (const std::int32_t label : {5, -1, 70000})
    bytes.append(reinterpret_cast<const char*>(&label), sizeof label);
  std::ofstream(path, std::ios::binary) << bytes << ")";
  EXPECT_EQ(read_labels(path), (std::vector<int>{5, -1, 70000}));
  std::ofstream(path, std::ios::binary) << bytes.substr(0, bytes.size() - 2);
  EXPECT_THROW(read_labels(path), FieldError);
}

TEST(FieldFile, ReadsUniformFields) {
  EXPECT_THAT(parse_internal_field(header("ascii") + "uniform 0.25;\n", "f", 3, 1),
              ElementsAre(0.25, 0.25, 0.25));
  EXPECT_THAT(parse_internal_field(header("binary") + "uniform (1 0 -2);\n", "f", 2, 3),
              ElementsAre(1, 0, -2, 1, 0, -2));
}

TEST(FieldFile, ReadsAsciiLists) {
  EXPECT_THAT(parse_internal_field(header("ascii") + "nonuniform List<scalar> \n3\n(\n0\n1e-3\n-0.5\n)\n;\n",
                                   "f", 3, 1),
              ElementsAre(0, 1e-3, -0.5));
  EXPECT_THAT(parse_internal_field(
                  header("ascii") + "nonuniform List<vector> \n2\n(\n(1 2 3)\n(4 5 6)\n)\n;\n", "f", 2, 3),
              ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(FieldFile, ReadsBinaryListsToTheLastBit) {
  // The second holds the bytes of blanks and brackets, which must not be taken for text.
  const std::vector<double> values{0.1, std::bit_cast<double>(0x2928290a20282928ULL), -1e300};
  const std::string text = header("binary") + "nonuniform List<scalar> \n3\n(" + bytes_of(values) + ")\n;\n";
  EXPECT_EQ(parse_internal_field(text, "f", 3, 1), values);
}

TEST(FieldFile, RefusesWhatIsNotWholeOrNotOfTheMesh) {
  const std::string whole =
      header("binary") + "nonuniform List<scalar> \n3\n(" + bytes_of({1, 2, 3}) + ")\n;\n";
  for (std::size_t length = 0; length < whole.size() - 3; ++length)
    EXPECT_THROW(parse_internal_field(whole.substr(0, length), "f", 3, 1), FieldError) << length;
  try {
    parse_internal_field(whole, "alpha.concrete", 4, 1);
    FAIL() << "a field of another mesh was read";
  } catch (const FieldError& error) {
    EXPECT_THAT(error.what(), HasSubstr("alpha.concrete: it holds 3 cells, the mesh has 4"));
  }
  EXPECT_THROW(parse_internal_field(header("ascii") + "uniform zero;\n", "f", 1, 1), FieldError);
  EXPECT_THROW(read_internal_field("no-such-field", 1, 1), FieldError);
}

}  // namespace
}  // namespace flowrest::foam
