// Runs of the real interFoam, short and coarse; skipped where OpenFOAM is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "foamCases/case_filler.h"
#include "foamCases/foam_run.h"
#include "foamCases/slump_sampler.h"
#include "foamCases/test_scene.h"
#include "runs/depth.h"
#include "runs/process.h"

namespace flowrest::foam {
namespace {

namespace fs = std::filesystem;
using testing::roussel_slump;
using testing::TemporaryFolder;

class OpenFoam : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!runs::find_program("interFoam"))
      GTEST_SKIP()
          << "OpenFOAM is not installed (Debian: apt-get install openfoam): interFoam is not on the PATH";
  }

  runs::Run run(const scenes::Scene& scene) {
    RunOptions options;
    options.directory = folder_.path() / "run";
    options.quiet = true;
    outcome_ = run_scene(scene, options);
    return runs::read_run(options.directory);
  }

  TemporaryFolder folder_;
  RunOutcome outcome_;
};

TEST_F(OpenFoam, SlumpsForHalfASecond) {
  const auto scene =
      roussel_slump("papanastasiou", {"foam.cell=0.02", "time.end=0.5", "output.snapshot_interval=0.2"});
  const auto result = run(scene);
  EXPECT_EQ(outcome_.status, runs::Status::end_time);
  EXPECT_EQ(result.info["verdict"], "sound");
  EXPECT_LT(std::abs(result.info["initial_volume_error"].get<double>()), 1e-4);
  EXPECT_LT(result.info["volume_error"].get<double>(), 1e-6);
  EXPECT_THAT(result.info["openfoam"].get<std::string>(), ::testing::HasSubstr("OPENFOAM"));

  const auto& time = result.history.at("time_s");
  ASSERT_EQ(time.size(), 11U);
  for (std::size_t i = 0; i < time.size(); ++i) EXPECT_NEAR(time[i], 0.05 * static_cast<double>(i), 0.01);
  const auto& spread = result.history.at("spread_mm");
  const auto& energy = result.history.at("kinetic_energy_J");
  EXPECT_NEAR(result.history.at("height_mm").front(), 300.0, 1e-6);
  EXPECT_NEAR(spread.back(), 437.0, 10.0);  // measured; 20 mm cells, so only a guard
  EXPECT_GT(*std::max_element(energy.begin(), energy.end()), 20.0 * energy.back());
  EXPECT_GT(result.history.at("initial_residual_U").back(), 0.0);

  ASSERT_EQ(result.profiles.size(), 3U);
  for (const auto& profile : result.profiles) {
    const runs::RadialDepth depth{profile.coordinate[1] - profile.coordinate[0], profile.value};
    EXPECT_NEAR(depth.volume(), scene.slump().volume(), 1e-4 * scene.slump().volume());
  }
  // 0, the snapshots and the end; the samples between them are gone.
  const auto left = time_directories(result.directory / "case");
  ASSERT_EQ(left.size(), 4U);
  EXPECT_NEAR(left[1].first, 0.2, 0.01);
  EXPECT_TRUE(fs::exists(left.back().second / "p_rgh"));
}

TEST_F(OpenFoam, TheInitialVolumeIsExactOnAnyGrid) {
  for (const char* cell : {"0.017", "0.023"}) {
    const auto result = run(roussel_slump("newtonian", {std::string("foam.cell=") + cell, "time.end=0.01"}));
    EXPECT_LT(std::abs(result.info["initial_volume_error"].get<double>()), 1e-10) << cell;
  }
}

TEST_F(OpenFoam, RunsEveryLawItAcceptsOnBothWalls) {
  for (const char* model : {"papanastasiou", "bi-viscous", "newtonian"}) {
    run(roussel_slump(model, {"foam.cell=0.03", "time.end=0.1", "walls.base=slip"}));
    EXPECT_EQ(outcome_.status, runs::Status::end_time) << model;
  }
}

/// With regularisation fine enough the two laws differ by nothing that flows: each checks the other's set-up.
TEST_F(OpenFoam, PapanastasiouAndBiViscousAgreeWhileTheConcreteFlows) {
  const std::vector<std::string> set = {"foam.cell=0.02", "time.end=0.3"};
  const double first = run(roussel_slump("papanastasiou", set)).history.at("spread_mm").back();
  const double second = run(roussel_slump("bi-viscous", set)).history.at("spread_mm").back();
  EXPECT_NEAR(first, second, 1.0);
  const double newtonian = run(roussel_slump("newtonian", set)).history.at("spread_mm").back();
  EXPECT_GT(newtonian, first + 3.0);
}

TEST_F(OpenFoam, AnInterruptLeavesAReadableRunAndAFullState) {
  const fs::path history = folder_.path() / "run" / "history.csv";
  std::thread interrupt([&] {
    for (int i = 0; i < 3000; ++i) {
      std::error_code ignored;
      if (fs::exists(history, ignored) && fs::file_size(history, ignored) > 600) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    kill(getpid(), SIGINT);
  });
  const auto result = run(roussel_slump("papanastasiou", {"foam.cell=0.02"}));
  interrupt.join();
  EXPECT_EQ(outcome_.status, runs::Status::interrupted);
  EXPECT_EQ(result.info["status"], "interrupted");
  EXPECT_LT(outcome_.time, 60.0);
  EXPECT_GE(result.history.rows(), 2U);
  const auto last = time_directories(result.directory / "case").back();
  EXPECT_TRUE(fs::exists(last.second / "p_rgh")) << last.second;
}

TEST_F(OpenFoam, TheCommittedCaseRunsAsItStands) {
  const fs::path copy = folder_.path() / "slump";
  fs::copy(cases_folder() / "slump", copy, fs::copy_options::recursive);
  std::string parameters = testing::text_of(copy / "sceneParameters");
  const std::string end = "endTime             60;";
  ASSERT_NE(parameters.find(end), std::string::npos);
  parameters.replace(parameters.find(end), end.size(), "endTime             0.06;");
  std::ofstream(copy / "sceneParameters") << parameters;
  runs::Process allrun(copy / "Allrun", {}, copy, folder_.path() / "log", {});
  ASSERT_TRUE(allrun.wait(120.0)) << "it takes too long";
  EXPECT_TRUE(allrun.poll()->good()) << allrun.poll()->how() << "\n"
                                     << testing::text_of(folder_.path() / "log");
  EXPECT_EQ(time_directories(copy).size(), 3U);  // 0, the sample at 0.05 s and the end
  runs::Process allclean(copy / "Allclean", {}, copy, folder_.path() / "log", {});
  ASSERT_TRUE(allclean.wait(30.0));
  EXPECT_TRUE(time_directories(copy).empty());
  EXPECT_TRUE(fs::exists(copy / "0.orig" / "U"));
  EXPECT_FALSE(fs::exists(copy / "constant" / "polyMesh"));
}

}  // namespace
}  // namespace flowrest::foam
