#include "runs/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::runs;
namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

namespace {

class Csv : public testing::Test {
 protected:
  Table table_of(const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return read_csv(path, true);
  }

  /// What is said against a file, without its folder.
  std::string refusal(const std::string& text) {
    try {
      table_of(text);
    } catch (const RunError& error) {
      const std::string what = error.what();
      return what.starts_with(temporary.path().string()) ? what.substr(temporary.path().string().size() + 1)
                                                         : what;
    }
    return "nothing was thrown";
  }

  /// Reads as 0, 200 and 1.5, 345.25.
  void expect_spread(const std::string& text) {
    const Table table = table_of(text);
    ASSERT_THAT(table.names, ElementsAre("time_s", "spread_mm")) << text;
    EXPECT_THAT(table.columns[0], ElementsAre(0.0, 1.5)) << text;
    EXPECT_THAT(table.columns[1], ElementsAre(200.0, 345.25)) << text;
  }

  TemporaryFolder temporary;
  fs::path path = temporary.path() / "measured.csv";
};

}  // namespace

TEST_F(Csv, ReadsWhatSpreadsheetsWrite) {
  const std::string plain = "time_s,spread_mm\n0,200\n1.5,345.25\n";
  expect_spread(plain);
  expect_spread("\xEF\xBB\xBF" + plain);                                           // a byte order mark
  expect_spread("time_s,spread_mm\r\n0,200\r\n1.5,345.25\r\n");                    // Windows
  expect_spread("time_s,spread_mm\r0,200\r1.5,345.25\r");                          // Macs of old
  expect_spread("time_s;spread_mm\n0;200\n1.5;345.25\n");                          // semicolons
  expect_spread("time_s;spread_mm\n0;200\n1,5;345,25\n");                          // and decimal commas
  expect_spread("time_s\tspread_mm\n0\t200\n1.5\t345.25\n");                       // tabs
  expect_spread("time_s\tspread_mm\n0\t200\n1,5\t345,25\n");                       // tabs and decimal commas
  expect_spread("\"time_s\",\"spread_mm\"\n\"0\",\"200\"\n\"1,5\",\"345,25\"\n");  // all in quotes
  expect_spread("sep=;\ntime_s;spread_mm\n0;200\n1,5;345,25\n");                   // with Excel's hint
  expect_spread("time_s,spread_mm,,\n0,200,,\n1.5,345.25\n,,,\n\n");               // empty columns and rows
  expect_spread("# measured on Monday\n\ntime_s,spread_mm\n0,200\n# a pause\n1.5,345.25");
  expect_spread("\xEF\xBB\xBFtime_s;spread_mm;\r\n0;200;\r\n1,5;3,4525e2;\r\n;;\r\n");  // all at once
}

TEST_F(Csv, ReadsThousandsThatAreBeyondDoubt) {
  const auto values = [this](const std::string& text) { return table_of(text).columns.back(); };
  EXPECT_THAT(values("time_s;pressure_Pa\n0;1.234,5\n1;12.345.678,25\n"), ElementsAre(1234.5, 12345678.25));
  EXPECT_THAT(values("time_s,pressure_Pa\n0,\"1,234.5\"\n1,\"12,345,678.25\"\n"),
              ElementsAre(1234.5, 12345678.25));
  EXPECT_THAT(values("time_s;pressure_Pa\n0;1 234,5\n1;12\xC2\xA0"
                     "345,25\n2;1\xE2\x80\xAF"
                     "234\n"),
              ElementsAre(1234.5, 12345.25, 1234.0));
  EXPECT_THAT(values("time_s,pressure_Pa\n0,1'234.5\n"), ElementsAre(1234.5));
  // In a file whose cells semicolons part, the comma is the decimal mark, three digits or not.
  EXPECT_THAT(values("time_s;spread_mm\n0;200,125\n1;345,250\n"), ElementsAre(200.125, 345.25));
  EXPECT_THAT(values("time_s;spread_mm\n0;200.125\n1;345.250\n"), ElementsAre(200.125, 345.25));
}

TEST_F(Csv, NamesTheCauseWhereTwoReadingsAreOpen) {
  EXPECT_THAT(refusal("time_s;spread_mm\n0;200.5\n1;345,25\n"),
              AllOf(StartsWith("measured.csv:3: '345,25' does not go with '200.5' ("),
                    HasSubstr("measured.csv:2"), HasSubstr("allowed: one of them throughout")));
  EXPECT_THAT(refusal("time_s;spread_mm\n0,5;200\n1;1.345\n"),
              StartsWith("measured.csv:3: '1.345' does not go with"));
  EXPECT_THAT(refusal("time_s\tspread_mm\n0\t200\n1\t1,345\n"),
              AllOf(StartsWith("measured.csv:3: '1,345' may be a number with decimals or one of thousands"),
                    HasSubstr("allowed: decimals with a point")));
  EXPECT_THAT(refusal("time_s\tforce_N\n0\t-1,345\n"), StartsWith("measured.csv:2: '-1,345' may be"));
  EXPECT_THAT(
      refusal("time_s;spread,mm\n0;200\n"),
      AllOf(StartsWith("measured.csv:1: the header holds commas and semicolons"), HasSubstr("allowed")));
}

