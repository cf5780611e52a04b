#include "runs/run_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::runs;
namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void put(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

template <class Function>
std::string message_of(Function function) {
  try {
    function();
  } catch (const RunError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

class RunDirectory : public testing::Test {
 protected:
  /// A run with history at 0, 0.1, ..., 0.9 s and a profile of three points at 0 and 0.5 s.
  void write_run(const fs::path& directory, Status status = Status::end_time) {
    RunWriter writer(directory, scene, "mpm");
    writer.history_columns({"time_s", "spread_mm"});
    for (int i = 0; i < 10; ++i) writer.history(std::vector{0.1 * i, 200.0 + i / 3.0});
    for (const double time : {0.0, 0.5})
      writer.profile(time, std::vector{0.005, 0.015, 0.025}, std::vector{0.3, 0.2, 0.1});
    writer.finish(status, "", "sound");
  }

  scenes::Scene scene = scenes::load_scene("roussel-slump");
  TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

}  // namespace

TEST_F(RunDirectory, ReadsBackWhatWasWritten) {
  write_run(folder / "run");
  const runs::Run run = read_run(folder / "run");
  EXPECT_EQ(run.info["title"], scene.title);
  EXPECT_EQ(run.info["scene"], scene.source);
  EXPECT_EQ(run.info["kind"], "slump");
  EXPECT_EQ(run.info["settings"]["material"]["yield_stress"], 50.0);
  EXPECT_EQ(run.info["verdict"], "sound");
  EXPECT_EQ(run.status(), Status::end_time);
  EXPECT_EQ(run.label(), "MPM elasto-viscoplastic");
  ASSERT_EQ(run.history.rows(), 10u);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(run.history.at("spread_mm")[i], 200.0 + i / 3.0);  // to the last bit
  ASSERT_EQ(run.profiles.size(), 2u);
  EXPECT_EQ(run.profiles[1].time, 0.5);
  EXPECT_THAT(run.profiles[1].value, ElementsAre(0.3, 0.2, 0.1));
}

TEST_F(RunDirectory, CarriesItsProvenance) {
  write_run(folder / "run");
  const auto provenance = read_run(folder / "run").info["provenance"];
  for (const char* key : {"flowrest", "git_hash", "compiler", "cpu", "system", "build", "written"})
    EXPECT_FALSE(provenance[key].get<std::string>().empty()) << key;
  const std::string hash = provenance["git_hash"];
  EXPECT_TRUE(hash == "unknown" || hash.size() == 40) << hash;
  EXPECT_TRUE(provenance["git_dirty"].is_boolean());
  EXPECT_GE(provenance["cores"].get<int>(), 1);
}

TEST_F(RunDirectory, NumbersKeepSeventeenDigits) {
  write_run(folder / "run");
  EXPECT_THAT(text_of(folder / "run" / "history.csv"), HasSubstr("0.10000000000000001,200.33333333333334\n"));
}

TEST_F(RunDirectory, RunJsonIsReplacedWhole) {
  const fs::path path = folder / "run" / "run.json";
  RunWriter writer(folder / "run", scene, "mpm");
  EXPECT_EQ(read_run(folder / "run").status(), Status::running);
  std::ifstream reader(path);  // holds the old file open while the new one comes
  writer.info()["steps"] = 12;
  writer.finish(Status::at_rest, "the bound fell under 0.6 %", "sound");
  const std::string old{std::istreambuf_iterator<char>(reader), std::istreambuf_iterator<char>()};
  EXPECT_EQ(nlohmann::json::parse(old)["status"], "running") << "the old file was written into";
  EXPECT_EQ(nlohmann::json::parse(text_of(path))["steps"], 12);
  for (const auto& entry : fs::directory_iterator(folder / "run"))
    EXPECT_TRUE(entry.path().filename() == "run.json" || entry.path().filename() == FolderLock::file_name)
        << "a temporary file stayed: " << entry.path();
}

TEST_F(RunDirectory, AFailedWriteLeavesTheOldFile) {
  put(folder / "run.json", "old");
  fs::create_directory(folder / "run.json.part");  // the temporary file cannot be opened
  EXPECT_THAT(message_of([&] { write_atomically(folder / "run.json", "new"); }),
              HasSubstr("cannot be written"));
  EXPECT_EQ(text_of(folder / "run.json"), "old");
}

TEST_F(RunDirectory, RefusesAFolderThatIsNotARun) {
  fs::create_directory(folder / "thesis");
  put(folder / "thesis" / "chapter1.tex", "years of work");
  EXPECT_THAT(message_of([&] { RunWriter(folder / "thesis", scene, "mpm"); }),
              HasSubstr("not empty and not a run"));
  put(folder / "thesis" / "run.json", "{\"format\": \"something else\"}");
  EXPECT_THAT(message_of([&] { RunWriter(folder / "thesis", scene, "mpm"); }), HasSubstr("flowrest run"));
  EXPECT_EQ(text_of(folder / "thesis" / "chapter1.tex"), "years of work");
  put(folder / "file", "x");
  EXPECT_THAT(message_of([&] { RunWriter(folder / "file", scene, "mpm"); }),
              HasSubstr("cannot be made a folder"));
}

TEST_F(RunDirectory, ReplacesAnEarlierRunAndNothingElse) {
  write_run(folder / "run");
  fs::create_directory(folder / "run" / "particles");
  put(folder / "run" / "checkpoint.h5", "x");
  put(folder / "run" / "notes.txt", "mine");
  RunWriter writer(folder / "run", scene, "foam", Replace::anything);
  EXPECT_FALSE(fs::exists(folder / "run" / "history.csv"));
  EXPECT_FALSE(fs::exists(folder / "run" / "profiles.csv"));
  EXPECT_FALSE(fs::exists(folder / "run" / "particles"));
  EXPECT_FALSE(fs::exists(folder / "run" / "checkpoint.h5"));
  EXPECT_EQ(text_of(folder / "run" / "notes.txt"), "mine");
  EXPECT_EQ(read_run(folder / "run").info["solver"], "foam");
}

TEST_F(RunDirectory, ResumesAtATime) {
  write_run(folder / "run", Status::interrupted);
  {
    std::ofstream file(folder / "run" / "history.csv", std::ios::app);
    file << "0.95,20";  // cut off in the middle of a row
  }
  RunWriter writer = RunWriter::resume(folder / "run", scene, 0.4);
  writer.history_columns({"time_s", "spread_mm"});
  writer.history(std::vector{0.45, 7.0});
  writer.profile(0.45, std::vector{0.005, 0.015, 0.025}, std::vector{3.0, 2.0, 1.0});
  writer.finish(Status::at_rest, "", "sound");
  const runs::Run run = read_run(folder / "run");
  EXPECT_THAT(run.history.at("time_s"), ElementsAre(0.0, 0.1, 0.2, 0.1 * 3, 0.4, 0.45));
  ASSERT_EQ(run.profiles.size(), 2u);
  EXPECT_EQ(run.profiles[0].time, 0.0);
  EXPECT_EQ(run.profiles[1].time, 0.45);
  EXPECT_EQ(run.info["resumed_at_s"], nlohmann::ordered_json::array({0.4}));
}

TEST_F(RunDirectory, ProfilesAreAlongTheAxisOfTheirApparatus) {
  const auto header = [&](const std::string& name, const std::vector<std::string>& set) {
    RunWriter writer(folder / "run", scenes::load_scene(name, {set, {}}), "mpm", Replace::anything);
    writer.profile(0.0, std::vector{0.005}, std::vector{0.3});
    std::string text = text_of(folder / "run" / "profiles.csv");
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(header("roussel-slump", {}), "time_s,r_m,depth_m");
  EXPECT_EQ(header("roussel-slump", {"geometry.dimension=quarter", "mpm.particles_per_cell=8"}),
            "time_s,r_m,depth_m");
  EXPECT_EQ(header("roussel-slump", {"geometry.dimension=plane"}), "time_s,x_m,depth_m") << "no radius there";
  EXPECT_EQ(header("poiseuille-100", {}), "time_s,y_m,velocity_m_s");
  EXPECT_EQ(header("mix-a-lbox-sf0", {}), "time_s,x_m,depth_m");
}

TEST_F(RunDirectory, TheTimeReachedHasOneNameAndItsOldOneIsRead) {
  EXPECT_EQ(simulated_time({{"simulated_s", 2.5}}), 2.5);
  EXPECT_EQ(simulated_time({{"time_reached_s", 1.5}}), 1.5) << "OpenFOAM's runs of version 0.1.0";
  EXPECT_EQ(simulated_time(nlohmann::ordered_json::object()), 0.0);
}

TEST_F(RunDirectory, EveryTimeIsThereOnce) {
  write_run(folder / "run", Status::interrupted);
  RunWriter writer = RunWriter::resume(folder / "run", scene, {0.4, 0.4, 0.0});
  writer.history_columns({"time_s", "spread_mm"});
  for (const double time : {0.4, 0.5, 0.5}) writer.history(std::vector{time, 7.0});
  for (const double time : {0.0, 0.5, 0.5})
    writer.profile(time, std::vector{0.005, 0.015, 0.025}, std::vector{3.0, 2.0, 1.0});
  writer.finish(Status::at_rest, "", "sound");
  const runs::Run run = read_run(folder / "run");
  EXPECT_THAT(run.history.at("time_s"), ElementsAre(0.0, 0.1, 0.2, 0.1 * 3, 0.4, 0.5));
  ASSERT_EQ(run.profiles.size(), 2u);
  for (const Profile& profile : run.profiles) EXPECT_EQ(profile.value.size(), 3u) << profile.time;
}

TEST_F(RunDirectory, AResumedRunTellsItsNewSettings) {
  write_run(folder / "run", Status::end_time);
  scene.time.end = 77.0;
  RunWriter::resume(folder / "run", scene, 0.4);
  const runs::Run run = read_run(folder / "run");
  EXPECT_EQ(run.info["settings"]["time"]["end"], 77.0);
  EXPECT_EQ(scenes::parse_scene(run.info["resolved_toml"], "run.json").time.end, 77.0);
}

TEST_F(RunDirectory, AResumedRunKeepsItsColumns) {
  write_run(folder / "run", Status::interrupted);
  RunWriter writer = RunWriter::resume(folder / "run", scene, 0.4);
  EXPECT_THAT(message_of([&] {
                writer.history_columns({"time_s", "height_mm"});
              }),
              HasSubstr("the columns are 'time_s,spread_mm'"));
  fs::create_directory(folder / "empty");
  EXPECT_THAT(message_of([&] { RunWriter::resume(folder / "empty", scene, 0.4); }),
              HasSubstr("cannot be resumed"));
}

TEST_F(RunDirectory, AnInterruptedRunReadsAsFarAsItCame) {
  write_run(folder / "run", Status::running);
  const fs::path directory = folder / "run";
  std::ofstream(directory / "history.csv", std::ios::app) << "0.95,2";
  std::ofstream(directory / "profiles.csv", std::ios::app) << "0.75,0.005,0.3\n0.75,0.01";
  const runs::Run run = read_run(directory);
  EXPECT_EQ(run.history.rows(), 10u);
  EXPECT_EQ(run.history.at("time_s").back(), 0.9);
  ASSERT_EQ(run.profiles.size(), 2u) << "a profile cut off in the middle was taken for a whole one";
  EXPECT_EQ(run.profiles.back().time, 0.5);
}

TEST_F(RunDirectory, ARunWithoutARowReads) {
  RunWriter(folder / "run", scene, "mpm").finish(Status::failed, "out of the domain", "sound");
  const runs::Run run = read_run(folder / "run");
  EXPECT_EQ(run.info["verdict"], "noisy: the numerics failed") << "what failed is not sound";
  EXPECT_EQ(run.history.rows(), 0u);
  EXPECT_TRUE(run.profiles.empty());
  RunWriter(folder / "run", scene, "mpm").finish(Status::end_time, "", "sound");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }),
              HasSubstr("neither history.csv nor profiles.csv"));
}

/// Writing past the limit on the size of files fails as it does on a full disk.
class LimitedFiles {
 public:
  explicit LimitedFiles(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~LimitedFiles() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST_F(RunDirectory, AFullDiskIsTheMachinesFaultAndSaidInRunJson) {
  RunWriter writer(folder / "run", scene, "mpm");
  writer.history_columns({"time_s", "spread_mm"});
  const LimitedFiles full(30000);
  int rows = 0;
  try {
    for (;; ++rows) writer.history(std::vector{0.1 * rows, 200.0});
  } catch (const MachineError& error) {
    EXPECT_EQ(error.what(),
              (folder / "run" / "history.csv").string() + ": cannot be written: File too large");
    writer.fail(failure_at_hand(0.0), "sound");
  }
  const runs::Run run = read_run(folder / "run");
  EXPECT_EQ(run.status(), Status::failed);
  EXPECT_EQ(run.info["failure"], "machine");
  EXPECT_EQ(run.info["verdict"], "unjudged: the machine failed before the run's end");
  EXPECT_THAT(run.info["reason"].get<std::string>(), HasSubstr("File too large"));
  EXPECT_EQ(run.history.rows(), static_cast<std::size_t>(rows))
      << "what was written stays, to its last whole row";
}

TEST_F(RunDirectory, OnADiskWithoutAByteLeftRunJsonIsWrittenAllTheSame) {
  const fs::path disk = folder / "disk";
  fs::create_directory(disk);
  if (mount("flowrest", disk.c_str(), "tmpfs", 0, "size=1m") != 0)
    GTEST_SKIP() << "only root may mount a disk";
  try {
    RunWriter writer(disk / "run", scene, "mpm");
    writer.history_columns({"time_s", "spread_mm"});
    try {
      for (int row = 0;; ++row) writer.history(std::vector{0.1 * row, 200.0});
    } catch (const MachineError&) {
      EXPECT_TRUE(disk_is_full(disk));
      writer.info()["more"] = std::string(20000, 'x');  // than was there before
      writer.fail(failure_at_hand(0.0));
    }
    const auto info = read_run(disk / "run").info;
    EXPECT_EQ(info["status"], "failed");
    EXPECT_THAT(info["reason"].get<std::string>(), HasSubstr("No space left on device"));
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  umount(disk.c_str());
}

TEST_F(RunDirectory, WhatCannotBeCutBackIsSaidInRunJson) {
  write_run(folder / "run", Status::interrupted);
  fs::create_directory(folder / "run" / "history.csv.part");
  EXPECT_THAT(message_of([&] { RunWriter::resume(folder / "run", scene, 0.4); }), HasSubstr("history.csv"));
  EXPECT_EQ(read_run(folder / "run").info["status"], "failed");
}

TEST_F(RunDirectory, SaysWhatIsWrongAndWhere) {
  write_run(folder / "run");
  const fs::path json = folder / "run" / "run.json";
  const fs::path history = folder / "run" / "history.csv";
  put(history, "time_s,spread_mm\n0,1\n0.1,mistake\n0.2,3\n");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }),
              HasSubstr("history.csv:3: 'mistake' in column spread_mm"));
  put(history, "time_s,spread_mm\n0,1\n0.1\n0.2,3\n");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }),
              HasSubstr("history.csv:3: 1 values where the header names 2"));
  put(history, "time_s,spread_mm\n0.2,1\n0.1,2\n");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }), HasSubstr("does not ascend"));
  put(history, "time_s,time_s\n");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }), HasSubstr("a second 'time_s'"));
  put(history, "time_s,spread_mm\n0,1\n");
  put(folder / "run" / "profiles.csv", "time_s,r_m\n0,1\n");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }),
              HasSubstr("profiles.csv:1: the columns are 'time_s,r_m'"));
  auto info = nlohmann::ordered_json::parse(text_of(json));
  info["status"] = "asleep";
  put(json, info.dump());
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }), HasSubstr("status 'asleep' is unknown"));
  info["format_version"] = 99;
  put(json, info.dump());
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }), HasSubstr("format_version is 99"));
  put(json, "{");
  EXPECT_THAT(message_of([&] { read_run(folder / "run"); }), HasSubstr("not a JSON object"));
  EXPECT_THAT(message_of([&] { read_run(folder / "nowhere"); }), HasSubstr("there is no run.json"));
}

