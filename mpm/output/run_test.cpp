#include "mpm/output/run.h"

#include <cmath>
#include <map>
#include <numbers>

#include "mpm/output/checkpoint.h"
#include "mpm/output/test_runs.h"
#include "mpm/solver/test_bodies.h"
#include "runs/depth.h"
#include "runs/gauges.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;
namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

/// A hook that stops a run, with a checkpoint, before its step number `steps` + 1.
std::function<bool()> stop_after(int steps) {
  return [steps, asked = 0]() mutable { return asked++ == steps; };
}

/// A hook that ends the run as a power cut would: at once, with no last checkpoint.
struct PowerCut {};
std::function<bool()> cut_after(int steps) {
  return [steps, asked = 0]() mutable -> bool {
    if (asked++ == steps) throw PowerCut{};
    return false;
  };
}

/// What a run says of itself, key by key, but for what it cost, who made it, how it was asked for and where
/// it was gone on with.
void expect_same_words(nlohmann::ordered_json one, nlohmann::ordered_json other) {
  EXPECT_FALSE(one.contains("resumed_at_s") && other.contains("resumed_at_s"));
  for (auto* info : {&one, &other})
    for (const char* key :
         {"resumed_at_s", "request", "provenance", "wall_s", "cpu_s", "particle_steps_per_cpu_s",
          "bytes_per_particle", "stage_wall_s", "peak_memory_bytes"})
      info->erase(key);
  for (const auto& [key, value] : one.items()) {
    ASSERT_TRUE(other.contains(key)) << key;
    EXPECT_EQ(value, other[key]) << key;
  }
  for (const auto& [key, value] : other.items()) EXPECT_TRUE(one.contains(key)) << key;
}

void expect_same_snapshots(const fs::path& one, const fs::path& other) {
  std::size_t ours = 0, theirs = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(one)) ++ours;
  for (const auto& entry : fs::directory_iterator(other)) {
    ++theirs;
    const fs::path same = one / entry.path().filename();
    ASSERT_TRUE(fs::exists(same)) << same;
    EXPECT_EQ(fs::file_size(same), fs::file_size(entry.path())) << same;
  }
  EXPECT_EQ(ours, theirs);
}

void expect_same_run(const fs::path& one, const fs::path& other) {
  for (const char* file : {"history.csv", "profiles.csv", "particles/particles.hdf.series"}) {
    EXPECT_FALSE(text_of(one / file).empty()) << file;
    EXPECT_EQ(text_of(one / file), text_of(other / file)) << file;
  }
  const auto a = read_checkpoint(one), b = read_checkpoint(other);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->run.time, b->run.time);
  EXPECT_EQ(a->run.steps, b->run.steps);
  EXPECT_EQ(a->run.dissipated, b->run.dissipated);
  EXPECT_EQ(a->run.calm_since, b->run.calm_since);
  EXPECT_EQ(a->solver.cells, b->solver.cells);
  EXPECT_EQ(all_of(a->solver).arrays, all_of(b->solver).arrays);
  EXPECT_EQ(a->run.histories, b->run.histories);
  EXPECT_EQ(a->run.last_profile, b->run.last_profile);
  EXPECT_EQ(a->run.last_snapshot, b->run.last_snapshot);
  EXPECT_EQ(a->noise_meter, b->noise_meter);
  EXPECT_EQ(a->run.noise.judged_until, b->run.noise.judged_until);
  EXPECT_EQ(a->scene, b->scene);
  expect_same_words(runs::read_run(one).info, runs::read_run(other).info);
  expect_same_snapshots(one / "particles", other / "particles");
}

}  // namespace

class MpmRun : public RunTest {};

TEST_F(MpmRun, HistoryHasItsColumnsAndARowEveryInterval) {
  const auto run = run_and_read(tiny_slump());
  EXPECT_THAT(
      run.history.names,
      ElementsAre("time_s", "spread_mm", "spread_1p5_mm", "spread_6_mm", "spread_mass_995_mm", "height_mm",
                  "volume_m3", "volume_at_rest_m3", "kinetic_energy_J", "potential_energy_J",
                  "elastic_energy_J", "dissipated_energy_J", "numerical_energy_J", "shear_rate_p99_1_s",
                  "sheared_layer_mm", "sheared_layer_cells", "shear_rate_mean_1_s", "time_step_s"));
  ASSERT_EQ(run.history.rows(), 7u);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(run.history.at("time_s")[i], 0.05 * static_cast<double>(i), 1e-12);
  ASSERT_EQ(run.profiles.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.profiles[i].time, 0.1 * static_cast<double>(i), 1e-12);
  EXPECT_EQ(run.status(), runs::Status::end_time);
  EXPECT_EQ(run.info["solver"], "mpm");
  EXPECT_GT(run.info["steps"].get<int>(), 100);
}

