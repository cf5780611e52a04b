// Runs against programs that only pretend to be OpenFOAM's: what becomes of a run when they fail, hang or are
// missing.
#include "foamCases/foam_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "foamCases/sampler.h"
#include "foamCases/test_interrupt.h"
#include "foamCases/test_scene.h"
#include "runs/temporary_folder.h"

namespace flowrest::foam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::roussel_slump;

class FakeOpenFoam : public ::testing::Test {
 protected:
  FakeOpenFoam()
      : scene_(roussel_slump("papanastasiou", {"foam.cell=0.05", "time.end=1", "foam.base_rows=1",
                                               "geometry.cone_radius_top=0.1"})) {
    setenv("FLOWREST_OPENFOAM_PROGRAMS", folder_.path().c_str(), 1);
    for (const char* name : {"blockMesh", "setAlphaField", "interFoam"}) program(name, "exit 0");
    // 9 rings, 6 + 1 rows: the two inner rings filled to the cone's top, which is as wide as its bottom.
    program("setFields",
            "awk 'BEGIN { print \"FoamFile { format ascii; }\\ninternalField nonuniform "
            "List<scalar>\\n63\\n(\";\n"
            "  for (i = 0; i < 63; ++i) print (i % 9 < 2 && i < 54) ? 1 : 0; print \")\\n;\" }' > "
            "0/alpha.concrete");
    options_.directory = folder_.path() / "run";
    options_.quiet = true;
  }

  ~FakeOpenFoam() override { unsetenv("FLOWREST_OPENFOAM_PROGRAMS"); }

  void program(const std::string& name, const std::string& body) {
    const fs::path path = folder_.path() / name;
    std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
    fs::permissions(path, fs::perms::owner_all);
  }

  static std::string step(double time, double time_step) {
    return fmt::format(
        "echo 'Courant Number mean: 0 max: 0.1'\necho 'deltaT = {}'\necho 'Time = {}'\n"
        "echo 'DILUPBiCGStab:  Solving for Ux, Initial residual = 0.01, Final residual = 0, No Iterations "
        "1'\n"
        "echo 'ExecutionTime = 0.1 s  ClockTime = 0 s'\n",
        time_step, time);
  }

  /// The reason a run fails for, and what it leaves.
  std::string failure() {
    try {
      run_scene(scene_, options_);
    } catch (const runs::NumericsError& error) {
      const auto run = runs::read_run(options_.directory);
      EXPECT_EQ(run.info["status"], "failed");
      EXPECT_THAT(error.what(), HasSubstr(run.info["reason"].get<std::string>()));
      return error.what();
    }
    return "no failure";
  }

  /// The same where the machine is at fault.
  std::string machine_failure() {
    try {
      run_scene(scene_, options_);
    } catch (const runs::MachineError& error) {
      const auto run = runs::read_run(options_.directory);
      EXPECT_EQ(run.info["status"], "failed");
      EXPECT_EQ(run.info["failure"], "machine");
      EXPECT_EQ(run.info["verdict"], "unjudged: the machine failed before the run's end");
      EXPECT_THAT(error.what(), HasSubstr(run.info["reason"].get<std::string>()));
      return error.what();
    } catch (const runs::NumericsError& error) {
      return std::string("the numerics: ") + error.what();
    }
    return "no failure";
  }

  testing::TemporaryFolder folder_;
  scenes::Scene scene_;
  RunOptions options_;
};

TEST_F(FakeOpenFoam, AFullDiskIsTheMachinesFault) {
  program("interFoam", step(0.5, 0.5) + "echo 'interFoam: write error: No space left on device'\nexit 1");
  EXPECT_THAT(machine_failure(),
              HasSubstr("interFoam ended with exit code 1: interFoam: write error: No space"));
  program("interFoam", step(0.5, 0.5) + step(1.0, 0.5) + "echo End");
  program("setFields", "echo 'cannot write: Disk quota exceeded'\nexit 1");
  options_.force = true;
  EXPECT_THAT(machine_failure(), HasSubstr("setFields ended with exit code 1: cannot write: Disk quota"));
}

TEST_F(FakeOpenFoam, ASolverThatTheSystemKillsDidNotDiverge) {
  program("interFoam", step(0.5, 0.5) + "kill -KILL $$");
  EXPECT_THAT(machine_failure(), HasSubstr("interFoam ended with signal 9 (Killed)"));
}