TEST_F(RunDirectory, ReadsForeignCsv) {
  const fs::path path = folder / "measured.csv";
  put(path, "time_s, spread_mm\r\n0, +1e-400\r\n 1.5e0 ,nan\r\n\r\n2,3");
  const Table table = read_csv(path, true);
  EXPECT_THAT(table.at("time_s"), ElementsAre(0.0, 1.5, 2.0));
  EXPECT_EQ(table.at("spread_mm")[0], 0.0);
  EXPECT_TRUE(std::isnan(table.at("spread_mm")[1]));
  EXPECT_EQ(read_csv(path).rows(), 2u)
      << "without the word that it is complete, a last line without its end is doubtful";
  EXPECT_THAT(message_of([&] { table.at("height_mm"); }),
              HasSubstr("no column 'height_mm'; there are: time_s,spread_mm"));
}

TEST_F(RunDirectory, RowsMustFitTheirColumns) {
  RunWriter writer(folder / "run", scene, "mpm");
  EXPECT_THROW(writer.history(std::vector{0.0}), std::invalid_argument);
  EXPECT_THROW(writer.history_columns({"spread_mm"}), std::invalid_argument);
  writer.history_columns({"time_s", "spread_mm"});
  EXPECT_THROW(writer.history(std::vector{0.0}), std::invalid_argument);
  EXPECT_THROW(writer.profile(0.0, std::vector{0.0}, std::vector<double>{}), std::invalid_argument);
}

TEST(CpuSeconds, GrowWithWork) {
  const double before = cpu_seconds();
  volatile double sum = 0.0;
  while (cpu_seconds() < before + 0.02)
    for (int i = 0; i < 10000; ++i) sum = sum + std::sqrt(i);
  EXPECT_LT(cpu_seconds() - before, 5.0);
  EXPECT_GE(cpu_seconds(true), cpu_seconds());
}
