#include "compare/comparison.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "compare/comparison_page.h"
#include "compare/exact/exact_run.h"
#include "compare/fields/states.h"
#include "compare/input_part.h"
#include "compare/measures/stop_rules.h"
#include "compare/synthetic_runs.h"
#include "compare/words.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::compare;
using scenes::Model;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

namespace {

class ComparisonTest : public testing::Test {
 protected:
  Comparison compared(const Options& options = {}) const {
    return compare_runs(find_runs({folder}), options);
  }
  const RunView& run(const Comparison& comparison, const std::string& label) const {
    for (const RunView& view : comparison.runs)
      if (view.label == label) return view;
    throw std::runtime_error("no run " + label);
  }
  std::string text(const Comparison& comparison) const {
    std::string all;
    for (const Finding& finding : comparison.findings) all += finding.text + '\n';
    return all;
  }
  void write_arrested() const {
    synthetic::Slump slump;
    slump.end = 20.0;
    slump.status = runs::Status::at_rest;
    synthetic::write(slump, folder / "evp");
  }
  synthetic::Slump creeping(double creep) const {
    synthetic::Slump slump;
    slump.model = Model::papanastasiou;
    slump.creep = creep;
    return slump;
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

std::string runs_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <class Function>
std::string message_of(Function function) {
  try {
    function();
  } catch (const runs::RunError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace

TEST_F(ComparisonTest, MeasuresWhatTheFormulaSays) {
  write_arrested();
  const synthetic::Slump fluid = creeping(2e-4);
  synthetic::write(fluid, folder / "papanastasiou");
  const Comparison comparison = compared();
  const Measures& evp = run(comparison, "MPM elasto-viscoplastic").measures;
  const Measures& creep = run(comparison, "MPM papanastasiou").measures;
  EXPECT_EQ(evp.rest_declared, 20.0);
  EXPECT_EQ(evp.cause, Cause::at_rest);
  EXPECT_EQ(evp.predicted_creep, 0.0);
  // 20/(1 + t/0.4)^3 falls through 0.05 1/s at 2.55 s.
  EXPECT_NEAR(*evp.rest_by_shear_rate, 2.55, 0.051);
  // 4 (0.288 - 0.1)/0.4/(1 + t/0.4)^3 falls through 5e-4 m/s at 5.82 s.
  EXPECT_NEAR(*evp.rest_by_spread_rate, 5.82, 0.3);
  EXPECT_TRUE(creep.rest_by_spread_rate) << "a creep of 0.2 mm/s passes the customary threshold of 0.5 mm/s";
  Options strict;
  strict.rest_spread_rate = 1e-4;
  EXPECT_FALSE(run(compared(strict), "MPM papanastasiou").measures.rest_by_spread_rate)
      << "a creep above the threshold is no rest";
  EXPECT_NEAR(*creep.residual, 2e-4, 1e-5);
  EXPECT_NEAR(*creep.predicted_creep, 6.9e-4, 1e-5);
  EXPECT_EQ(creep.cause, Cause::creep);
  EXPECT_THAT(text(comparison), HasSubstr("within a factor of 3: MPM papanastasiou (0.20 mm/s of 0.69 mm/s"));
  EXPECT_NEAR(*creep.volume_drift, -1e-5, 1e-9);
  EXPECT_EQ(creep.cpu, 12.0);
  EXPECT_NEAR(*creep.cpu_per_simulated_second, 0.2, 1e-12);
  for (const double time : {20.0, 25.0, 60.0})
    EXPECT_NEAR(creep.overshoot.at(time),
                2.0 * (fluid.radius_at(time) - fluid.radius_at(20.0) + 0.5 * 2e-4 * 20.0), 2e-5)
        << "at " << time;
  EXPECT_NEAR(*creep.stop_highest - *creep.stop_lowest, 2.0 * (fluid.radius_at(60.0) - fluid.radius_at(10.0)),
              1e-6);
  EXPECT_NEAR(*evp.centre_depth, 0.0396, 1e-3);
  // The profile is h sqrt(1 - r / R), and the history has 2 R.
  const auto at = [&](double depth) { return *evp.gauge_end * (1.0 - std::pow(depth / 0.0396, 2)); };
  EXPECT_NEAR(*evp.spread_at_half, at(0.0015), 2e-4);
  EXPECT_NEAR(*evp.spread_at_twice, at(0.006), 2e-4);
}

/// gradient.json beside a run gives its inputs' part; one whose check failed, or that is no such file, gives nothing.
TEST_F(ComparisonTest, TakesUpWhatInputsMakeOfAResult) {
  write_arrested();
  EXPECT_FALSE(input_chapter(compared()));
  const auto leave = [&](const std::string& word) {
    std::ofstream(folder / "evp" / "gradient.json")
        << R"({"quantity": "smooth_spread_mm", "unit": "mm", "value": 550.0, "check": {"word": ")" << word
        << R"("}, "input_uncertainty": {"standard": 6.5, "of": [{"key": "a", "share": 0.2}, {"key": "b", "share": 0.8}]}})";
  };
  leave("agrees");
  const Comparison comparison = compared();
  const auto parts = input_parts(comparison.runs.front().run);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].standard, 6.5);
  EXPECT_EQ(parts[0].shares[0].key, "b");
  const auto chapter = input_chapter(comparison);
  ASSERT_TRUE(chapter);
  const auto& table = std::get<report::Table>(chapter->blocks.front());
  EXPECT_EQ(std::get<std::string>(table.rows.front().cells.back()), "80 % b, 20 % a");
  leave("fails its check");
  EXPECT_FALSE(input_chapter(compared()));
  std::ofstream(folder / "evp" / "gradient.json") << "[1, {}]";
  EXPECT_FALSE(input_chapter(compared()));
}