TEST_F(FakeOpenFoam, WhoeverEndsUsMayEndTheSolverFirst) {
  // A scheduler asks every process of a job at once.
  program("interFoam", step(0.5, 0.5) + "kill -TERM $PPID; kill -TERM $$");
  EXPECT_EQ(run_scene(scene_, options_).status, runs::Status::interrupted);
  EXPECT_EQ(runs::read_run(options_.directory).info["status"], "interrupted");
}

TEST_F(FakeOpenFoam, ARunThatFailedIsNotSound) {
  std::string steps;
  for (int i = 1; i <= 400; ++i) steps += step(0.001 * i, 0.001);
  program("interFoam", steps + "kill -SEGV $$");
  EXPECT_THAT(failure(), HasSubstr("interFoam ended with signal 11"));
  EXPECT_THAT(runs::read_run(options_.directory).info["verdict"].get<std::string>(), HasSubstr("noisy: "));
}

TEST_F(FakeOpenFoam, AFinishedRunIsTakenAsItIs) {
  program("interFoam", step(0.5, 0.5) + step(1.0, 0.5) + "echo End");
  const auto first = run_scene(scene_, options_);
  program("interFoam", "exit 1");
  const auto second = run_scene(scene_, options_);
  EXPECT_EQ(second.status, runs::Status::end_time);
  EXPECT_EQ(second.verdict, first.verdict);
  EXPECT_EQ(second.time, first.time);
  EXPECT_EQ(second.gauges, first.gauges);
  options_.force = true;
  EXPECT_THAT(failure(), HasSubstr("interFoam ended with exit code 1"));
}

TEST_F(FakeOpenFoam, AFolderThatSomebodyElseWritesIntoIsLeftAlone) {
  program("interFoam", step(0.5, 0.5) + "kill -SEGV $$");
  failure();
  const std::string info = testing::text_of(options_.directory / "run.json");
  const runs::FolderLock other(options_.directory);
  options_.force = true;
  for (const auto& attempt :
       {run_scene, +[](const scenes::Scene&, const RunOptions& o) { return resume_run(o); }})
    try {
      attempt(scene_, options_);
      ADD_FAILURE() << "it wrote";
    } catch (const runs::RunError& error) {
      EXPECT_THAT(error.what(), HasSubstr("is writing here"));
    }
  EXPECT_EQ(testing::text_of(options_.directory / "run.json"), info);
  EXPECT_TRUE(fs::exists(options_.directory / "case" / "log.interFoam"));
}

TEST_F(FakeOpenFoam, ARunThatEndsIsDone) {
  program("interFoam", "echo 'Build  : OPENFOAM=fake'\n" + step(0.5, 0.5) + step(1.0, 0.5) + "echo End");
  const auto outcome = run_scene(scene_, options_);
  EXPECT_EQ(outcome.status, runs::Status::end_time);
  const auto run = runs::read_run(options_.directory);
  EXPECT_EQ(run.info["status"], "end-time");
  EXPECT_EQ(run.info["openfoam"], "OPENFOAM=fake");
  EXPECT_EQ(run.info["openfoam_program"], (folder_.path() / "interFoam").string());
  EXPECT_EQ(run.info["steps"], 2);
  EXPECT_NEAR(run.history.at("volume_m3").front(), std::acos(-1.0) * 0.1 * 0.1 * 0.3, 1e-12);
}

TEST_F(FakeOpenFoam, MissingProgramsAreNamedAndNothingIsWritten) {
  const testing::TemporaryFolder empty;
  setenv("FLOWREST_OPENFOAM_PROGRAMS", empty.path().c_str(), 1);
  try {
    run_scene(scene_, options_);
    FAIL() << "it ran without OpenFOAM";
  } catch (const runs::MissingProgram& error) {
    EXPECT_THAT(error.what(), HasSubstr((empty / "blockMesh").string() + " is not there"));
    EXPECT_THAT(error.what(), HasSubstr("apt-get install openfoam"));
  }
  EXPECT_FALSE(fs::exists(options_.directory));
}

TEST_F(FakeOpenFoam, AFatalErrorIsTheReason) {
  program("interFoam", step(0.5, 0.5) + "echo '--> FOAM FATAL ERROR: '\necho 'it cannot be'\nexit 1");
  EXPECT_THAT(failure(), HasSubstr("interFoam at 0.5 s: FOAM FATAL ERROR: it cannot be"));
}

