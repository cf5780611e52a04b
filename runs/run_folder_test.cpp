#include "runs/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::runs;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::HasSubstr;

namespace {

class RunFolderTest : public testing::Test {
 protected:
  static scenes::Scene scene(const std::vector<std::string>& set = {}) {
    return scenes::load_scene("roussel-slump", {set, {}});
  }

  void leave(Status status, const std::vector<std::string>& set = {}) const {
    RunWriter writer(folder_, scene(set), "mpm", Replace::anything);
    writer.history_columns({"time_s", "spread_mm"});
    writer.history(std::vector{0.0, 200.0});
    if (status == Status::failed)
      writer.fail({Fault::numerics, "too fast"});
    else
      writer.finish(status, "", "sound");
  }

  /// Ended by the machine.
  void leave_cut_off() const {
    leave(Status::running);
    RunWriter::resume(folder_, scene(), 0.0).fail({Fault::machine, "the disk is full"});
  }

  void change(const std::string& key, const Json& value) const {
    Json info = read_run(folder_).info;
    info[Json::json_pointer(key)] = value;
    write_atomically(folder_ / "run.json", info.dump());
  }

  std::string refusal(const std::vector<std::string>& set = {}, const std::string& solver = "mpm",
                      Replace replace = Replace::failed, const Json& beside = Json::object()) const {
    try {
      const RunFolder folder(folder_, scene(set), solver, replace, beside);
      return folder.is_finished() ? "there already" : "free";
    } catch (const RunError& error) {
      return error.what();
    }
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_ / "run";
};

}  // namespace

TEST_F(RunFolderTest, AFinishedRunOfTheSameSettingsIsTakenAsItIs) {
  for (const Status status : {Status::at_rest, Status::end_time}) {
    leave(status);
    EXPECT_EQ(refusal(), "there already");
    EXPECT_EQ(refusal({"title=another", "mpm.threads=2", "foam.cell=0.03"}), "there already")
        << "what does not bear on it may differ";
    EXPECT_EQ(refusal({}, "mpm", Replace::anything), "free");
  }
  EXPECT_THAT(RunFolder(folder_, scene(), "mpm").finished_words(), HasSubstr("is there already (end-time)"));
}

TEST_F(RunFolderTest, AFinishedRunOfOtherSettingsIsRefusedAndTheyAreNamed) {
  leave(Status::end_time);
  const Json before = read_run(folder_).info;
  EXPECT_EQ(
      refusal({"time.end=2", "mpm.cell=0.02"}),
      folder_.string() +
          ": holds a finished run of other settings: time.end is 60.0 there and 2.0 here, mpm.cell is " +
          before["settings"]["mpm"]["cell"].dump() +
          " there and 0.02 here; name another folder with -o, or --force to replace that run");
  EXPECT_THAT(refusal({}, "foam"), HasSubstr("solver is mpm there and foam here"));
  EXPECT_EQ(read_run(folder_).info, before);
  EXPECT_EQ(read_run(folder_).history.rows(), 1u);
  EXPECT_EQ(refusal({"time.end=2"}, "mpm", Replace::anything), "free");
}

TEST_F(RunFolderTest, AnotherVersionsRunIsAnotherRun) {
  leave(Status::end_time);
  change("/provenance/git_hash", "0123456789abcdef");
  EXPECT_THAT(refusal(), HasSubstr("a finished run of the same settings by another version, flowrest"));
  EXPECT_THAT(refusal(), HasSubstr("(commit 0123456789ab"));
}

TEST_F(RunFolderTest, AnUnfinishedRunIsToBeGoneOnWith) {
  for (const Status status : {Status::running, Status::interrupted}) {
    leave(status);
    EXPECT_THAT(refusal(), HasSubstr("go on with it: flowrest mpm --resume " + folder_.string()));
    EXPECT_THAT(refusal(), HasSubstr("--force"));
    EXPECT_THAT(refusal({"time.end=2"}), HasSubstr("holds an unfinished run of other settings: time.end"));
    EXPECT_EQ(refusal({}, "mpm", Replace::unfinished), "free");
    EXPECT_EQ(standing_in(folder_, scene(), "mpm"), Standing::unfinished);
  }
}

TEST_F(RunFolderTest, AFailedRunMakesRoomUnlessTheMachineFailedIt) {
  leave(Status::failed);
  EXPECT_EQ(refusal(), "free");
  EXPECT_EQ(refusal({"time.end=2"}), "free");
  leave_cut_off();
  EXPECT_THAT(refusal(), HasSubstr("go on with it"));
  EXPECT_THAT(refusal({"time.end=2"}), HasSubstr("of other settings"));
}

TEST_F(RunFolderTest, WhatIsAskedForBesidesTheSceneMustBeTheSame) {
  {
    RunWriter(RunFolder(folder_, scene(), "mpm", Replace::failed, {{"flocculation", 0.1}}))
        .finish(Status::at_rest, "", "sound");
  }
  EXPECT_EQ(refusal({}, "mpm", Replace::failed, {{"flocculation", 0.1}}), "there already");
  EXPECT_THAT(refusal({}, "mpm", Replace::failed, {{"flocculation", 0.2}}),
              HasSubstr("flocculation is 0.1 there and 0.2 here"));
  EXPECT_THAT(refusal({}, "mpm", Replace::failed, {{"flocculation", nullptr}}),
              HasSubstr("flocculation is 0.1 there and not given here"));
}

TEST_F(RunFolderTest, ASecondWriterIsRefusedWhateverItIsForced) {
  const RunWriter writer(folder_, scene(), "mpm");
  const auto written = fs::last_write_time(folder_ / "run.json");
  EXPECT_THAT(refusal({}, "mpm", Replace::anything), HasSubstr("is writing here"));
  EXPECT_THROW(RunWriter::resume(folder_, scene(), 0.0), RunError);
  EXPECT_EQ(fs::last_write_time(folder_ / "run.json"), written);
}

TEST_F(RunFolderTest, ARefusedFolderIsLeftAsItWas) {
  fs::create_directory(folder_);
  std::ofstream(folder_ / "chapter1.tex") << "years of work";
  EXPECT_THAT(refusal({}, "mpm", Replace::anything), HasSubstr("not empty and not a run"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(RunFolderTest, ManyDifferencesAreCounted) {
  const auto set = std::vector<std::string>{"time.end=2",
                                            "mpm.cell=0.02",
                                            "mpm.cfl=0.3",
                                            "material.density=2000",
                                            "material.yield_stress=40",
                                            "output.history_interval=0.2",
                                            "output.profile_interval=2",
                                            "output.snapshot_interval=2"};
  leave(Status::end_time);
  EXPECT_THAT(refusal(set), HasSubstr(" and 2 more; name"));
}