TEST_F(ComparisonTest, RulesToStopByCutWhereTheFormulaSaysAndReadTheGaugeThen) {
  write_arrested();
  const synthetic::Slump fluid = creeping(2e-4);
  synthetic::write(fluid, folder / "papanastasiou");
  const Comparison comparison = compared();
  const RunView& view = run(comparison, "MPM papanastasiou");
  const auto stops = stops_by_rules(view, comparison.thresholds);
  const auto stop = [&](const std::string& rule) {
    for (const RuleStop& s : stops)
      if (s.rule == rule) return s;
    ADD_FAILURE() << "no rule " << rule;
    return RuleStop{};
  };
  EXPECT_NEAR(*stop("cut at 20 s").gauge, 2.0 * fluid.radius_at(20.0), 2e-4);
  // 20/(1 + t/0.4)^3 + 0.004 falls through 0.1 and 0.01 1/s at 1.97 and 5.57 s.
  EXPECT_NEAR(*stop("shear rate below 0.1 1/s").time, 1.97, 0.051);
  EXPECT_NEAR(*stop("shear rate below 0.01 1/s").time, 5.57, 0.051);
  // 4 (0.288 - 0.1)/0.4/(1 + t/0.4)^3 + 2e-4 falls through 1 mm/s at 4.92 s, and never through 0.1.
  EXPECT_NEAR(*stop("growth below 1 mm/s").time, 4.92, 0.3);
  EXPECT_FALSE(stop("growth below 0.1 mm/s").time);
  EXPECT_FALSE(stop("mean speed below 0.1 mm/s").time) << "the run does not tell its energy";
}

TEST_F(ComparisonTest, SplitsLawFromSolver) {
  write_arrested();
  synthetic::write(creeping(1e-4), folder / "mpm-fluid");
  synthetic::Slump foam = creeping(1e-4);
  foam.solver = "foam";
  foam.radius = 0.294;
  synthetic::write(foam, folder / "foam-fluid");
  const Comparison comparison = compared();
  std::map<std::string, std::vector<double>> by_kind;
  for (const Pair& pair : comparison.pairs) by_kind[pair.kind].push_back(*pair.at.back().gauge_difference);
  ASSERT_THAT(by_kind["law"], testing::SizeIs(1));
  ASSERT_THAT(by_kind["solver"], testing::SizeIs(1));
  EXPECT_NEAR(by_kind["solver"][0], 0.012, 1e-5);
  EXPECT_NEAR(by_kind["law"][0], 0.006, 2e-4);
  EXPECT_THAT(text(comparison),
              HasSubstr("Changing only the solver: OpenFOAM papanastasiou ends level within 14 mm with MPM"));
}

TEST_F(ComparisonTest, TheSquareSplitsTheDifferenceAtEachTime) {
  write_arrested();
  auto mpm = creeping(2e-4);
  mpm.radius = 0.291;
  synthetic::write(mpm, folder / "mpm-fluid");
  synthetic::Slump solid;
  solid.solver = "foam";
  solid.radius = 0.298;
  synthetic::write(solid, folder / "foam-solid");
  auto fluid = creeping(5e-4);
  fluid.solver = "foam";
  fluid.radius = 0.304;
  synthetic::write(fluid, folder / "foam-fluid");
  const Comparison comparison = compared();
  ASSERT_TRUE(comparison.square);
  EXPECT_EQ(comparison.square->fluid, "papanastasiou");
  EXPECT_TRUE(comparison.square->missing.empty());
  ASSERT_GT(comparison.square->at.size(), 20u);
  for (const auto& at : comparison.square->at) {
    EXPECT_NEAR(at.law + at.discretisation, at.total, 1e-12) << at.time;
    EXPECT_GE(at.noise, 0.0);
  }
  // Late, where all have their radius: solid 576 and 596 mm, fluid 582 and 608 mm and what they creep.
  const auto& last = comparison.square->at.back();
  EXPECT_NEAR(last.time, 60.0, 1e-9);
  EXPECT_NEAR(last.law, 0.5 * ((0.006 + 0.012) + (0.012 + 0.030)), 3e-4);
  EXPECT_NEAR(last.discretisation, 0.5 * (0.020 + (0.026 + 0.018)), 3e-4);
  EXPECT_NEAR(last.interaction, 0.5 * ((0.012 + 0.030) - (0.006 + 0.012)), 3e-4);
  EXPECT_THAT(text(comparison), HasSubstr("the law makes 30 mm and the discretisation 32 mm"));
}

TEST_F(ComparisonTest, ASquareThatLacksARunSaysHowToMakeIt) {
  write_arrested();
  synthetic::write(creeping(1e-4), folder / "mpm-fluid");
  const Comparison comparison = compared();
  ASSERT_TRUE(comparison.square);
  EXPECT_THAT(comparison.square->missing,
              ElementsAre("flowrest foam roussel-slump --model elasto-viscoplastic",
                          "flowrest foam roussel-slump --model papanastasiou"));
  EXPECT_TRUE(comparison.square->at.empty());
  EXPECT_THAT(comparison.missing,
              testing::Contains(HasSubstr("flowrest foam roussel-slump --model bi-viscous")));
}