TEST_F(FakeOpenFoam, AMeshThatFailsIsTheReason) {
  program("blockMesh", "echo '--> FOAM FATAL IO ERROR: '\necho 'no vertices'\nexit 1");
  EXPECT_THAT(failure(), HasSubstr("blockMesh ended with exit code 1: FOAM FATAL IO ERROR: no vertices"));
}

TEST_F(FakeOpenFoam, InitialFieldsThatAreNotTheBodyEndTheRun) {
  program("interFoam", step(0.5, 0.5) + step(1.0, 0.5) + "echo End");
  program(
      "setFields",
      "awk 'BEGIN { print \"FoamFile { format ascii; }\\ninternalField nonuniform List<scalar>\\n63\\n(\";\n"
      "  for (i = 0; i < 63; ++i) print (i % 9 < 1 && i < 54) ? 1 : 0; print \")\\n;\" }' > "
      "0/alpha.concrete");
  EXPECT_THAT(failure(),
              HasSubstr("the concrete in the mesh differs by -75 % from the scene's body at the start"));
  EXPECT_FALSE(fs::exists(options_.directory / "case" / "log.interFoam"));
}

TEST_F(FakeOpenFoam, AFieldOfAnotherMeshEndsTheRun) {
  program("interFoam", step(0.5, 0.5) +
                           "mkdir 0.5; cp 0/U 0.5/; sed 's/^63$/62/' 0/alpha.concrete > "
                           "0.5/alpha.concrete\n" +
                           step(1.0, 0.5) + "sleep 60");
  EXPECT_THAT(failure(), HasSubstr("it holds 62 cells, the mesh has 63"));
}

/// OpenFOAM reads none of these in a path; its programs know the case by another, the reader by its own.
TEST_F(FakeOpenFoam, ACaseIsReachedThroughAPathThatCanBeRead) {
  options_.directory = folder_.path() / "a b'c\"d$e#f;g{h(iö" / "run";
  program("interFoam", "echo $PWD > path\n" + step(0.5, 0.5) +
                           "echo '--> FOAM FATAL ERROR: '\necho \"file $PWD/0/U\"\nexit 1");
  const fs::path own = options_.directory / "case";
  EXPECT_THAT(failure(), HasSubstr("FOAM FATAL ERROR: file " + own.string() + "/0/U"));
  std::string path = testing::text_of(own / "path");
  path.pop_back();
  EXPECT_TRUE(runs::is_plain(path)) << path;
  EXPECT_FALSE(fs::exists(path)) << "the link stays behind";
}

TEST_F(FakeOpenFoam, ACrashIsTheReason) {
  program("interFoam", step(0.5, 0.5) + "kill -SEGV $$");
  EXPECT_THAT(failure(), HasSubstr("interFoam ended with signal 11"));
}