/// A copy of the tiny slump a hundredth as large: stresses and moduli go with lengths, times and speeds with
/// the root.
scenes::Scene tiny_slump_a_hundredth_as_large() {
  return tiny_slump(
      {"geometry.cone_height=0.003", "geometry.cone_radius_top=0.0005", "geometry.cone_radius_bottom=0.001",
       "geometry.domain_radius=0.0045", "geometry.domain_height=0.0035", "material.yield_stress=0.5",
       "material.plastic_viscosity=0.05", "material.youngs_modulus=1e3", "mpm.cell=0.0002",
       "foam.cell=0.0002", "time.end=0.03", "output.history_interval=0.005", "output.profile_interval=0.01",
       "output.snapshot_interval=0.01", "output.checkpoint_interval=0.01"});
}

TEST_F(MpmRun, ACopyAHundredthAsLargeGivesTheSameNumbersScaled) {
  const auto large = run_and_read(tiny_slump(), "large");
  const auto small = run_and_read(tiny_slump_a_hundredth_as_large(), "small");
  const auto scale_of = [](const std::string& column) {
    if (column == "time_s" || column == "time_step_s") return 0.1;
    if (column.ends_with("_mm")) return 0.01;
    if (column.ends_with("_m3")) return 1e-6;
    if (column.ends_with("_J")) return 1e-8;
    if (column.ends_with("_1_s")) return 10.0;
    if (column.ends_with("_cells")) return 1.0;
    throw std::logic_error(column + " is of an unknown unit");
  };
  ASSERT_EQ(small.history.names, large.history.names);
  ASSERT_EQ(small.history.rows(), large.history.rows());
  EXPECT_EQ(small.info["steps"], large.info["steps"]);
  EXPECT_EQ(small.info["verdict"], large.info["verdict"]);
  for (const auto& name : large.history.names) {
    const auto &a = small.history.at(name), &b = large.history.at(name);
    const double scale = scale_of(name);
    double most = 0.0;
    for (const double v : b) most = std::isnan(v) ? most : std::max(most, std::abs(v));
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_EQ(std::isnan(a[i]), std::isnan(b[i])) << name << " in row " << i;
      if (std::isnan(b[i])) continue;
      EXPECT_NEAR(a[i], scale * b[i], 1e-6 * scale * most) << name << " in row " << i;
    }
    EXPECT_GT(most, 0.0) << name;
  }
  EXPECT_GT(small.history.at("spread_mm").back(), 2.0);
}

TEST_F(MpmRun, TheSpreadIsReadAtTheDepthOfTheScene) {
  const auto usual = run_and_read(tiny_slump({"time.end=0.1"}), "usual");
  const auto deep = run_and_read(tiny_slump({"time.end=0.1", "gauges.spread_depth=0.006"}), "deep");
  EXPECT_EQ(deep.history.at("spread_mm"), usual.history.at("spread_6_mm"));
  EXPECT_EQ(deep.history.at("spread_1p5_mm"), usual.history.at("spread_mm"));
  EXPECT_EQ(deep.info["gauges"]["spread_6_mm"]["depth_m"], 0.012);
  // Deeper than the cone ever is: nothing is read, and nothing is written.
  const auto none = run_and_read(tiny_slump({"time.end=0.1", "gauges.spread_depth=0.299"}), "none");
  EXPECT_TRUE(std::isnan(none.history.at("spread_mm").back()));
  EXPECT_TRUE(std::isnan(none.history.at("spread_6_mm").front()));
  EXPECT_TRUE(std::isnan(runs::read_run(folder / "none").history.at("spread_mm").back()));
}