TEST_F(ComparisonTest, WordsCarryNoMoreDigitsThanAreKnown) {
  EXPECT_EQ(words::spread(0.5634, 0.0084), "563 ± 8 mm");
  EXPECT_EQ(words::spread(0.5634, 0.010), "563 ± 10 mm");
  EXPECT_EQ(words::spread(0.6234, 0.034), "620 ± 30 mm");
  EXPECT_EQ(words::spread(0.7234, 0.114), "720 ± 110 mm");
  EXPECT_EQ(words::spread(0.5634, 0.00004), "563 ± 1 mm");
  EXPECT_EQ(words::spread(0.5634, std::nullopt), "563 mm");

  // Two grids tell more than a cell: 10 and 5 mm that differ by 4 mm leave 4 mm to the finer, 8 mm to the
  // coarser.
  synthetic::Slump coarse;
  coarse.set = {"mpm.cell=0.010"};
  synthetic::Slump fine;
  fine.set = {"mpm.cell=0.005"};
  fine.cell = 0.002;
  fine.radius = coarse.radius + 0.002;
  synthetic::write(coarse, folder / "coarse");
  synthetic::write(fine, folder / "fine");
  const Comparison comparison = compared();
  const RunView& finer = run(comparison, "MPM elasto-viscoplastic, 5 mm cells");
  EXPECT_NEAR(*finer.measures.uncertainty, 0.004, 2e-4);
  EXPECT_EQ(finer.measures.uncertainty_source, "the difference between its grids");
  EXPECT_NEAR(*run(comparison, "MPM elasto-viscoplastic, 10 mm cells").measures.uncertainty, 0.008, 1e-3);
}

TEST(ShearRate, IsThatOfTheFlowInTheSection) {
  fields::Cells cells;
  std::vector<double> cover, u, w;
  constexpr double width = 0.01, height = 0.005;
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 10; ++column) {
      cells.west.push_back(column * width);
      cells.east.push_back((column + 1) * width);
      cells.bottom.push_back(row * height);
      cells.top.push_back((row + 1) * height);
      cover.push_back(1.0);
    }
  const auto fill = [&](auto along, auto up) {
    u.clear();
    w.clear();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double x = 0.5 * (cells.west[i] + cells.east[i]), z = 0.5 * (cells.bottom[i] + cells.top[i]);
      u.push_back(along(x, z));
      w.push_back(up(x, z));
    }
  };
  // Simple shear over a wall that holds: exact in every cell but the topmost, which has no neighbour to tell
  // by.
  fill([](double, double z) { return 3.0 * z; }, [](double, double) { return 0.0; });
  const auto sheared = fields::shear_rate(cells, cover, u, w, false, true);
  for (std::size_t i = 0; i < 70; ++i) EXPECT_NEAR(sheared[i], 3.0, 1e-9) << i;
  // Axisymmetric squeezing u = a r, w = -2 a z: sqrt(12) a.
  fill([](double r, double) { return 2.0 * r; }, [](double, double z) { return -4.0 * z; });
  const auto squeezed = fields::shear_rate(cells, cover, u, w, true, false);
  EXPECT_NEAR(squeezed[25], std::sqrt(12.0) * 2.0, 1e-9);
  EXPECT_NEAR(squeezed[10], std::sqrt(12.0) * 2.0, 1e-9) << "beside the axis";
  // Air that rushes past does not count: the face takes the concrete's velocity.
  fill([](double, double z) { return z > 0.02 ? 50.0 : 0.0; }, [](double, double) { return 0.0; });
  for (std::size_t i = 0; i < cells.size(); ++i) cover[i] = cells.bottom[i] > 0.0199 ? 0.0 : 1.0;
  const auto covered = fields::shear_rate(cells, cover, u, w, false, true);
  EXPECT_NEAR(covered[35], 0.0, 1e-9);
}

TEST_F(ComparisonTest, ProfileErrorsVanishBetweenARunAndItself) {
  write_arrested();
  fs::copy(folder / "evp", folder / "again", fs::copy_options::recursive);
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.pairs.size(), 1u);
  EXPECT_EQ(comparison.pairs[0].kind, "settings");
  for (const auto& at : comparison.pairs[0].at) EXPECT_EQ(at.error.linf, 0.0) << at.time;
  EXPECT_NE(comparison.runs[0].label, comparison.runs[1].label);
}

TEST_F(ComparisonTest, AgainstTheExactProfiles) {
  synthetic::Slump slump;
  slump.radius = 0.29997;  // H sqrt(1 - r/R) with R of the leading order is the leading order itself
  slump.status = runs::Status::at_rest;
  slump.cell = 0.0025;
  synthetic::write(slump, folder / "evp");
  exact::write_exact_runs(scenes::load_scene("roussel-slump"), folder / "exact");
  const Comparison comparison = compared();
  ASSERT_EQ(comparison.runs.size(), 3u);
  for (const Pair& pair : comparison.pairs) {
    const bool leading = comparison.runs[pair.reference].label == "exact, leading order";
    const ProfileError& error = pair.at.back().error;
    if (leading) {
      EXPECT_LT(error.l1, 2e-4);
      EXPECT_LT(error.l1_relative, 0.01);
    } else {
      EXPECT_GT(error.l1, 1e-3);
    }
  }
  EXPECT_THAT(text(comparison), HasSubstr("596 mm (exact, leading order) and 562 mm (exact, second order)"));
  EXPECT_THAT(comparison.fair, HasSubstr("quasi-static"));
}

TEST_F(ComparisonTest, ASolutionInTimeIsNotCalledQuasiStatic) {
  write_arrested();
  const auto scene = scenes::load_scene("roussel-slump", {{"time.end=1"}, {}});
  exact::write_film_run(scene, folder / "film", true, runs::Replace::anything);
  EXPECT_THAT(text(compared()),
              AllOf(HasSubstr("Solutions in time end at "), Not(HasSubstr("quasi-static solutions"))));
}