TEST_F(FakeOpenFoam, ANumberThatIsNoneEndsTheRunAtOnce) {
  program("interFoam",
          step(0.5, 0.5) +
              "echo 'Time = 1'\necho 'DILUPBiCGStab:  Solving for Ux, Initial residual = nan,'\nsleep 60");
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(failure(), HasSubstr("a number that is none"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

TEST_F(FakeOpenFoam, ACollapsingStepEndsTheRunAtOnce) {
  std::string steps;
  for (int i = 0; i < 30; ++i) steps += step(0.5 + 1e-9 * i, 1e-9);
  program("interFoam", steps + "sleep 60");
  EXPECT_THAT(failure(), HasSubstr("the time step collapsed to 1e-09 s at 0.5 s"));
}

TEST_F(FakeOpenFoam, AnEndBeforeTheEndIsAFailure) {
  program("interFoam", step(0.5, 0.5));
  EXPECT_THAT(failure(), HasSubstr("interFoam stopped before its end time"));
}

TEST_F(FakeOpenFoam, ConcreteAtTheRimEndsTheRun) {
  program("interFoam",
          step(0.5, 0.5) +
              "mkdir 0.5; cp 0/U 0.5/; sed 's/uniform List.*/&/' 0/alpha.concrete |"
              " awk 'NR > 4 && NR < 68 { n++; print (n % 9 == 0 && n < 10) ? 1 : $0; next } { print }'"
              " > 0.5/alpha.concrete\n" +
              step(1.0, 0.5) + "sleep 60");
  EXPECT_THAT(
      failure(),
      HasSubstr("the concrete reached the rim of the mesh at 0.5 s: geometry.domain_radius = 0.45 m"));
}

TEST_F(FakeOpenFoam, ConcreteFasterThanItsWeightCanMakeItEndsTheRun) {
  program("interFoam",
          step(0.5, 0.5) +
              "mkdir 0.5; cp 0/alpha.concrete 0.5/; sed 's/uniform (0 0 0)/uniform (0 0 9)/' 0/U > 0.5/U\n" +
              step(1.0, 0.5) + "sleep 60");
  // 2300 kg/m3 in 0.00942 m3, at 9 m/s against the fall of its 0.3 m.
  EXPECT_THAT(failure(), HasSubstr("the concrete moves with 878 J at 0.5 s"));
  EXPECT_THAT(testing::text_of(options_.directory / "case" / "log.interFoam"), HasSubstr("Time = 0.5"));
}

TEST_F(FakeOpenFoam, ConcreteThatIsLostMakesTheVerdictNoisy) {
  program("interFoam", step(0.5, 0.5) +
                           "mkdir 0.5; cp 0/U 0.5/;"
                           " awk '$1 == \"1\" { print 0.999; next } { print }' 0/alpha.concrete"
                           " > 0.5/alpha.concrete\n" +
                           step(1.0, 0.5) + "echo End");
  const std::string verdict =
      "noisy: the volume of concrete is off by 0.1 % since 0.5 s, where 0.02 % are allowed";
  EXPECT_EQ(run_scene(scene_, options_).verdict, verdict);
  EXPECT_EQ(runs::read_run(options_.directory).info["verdict"], verdict);
}

TEST_F(FakeOpenFoam, AnotherCaseIsLeftAlone) {
  program("interFoam", "exit 1");
  fs::create_directories(options_.directory / "system");
  std::ofstream(options_.directory / "system" / "controlDict") << "application simpleFoam;";
  EXPECT_THROW(run_scene(scene_, options_), runs::RunError);
  EXPECT_EQ(testing::text_of(options_.directory / "system" / "controlDict"), "application simpleFoam;");
  EXPECT_FALSE(fs::exists(options_.directory / "run.json"));
}

/// What --resume says of a folder.
std::string refusal_to_resume(const fs::path& directory, const std::vector<std::string>& set = {}) {
  RunOptions options;
  options.directory = directory;
  options.quiet = true;
  try {
    resume_run(options, set);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(FakeOpenFoam, OnlyAnUnfinishedRunOfItsOwnIsGoneOnWith) {
  EXPECT_THAT(refusal_to_resume(options_.directory), HasSubstr("is not a run of `flowrest foam`"));
  program("interFoam", step(1.0, 0.5) + "echo End");
  run_scene(scene_, options_);
  EXPECT_THAT(refusal_to_resume(options_.directory), HasSubstr("has come to its end (end-time)"));
}

TEST_F(FakeOpenFoam, ARunWithoutAWholeStateStartsOver) {
  program("interFoam", step(0.5, 0.5) + "mkdir 0.5; cp 0/U 0.5/; kill -SEGV $$");
  failure();
  program("interFoam", step(0.5, 0.5) + step(1.0, 0.5) + "echo End");
  EXPECT_EQ(resume_run(options_).status, runs::Status::end_time);
  EXPECT_EQ(runs::read_run(options_.directory).info["steps"], 2);
}

/// A state at 0.5 s with everything that is needed to go on, out of the initial fields.
const char* const whole_state =
    "mkdir -p 0.5/uniform; cp 0/U 0/alpha.concrete 0/p_rgh 0.5/; touch 0.5/phi 0.5/uniform/time\n";

TEST_F(FakeOpenFoam, ACaseThatWasChangedIsNotGoneOnWith) {
  program("interFoam", step(0.5, 0.5) + whole_state + "kill -SEGV $$");
  failure();
  std::ofstream(options_.directory / "case" / "sceneParameters", std::ios::app) << "\n";
  EXPECT_EQ(refusal_to_resume(options_.directory).find("it is not what"), std::string::npos)
      << "what follows the ranks is no matter of the scene";
  auto text = testing::text_of(options_.directory / "case" / "sceneParameters");
  text.replace(text.find("endTime"), 7, "anotherTime");
  std::ofstream(options_.directory / "case" / "sceneParameters") << text;
  EXPECT_THAT(refusal_to_resume(options_.directory), HasSubstr("it is not what `flowrest foam` writes"));
}

TEST_F(FakeOpenFoam, GoingOnKeepsWhatTheRunHasBehindIt) {
  program("interFoam", step(0.5, 0.5) + whole_state + step(0.6, 0.1) + "mkdir 0.6; kill -SEGV $$");
  failure();
  program("interFoam", "[ -d 0.6 ] && exit 1\n" + step(1.0, 0.5) + "echo End");
  EXPECT_EQ(resume_run(options_).status, runs::Status::end_time);
  const auto run = runs::read_run(options_.directory);
  EXPECT_EQ(run.info["steps"], 2);  // the one to 0.6 s was lost
  EXPECT_EQ(run.info["resumed_at_s"][0], 0.5);
  EXPECT_EQ(run.history.at("time_s"), (std::vector<double>{0.0, 0.5}));
  EXPECT_TRUE(fs::exists(options_.directory / "case" / "log.interFoam.1"));
}

/// A state as interFoam leaves it at its end: no step is told beside it.
std::string last_state(const std::string& time) {
  return fmt::format("mkdir -p {0}; cp 0/U 0/alpha.concrete 0/p_rgh {0}/; touch {0}/phi\n", time);
}

TEST_F(FakeOpenFoam, AProlongedRunSaysWhatOneOfThatLengthSays) {
  scene_.time.end = 2.0;
  const std::string first = step(0.5, 0.5) + step(1.0, 0.5), then = step(1.5, 0.5) + step(2.0, 0.5);
  program("interFoam", first + last_state("1") + then + last_state("2") + "echo End");
  run_scene(scene_, options_);
  const auto whole = runs::read_run(options_.directory);

  options_.directory = folder_.path() / "prolonged";
  scene_.time.end = 1.0;
  program("interFoam", first + last_state("1") + "echo End");
  run_scene(scene_, options_);
  EXPECT_TRUE(fs::exists(options_.directory / "case" / "1" / "uniform" / "time"));
  EXPECT_THAT(refusal_to_resume(options_.directory, {"time.end=0.7"}), HasSubstr("time.end=... above 1 s"));
  EXPECT_THAT(refusal_to_resume(options_.directory, {"time.end=2", "foam.cell=0.04"}),
              HasSubstr("foam.cell"));
  program("interFoam", "[ -d 1 ] || exit 1\n" + then + last_state("2") + "echo End");
  EXPECT_EQ(resume_run(options_, {"time.end=2"}).status, runs::Status::end_time);
  const auto prolonged = runs::read_run(options_.directory);
  EXPECT_THAT(testing::text_of(options_.directory / "case" / "sceneParameters"),
              HasSubstr("endTime             2;"));

  EXPECT_EQ(prolonged.history.names, whole.history.names);
  for (const char* table : {"history.csv", "profiles.csv"})
    EXPECT_EQ(testing::text_of(options_.directory / table), testing::text_of(folder_.path() / "run" / table));
  auto said = prolonged.info, expected = whole.info;
  EXPECT_EQ(said["resumed_at_s"], nlohmann::ordered_json::array({1.0}));
  EXPECT_EQ(said["request"]["set"].back(), "time.end=2")
      << "a command made of it asks for the run as it is now";
  // The test has changed the other's end behind its request.
  for (auto* info : {&said, &expected})
    for (const char* key : {"resumed_at_s", "provenance", "wall_s", "cpu_s", "cpu_by_program_s",
                            "cell_steps_per_cpu_s", "cpu_s_per_simulated_s", "peak_memory_bytes", "request"})
      info->erase(key);
  for (const auto& [key, value] : expected.items()) EXPECT_EQ(said[key], value) << key;
  EXPECT_EQ(said.size(), expected.size());
}

TEST_F(FakeOpenFoam, AFinishedRunWithoutAStateIsNotMadeAnew) {
  program("interFoam", step(0.5, 0.5) + step(1.0, 0.5) + "echo End");
  run_scene(scene_, options_);
  const std::string info = testing::text_of(options_.directory / "run.json");
  EXPECT_THAT(refusal_to_resume(options_.directory, {"time.end=2"}), HasSubstr("holds no whole state"));
  EXPECT_EQ(testing::text_of(options_.directory / "run.json"), info);
  EXPECT_TRUE(fs::exists(options_.directory / "case" / "log.interFoam"));
}

TEST(RowsOfALongerRun, AreThoseThatAreNotThereForTheEndsSake) {
  const auto scene = roussel_slump("papanastasiou", {"output.history_interval=0.1"});
  EXPECT_EQ(last_regular_row(scene, 0.1, {0.0, 0.099, 0.2001, 0.25}), 0.2001);
  EXPECT_EQ(last_regular_row(scene, 0.1, {0.0, 0.099, 0.2001}), 0.2001);
  EXPECT_EQ(last_regular_row(scene, 0.1, {}), -1.0);
  // Gone on with at 0.15 s, its rows are spaced from there.
  EXPECT_EQ(last_regular_row(scene, 0.1, {0.0, 0.1, 0.25, 0.35, 0.37}), 0.35);
}

/// Once the run's solver has begun.
std::jthread interrupt_when_begun(const fs::path& log) {
  return testing::interrupt_at(log, 0, std::chrono::milliseconds(100));
}

TEST_F(FakeOpenFoam, AnInterruptLetsTheSolverEndItsStep) {
  program("interFoam", "trap 'echo End; exit 0' USR2\n" + step(0.5, 0.5) + "while :; do sleep 0.05; done");
  const auto interrupt = interrupt_when_begun(options_.directory / "case" / "log.interFoam");
  const auto outcome = run_scene(scene_, options_);
  EXPECT_EQ(outcome.status, runs::Status::interrupted);
  const auto run = runs::read_run(options_.directory);
  EXPECT_EQ(run.info["status"], "interrupted");
  EXPECT_EQ(run.info["steps"], 1);
  EXPECT_GE(run.history.rows(), 1U);
}

/// A signal would reach them in different steps, and each would wait for the other.
TEST_F(FakeOpenFoam, SeveralRanksAreStoppedByAFileAndNoSignal) {
  options_.ranks = 2;
  // All cells are the first one's.
  program("decomposePar",
          "head='FoamFile { format ascii; }'\n"
          "for i in 0 1; do mkdir -p processor$i/0 processor$i/constant/polyMesh; done\n"
          "cp 0/* processor0/0; cp 0/U processor1/0\n"
          "echo \"$head internalField nonuniform List<scalar> 0();\" > processor1/0/alpha.concrete\n"
          "echo \"$head 63 ($(seq 0 62))\" > processor0/constant/polyMesh/cellProcAddressing\n"
          "echo \"$head 0()\" > processor1/constant/polyMesh/cellProcAddressing");
  program("reconstructPar", "exit 0");
  program("interFoam", "trap 'exit 7' USR2\n" + step(0.5, 0.5) +
                           "until [ -e stop ]; do sleep 0.05; done; sleep 0.5; echo End");
  const auto interrupt = interrupt_when_begun(options_.directory / "case" / "log.interFoam");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(run_scene(scene_, options_).status, runs::Status::interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(40)) << "the grace is a minute";
  EXPECT_FALSE(fs::exists(options_.directory / "case" / "processor0"));
}

TEST_F(FakeOpenFoam, ASolverThatDoesNotStopIsMadeTo) {
  options_.grace = 0.2;
  program("interFoam", "trap '' USR2 TERM\n" + step(0.5, 0.5) + "while :; do sleep 0.05; done");
  const auto interrupt = interrupt_when_begun(options_.directory / "case" / "log.interFoam");
  const auto outcome = run_scene(scene_, options_);
  EXPECT_EQ(outcome.status, runs::Status::interrupted);
}

TEST_F(FakeOpenFoam, AskedAgainItLeavesNobodyRunning) {
  // Deaf to all that can be ignored, in a session of its own as mpirun's ranks are.
  const fs::path pid = folder_.path() / "pid";
  program("interFoam", "trap '' USR2 TERM\nsetsid /bin/sh -c \"trap '' USR2 TERM; echo \\$\\$ > '" +
                           pid.string() + "'; while :; do sleep 0.05; done\" &\n" + step(0.5, 0.5) +
                           "while :; do sleep 0.05; done");
  const auto begin = std::chrono::steady_clock::now();
  const auto first = testing::interrupt_at(pid, 1, std::chrono::milliseconds(100)),
             second = testing::interrupt_at(pid, 1, std::chrono::milliseconds(1500));
  EXPECT_EQ(run_scene(scene_, options_).status, runs::Status::interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(40)) << "the grace is a minute";
  const fs::path stat = "/proc/" + std::to_string(std::stol(testing::text_of(pid))) + "/stat";
  const std::string left = fs::exists(stat) ? testing::text_of(stat) : "";
  EXPECT_TRUE(left.empty() || left.find(") Z ") != std::string::npos) << left;
}

}  // namespace
}  // namespace flowrest::foam