TEST_F(MpmRun, WhatIsShownOfARunHasDigitsThatSuitTheBody) {
  const auto shown = [](const scenes::Scene& scene, double spread) {
    return runs::shown_length("spread", spread, scene.gauges.spread_depth);
  };
  EXPECT_EQ(shown(tiny_slump(), 0.408), "spread 408.0 mm");
  EXPECT_EQ(shown(tiny_slump_a_hundredth_as_large(), 0.00408), "spread 4.080 mm");
  EXPECT_EQ(shown(tiny_slump(), runs::nothing), "no spread: nowhere 3 mm deep");
}

TEST_F(MpmRun, ThixotropyAddsItsColumn) {
  const auto run = run_and_read(
      tiny_slump({"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                  "thixotropy.initial_flocculation=1.8", "time.end=0.05"}));
  EXPECT_EQ(run.history.names.end()[-2], "flocculation_mean");
  EXPECT_EQ(run.history.names.back(), "yield_stress_mean_Pa");
  EXPECT_NEAR(run.history.at("flocculation_mean")[0], 1.8, 1e-12);
  for (std::size_t i = 0; i < run.history.rows(); ++i)
    EXPECT_NEAR(run.history.at("yield_stress_mean_Pa")[i],
                50.0 * (1.0 + run.history.at("flocculation_mean")[i]), 1e-9);
}

/// Loaded below what it holds it only ages: tau0 (1 + lambda0) + A_thix t + A t_c (exp(t / t_c) - 1).
TEST_F(MpmRun, TheYieldStressGrowsAtRestAsTheClosedFormSays) {
  for (const char* model : {"elasto-viscoplastic", "papanastasiou"}) {
    auto scene = tiny_slump({"thixotropy.flocculation_rate=39", "thixotropy.deflocculation_coefficient=0",
                             "thixotropy.initial_flocculation=80", "thixotropy.ageing_rate=700",
                             "thixotropy.ageing_time=0.2", "thixotropy.initial_age=0.05", "time.end=0.2",
                             std::string("material.model=") + model, "runs.mpm=" + std::string(model)});
    const auto run = run_and_read(scene);
    const auto& time = run.history.at("time_s");
    ASSERT_GT(run.history.rows(), 3u);
    for (std::size_t i = 0; i < time.size(); ++i)
      EXPECT_NEAR(run.history.at("yield_stress_mean_Pa")[i],
                  50.0 * 81.0 + 39.0 * time[i] + 700.0 * 0.2 * std::expm1((0.05 + time[i]) / 0.2), 1e-8)
          << model << " at " << time[i];
  }
}

/// A slump that ages faster spreads less: the solver feels what the column says.
TEST_F(MpmRun, WhatAgesSpreadsLess) {
  const std::vector<std::string> flocs = {"thixotropy.flocculation_rate=0",
                                          "thixotropy.deflocculation_coefficient=0",
                                          "thixotropy.initial_flocculation=0", "time.end=0.4"};
  const auto spread_with = [&](const std::string& rate, const std::string& name) {
    auto set = with(flocs, {"thixotropy.ageing_rate=" + rate});
    run(tiny_slump(set), options(name));
    return runs::read_run(folder / name).history.at("spread_mm").back();
  };
  EXPECT_LT(spread_with("2000", "aged"), spread_with("0", "ageless") - 10.0);
}

TEST_F(MpmRun, ADuctHasItsOwnGauges) {
  const auto scene =
      scenes::load_scene("poiseuille-step-down", {{"mpm.cell=0.02", "time.end=0.04", "mpm.threads=1"}, {}});
  const auto run = run_and_read(scene);
  EXPECT_EQ(run.history.names[1], "plug_velocity_m_s");
  EXPECT_EQ(run.history.names[2], "mean_velocity_m_s");
  // The middle does not know of the walls before a shear wave (4.1 m/s) has come: until then it falls along
  // the duct.
  EXPECT_NEAR(run.history.at("plug_velocity_m_s").back(), 2000.0 / 2000.0 * 0.04, 1e-4);
}

TEST_F(MpmRun, AProfilesVolumeIsTheVolumeOfTheParticles) {
  for (const std::string dimension : {"axisymmetric", "quarter", "full", "plane"}) {
    const bool solid = dimension == "quarter" || dimension == "full";
    const auto run =
        run_and_read(tiny_slump({"geometry.dimension=" + dimension, "time.end=0.1",
                                 solid ? "mpm.particles_per_cell=8" : "mpm.particles_per_cell=9"}),
                     dimension);
    const auto& profile = run.profiles.back();
    double volume = 0.0;
    for (std::size_t i = 0; i < profile.value.size(); ++i) {
      const double inner = profile.coordinate[i] - 0.01, outer = profile.coordinate[i] + 0.01;
      volume +=
          profile.value[i] *
          (dimension == "plane" ? 2.0 * (outer - inner) : std::numbers::pi * (outer * outer - inner * inner));
    }
    const double expected = run.history.at("volume_m3").back();
    EXPECT_NEAR(volume, expected, 1e-12 * expected) << dimension;
    const double cone = dimension == "plane" ? 0.045 : 5.497787143782138e-3;
    EXPECT_NEAR(run.history.at("volume_at_rest_m3").back(), cone, 1e-11 * cone) << dimension;
  }
}

TEST_F(MpmRun, EveryFigureOfTheWholeBodyIsTheSameForAQuarterAndTheFullCone) {
  std::vector<runs::Run> both;
  for (const std::string dimension : {"quarter", "full"})
    both.push_back(run_and_read(
        tiny_slump({"geometry.dimension=" + dimension, "mpm.particles_per_cell=8", "time.end=0.2"}),
        dimension));
  for (const auto& name : both[0].history.names) {
    const double a = both[0].history.at(name).back(), b = both[1].history.at(name).back();
    EXPECT_NEAR(a, b, 1e-7 * std::abs(a) + (name == "numerical_energy_J" ? 1e-6 : 0.0)) << name;
  }
}

TEST_F(MpmRun, TheSameSceneGivesTheSameBytes) {
  run(tiny_slump(), options("a"));
  run(tiny_slump(), options("b"));
  expect_same_run(folder / "a", folder / "b");
}

TEST_F(MpmRun, StepsLandOnTheRowsOfTheHistoryAndKeepTheCourantNumber) {
  const auto run = run_and_read(tiny_slump({"mpm.cfl=0.5"}));
  const auto scene = tiny_slump();
  const double largest = 0.5 * 0.02 / scene.material.longitudinal_speed();
  for (std::size_t i = 1; i < run.history.rows(); ++i) EXPECT_LE(run.history.at("time_step_s")[i], largest);
}

TEST_F(MpmRun, AnEndTimeBelowOneStepDoesOneStep) {
  const auto run = run_and_read(tiny_slump({"time.end=1e-7"}));
  EXPECT_EQ(run.info["steps"], 1);
  EXPECT_DOUBLE_EQ(run.history.at("time_s").back(), 1e-7);
}

class ResumedRun : public RunTest,
                   public testing::WithParamInterface<std::tuple<std::string, std::string, std::string>> {
 protected:
  std::vector<std::string> settings() const {
    const auto& [scheme, model, precision] = GetParam();
    std::vector<std::string> set = {"mpm.scheme=" + scheme, "material.model=" + model,
                                    "mpm.precision=" + precision};
    if (model != "elasto-viscoplastic") return set;
    return with(set, {"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                      "thixotropy.initial_flocculation=1.8", "thixotropy.ageing_rate=50",
                      "thixotropy.ageing_time=0.7", "thixotropy.initial_age=0.1",
                      scheme == "linear-flip" ? "thixotropy.breakdown_exponent=0.6"
                                              : "thixotropy.breakdown_exponent=1"});
  }
};

TEST_P(ResumedRun, GoesOnBitForBitFromAnyStep) {
  const auto scene = tiny_slump(settings());
  run(scene, options("whole"));
  for (const int step : {17, 83}) {
    const std::string name = "stopped after " + std::to_string(step);
    auto stopped = options(name);
    stopped.interrupted = stop_after(step);
    EXPECT_EQ(run(scene, stopped).status, runs::Status::interrupted);
    EXPECT_EQ(runs::read_run(folder / name).status(), runs::Status::interrupted);
    EXPECT_EQ(read_checkpoint(folder / name)->run.steps, step);
    // And once more on the way.
    stopped.interrupted = stop_after(31);
    EXPECT_EQ(resume(stopped).status, runs::Status::interrupted);
    EXPECT_EQ(resume(options(name)).status, runs::Status::end_time);
    expect_same_run(folder / "whole", folder / name);
  }
}

TEST_P(ResumedRun, GoesOnBitForBitFromTheLastCheckpointAfterAPowerCut) {
  const auto scene = tiny_slump(settings());
  run(scene, options("whole"));
  auto cut = options("cut");
  cut.interrupted = cut_after(110);  // past the checkpoint at 0.1 s and rows after it
  EXPECT_THROW(run(scene, cut), PowerCut);
  ASSERT_TRUE(read_checkpoint(folder / "cut"));
  EXPECT_LT(read_checkpoint(folder / "cut")->run.steps, 110.0);
  EXPECT_EQ(resume(options("cut")).status, runs::Status::end_time);
  expect_same_run(folder / "whole", folder / "cut");
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, ResumedRun,
                         testing::Combine(testing::Values("quadratic-apic", "linear-flip"),
                                          testing::Values("elasto-viscoplastic", "papanastasiou"),
                                          testing::Values("double", "float")),
                         [](const auto& tested) {
                           std::string name = std::get<0>(tested.param) + "_" + std::get<1>(tested.param) +
                                              "_" + std::get<2>(tested.param);
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST_F(MpmRun, ResumedBeforeItsFirstCheckpointItStartsOver) {
  run(tiny_slump(), options("whole"));
  auto cut = options("cut");
  cut.interrupted = cut_after(3);
  EXPECT_THROW(run(tiny_slump(), cut), PowerCut);
  EXPECT_FALSE(read_checkpoint(folder / "cut"));
  EXPECT_EQ(resume(options("cut")).status, runs::Status::end_time);
  expect_same_run(folder / "whole", folder / "cut");
}

TEST_F(MpmRun, InterruptedWhileItSettlesItRestsAtTheSameTime) {
  // A bound that is soon met must hold for half a second: the interruption falls into it.
  const auto scene = tiny_slump({"time.end=20", "time.rest_bound=0.1"});
  ASSERT_EQ(run(scene, options("whole")).status, runs::Status::at_rest);
  const auto whole = runs::read_run(folder / "whole");
  auto stopped = options("stopped");
  stopped.interrupted = stop_after(whole.info["steps"].get<int>() - 100);
  ASSERT_EQ(run(scene, stopped).status, runs::Status::interrupted);
  EXPECT_GE(read_checkpoint(folder / "stopped")->run.calm_since, 0.0);
  ASSERT_EQ(resume(options("stopped")).status, runs::Status::at_rest);
  const auto rested = runs::read_run(folder / "stopped");
  EXPECT_EQ(rested.info["rest_time_s"].get<double>(), whole.info["rest_time_s"].get<double>());
  EXPECT_EQ(rested.info["steps"].get<int>(), whole.info["steps"].get<int>());
  expect_same_run(folder / "whole", folder / "stopped");
}

/// What the folder of a run holds, by name.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().string()] = text_of(entry.path());
  return files;
}

std::string refusal_to_resume(const RunOptions& options, const std::vector<std::string>& set = {}) {
  try {
    resume(options, set);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(MpmRun, AFinishedRunIsNotGoneOnWithAndStaysAsItIs) {
  for (const bool has_checkpoint : {true, false}) {
    run(tiny_slump(), options("run"));
    if (!has_checkpoint) fs::remove(folder / "run" / "checkpoint.h5");
    const auto files = files_of(folder / "run");
    EXPECT_THAT(refusal_to_resume(options("run")), HasSubstr("is finished"));
    EXPECT_THAT(refusal_to_resume(options("run"), {"time.end=0.2"}), HasSubstr("time.end=... above 0.3 s"));
    EXPECT_THAT(refusal_to_resume(options("run"), {"time.end=1", "mpm.cell=0.01"}), HasSubstr("mpm.cell"));
    if (!has_checkpoint) {
      EXPECT_THAT(refusal_to_resume(options("run"), {"time.end=1"}), HasSubstr("no checkpoint.h5"));
    }
    EXPECT_EQ(files_of(folder / "run"), files);
  }
}

TEST_F(MpmRun, AResumedRunKeepsTheNameOfItsScene) {
  auto stopped = options("run");
  stopped.interrupted = stop_after(20);
  run(tiny_slump(), stopped);
  resume(options("run"));
  const auto info = runs::read_run(folder / "run").info;
  EXPECT_EQ(info["scene_name"], "roussel-slump");
  EXPECT_EQ(info["scene"], tiny_slump().source);
  EXPECT_EQ(info["title"], tiny_slump().title);
}

/// Runs to one end and prolongs it to another, beside one that was that long from the start.
class ProlongedRun : public RunTest, public testing::WithParamInterface<const char*> {};

TEST_P(ProlongedRun, IsTheRunThatWasThatLongFromTheStart) {
  run(tiny_slump(), options("whole"));
  ASSERT_EQ(run(tiny_slump({std::string("time.end=") + GetParam()}), options("run")).status,
            runs::Status::end_time);
  EXPECT_EQ(resume(options("run"), {"time.end=0.3"}).status, runs::Status::end_time);
  expect_same_run(folder / "whole", folder / "run");
}

// On a row and a profile, on a row alone, between rows, within the first row, in the last steps before a row.
INSTANTIATE_TEST_SUITE_P(FromAnyEnd, ProlongedRun, testing::Values("0.2", "0.15", "0.17", "0.01", "0.1999"));

TEST_F(MpmRun, ProlongedByRowsWhoseTimesRoundItIsTheLongerRun) {
  // 3 * 0.1 is more than 0.3, and 7 * 0.1 than 0.7.
  const std::vector<std::string> rows = {"output.history_interval=0.1", "output.profile_interval=0.1"};
  run(tiny_slump(with(rows, {"time.end=0.7"})), options("whole"));
  run(tiny_slump(with(rows, {"time.end=0.3"})), options("run"));
  resume(options("run"), {"time.end=0.7"});
  expect_same_run(folder / "whole", folder / "run");
  EXPECT_EQ(runs::read_run(folder / "run").history.rows(), 8u);
}

TEST_F(MpmRun, ProlongedTwiceAndInterruptedOnTheWayItIsTheLongerRun) {
  run(tiny_slump(), options("whole"));
  run(tiny_slump({"time.end=0.07"}), options("run"));
  resume(options("run"), {"time.end=0.13"});
  auto stopped = options("run");
  stopped.interrupted = stop_after(20);
  EXPECT_EQ(resume(stopped, {"time.end=0.22"}).status, runs::Status::interrupted);
  EXPECT_EQ(runs::read_run(folder / "run").info["settings"]["time"]["end"], 0.22);
  stopped.interrupted = cut_after(30);
  EXPECT_THROW(resume(stopped, {"time.end=0.3"}), PowerCut);
  // It was prolonged, whatever cut it off: the end is no more to be said.
  resume(options("run"));
  expect_same_run(folder / "whole", folder / "run");
}

TEST_F(MpmRun, InterruptedInTheLastStepsBeforeItsEndItIsProlongedAllTheSame) {
  run(tiny_slump(), options("whole"));
  run(tiny_slump({"time.end=0.17"}), options("short"));
  auto stopped = options("run");
  stopped.interrupted = stop_after(runs::read_run(folder / "short").info["steps"].get<int>() - 1);
  ASSERT_EQ(run(tiny_slump({"time.end=0.17"}), stopped).status, runs::Status::interrupted);
  resume(options("run"), {"time.end=0.3"});
  expect_same_run(folder / "whole", folder / "run");
}

TEST_F(MpmRun, AnInterruptedRunCanBeMadeShorterButNotThanItIs) {
  run(tiny_slump({"time.end=0.22"}), options("whole"));
  auto stopped = options("run");
  stopped.interrupted = stop_after(100);
  run(tiny_slump(), stopped);
  EXPECT_THAT(refusal_to_resume(options("run"), {"time.end=0.1"}),
              HasSubstr("has come further; allowed: from 0.2"));
  EXPECT_EQ(resume(options("run"), {"time.end=0.22"}).status, runs::Status::end_time);
  expect_same_run(folder / "whole", folder / "run");
}

TEST_F(MpmRun, ThreadsAndCheckpointsMayChangeWhileItGoesOn) {
  run(tiny_slump({"mpm.threads=2", "output.checkpoint_interval=0.2"}), options("whole"));
  auto stopped = options("run");
  stopped.interrupted = stop_after(70);
  run(tiny_slump(), stopped);
  resume(options("run"), {"mpm.threads=2", "output.checkpoint_interval=0.2"});
  expect_same_run(folder / "whole", folder / "run");
}

TEST_F(MpmRun, ARestedRunIsProlongedPastItsRest) {
  const std::vector<std::string> rests = {"time.end=20", "time.rest_bound=0.1",
                                          "output.profile_interval=0.25"};
  ASSERT_EQ(run(tiny_slump(rests), options("run")).status, runs::Status::at_rest);
  const double rest = runs::read_run(folder / "run").info["simulated_s"];
  const auto end = "time.end=" + std::to_string(rest + 0.23);
  // A longer end alone changes nothing but what it says of it.
  run(tiny_slump(with(rests, {"time.end=30"})), options("longer"));
  EXPECT_EQ(resume(options("run"), {"time.end=30"}).status, runs::Status::at_rest);
  expect_same_run(folder / "longer", folder / "run");

  run(tiny_slump(with(rests, {end, "time.stop_at_rest=false"})), options("whole"));
  EXPECT_EQ(resume(options("run"), {end, "time.stop_at_rest=false"}).status, runs::Status::end_time);
  expect_same_run(folder / "whole", folder / "run");
}

TEST_F(MpmRun, AnInterruptionInTheMidstOfANoiseMeasurementLeavesNoTrace) {
  // Its first three steps are looked at, and those after a row 200 steps later.
  const auto scene = tiny_slump({"time.end=0.05"});
  run(scene, options("whole"));
  for (const int step : {1, 2, 3}) {
    const std::string name = std::to_string(step);
    auto stopped = options(name);
    stopped.interrupted = stop_after(step);
    run(scene, stopped);
    resume(options(name));
    expect_same_run(folder / "whole", folder / name);
  }
}

TEST_F(MpmRun, EveryTimeIsInEveryTableOnceWhateverEndsTheRun) {
  const std::vector<std::string> rests = {"time.end=20", "time.rest_bound=0.1"};
  run(tiny_slump(), options("end"));
  run(tiny_slump(with(rests, {"output.profile_interval=0.05", "output.snapshot_interval=0.05"})),
      options("rest"));
  auto stopped = options("stopped");
  stopped.interrupted = stop_after(100);
  run(tiny_slump(), stopped);
  EXPECT_EQ(runs::read_run(folder / "rest").status(), runs::Status::at_rest);
  for (const char* name : {"end", "rest", "stopped"}) {
    const auto run = runs::read_run(folder / name);
    const auto& time = run.history.at("time_s");
    for (std::size_t i = 1; i < time.size(); ++i) EXPECT_GT(time[i], time[i - 1]) << name;
    std::size_t points = run.profiles.front().value.size();
    for (const auto& profile : run.profiles) {
      EXPECT_LT(profile.value.size(), 2 * points) << name << " at " << profile.time << " s";
      points = profile.value.size();
    }
    const auto series = nlohmann::json::parse(text_of(folder / name / "particles" / "particles.hdf.series"));
    double last = -1.0;
    for (const auto& entry : series["files"]) {
      EXPECT_GT(entry["time"].get<double>(), last) << name;
      last = entry["time"];
    }
  }
}

TEST_F(MpmRun, ARunOfThePlainMethodGoesOnWithIt) {
  auto plain = options("whole");
  plain.method = Method::plain;
  run(tiny_slump({"time.end=0.1"}), plain);
  plain.directory = folder / "run";
  run(tiny_slump({"time.end=0.05"}), plain);
  auto with_instructions = options("run");
  with_instructions.instruction_set = "generic";
  EXPECT_THAT(refusal_to_resume(with_instructions, {"time.end=0.1"}), HasSubstr("has no instruction set"));
  resume(options("run"), {"time.end=0.1"});
  expect_same_run(folder / "whole", folder / "run");
}

TEST_F(MpmRun, ARunOfAnotherInstructionSetGoesOnWithIt) {
  auto stopped = options("run");
  stopped.instruction_set = "generic";
  run(tiny_slump(), stopped);
  resume(options("run"), {"time.end=0.35"});
  EXPECT_EQ(runs::read_run(folder / "run").info["instruction_set"], "generic");
}

TEST_F(MpmRun, WhatWasKilledBeforeItsFirstCheckpointIsGoneOnWith) {
  { const runs::RunWriter killed_here(folder / "run", tiny_slump(), "mpm"); }
  EXPECT_EQ(resume(options("run")).status, runs::Status::end_time);
}

TEST_F(MpmRun, NothingToResumeIsAnError) {
  fs::create_directories(folder / "empty");
  EXPECT_THROW(resume(options("empty")), runs::RunError);
  EXPECT_THROW(resume(options("missing")), runs::RunError);
}

TEST_F(MpmRun, ADamagedCheckpointIsAnErrorThatNamesIt) {
  run(tiny_slump(), options("run"));
  const fs::path file = folder / "run" / "checkpoint.h5";
  const std::string whole = text_of(file);
  const auto refusal = [&] { return refusal_to_resume(options("run"), {"time.end=1"}); };
  for (const std::size_t kept : {std::size_t{0}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << whole.substr(0, kept);
    EXPECT_THAT(refusal(), HasSubstr("checkpoint.h5"))
        << "cut to " << kept << " of " << whole.size() << " bytes";
  }
  std::ofstream(file, std::ios::binary | std::ios::trunc) << std::string(whole.size(), '?');
  EXPECT_THAT(refusal(), HasSubstr("checkpoint.h5"));
  // History and profiles are as they were.
  EXPECT_EQ(runs::read_run(folder / "run").history.rows(), 7u);
}

TEST_F(MpmRun, ACheckpointReadsBackAsItWasWritten) {
  RunState written;
  written.time = 1.0 / 3.0;
  written.steps = 12345.0;
  written.calm_since = -1.0;
  written.checkpoints = 7.0;
  written.stages.nodes = 0.25;
  const std::vector<double> noise_meter = {2.0, 0.1, 0.2, 0.3};
  const std::string scene = "title = \"ä\"\n";
  const SolverSettings s = concrete({.dimension = 3});
  // More particles than are written at once, some of them far from the others.
  auto seeds = block(s, {0, 0, 0}, {16, 16, 16}, 2);
  for (std::size_t p = 0; p < seeds.size() / 2; ++p) seeds[p].cell[0] -= 400000;
  Open open(*make_solver(s, seeds), s);
  open.velocity(0)[0] = -0.0;
  open.velocity(1)[1] = 1e-300;
  open.velocity(2).back() = 1e300;
  open.state.tile_capacity = 128;
  const auto solver = make_solver(s, open.state);
  write_checkpoint(folder, written, *solver, scene, noise_meter);
  const auto read = read_checkpoint(folder);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->run.time, written.time);
  EXPECT_EQ(read->run.steps, written.steps);
  EXPECT_EQ(read->run.calm_since, written.calm_since);
  EXPECT_EQ(read->run.checkpoints, written.checkpoints);
  EXPECT_EQ(read->run.stages.nodes, 0.25);
  EXPECT_EQ(read->noise_meter, noise_meter);
  EXPECT_EQ(read->scene, scene);
  Open again(all_of(read->solver), s);
  EXPECT_EQ(again.state.cells, open.state.cells);
  EXPECT_EQ(again.state.arrays, open.state.arrays);
  EXPECT_TRUE(std::signbit(again.velocity(0)[0]));
  EXPECT_EQ(again.state.tile_capacity, 128);
}

TEST_F(MpmRun, MaterialThatReachesTheDomainsEdgeFailsAndKeepsItsData) {
  const auto scene = tiny_slump({"geometry.domain_radius=0.12", "time.end=2.0"});
  try {
    run(scene, options("run"));
    FAIL() << "nothing was thrown";
  } catch (const runs::NumericsError& error) {
    EXPECT_THAT(error.what(), HasSubstr("geometry.domain_radius"));
  }
  const auto left = runs::read_run(folder / "run");
  EXPECT_EQ(left.status(), runs::Status::failed);
  EXPECT_THAT(left.info["reason"].get<std::string>(), HasSubstr("geometry.domain_radius"));
  EXPECT_THAT(left.info["verdict"].get<std::string>(), HasSubstr("noisy"));
  EXPECT_GT(left.history.rows(), 1u);
  EXPECT_GE(left.profiles.size(), 1u);
  EXPECT_LT(left.history.at("time_s").back(), 1.0);
}

TEST_F(MpmRun, AnUnstableStepFailsWithAReason) {
  const auto scene = tiny_slump({"mpm.time_step=0.008", "mpm.allow_unstable_step=true", "time.end=1.0"});
  EXPECT_THROW(run(scene, options("run")), runs::NumericsError);
  EXPECT_EQ(runs::read_run(folder / "run").status(), runs::Status::failed);
}