TEST_F(ComparisonTest, ANoisyRunIsCalledSo) {
  write_arrested();
  synthetic::Slump noisy = creeping(4e-3);
  noisy.solver = "foam";
  noisy.verdict = "noisy: the initial residual rose to 0.12";
  synthetic::write(noisy, folder / "foam");
  Comparison comparison = compared();
  EXPECT_TRUE(run(comparison, "OpenFOAM papanastasiou").doubt.noisy);
  EXPECT_EQ(run(comparison, "OpenFOAM papanastasiou").measures.cause, Cause::noise);
  EXPECT_THAT(text(comparison), HasSubstr("noisy: the initial residual rose to 0.12"));
  noisy.verdict = "sound";
  synthetic::write(noisy, folder / "foam");
  comparison = compared();
  EXPECT_EQ(run(comparison, "OpenFOAM papanastasiou").measures.cause, Cause::unexplained);
  EXPECT_THAT(text(comparison), Not(HasSubstr("noisy")));
  noisy.creep = 1e-4;
  noisy.verdict = "noisy: the initial residual rose to 0.12";
  synthetic::write(noisy, folder / "foam");
  EXPECT_EQ(run(compared(), "OpenFOAM papanastasiou").measures.cause, Cause::creep_or_noise);
}

TEST_F(ComparisonTest, ARunOfTooFewCellsIsCalledUnderResolvedAndNotNoisy) {
  write_arrested();
  synthetic::Slump coarse = creeping(4e-3);
  coarse.solver = "foam";
  coarse.verdict = "under-resolved: 3.3 cells over the sheared layer";
  synthetic::write(coarse, folder / "foam");
  Comparison comparison = compared();
  const RunView& view = run(comparison, "OpenFOAM papanastasiou");
  EXPECT_TRUE(view.doubt.under_resolved);
  EXPECT_EQ(view.measures.cause, Cause::unexplained);
  EXPECT_THAT(text(comparison), HasSubstr("under-resolved: OpenFOAM papanastasiou"));
  EXPECT_THAT(text(comparison), HasSubstr("under-resolved: 3.3 cells over the sheared layer"));
  EXPECT_THAT(text(comparison), Not(HasSubstr("noisy")));
  coarse.verdict = "noisy: it chatters; under-resolved: 3.3 cells";
  synthetic::write(coarse, folder / "foam");
  EXPECT_THAT(text(compared()), HasSubstr("noisy, under-resolved: it chatters; under-resolved: 3.3 cells"));
}

/// Regularised so stiffly that it hardly creeps, a fluid still does what the exact material does.
TEST_F(ComparisonTest, AFluidMayApproachRestAsTheExactMaterialDoes) {
  synthetic::Slump fluid = creeping(2.3e-4);
  fluid.radius = 0.28;
  fluid.set = {"material.regularisation_time=1000"};
  synthetic::write(fluid, folder / "stiff");
  Comparison comparison = compared();
  const Measures& stiff = run(comparison, "MPM papanastasiou").measures;
  EXPECT_GT(*stiff.residual, 3.0 * *stiff.predicted_creep);
  EXPECT_EQ(stiff.cause, Cause::approaching_rest);
  EXPECT_LT(*stiff.approach_least, *stiff.approach_most);
  EXPECT_THAT(text(comparison),
              HasSubstr("the exact material's own approach to rest, and creep: MPM papanastasiou"));
  // Faster than both, it is not explained.
  fluid.creep = 5e-4;
  synthetic::write(fluid, folder / "stiff");
  comparison = compared();
  EXPECT_EQ(run(comparison, "MPM papanastasiou").measures.cause, Cause::unexplained);
  // A solid that has not come to rest is held against it, too; with thixotropy no film is known.
  fluid.model = Model::elasto_viscoplastic;
  synthetic::write(fluid, folder / "stiff");
  comparison = compared();
  EXPECT_EQ(run(comparison, "MPM elasto-viscoplastic").measures.cause, Cause::approaching_rest);
  EXPECT_THAT(text(comparison), HasSubstr("grows by 0.50 mm/s, where a thin film of it still grows by"));
  fluid.set.insert(fluid.set.end(), {"thixotropy.flocculation_rate=0.1", "thixotropy.initial_flocculation=0",
                                     "thixotropy.deflocculation_coefficient=0.1"});
  synthetic::write(fluid, folder / "stiff");
  EXPECT_FALSE(run(compared(), "MPM elasto-viscoplastic").measures.approach_most);
}

TEST_F(ComparisonTest, IncompleteRunsAreReadAndCalledSo) {
  write_arrested();
  synthetic::Slump cut = creeping(1e-4);
  cut.end = 12.3;
  cut.status = runs::Status::interrupted;
  cut.reason = "by the user";
  synthetic::write(cut, folder / "cut");
  runs::RunWriter(folder / "failed", scenes::load_scene("roussel-slump"), "foam")
      .finish(runs::Status::failed, "a step of 1e-12 s", "sound");
  const Comparison comparison = compared();
  EXPECT_THAT(text(comparison),
              HasSubstr("MPM papanastasiou is incomplete (interrupted at 12.3 s: by the user)"));
  EXPECT_THAT(text(comparison),
              HasSubstr("is incomplete (failed before the first record: a step of 1e-12 s)"));
  EXPECT_FALSE(run(comparison, "MPM papanastasiou").gauge_at(20.0))
      << "an interrupted run was held past its end";
  EXPECT_EQ(run(comparison, "MPM papanastasiou").measures.cause, Cause::unknown);
  EXPECT_TRUE(run(comparison, "MPM elasto-viscoplastic").gauge_at(60.0)) << "a run at rest stays where it is";
}

