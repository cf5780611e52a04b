#include "studies/ledger.h"

#include <gmock/gmock.h>

#include <fstream>

#include "runs/errors.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::studies::ledger;
using ::testing::HasSubstr;

namespace {

Entry entry(const std::string& commit, double error) {
  Entry e;
  e.date = "2026-12-01";
  e.commit = commit;
  e.sources = "tree of " + commit;
  e.quantity = "A duct, Bingham: relative L2, of the \"velocity\"";
  e.solver = "MPM, double";
  e.settings = "cell 0.0125";
  e.value = 1.3 + error;
  e.reference = 1.3;
  e.error = error;
  e.uncertainty = 1e-4;
  e.cpu = 2.5;
  return e;
}

struct Ledger : ::testing::Test {
  runs::TemporaryFolder folder;
  std::filesystem::path file = folder / "some folder";
  Ledger() { file /= "ledger.csv"; }
};

}  // namespace

TEST_F(Ledger, KeepsWhatItIsTold) {
  EXPECT_TRUE(read(file).empty());
  EXPECT_EQ(append(file, {entry("aaa", 0.01)}), 1u);
  EXPECT_EQ(append(file, {entry("bbb", 0.02)}), 1u);
  const auto rows = read(file);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].key(), entry("aaa", 0.01).key());
  EXPECT_EQ(rows[1].commit, "bbb");
  EXPECT_DOUBLE_EQ(rows[1].error, 0.02);
  EXPECT_DOUBLE_EQ(rows[1].reference.value(), 1.3);
  EXPECT_DOUBLE_EQ(rows[1].uncertainty.value(), 1e-4);
}

TEST_F(Ledger, OnlyGrowsAndTakesTheSameSourcesOnce) {
  append(file, {entry("aaa", 0.01)});
  std::ifstream before_file(file);
  const std::string before(std::istreambuf_iterator<char>(before_file), {});
  EXPECT_EQ(append(file, {entry("aaa", 0.05)}), 0u);
  EXPECT_EQ(append(file, {entry("bbb", 0.01)}), 1u);
  std::ifstream after_file(file);
  const std::string after(std::istreambuf_iterator<char>(after_file), {});
  EXPECT_EQ(after.substr(0, before.size()), before);
}

TEST_F(Ledger, NamesWhatGotWorseBeyondItsUncertaintyAndNothingElse) {
  const std::vector<Entry> there = {entry("aaa", 0.5), entry("bbb", 0.01)};
  const auto change = [&](double error) { return changes(there, {entry("ccc", error)}).front(); };
  EXPECT_EQ(change(0.01).before.commit, "bbb") << "the last row counts";
  EXPECT_FALSE(change(0.01).worse());
  EXPECT_FALSE(change(0.0102).worse());
  EXPECT_TRUE(change(0.011).worse());
  EXPECT_FALSE(change(0.001).worse());
  Entry other = entry("ccc", 9.0);
  other.settings = "cell 1";
  EXPECT_TRUE(changes(there, {other}).empty()) << "nothing to hold it against";
}

TEST_F(Ledger, SaysWhatIsNoLedger) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << "a,b\n1,2\n";
  try {
    read(file);
    FAIL();
  } catch (const runs::RunError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("ledger.csv:1: its columns are not a ledger's; needed: date,commit,"));
  }
}

TEST_F(Ledger, ItsPageShowsEveryQuantityOverTheCommits) {
  const auto page = page_of({entry("aaa", 0.01), entry("bbb", 0.02)});
  EXPECT_THAT(page.words.front().index(), 0u);
  ASSERT_EQ(page.chapters.size(), 3u);
  const auto& plot = std::get<report::Plot>(page.chapters.back().blocks.front());
  EXPECT_EQ(plot.curves.front().x, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(plot.curves.front().y, (std::vector<double>{0.01, 0.02}));
  const auto& table = std::get<report::Table>(page.chapters.front().blocks.front());
  EXPECT_EQ(table.rows.front().badge, "worse");
}
