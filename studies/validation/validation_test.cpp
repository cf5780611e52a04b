#include "studies/validation/validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "compare/apparatus/apparatus.h"
#include "compare/report/browser.h"
#include "compare/synthetic_runs.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::studies;
using namespace flowrest::studies::validation;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

class ValidationTest : public testing::Test {
 protected:
  ValidationTest() { options.folder = folder.root; }

  /// A slump that spreads as end (1 - exp(-5 t)) from 200 mm, with flocs that break and, in a fluid, grow
  /// again.
  void make(const Wanted& wanted, double end, runs::Status status = runs::Status::end_time) const {
    const scenes::Scene& scene = *wanted.point.scene;
    const bool solid = wanted.model == scenes::Model::elasto_viscoplastic;
    const double stops = solid ? 1.0 : 20.0;
    runs::RunWriter writer(folder.run(wanted.point.id), scene, to_string(wanted.solver));
    writer.history_columns({"time_s", "spread_mm", "shear_rate_p99_1_s", "flocculation_mean"});
    for (int i = 0; 0.05 * i <= stops + 1e-9; ++i) {
      const double time = 0.05 * i, creep = solid ? 0.0 : 0.25 * time;
      writer.history(std::vector{time, 200.0 + (end - 200.0) * (1.0 - std::exp(-5.0 * time)) + creep, 1.0,
                                 time < 1.0 ? 2.8 - time : 1.8 + 0.002 * (time - 1.0)});
    }
    writer.info()["cpu_s"] = 2.0;
    if (solid) writer.info()["rest_time_s"] = stops;
    writer.finish(solid && status == runs::Status::end_time ? runs::Status::at_rest : status, "", "sound");
    fs::create_directories(folder.mark(wanted.point.id).parent_path());
    std::ofstream(folder.mark(wanted.point.id)) << nlohmann::ordered_json{
        {"ending", "finished"}, {"settings", nlohmann::ordered_json::parse(scenes::resolved_json(scene))}};
  }

  runs::TemporaryFolder temporary;
  Folder folder{temporary.path()};
  Options options{.scenes = {"mix-a-slump-sf600"}, .solver = Solver::mpm};
};

Number number(double measured, double allowed, std::optional<double> ours, std::optional<double> uncertainty,
              Mark mark = Mark::independent) {
  Number n;
  n.published = {"scene", "spread_mm", measured, std::nullopt, allowed, mark, "Table"};
  n.ours = ours;
  n.coarse = ours;
  n.uncertainty = uncertainty;
  n.verdict = Verdict::never;
  judge(n);
  return n;
}

}  // namespace

TEST(Judgement, IsPlain) {
  EXPECT_EQ(number(500, 30, 520.0, 10.0).words, "agrees");
  EXPECT_EQ(number(500, 30, 520.0, 10.0, Mark::circular).words,
            "agrees, but the scene's yield stress was computed back from it");
  EXPECT_EQ(number(500, 30, 540.0, 10.0).words, "misses by 40 mm, 30 mm are allowed");
  const Number within = number(500, 30, 510.0, 45.0), off = number(500, 30, 560.0, 45.0),
               far = number(500, 30, 580.0, 45.0);
  EXPECT_EQ(within.verdict, Verdict::unresolved) << "what is known less well than is allowed cannot agree";
  EXPECT_EQ(within.words, "unresolved: within the 30 mm allowed, but known to ± 45 mm only");
  EXPECT_EQ(off.verdict, Verdict::unresolved) << "what is allowed is within reach of what the grids know";
  EXPECT_EQ(off.words, "unresolved: 60 mm off, 30 mm are allowed, but known to ± 45 mm only");
  EXPECT_EQ(far.words, "misses by 80 mm, 30 mm are allowed") << "no grid takes it there";
  const Number one_grid = number(500, 30, 500.0, std::nullopt);
  EXPECT_EQ(one_grid.verdict, Verdict::unresolved) << "one grid knows nothing";
  EXPECT_EQ(one_grid.within, true);
  EXPECT_EQ(number(500, 30, std::nullopt, std::nullopt).words, "never happens");
  Number fluid;
  fluid.published = {"scene", "rest_s", 10.0, std::nullopt, 3.0, Mark::independent, "Table"};
  fluid.model = scenes::Model::papanastasiou;
  fluid.verdict = Verdict::never;
  judge(fluid);
  EXPECT_EQ(fluid.words, "a fluid never rests");
}