TEST_F(ComparisonTest, ADuctStopsOrCreeps) {
  synthetic::Duct stopping, creeping_duct;
  stopping.decay = 2.0;
  creeping_duct.model = Model::papanastasiou;
  creeping_duct.creep = 1.7e-2;
  creeping_duct.from_plate = true;  // its y runs from 0 to the height
  synthetic::write(stopping, folder / "evp");
  synthetic::write(creeping_duct, folder / "papanastasiou");
  exact::write_exact_runs(scenes::load_scene("poiseuille-step-down"), folder / "exact");
  const Comparison comparison = compared();
  const Measures& evp = run(comparison, "MPM elasto-viscoplastic").measures;
  const Measures& fluid = run(comparison, "MPM papanastasiou").measures;
  EXPECT_NEAR(*evp.stop_after_step, 2.0 * 0.99, 0.051);
  EXPECT_EQ(evp.cause, Cause::at_rest);
  EXPECT_FALSE(fluid.stop_after_step);
  EXPECT_NEAR(*fluid.residual, 1.7e-2, 1e-9);
  EXPECT_NEAR(*fluid.predicted_creep, 1.69e-2, 2e-4);
  EXPECT_EQ(fluid.cause, Cause::creep);
  for (const Pair& pair : comparison.pairs) {
    if (pair.kind != "exact") continue;
    ASSERT_EQ(pair.at.size(), 2u);
    EXPECT_EQ(pair.at[0].time, 12.0);
    EXPECT_LT(pair.at[0].error.l2_relative, 5e-3) << comparison.runs[pair.run].label;
  }
  EXPECT_THAT(text(comparison), HasSubstr("stops within 5.9 s of the last change of force"));
}

TEST_F(ComparisonTest, RestByABoundSaysWhatMayStillCome) {
  synthetic::Slump early;
  early.end = 5.0;  // its spread still grows by about 1 mm/s
  early.status = runs::Status::at_rest;
  synthetic::write(early, folder / "evp");
  auto info = runs::read_run(folder / "evp").info;
  info["growth_to_come"] = 0.006;
  runs::write_atomically(folder / "evp" / "run.json", info.dump());
  const Comparison comparison = compared();
  EXPECT_EQ(comparison.runs[0].measures.cause, Cause::within_bound);
  EXPECT_THAT(text(comparison), HasSubstr("with at most 4 mm still to come"));
}

TEST_F(ComparisonTest, RunsThatPassTheirEndByAStepEndTogether) {
  synthetic::Slump one = creeping(1e-4), other = creeping(2e-4);
  other.end = 60.05;
  other.solver = "foam";
  synthetic::write(one, folder / "one");
  synthetic::write(other, folder / "other");
  const Comparison comparison = compared();
  EXPECT_EQ(comparison.end, 60.0);
  ASSERT_EQ(comparison.pairs.size(), 1u);
  EXPECT_EQ(comparison.pairs[0].at.back().time, 60.0);
  EXPECT_THAT(text(comparison), HasSubstr("The regularised fluids have not come to rest by 60 s: MPM"));
}

TEST_F(ComparisonTest, OneRunAloneIsEnough) {
  synthetic::write(creeping(1e-4), folder / "only");
  const Comparison comparison = compared();
  EXPECT_EQ(comparison.runs.size(), 1u);
  EXPECT_TRUE(comparison.pairs.empty());
  EXPECT_FALSE(comparison.runs[0].measures.overshoot_reference);
  EXPECT_THAT(text(comparison), HasSubstr("MPM papanastasiou stands at"));
}

TEST_F(ComparisonTest, RunsOfDifferentScenesAreNotPassedOffAsOne) {
  write_arrested();
  scenes::Overrides stiffer;
  stiffer.set = {"material.yield_stress=100"};
  exact::write_exact_runs(scenes::load_scene("roussel-slump", stiffer), folder / "exact");
  EXPECT_THAT(compared().notes, ElementsAre(HasSubstr("they differ in material.yield_stress")));
  synthetic::write(synthetic::Duct{}, folder / "duct");
  EXPECT_THAT(message_of([&] { compared(); }), HasSubstr("cannot be compared with a"));
}

TEST_F(ComparisonTest, SaysWhatIsMissing) {
  EXPECT_THAT(message_of([&] { find_runs({folder / "nowhere"}); }), HasSubstr("there is no such folder"));
  EXPECT_THAT(message_of([&] { find_runs({folder}); }), HasSubstr("no run.json in it or in its folders"));
  EXPECT_THAT(message_of([&] { compare_runs({}); }), HasSubstr("at least one run directory"));
  write_arrested();
  EXPECT_EQ(find_runs({folder, folder / "evp"}).size(), 1u) << "a run named twice counts once";
  EXPECT_THAT(message_of([&] { write_comparison(compared(), folder / "evp"); }),
              HasSubstr("name another folder"));
}

TEST_F(ComparisonTest, WritesWhatItMeasured) {
  write_arrested();
  synthetic::write(creeping(2e-4), folder / "papanastasiou");
  write_comparison(compared(), folder / "report");
  std::ifstream file(folder / "report" / "comparison.json");
  const auto json = nlohmann::ordered_json::parse(file);
  EXPECT_EQ(json["runs"][0]["measures"]["rest_declared_s"], 20.0);
  EXPECT_NEAR(json["runs"][1]["measures"]["residual_mm_s"].get<double>(), 0.2, 0.01);
  EXPECT_NEAR(json["runs"][1]["measures"]["overshoot_at_60s_mm"].get<double>(), 12.0, 0.3);
  for (const char* name : {"measures.csv", "spread.csv", "profiles.csv"}) {
    std::ifstream csv(folder / "report" / name);
    std::string header, row;
    std::getline(csv, header);
    std::getline(csv, row);
    EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ',')) << name;
    EXPECT_FALSE(row.empty()) << name;
  }
}