TEST_F(Csv, NamesTheCauseWhereItIsNoSuchTable) {
  EXPECT_THAT(refusal(std::string("\xFF\xFEt\0i\0m\0e\0", 10)),
              AllOf(StartsWith("measured.csv:1: is text in UTF-16"), HasSubstr("allowed: text in UTF-8")));
  EXPECT_THAT(refusal(std::string("t\0i\0m\0e\0_\0s\0\n\0", 14)),
              StartsWith("measured.csv:1: is text in UTF-16"));
  EXPECT_THAT(refusal("PK\x03\x04 and so on"), HasSubstr("a spreadsheet's own file"));
  EXPECT_THAT(refusal("time_s spread_mm\n0 200\n"),
              AllOf(StartsWith("measured.csv:1: the header is parted by blanks"), HasSubstr("allowed")));
  EXPECT_THAT(refusal("time_s|spread_mm\n0|200\n"), HasSubstr("parted by bars"));
  EXPECT_THAT(refusal("0,200\n1,300\n"),
              StartsWith("measured.csv:1: the first line holds numbers; a header"));
  EXPECT_THAT(refusal("time_s,\"spread_mm\n0,200\n"), StartsWith("measured.csv:1: a quote is opened"));
  EXPECT_THAT(refusal("time_s,spread_mm\n0,\"200\"mm\n"), StartsWith("measured.csv:2: a cell goes on after"));
  EXPECT_THAT(refusal("time_s,,spread_mm\n0,1,2\n"), StartsWith("measured.csv:1: column 2 is unnamed"));
  EXPECT_THAT(refusal("time_s,spread_mm\n0,200,7\n"),
              StartsWith("measured.csv:2: 3 values where the header names 2"));
  EXPECT_THAT(refusal("time_s,spread_mm\n\n# why\n0,soon\n"),
              StartsWith("measured.csv:4: 'soon' in column spread_mm is not"));
}

TEST_F(Csv, ACellInQuotesHoldsWhatItLikes) {
  std::ofstream(path, std::ios::binary) << "scene,source\r\na,\"one, \"\"two\"\"\nand three\"\r\nb,plain\r\n";
  const CsvText text = read_csv_text(path);
  ASSERT_EQ(text.rows.size(), 2u);
  EXPECT_EQ(text.rows[0].cells[1], "one, \"two\"\nand three");
  EXPECT_EQ(text.rows[1].line, 4u) << "its line of the file";
}

TEST_F(Csv, ALastLineWithoutItsEndWasCutOff) {
  std::ofstream(path, std::ios::binary) << "time_s;spread_mm\r\n0;200\r\n1;3";
  EXPECT_EQ(read_csv(path).rows(), 1u);
  EXPECT_EQ(read_csv(path, true).rows(), 2u);
}

TEST_F(Csv, ARunMeasuredInASpreadsheetIsRead) {
  const fs::path run = temporary.path() / "run";
  fs::create_directory(run);
  std::ofstream(run / "run.json") << R"({"format": "flowrest run", "format_version": 1, "title": "Slump",
    "kind": "slump", "solver": "measured", "status": "at-rest"})";
  std::ofstream(run / "history.csv", std::ios::binary)
      << "\xEF\xBB\xBFtime_s;spread_mm\r\n0;200\r\n1,5;345,25\r\n";
  std::ofstream(run / "profiles.csv", std::ios::binary)
      << "time_s;r_m;depth_m\r\n\r\n1,5;0,01;0,1\r\n0;0,01;0,1\r\n";
  try {
    read_run(run);
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("profiles.csv:4: time 0 does not follow 1.5"))
        << "the line of the file";
  }
  std::ofstream(run / "profiles.csv", std::ios::binary)
      << "time_s;r_m;depth_m\r\n0;0,01;0,1\r\n1,5;0,01;0,25\r\n";
  EXPECT_THAT(read_run(run).history.at("spread_mm"), ElementsAre(200.0, 345.25));
  EXPECT_THAT(read_run(run).profiles.back().value, ElementsAre(0.25));
}