/// 20 mm short of a wall may be within what is allowed; to stop there, and to be stopped by the wall, is not
/// the same.
TEST(Judgement, WhatAWallStoppedDidNotStopShortOfIt) {
  Number front;
  front.published = {"scene", "front_mm", 580.0, std::nullopt, 30.0, Mark::independent, "Table"};
  front.ours = front.coarse = 600.0;
  front.uncertainty = 0.0;
  judge(front);
  EXPECT_EQ(front.words, "agrees") << "where no wall is known";
  front.wall = 600.0;
  judge(front);
  EXPECT_EQ(front.verdict, Verdict::misses);
  EXPECT_EQ(front.within, false);
  EXPECT_EQ(front.words, "misses: it reaches the wall at 600 mm, before which it should stop");
  front.ours = 590.0;
  judge(front);
  EXPECT_EQ(front.words, "agrees");
}

TEST(Published, EveryRowIsOfASceneThatThereIs) {
  const auto published = read_published();
  EXPECT_GE(published.size(), 28u);
  for (const Published& p : published) {
    EXPECT_NO_THROW(scenes::load_scene(p.scene)) << p.scene;
    EXPECT_TRUE(p.target()) << p.scene;
    EXPECT_GT(p.allowed, 0.0) << p.scene;
  }
  for (const PaperItem& item : read_paper_items())
    EXPECT_NO_THROW(scenes::load_scene(item.scene)) << item.scene;
}

TEST_F(ValidationTest, EveryPaperSceneCanBeRunAtBothResolutions) {
  options.scenes.clear();
  options.solver.reset();
  for (const SceneWanted& scene : plan(options))
    for (std::size_t i = 0; i + 1 < scene.runs.size(); i += 2) {
      const double ratio = scene.runs[i + 1].cell / scene.runs[i].cell;
      EXPECT_NEAR(ratio, options.coarsening, 0.05 * options.coarsening) << scene.name;
      EXPECT_GT(expected_cost(scene.runs[i].point).cpu_seconds,
                expected_cost(scene.runs[i + 1].point).cpu_seconds)
          << scene.runs[i].point.label;
    }
}