TEST_F(ComparisonTest, ExactRunsRefuseScenesWithoutASolution) {
  const auto refusal = [&](const std::string& set) {
    scenes::Overrides overrides;
    overrides.set = {set};
    return message_of(
        [&] { exact::write_exact_runs(scenes::load_scene("roussel-slump", overrides), folder / "exact"); });
  };
  EXPECT_THAT(refusal("material.yield_stress=0"), HasSubstr("without a yield stress"));
  EXPECT_THAT(refusal("material.yield_stress=5000"), HasSubstr("the cone stands"));
  EXPECT_THAT(refusal("walls.base=slip"), HasSubstr("base without slip"));
  EXPECT_FALSE(fs::exists(folder / "exact")) << "something was written all the same";
}

TEST_F(ComparisonTest, AnLBoxHasAnArrestedShapeForTheStructureItEndsWith) {
  const auto box = [](std::vector<std::string> set = {}) {
    return scenes::load_scene("mix-b-lbox-sf600", {std::move(set), std::nullopt});
  };
  const auto refusal = [&](const scenes::Scene& scene, std::optional<double> flocculation) {
    return message_of([&] { exact::write_exact_runs(scene, folder / "refused", flocculation); });
  };
  EXPECT_THAT(refusal(box(), std::nullopt), HasSubstr("--flocculation gives what it is"));
  EXPECT_THAT(refusal(box(), -1.0), HasSubstr("allowed: from 0"));
  EXPECT_THAT(refusal(box(), 4.4), HasSubstr("it would fill the opening (150 mm)"));
  EXPECT_THAT(refusal(box({"walls.base=slip"}), 0.5), HasSubstr("hold nothing"));
  EXPECT_THAT(refusal(scenes::load_scene("roussel-slump"), 0.5), HasSubstr("not thixotropic"));
  EXPECT_THAT(refusal(scenes::load_scene("mix-a-slump-sf0", {{"thixotropy.ageing_rate=0.01"}, {}}), 0.5),
              HasSubstr("grows with age (thixotropy.ageing_rate)"));
  EXPECT_FALSE(fs::exists(folder / "refused"));

  const auto written = exact::write_exact_runs(box(), folder / "exact", 0.5);
  ASSERT_EQ(written.size(), 1U);
  const auto run = runs::read_run(written.front().directory);
  const double front = run.history.at("front_mm").back();
  EXPECT_GT(front, 500.0);
  EXPECT_LT(front, 600.0);
  EXPECT_EQ(run.history.at("end_height_mm").back(), 0.0);
  ASSERT_EQ(run.profiles.size(), 1U);
  EXPECT_NEAR(run.profiles[0].value.front(), 1e-3 * run.history.at("start_height_mm").back(), 1e-12);

  synthetic::write(synthetic::Box{}, folder / "mpm");
  const Comparison comparison = compared();
  EXPECT_THAT(text(comparison), HasSubstr("mm (exact, arrested, flocculation 0.5)"));
  // Broken down, it reaches the end.
  exact::write_exact_runs(box(), folder / "exact", 0.0, runs::Replace::anything);
  EXPECT_THAT(text(compared()), HasSubstr("600 mm, 35 mm high at the end (exact, arrested, flocculation 0)"));
}

/// One solid at rest and one fluid that creeps, of a size.
Comparison solid_and_fluid(const fs::path& folder, double size) {
  synthetic::Slump solid, fluid;
  solid.size = fluid.size = size;
  solid.end = 20.0;
  solid.status = runs::Status::at_rest;
  fluid.model = Model::papanastasiou;
  fluid.creep = 2e-4;
  synthetic::write(solid, folder / "solid");
  synthetic::write(fluid, folder / "fluid");
  return compare_runs(find_runs({folder}));
}

