#include "elements/run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "elements/commands.h"
#include "runs/errors.h"
#include "runs/temporary_folder.h"
#include "scenes/test_scenes.h"

using namespace flowrest;
using scenes::test::replaced;
using scenes::test::slump_text;
using testing::HasSubstr;

namespace {

class Run : public testing::Test {
 protected:
  static scenes::Scene scene(std::string text = slump_text) {
    text = replaced(std::move(text), "end = 60.0", "end = 0.2");
    return scenes::parse_scene(
        replaced(std::move(text), "snapshot_interval = 1.0", "snapshot_interval = 0.09"), "slump.toml");
  }
  elements::RunOptions options() const {
    elements::RunOptions chosen;
    chosen.directory = folder.path() / "run";
    chosen.columns = 16;
    chosen.quiet = true;
    return chosen;
  }
  runs::Run read() const { return runs::read_run(options().directory); }
  runs::TemporaryFolder folder;
};

}  // namespace

TEST_F(Run, LeavesARunDirectoryWithItsUncertainty) {
  EXPECT_EQ(elements::run(scene(), options()).status, runs::Status::end_time);
  const runs::Run run = read();
  EXPECT_EQ(run.info.at("solver"), "exact");
  EXPECT_EQ(run.info.at("model"), "bingham");
  EXPECT_EQ(run.label(), "finite elements, bingham");
  const auto& time = run.history.at("time_s");
  ASSERT_EQ(time.size(), 5U);
  EXPECT_EQ(time.back(), 0.2);
  const auto &spread = run.history.at("spread_mm"), &uncertainty = run.history.at("spread_uncertainty_mm");
  EXPECT_NEAR(spread.front(), 199.0, 1e-6);
  EXPECT_EQ(uncertainty.front(), 0.0);
  for (std::size_t i = 1; i < time.size(); ++i) {
    EXPECT_GT(spread[i], spread[i - 1]);
    EXPECT_GE(uncertainty[i], uncertainty[i - 1]) << "an uncertainty that passes through 0 is none";
    EXPECT_NEAR(run.history.at("volume_m3")[i] / run.history.at("volume_m3").front(), 1.0, 1e-6);
  }
  EXPECT_GT(uncertainty.back(), 0.0);
  EXPECT_LT(uncertainty.back(), 5.0);
}

TEST_F(Run, ProfilesHaveTheVolumeAndTheSpreadOfTheirRow) {
  elements::run(scene(), options());
  const runs::Run run = read();
  ASSERT_GE(run.profiles.size(), 2U);
  const runs::Profile& last = run.profiles.back();
  EXPECT_EQ(last.time, 0.2);
  double volume = 0.0;
  for (std::size_t i = 1; i < last.value.size(); ++i) {
    const double a = last.coordinate[i - 1], b = last.coordinate[i], inner = last.value[i - 1],
                 outer = last.value[i];
    volume += 3.14159265358979 / 3.0 * (b - a) * (inner * (2.0 * a + b) + outer * (a + 2.0 * b));
  }
  EXPECT_NEAR(volume / run.history.at("volume_m3").back(), 1.0, 3e-3);
  EXPECT_NEAR(2e3 * last.coordinate.back(), run.history.at("spread_mm").back(), 2.0);
}

TEST_F(Run, FieldsLieAtTheirTimes) {
  elements::run(scene(), options());
  std::ifstream index(options().directory / "fields" / "fields.pvd");
  const std::string text{std::istreambuf_iterator<char>(index), {}};
  for (const char* part : {"timestep=\"0.089999999999999997\" file=\"fields_000000.vtu\"",
                           "timestep=\"0.17999999999999999\" file=\"fields_000001.vtu\"",
                           "timestep=\"0.20000000000000001\" file=\"fields_000002.vtu\""})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST_F(Run, EveryLawIsServed) {
  for (const char* law : {"papanastasiou", "newtonian"}) {
    elements::RunOptions chosen = options();
    chosen.directory = folder.path() / law;
    elements::run(
        scene(replaced(slump_text, "model = \"elasto-viscoplastic\"", fmt::format("model = \"{}\"", law))),
        chosen);
    const runs::Run run = runs::read_run(chosen.directory);
    EXPECT_EQ(run.info.at("model"), law);
    EXPECT_EQ(run.history.at("spread_by_rounding_mm").back(), 0.0) << "only a law that can rest is rounded";
  }
}

TEST_F(Run, AFinishedRunIsTakenAsItIs) {
  elements::run(scene(), options());
  const auto written = std::filesystem::last_write_time(options().directory / "run.json");
  EXPECT_THAT(elements::run(scene(), options()).summary, HasSubstr("taken as it is"));
  EXPECT_EQ(std::filesystem::last_write_time(options().directory / "run.json"), written);
}

TEST_F(Run, AFailedOneSaysWhyAndKeepsItsData) {
  EXPECT_THROW(
      elements::run(scene(replaced(slump_text, "domain_radius = 0.45", "domain_radius = 0.12")), options()),
      runs::NumericsError);
  const runs::Run run = read();
  EXPECT_EQ(run.status(), runs::Status::failed);
  EXPECT_THAT(run.info.at("reason").get<std::string>(), HasSubstr("geometry.domain_radius"));
  EXPECT_GE(run.history.rows(), 2U);
}

TEST_F(Run, AnInterruptedOneSaysSo) {
  elements::RunOptions stopped = options();
  int rows = 0;
  stopped.interrupted = [&] { return ++rows > 2; };
  EXPECT_EQ(elements::run(scene(), stopped).status, runs::Status::interrupted);
  EXPECT_EQ(read().history.rows(), 2U);
}
