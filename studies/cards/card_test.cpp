#include "studies/cards/card.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

#include "runs/errors.h"
#include "runs/temporary_folder.h"
#include "scenes/scene.h"

using namespace flowrest;
using namespace flowrest::studies::cards;
using ::testing::HasSubstr;

namespace {

const char* const good = R"(
title = "A slump"
statement = "A cone."
source = "somebody"
[[target]]
quantity = "spread_mm"
at = 10.0
value = 532.5
uncertainty = 1.0
[[target]]
quantity = "height_mm"
value = 38.3
uncertainty = 0.5
)";

std::string refusal(const std::string& text) {
  try {
    parse_card(text, "card.toml");
  } catch (const scenes::SceneError& error) {
    return error.what();
  }
  return "";
}

std::string changed(const std::string& from, const std::string& to) {
  std::string text = good;
  text.replace(text.find(from), from.size(), to);
  return text;
}

struct AnAnswer : ::testing::Test {
  std::filesystem::path answer(const std::string& text) {
    const auto path = folder.path() / "answer.csv";
    std::ofstream(path) << text;
    return path;
  }
  runs::TemporaryFolder folder;
  Card card = parse_card(good, "card.toml");
};

}  // namespace

TEST(Cards, AllThatWeBringAreReadAndKnowHowWellTheyKnow) {
  const auto names = card_names();
  EXPECT_GE(names.size(), 10u);
  for (const std::string& name : names) {
    const Card card = load_card(name);
    EXPECT_EQ(card.name, name);
    EXPECT_GT(card.statement.size(), 200u) << name;
    for (const Target& target : card.targets) EXPECT_GT(target.uncertainty, 0.0) << name;
    EXPECT_THAT(shown(card), HasSubstr(card.title));
  }
}

TEST(Cards, WhatIsWrongIsNamedByLine) {
  EXPECT_THAT(refusal(changed("source = \"somebody\"", "")), HasSubstr("source is missing"));
  EXPECT_THAT(refusal(changed("uncertainty = 1.0", "uncertainty = 0")),
              HasSubstr("card.toml:9:15: target.uncertainty must be above 0"));
  EXPECT_THAT(
      refusal(changed("at = 10.0", "when = 10.0")),
      HasSubstr(
          R"(card.toml:7:1: unknown key "target.when"; allowed: quantity, at, value, uncertainty, note)"));
  EXPECT_THAT(refusal(changed("value = 532.5", "")), HasSubstr("target.value is missing"));
  EXPECT_THAT(refusal(changed("\"somebody\"", "\"somebody")), HasSubstr("card.toml:4:"));
  EXPECT_THROW(load_card("no-such-card"), scenes::SceneError);
}

TEST_F(AnAnswer, ByTimeAgreesOrMissesByItsUncertainty) {
  const auto judged = judge(card, answer("time_s,spread_mm,height_mm\n0,200,300\n9,531,50\n11,533,38.9\n"));
  ASSERT_EQ(judged.size(), 2u);
  EXPECT_DOUBLE_EQ(judged[0].answer.value(), 532.0);  // linear in between
  EXPECT_EQ(judged[0].verdict, Judged::Verdict::agrees);
  EXPECT_EQ(judged[1].verdict, Judged::Verdict::agrees);
  EXPECT_TRUE(agrees(judged));
  EXPECT_FALSE(agrees(judge(card, answer("time_s,spread_mm,height_mm\n0,200,300\n9,531,50\n11,533,39.9\n"))));
}

TEST_F(AnAnswer, ShiftedByThreeUncertaintiesMisses) {
  for (const double shift : {-3.0, 3.0}) {
    const auto judged = judge(card, answer(fmt::format("quantity,value\nspread_mm,{}\nheight_mm,{}\n",
                                                       532.5 + shift * 1.0, 38.3 + shift * 0.5)));
    for (const Judged& j : judged) EXPECT_EQ(j.verdict, Judged::Verdict::misses) << j.target.quantity;
  }
}

TEST_F(AnAnswer, ThatLacksSomethingSaysWhat) {
  const auto judged = judge(card, answer("time_s,spread_mm\n0,200\n9,531\n"));
  EXPECT_EQ(judged[0].verdict, Judged::Verdict::absent);
  EXPECT_EQ(judged[0].why, "it goes from 0 to 9 s");
  EXPECT_EQ(judged[1].why, "there is no column height_mm");
  EXPECT_FALSE(agrees(judged));
  EXPECT_THAT(to_json(card, judged), HasSubstr("\"verdict\":\"absent\""));
  EXPECT_THROW(judge(card, answer("radius_m,depth_m\n0,0\n")), runs::RunError);
}