TEST_F(ComparisonTest, ACopyAHundredthAsLargeIsMeasuredAlike) {
  const Comparison large = solid_and_fluid(folder / "large", 1.0),
                   small = solid_and_fluid(folder / "small", 0.01);
  EXPECT_NEAR(small.grain.length, 1e-5, 1e-18);
  EXPECT_DOUBLE_EQ(small.thresholds.time_unit, 0.1);
  ASSERT_EQ(small.runs.size(), 2u);
  ASSERT_EQ(small.times.size(), large.times.size());
  ASSERT_EQ(small.stops.size(), large.stops.size());
  ASSERT_EQ(small.grid.size(), large.grid.size());
  for (std::size_t i = 0; i < 2; ++i) {
    const Measures &a = small.runs[i].measures, &b = large.runs[i].measures;
    const auto same = [&](const char* what, const std::optional<double>& mine,
                          const std::optional<double>& other, double scale) {
      ASSERT_EQ(mine.has_value(), other.has_value()) << what;
      if (!mine) return;
      EXPECT_NEAR(*mine, scale * *other, 1e-6 * std::abs(scale * *other) + 1e-12) << what;
    };
    constexpr double length = 0.01, time = 0.1, speed = 0.1;
    same("spread", a.gauge_end, b.gauge_end, length);
    same("at half", a.spread_at_half, b.spread_at_half, length);
    same("at twice", a.spread_at_twice, b.spread_at_twice, length);
    same("centre", a.centre_depth, b.centre_depth, length);
    same("uncertainty", a.uncertainty, b.uncertainty, length);
    same("rest by shear rate", a.rest_by_shear_rate, b.rest_by_shear_rate, time);
    // Rounding decides which rows a window ends at: a row of the history.
    ASSERT_EQ(a.rest_by_spread_rate.has_value(), b.rest_by_spread_rate.has_value());
    if (a.rest_by_spread_rate) {
      EXPECT_NEAR(*a.rest_by_spread_rate, time * *b.rest_by_spread_rate, 0.0051);
    }
    same("residual", a.residual, b.residual, speed);
    same("creep", a.predicted_creep, b.predicted_creep, speed);
    same("lowest stop", a.stop_lowest, b.stop_lowest, length);
    EXPECT_EQ(a.cause, b.cause);
    EXPECT_EQ(a.overshoot.size(), b.overshoot.size());
  }
  EXPECT_THAT(text(large),
              HasSubstr("MPM elasto-viscoplastic comes to rest after 20 s with a spread of 576 ± 10 mm"));
  EXPECT_THAT(text(small),
              HasSubstr("MPM elasto-viscoplastic comes to rest after 2.0 s with a spread of 5.76 ± 0.10 mm"));
  EXPECT_THAT(text(large), HasSubstr("growing by 0.20 mm/s"));
  EXPECT_THAT(text(small), HasSubstr("growing by 0.020 mm/s"));
  const auto json = to_json(small);
  EXPECT_NEAR(json["thresholds"]["spread_depth_mm"].get<double>(), 0.03, 1e-15);
  EXPECT_NEAR(json["thresholds"]["rest_spread_rate_mm_s"].get<double>(), 0.05, 1e-12);
  write_comparison(small, folder / "report");
  const std::string page = runs_text(folder / "report" / "index.html");
  EXPECT_THAT(page, HasSubstr("falls through 0.03 mm"));
  EXPECT_THAT(page, HasSubstr("at 0.015 mm depth"));
}

TEST_F(ComparisonTest, RunsWithoutTheKeyAreReadAtThreeMillimetresAndADifferenceIsNoted) {
  write_arrested();
  synthetic::Slump other;
  other.model = Model::papanastasiou;
  other.set = {"gauges.spread_depth=0.006"};
  synthetic::write(other, folder / "other");
  EXPECT_THAT(compared().notes,
              testing::Contains(HasSubstr("not read at the same depth: 3 mm in MPM "
                                          "elasto-viscoplastic; 6 mm in MPM papanastasiou")));
  // A run of before, whose settings have no gauges.
  auto info = nlohmann::ordered_json::parse(runs_text(folder / "evp" / "run.json"));
  info["settings"].erase("gauges");
  info.erase("gauges");
  runs::write_atomically(folder / "evp" / "run.json", info.dump());
  const Comparison comparison = compare_runs({folder / "evp"});
  EXPECT_EQ(comparison.gauges, scenes::Gauges{});
  EXPECT_THAT(comparison.notes, testing::IsEmpty());
}

TEST_F(ComparisonTest, AGaugeThatReadsNothingAtTheEndIsNeverZeroAndNeverAnOldReading) {
  write_arrested();
  synthetic::write(creeping(1e-4), folder / "fluid");
  const auto table = runs::read_run(folder / "evp").history;
  std::string csv = "time_s,spread_mm,height_mm,volume_m3,shear_rate_p99_1_s\n";
  for (std::size_t i = 0; i < table.rows(); ++i)
    csv += fmt::format("{},{},{},{},{}\n", table.columns[0][i],
                       i + 5 < table.rows() ? fmt::format("{}", table.columns[1][i]) : "",
                       table.columns[2][i], table.columns[3][i], table.columns[4][i]);
  runs::write_atomically(folder / "evp" / "history.csv", csv);
  const Comparison comparison = compared();
  const RunView& view = run(comparison, "MPM elasto-viscoplastic");
  EXPECT_FALSE(view.measures.gauge_end);
  EXPECT_FALSE(view.measures.readings.at("spread_mm").value);
  EXPECT_FALSE(view.measures.residual);
  EXPECT_FALSE(view.gauge_at(20.0)) << "what stood earlier does not stand for what cannot be read";
  EXPECT_TRUE(view.gauge_at(10.0));
  EXPECT_FALSE(run(comparison, "MPM papanastasiou").measures.overshoot_reference);
  EXPECT_THAT(text(comparison), HasSubstr("with a spread of nothing that can be read (nowhere 3 mm deep)"));
  EXPECT_THAT(
      comparison.notes,
      testing::Contains("Nothing is read of the spread at the end of MPM elasto-viscoplastic (nowhere 3 mm "
                        "deep)."));
  const auto json = to_json(comparison);
  EXPECT_TRUE(json["runs"][0]["measures"]["spread_end_mm"].is_null());
  write_comparison(comparison, folder / "report");
}

TEST(Words, HaveDigitsThatSuitTheBody) {
  const words::Grain small = words::grain_of({.spread_depth = 3e-5, .still_speed = 1e-5, .rate_window = 0.2},
                                             scenes::MainGauge::spread);
  EXPECT_EQ(words::spread(0.005419, small), "5.42 mm");
  EXPECT_EQ(words::spread(0.005419, 0.0002, small), "5.4 ± 0.2 mm");
  EXPECT_EQ(words::spread(0.005419, 1e-9, small), "5.42 ± 0.01 mm");
  EXPECT_EQ(words::reading(5.419, std::nullopt, "mm", small), "5.42 mm");
  EXPECT_EQ(words::reading(0.1234, 0.0042, "s", small), "0.123 ± 0.004 s");
  EXPECT_EQ(words::speed(2e-7, small), "0.0002 mm/s");
  EXPECT_EQ(words::speed(2e-8, small), "less than 0.0001 mm/s");
  EXPECT_EQ(words::time(0.0512), "0.051 s");
  EXPECT_EQ(words::decimals_down_to(5.3), 0);
  EXPECT_EQ(words::decimals_down_to(0.053), 2);
  // 0.6 mm, as of a mini-cone: told to a tenth of a millimetre.
  EXPECT_EQ(words::spread(0.2313, words::grain_of({.spread_depth = 6e-4}, scenes::MainGauge::spread)),
            "231.3 mm");
}

