#include "runs/earlier_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::runs;
namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

class EarlierRunTest : public testing::Test {
 protected:
  EarlierRun run_that_ended(Status status) const {
    RunWriter writer(folder / "run", scene, "mpm");
    writer.finish(status, "", "sound");
    return read_earlier_run(folder / "run", "mpm");
  }
  template <class Action>
  static std::string message_of(Action action) {
    try {
      action();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  }
  static std::string refusal(const EarlierRun& run, const std::vector<std::string>& set,
                             const std::vector<std::string>& free = {}) {
    return message_of([&] { scene_to_go_on_with(run, set, free); });
  }

  scenes::Scene scene = scenes::load_scene("roussel-slump", {{"time.end=10", "mpm.threads=1"}, {}});
  TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

}  // namespace

TEST_F(EarlierRunTest, HasTheNameTitleAndTextOfItsScene) {
  const EarlierRun run = run_that_ended(Status::interrupted);
  EXPECT_EQ(run.scene.name, "roussel-slump");
  EXPECT_EQ(run.scene.title, scene.title);
  EXPECT_EQ(run.scene.source, scene.source);
  EXPECT_TRUE(differing_settings(run.scene, scene).empty());
  EXPECT_EQ(scene_to_go_on_with(run, {}).name, "roussel-slump");
}

TEST_F(EarlierRunTest, AnotherSolversRunIsRefusedByName) {
  run_that_ended(Status::interrupted);
  EXPECT_THAT(message_of([&] { read_earlier_run(folder / "run", "foam"); }),
              HasSubstr("is not a run of `flowrest foam` that can be gone on with"));
  EXPECT_THAT(message_of([&] { read_earlier_run(folder / "missing", "mpm"); }),
              HasSubstr("is not a run of `flowrest mpm` that can be gone on with"));
}

TEST_F(EarlierRunTest, AFinishedRunIsOnlyProlonged) {
  for (const Status status : {Status::end_time, Status::at_rest}) {
    const EarlierRun run = run_that_ended(status);
    const auto finished = AllOf(HasSubstr("is finished"), HasSubstr("time.end=... above 10 s prolongs it"));
    EXPECT_THAT(refusal(run, {}), finished);
    EXPECT_THAT(refusal(run, {"time.end=9"}), finished);
    EXPECT_THAT(refusal(run, {"time.end=10"}), finished);
    EXPECT_EQ(scene_to_go_on_with(run, {"time.end=20"}).time.end, 20.0);
  }
  const EarlierRun rested = run_that_ended(Status::at_rest);
  EXPECT_FALSE(scene_to_go_on_with(rested, {"time.stop_at_rest=false"}).time.stop_at_rest);
}

TEST_F(EarlierRunTest, WhatWouldBeAnotherRunIsRefusedByName) {
  const EarlierRun run = run_that_ended(Status::interrupted);
  for (const char* setting : {"mpm.cell=0.02", "material.yield_stress=51", "output.history_interval=0.1",
                              "output.profile_interval=1", "output.snapshot_interval=2", "title=other",
                              "runs.mpm=newtonian", "walls.base=slip"}) {
    const std::string key = std::string(setting).substr(0, std::string(setting).find('='));
    EXPECT_THAT(refusal(run, {"time.end=20", setting}),
                AllOf(HasSubstr(key), HasSubstr("the settings it began with"),
                      HasSubstr("allowed with --resume: --set of time.end, time.stop_at_rest=false")))
        << setting;
  }
  EXPECT_THAT(refusal(run, {"mpm.threads=2"}), HasSubstr("mpm.threads = 1"));
  EXPECT_EQ(scene_to_go_on_with(run, {"mpm.threads=2"}, {"mpm.threads"}).mpm.threads, 2);
  EXPECT_EQ(refusal(run, {"mpm.threads=1"}), "accepted") << "that is what it has";
  EXPECT_THAT(refusal(run, {"time.end=-1"}), HasSubstr("time.end"));
  EXPECT_THAT(refusal(run, {"time.ende=20"}), HasSubstr("nearest"));
}

TEST_F(EarlierRunTest, WhatItAsksForGivesEachKeyOnce) {
  const EarlierRun run = run_that_ended(Status::end_time);
  for (const char* setting : {"time.end=20", "time.end = 20"})
    EXPECT_THAT(scene_to_go_on_with(run, {setting}).request.overrides.set,
                ElementsAre("mpm.threads=1", setting));
}

TEST_F(EarlierRunTest, StoppingAtRestCannotBeTurnedOnLater) {
  scene.time.stop_at_rest = false;
  const EarlierRun run = run_that_ended(Status::interrupted);
  EXPECT_THAT(refusal(run, {"time.stop_at_rest=true"}), HasSubstr("it may have been at rest before"));
}

TEST_F(EarlierRunTest, AnEndThatHasPassedIsRefused) {
  const EarlierRun run = run_that_ended(Status::interrupted);
  const scenes::Scene shorter = scene_to_go_on_with(run, {"time.end=3"});
  EXPECT_EQ(message_of([&] { check_end(run, shorter, 3.0); }), "accepted");
  EXPECT_THAT(message_of([&] { check_end(run, shorter, 3.05); }), HasSubstr("allowed: from 3.05 s"));
}

TEST(BesideResume, OptionsWithoutEffectAreNamed) {
  refuse_beside_resume({}, "--set");
  try {
    refuse_beside_resume({"--model", "--output"}, "--set, --json");
    FAIL() << "accepted";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("--model and --output"), HasSubstr("--set, --json")));
  }
}