TEST_F(ValidationTest, AMalformedTableIsRefusedWithItsLine) {
  const char* before = std::getenv("FLOWREST_SCENES");
  const std::string kept = before ? before : "";
  setenv("FLOWREST_SCENES", folder.root.c_str(), 1);
  const auto complaint = [&](const std::string& row) -> std::string {
    std::ofstream(folder.root / "published.csv")
        << "# comment\nscene,quantity,measured,paper,allowed,mark,source,model\n"
        << row << "\n";
    try {
      read_published();
    } catch (const runs::RunError& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(complaint("s,spread_mm,1,,2,,Table"), "taken");
  EXPECT_THAT(complaint("s,spread_mm,1x,,2,,Table"), HasSubstr("published.csv:3: '1x' is no number"));
  EXPECT_THAT(complaint("s,spread_mm,1"), HasSubstr(":3: has 3 cells; expected: 7 to 8"));
  EXPECT_THAT(complaint("s,spread_mm,1,,2,fitted,Table"), HasSubstr("allowed: calibrated, circular"));
  before ? setenv("FLOWREST_SCENES", kept.c_str(), 1) : unsetenv("FLOWREST_SCENES");
}

TEST_F(ValidationTest, HoldsTwoGridsOfEveryLawAgainstWhatIsPublished) {
  const auto wanted = plan(options);
  ASSERT_EQ(wanted.size(), 1u);
  ASSERT_EQ(wanted[0].runs.size(), 4u) << "two laws on two grids";
  for (const Wanted& run : wanted[0].runs) make(run, run.coarse ? 474.0 : 470.0);
  const Validation found = collect(folder, wanted, options);
  const SceneFound& scene = found.scenes.at(0);
  ASSERT_EQ(scene.numbers.size(), 2u) << "one published number, two laws";
  const Number& solid = scene.numbers[0];
  // exp(-5) of 270 mm is still to come; the grids differ by 4 (1 - exp(-5)) mm on cells 4/3 apart.
  EXPECT_NEAR(*solid.ours, 470.0 - 270.0 * std::exp(-5.0), 1e-9);
  EXPECT_NEAR(*solid.uncertainty, 3.0 * 4.0 * (1.0 - std::exp(-5.0)), 1e-9);
  EXPECT_EQ(solid.verdict, Verdict::agrees) << solid.words;
  ASSERT_EQ(scene.perpetual.size(), 1u);
  const Perpetual& p = scene.perpetual[0];
  EXPECT_EQ(p.rest, 1.0);
  ASSERT_EQ(p.fluid_at.size(), 4u) << "at rest, at twice and five times that, at the end";
  EXPECT_NEAR(p.fluid_at[3].second - p.fluid_at[0].second, 0.25 * 19.0 + 270.0 * std::exp(-5.0), 1e-6);
  ASSERT_EQ(scene.flocculation.size(), 2u);
  EXPECT_NEAR(scene.flocculation[0].growth_at_rest, 0.39 / 92.0, 1e-12);
  EXPECT_TRUE(scene.notes.empty());
  write(found, folder.root);
  const auto json = nlohmann::json::parse(std::ifstream(folder.root / "validation.json"));
  EXPECT_EQ(json["scenes"][0]["numbers"][0]["verdict"], "agrees");
  std::ifstream page(folder.root / "index.html");
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  EXPECT_THAT(html,
              HasSubstr("MPM elasto-viscoplastic meets 1 of 1 published numbers (1 of them calibrated or "
                        "circular, so no evidence)"));
  std::ifstream csv(folder.root / "validation.csv");
  const std::string rows{std::istreambuf_iterator<char>(csv), {}};
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3);
}

namespace {

Found run_of(Solver solver, scenes::Model model, double end_gauge, std::optional<double> rest,
             std::optional<double> arrival, double creep) {
  Found run;
  run.wanted.solver = solver;
  run.wanted.model = model;
  run.outcome.ending = Ending::finished;
  run.end = 20.0;
  run.gauge_end = end_gauge;
  run.rest = rest;
  run.arrival = arrival;
  run.creep = creep;
  return run;
}

Number number_of(const std::string& scene, const std::string& quantity, double paper,
                 std::optional<double> ours, scenes::Model model, const std::string& source) {
  Number n;
  n.published = {scene, quantity, std::nullopt, paper, 0.1 * paper, Mark::independent, source, model};
  n.model = model;
  n.ours = ours;
  n.coarse = ours;
  n.within = ours && std::abs(*ours - paper) <= 0.1 * paper;
  return n;
}

/// The verdict and the words of a claim in one law.
using Said = std::pair<std::string, std::string>;
Said found_of(const std::vector<Finding>& all, const std::string& claim, const std::string& law) {
  for (const Finding& f : all)
    if (f.claim.find(claim) != std::string::npos && f.law == law) return {to_string(f.holds), f.seen};
  return {"no such claim", ""};
}

constexpr auto solid_law = scenes::Model::elasto_viscoplastic, fluid_law = scenes::Model::papanastasiou;
constexpr const char *solid_name = "elasto-viscoplastic", *fluid_name = "papanastasiou";

}  // namespace

TEST(Findings, AnLBoxStopsShortInTheSolidAndNotInTheFluid) {
  SceneFound box{.name = "mix-b-lbox-sf0",
                 .apparatus = &compare::report_of(scenes::Apparatus(scenes::LBox{})),
                 .length_mm = 600.0};
  box.numbers = {number_of("mix-b-lbox-sf0", "front_mm", 580.0, 570.0, solid_law, "Yu Table 3")};
  box.runs = {run_of(Solver::mpm, solid_law, 570.0, 12.0, std::nullopt, 0.0),
              run_of(Solver::mpm, fluid_law, 585.0, std::nullopt, std::nullopt, 0.7)};
  auto all = findings_of({box});
  EXPECT_EQ(found_of(all, "stops short", solid_name), Said("holds", "is at 570 mm after 20 s"));
  EXPECT_EQ(found_of(all, "solid stops by itself", solid_name), Said("holds", "rests after 12 s"));
  EXPECT_EQ(found_of(all, "fluid does not stop", fluid_name),
            Said("holds", "after 20 s it still moves by 0.70 mm/s, 15 mm beyond the solid's end"));
  EXPECT_EQ(found_of(all, "stops short", fluid_name).first, "no such claim");
  // Still moving so fast that it would be at the wall in as much time again: nobody knows.
  box.runs[0] = run_of(Solver::mpm, solid_law, 570.0, std::nullopt, std::nullopt, 2.0);
  box.runs[1].creep = 0.001;
  all = findings_of({box});
  EXPECT_EQ(found_of(all, "stops short", solid_name).first, "undecided");
  EXPECT_EQ(found_of(all, "solid stops by itself", solid_name).first, "does not hold");
  EXPECT_EQ(found_of(all, "fluid does not stop", fluid_name).first, "does not hold");
  box.runs[0].arrival = 9.0;
  EXPECT_EQ(found_of(findings_of({box}), "stops short", solid_name),
            Said("does not hold", "arrives after 9.0 s"));
  box.runs[0].outcome.ending = Ending::missing;
  EXPECT_EQ(found_of(findings_of({box}), "stops short", solid_name).first, "not run");
  // Where an arrival is published, arriving is what is claimed, of every law.
  box.numbers[0].published.quantity = "arrival_s";
  box.runs[1].arrival = 3.0;
  EXPECT_EQ(found_of(findings_of({box}), "reaches the end wall", fluid_name),
            Said("holds", "arrives after 3.0 s"));
}

TEST(Findings, TheOrderOfTheFunnelsTimesIsThatOfEveryPairToldApart) {
  const auto order = [](std::vector<std::optional<double>> ours, const std::string& law) {
    std::vector<SceneFound> scenes;
    const double paper[] = {1.4, 1.5, 1.36, 1.5};
    for (std::size_t i = 0; i < ours.size(); ++i)
      scenes.push_back({.name = "funnel",
                        .apparatus = &compare::report_of(scenes::Apparatus(scenes::VFunnel{})),
                        .numbers = {number_of("funnel", "light_s", paper[i], ours[i],
                                              i < 2 ? solid_law : fluid_law, "Yu Table 4")}});
    return found_of(findings_of(scenes), "in the paper's order", law);
  };
  // 1.36 < 1.40 < 1.50 = 1.50: five of six pairs are told apart.
  EXPECT_EQ(order({1.8, 1.9, 1.7, 1.95}, "all laws"), Said("holds", "5 of 5 pairs are in order"));
  EXPECT_EQ(order({1.8, 1.9, 1.799, 1.95}, "all laws"),
            Said("undecided", "4 of 5 pairs are in order; 1 cannot be told apart"));
  EXPECT_EQ(order({1.9, 1.8, 1.7, 1.95}, solid_name),
            Said("does not hold",
                 "0 of 1 pairs are in order; the other way round: funnel (1.90 s) and funnel (1.80 s)"));
  EXPECT_EQ(order({1.8, 1.9, std::nullopt, 1.95}, "all laws").first, "undecided") << "one is not known";
}

TEST(Findings, FlocsBreakInFlowAndGrowAtRest) {
  SceneFound slump{.name = "mix-a-slump-sf600",
                   .apparatus = &compare::report_of(scenes::Apparatus(scenes::Slump{}))};
  Flocculation solid{.start = 2.8,
                     .least = 1.8,
                     .least_at = 0.6,
                     .end = 1.81,
                     .end_at = 1.2,
                     .rate_end = 0.003,
                     .held = true,
                     .growth_at_rest = 0.004};
  Flocculation fluid = solid;
  fluid.model = fluid_law;
  fluid.held = false;
  fluid.rate_end = -0.001;
  slump.flocculation = {solid, fluid};
  const auto all = findings_of({slump});
  EXPECT_EQ(found_of(all, "λ falls while", solid_name), Said("holds", "from 2.80 to 1.80 within 0.6 s"));
  EXPECT_EQ(found_of(all, "grows again", solid_name),
            Said("holds", "rests with 1.81, from where it grows by 0.004 a second"));
  EXPECT_EQ(found_of(all, "keeps falling in the fluid", fluid_name),
            Said("holds", "falls by 0.001 a second at 1.2 s, 25 % of what it has at rest"));
  slump.flocculation[1].rate_end = 0.002;
  slump.flocculation[0].least = 2.8;
  const auto other = findings_of({slump});
  EXPECT_EQ(found_of(other, "keeps falling in the fluid", fluid_name).first, "does not hold");
  EXPECT_EQ(found_of(other, "λ falls while", solid_name).first, "does not hold");
}

TEST(Findings, TableTwoIsMetByEverySpreadOnGridsThatAreClose) {
  SceneFound slump{.name = "mix-a-slump-sf0",
                   .apparatus = &compare::report_of(scenes::Apparatus(scenes::Slump{}))};
  slump.numbers = {number_of("mix-a-slump-sf0", "spread_mm", 535.0, 550.0, solid_law, "Yu Table 2")};
  slump.numbers[0].coarse = 545.0;
  EXPECT_EQ(found_of(findings_of({slump}), "one set of parameters", solid_name),
            Said("holds", "at most 15 mm too wide (mix-a-slump-sf0); two grids differ by 5 mm at most"));
  slump.numbers[0].coarse = 534.0;
  EXPECT_EQ(found_of(findings_of({slump}), "one set of parameters", solid_name).first, "does not hold");
  slump.numbers[0].coarse.reset();
  EXPECT_EQ(found_of(findings_of({slump}), "one set of parameters", solid_name).first, "undecided");
}

TEST_F(ValidationTest, AMissingRunSaysHowItIsMade) {
  const auto wanted = plan(options);
  make(wanted[0].runs[0], 470.0);
  make(wanted[0].runs[2], 470.0, runs::Status::interrupted);
  const Validation found = collect(folder, wanted, options);
  const SceneFound& scene = found.scenes.at(0);
  EXPECT_EQ(scene.numbers[0].words, "unresolved: within the 30 mm allowed, but only one resolution has it");
  EXPECT_EQ(scene.numbers[1].verdict, Verdict::incomplete);
  EXPECT_THAT(scene.numbers[1].words, HasSubstr("interrupted at 20 s"));
  ASSERT_FALSE(scene.notes.empty());
  EXPECT_THAT(scene.notes.back(), HasSubstr("`flowrest validate mix-a-slump-sf600 -o "));
  EXPECT_THAT(scene.notes.back(), HasSubstr("MPM elasto-viscoplastic, 13.33 mm cells"));
  EXPECT_NO_THROW(write(found, folder.root));
  // Nothing at all is a page, too.
  EXPECT_NO_THROW(write(collect(Folder{folder.root / "none"}, wanted, options), folder.root));
}

TEST_F(ValidationTest, WholeRunsOfTheSameSettingsAndVersionAreKept) {
  const auto wanted = plan(options);
  Study study;
  study.name = "validation";
  EXPECT_EQ(prepare(folder, study, points_of(wanted)), 4u);
  for (const Wanted& run : wanted[0].runs) make(run, 470.0);
  EXPECT_EQ(prepare(folder, study, points_of(plan(options))), 0u);
  Options changed = options;
  changed.set = {"material.yield_stress=93"};
  EXPECT_EQ(prepare(folder, study, points_of(plan(changed))), 4u);
  // A run of another version has the same name but for its mark; it is taken only where that is asked for.
  const std::string id = wanted[0].runs[0].point.id;
  const std::string other = id.substr(0, id.rfind('-')) + "-000000000000";
  fs::rename(folder.run(id), folder.run(other));
  fs::rename(folder.mark(id), folder.mark(other));
  EXPECT_EQ(prepare(folder, study, points_of(plan(options))), 1u);
  options.any_version = true;
  EXPECT_EQ(prepare(folder, study, points_of(plan(options))), 0u);
}

TEST(ExactNumbers, EveryLawIsHeldAgainstItsOwn) {
  const auto of = [](const std::string& name) {
    std::map<scenes::Model, double> found;
    for (const Published& p : exact_numbers(name, scenes::load_scene(name, {})))
      found[p.model.value()] = p.target().value();
    return found;
  };
  // 2000 N/m3 between plates 0.5 m apart: F (H/2 - tau0/F)^2 / (2 eta), the fluid sheared in its plug as
  // well.
  const auto steady = of("poiseuille-200");
  EXPECT_NEAR(steady.at(solid_law), 0.75, 1e-12);
  EXPECT_GT(steady.at(fluid_law), 0.755);
  EXPECT_LT(steady.at(fluid_law), 0.775);
  // Stepped down below yield, only the fluid has a velocity.
  const auto stepped = of("poiseuille-step-down");
  EXPECT_EQ(stepped.count(solid_law), 0u);
  EXPECT_NEAR(stepped.at(fluid_law), 0.01685, 1e-4);
  EXPECT_TRUE(of("mix-a-slump-sf0").empty());
}

/// A run that is cut before the published time does not say that it never happens.
TEST_F(ValidationTest, ARunCutShortIsIncompleteAndNotOneThatNeverRests) {
  options.scenes = {"mix-b-lbox-sf600"};
  options.model = scenes::Model::elasto_viscoplastic;
  for (const double end : {10.0, 20.0}) {
    const auto wanted = plan(options);
    for (const Wanted& run : wanted[0].runs) {
      compare::synthetic::Box box;
      box.end = end;
      fs::remove_all(folder.run(run.point.id));
      compare::synthetic::write(box, folder.run(run.point.id));
    }
    const auto found = collect(folder, wanted, options);
    for (const Number& n : found.scenes[0].numbers)
      if (n.published.quantity == "rest_s") {
        EXPECT_EQ(n.words, end < 13.0 ? "incomplete: the run ended after 10 s" : "never happens");
      }
  }
}

TEST_F(ValidationTest, WhatCannotBeIsRefusedBeforeAnythingIsWritten) {
  options.scenes = {"mix-a-slump-sf0", "no-such-scene"};
  EXPECT_THROW(plan(options), scenes::SceneError);
  options.scenes = {"mix-a-slump-sf0"};
  options.model = scenes::Model::newtonian;
  EXPECT_THROW(plan(options), scenes::SceneError);
  EXPECT_TRUE(fs::is_empty(folder.root));
}

/// A page of a slump and an L-box, one run of them missing, opened in Chromium.
TEST_F(ValidationTest, ThePageOpensAnswersAndIsReadableOnATelephone) {
  if (report::browser_program().empty())
    GTEST_SKIP() << "the page cannot be opened: Chromium is not installed (apt-get install chromium)";
  options.scenes = {"mix-a-slump-sf600", "mix-b-lbox-sf600"};
  const auto wanted = plan(options);
  for (const Wanted& run : wanted[0].runs) make(run, run.coarse ? 474.0 : 470.0);
  for (const Wanted& run : wanted[1].runs) {
    if (run.coarse && run.model == scenes::Model::papanastasiou) continue;
    compare::synthetic::Box box;
    box.model = run.model;
    box.set = {"mpm.threads=1"};
    box.walls_differ = "the bars are square";
    if (run.coarse) box.set.push_back("mpm.cell=" + std::to_string(run.cell));
    compare::synthetic::write(box, folder.run(run.point.id));
  }
  write(collect(folder, wanted, options), folder.root);
  report::Browser page(folder.root);
  page.window(1280, 900);
  page.open(folder.root / "index.html");
  ASSERT_TRUE(page.wait_for("document.documentElement.dataset.drawn > 0"));
  const auto ids = page.evaluate("[...document.querySelectorAll('figure')].map(f => f.id)");
  EXPECT_EQ(ids[0], "lengths");
  for (const auto& id : ids) {
    page.evaluate("document.getElementById(" + id.dump() + ").scrollIntoView()");
    EXPECT_TRUE(page.wait_for("document.getElementById(" + id.dump() +
                              ").querySelector('.body').children.length > 0"))
        << id;
  }
  EXPECT_THAT(page.evaluate("document.querySelector('.opening').textContent").get<std::string>(),
              testing::AllOf(HasSubstr("MPM elasto-viscoplastic meets"), HasSubstr("missing")));
  const std::string box = page.evaluate("document.getElementById('scene-mix-b-lbox-sf600').textContent");
  EXPECT_THAT(box, HasSubstr("differ from the scene's: the bars are square."));
  EXPECT_THAT(box, HasSubstr("flowrest validate mix-b-lbox-sf600"));
  for (const auto& title : page.evaluate(
           "[...document.querySelectorAll('section[id^=scene-] figure .title')].map(t => t.textContent)"))
    EXPECT_THAT(title.get<std::string>(), testing::HasSubstr("mix-")) << "a figure lacks its scene's name";
  // Every row of the table that does not agree carries its badge.
  const auto rows = page.evaluate(
      "[...document.querySelectorAll('#published tbody tr')].map(r => "
      "[/^(agrees|not comparable)/.test(r.cells[3].textContent), "
      "r.querySelectorAll('.badge').length])");
  ASSERT_EQ(rows.size(), 6u);
  for (const auto& row : rows)
    if (!row[0]) {
      EXPECT_EQ(row[1], 1);
    }
  const auto look = [&](const std::string& name) {
    if (const char* kept = std::getenv("FLOWREST_SCREENSHOTS"))
      page.screenshot(fs::path(kept) / (name + ".png"));
  };
  page.evaluate("window.scrollTo(0, 0)");
  look("validation");
  page.window(390, 844, true);
  EXPECT_TRUE(page.wait_for("document.documentElement.scrollWidth <= document.documentElement.clientWidth"));
  look("validation-telephone");
  EXPECT_TRUE(page.pdf().starts_with("%PDF-"));
  EXPECT_THAT(page.complaints(), testing::IsEmpty());
}