TEST(Words, CarryNoMoreDigitsThanTheyShould) {
  EXPECT_EQ(words::spread(0.5756), "576 mm");
  EXPECT_EQ(words::time(19.42), "19 s");
  EXPECT_EQ(words::time(4.637), "4.6 s");
  EXPECT_EQ(words::speed(2.5e-4), "0.25 mm/s");
  EXPECT_EQ(words::speed(4.44e-6), "0.004 mm/s");
  EXPECT_EQ(words::speed(1e-9), "less than 0.001 mm/s");
  EXPECT_EQ(words::velocity(4.0 / 3.0), "1.333 m/s");
  EXPECT_EQ(words::velocity(1.69e-2), "16.9 mm/s");
  EXPECT_EQ(words::duration(14.2), "14 s");
  EXPECT_EQ(words::duration(266.0), "4.4 min");
  EXPECT_EQ(words::duration(7600.0), "2.1 h");
  EXPECT_EQ(words::percent(0.0132), "1.3 %");
  EXPECT_EQ(words::listed({"a", "b", "c"}), "a, b and c");
  EXPECT_EQ(words::listed({"a", "b"}, "; "), "a; b");
}

TEST_F(ComparisonTest, AnLBoxIsToldInItsOwnWords) {
  synthetic::Box stiff;
  stiff.status = runs::Status::at_rest;
  synthetic::write(stiff, folder / "evp");
  synthetic::Box fluid;
  fluid.model = Model::papanastasiou;
  fluid.front = 0.7;
  fluid.walls_differ = "the bars are square";
  synthetic::write(fluid, folder / "fluid");
  const Comparison comparison = compared();
  EXPECT_THAT(comparison.findings.front().text,
              HasSubstr("MPM elasto-viscoplastic comes to rest after 10 s with a front of 520 ± 10 mm"));
  // 0.7 (1 - exp(-t)) = 0.6 at ln 7; between rows of 0.05 s.
  const auto& arrival = run(comparison, "MPM papanastasiou").measures.readings.at("arrival_s");
  ASSERT_TRUE(arrival.value);
  EXPECT_NEAR(*arrival.value, std::log(7.0), 0.05);
  EXPECT_FALSE(arrival.uncertainty) << "there is one grid only";
  EXPECT_FALSE(run(comparison, "MPM elasto-viscoplastic").measures.readings.at("arrival_s").value);
  const std::string told = text(comparison);
  EXPECT_THAT(told,
              HasSubstr("MPM papanastasiou reaches the end wall after 1.9 s and stands 40 mm high there"));
  EXPECT_THAT(told, HasSubstr("from 4.40 to 2.40 at 2.0 s, up again to 2.56 by 10 s"));
  EXPECT_THAT(told, Not(HasSubstr("spread")));
  EXPECT_THAT(comparison.notes,
              testing::Contains("Walls of MPM papanastasiou differ from the scene's: the bars are square."));
  write_comparison(comparison, folder / "report");
  EXPECT_TRUE(fs::exists(folder / "report" / "front.csv"));
  std::ifstream csv(folder / "report" / "measures.csv");
  std::string header;
  std::getline(csv, header);
  EXPECT_THAT(header,
              testing::AllOf(HasSubstr(",arrival_s,arrival_s_uncertainty,"), Not(HasSubstr("spread"))));
}

TEST_F(ComparisonTest, AFunnelsGridsSayHowWellItsLightIsKnown) {
  synthetic::Funnel fine, coarse;
  fine.set = {"mpm.cell=0.01"};
  coarse.set = {"mpm.cell=0.02"};
  coarse.empty = 2.5;
  synthetic::write(fine, folder / "fine");
  synthetic::write(coarse, folder / "coarse");
  const Comparison comparison = compared();
  const auto& light = run(comparison, "MPM elasto-viscoplastic, 10 mm cells").measures.readings.at("light_s");
  EXPECT_NEAR(*light.value, 2.0 * (1.0 - 3.0 / 600.0), 1e-9);
  EXPECT_NEAR(*light.uncertainty, 0.5 * (1.0 - 3.0 / 600.0), 1e-9);
  EXPECT_THAT(comparison.findings.front().text,
              HasSubstr("and after 2.0 ± 0.5 s (MPM elasto-viscoplastic, 10 mm cells)"));
}

TEST(CarriedOn, WhatRestsGrowsSteadilyOrNotAtAll) {
  report::Curve curve{.x = {0.0, 1.0}, .y = {3.0, 2.0}};
  carry_on(curve, 0.1, 11.0);
  EXPECT_EQ(curve.held_from, 1.0);
  EXPECT_NEAR(curve.x.back(), 11.0, 1e-12);
  for (std::size_t i = 1; i < curve.x.size(); ++i)
    EXPECT_NEAR(curve.y[i], 2.0 + 0.1 * (curve.x[i] - 1.0), 1e-12) << "at " << curve.x[i];
}
