// The particles of a run as the report shows them: read back from its snapshots, where they were written.
#include "compare/fields/section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "compare/comparison.h"
#include "mpm/output/snapshot.h"
#include "mpm/sampling/sampling.h"
#include "mpm/solver/settings.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
namespace fs = std::filesystem;

namespace {

class SectionTest : public testing::Test {
 protected:
  /// A slump after no step and after some, with snapshots of both.
  void write_run(const fs::path& directory, bool snapshots) {
    const auto scene = scenes::load_scene("roussel-slump", {{"mpm.cell=0.02", "mpm.threads=1"}, {}});
    solver = mpm::make_solver(mpm::settings_of(scene), mpm::seed_particles(scene));
    runs::RunWriter writer(directory, scene, "mpm");
    writer.history_columns({"time_s", "spread_mm"});
    std::optional<mpm::SnapshotWriter> states;
    if (snapshots) states.emplace(directory / "particles", scene, -1.0);
    for (const double time : {0.0, 0.02}) {
      writer.history(std::vector{time, 200.0 + 100.0 * time});
      if (states) states->write(time, *solver);
      if (time > 0.0) break;
      for (int i = 0; i < 20; ++i) solver->step(1e-3, mpm::acceleration_at(scene, 0.0));
    }
    writer.finish(runs::Status::end_time, "", "sound");
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
  std::unique_ptr<mpm::Solver> solver;
};

}  // namespace

TEST_F(SectionTest, HoldsEveryParticleWhereItIs) {
  write_run(folder / "mpm", true);
  const auto comparison = compare::compare_runs({folder / "mpm"});
  const auto sections = compare::fields::sections_of(comparison);
  ASSERT_EQ(sections.size(), 1u) << "nothing but an L-box in space is cut level, too";
  const report::Section* section = &sections.front();
  ASSERT_EQ(section->panels.size(), 1u);
  ASSERT_EQ(section->panels[0].frames.size(), 2u);
  const auto& state = section->panels[0].frames[1];
  EXPECT_EQ(state.x.size(), solver->particle_count());
  EXPECT_THAT(section->quantities, testing::SizeIs(testing::Ge(2u)));
  EXPECT_EQ(section->quantities[0].name, "shear rate");
  // A 65536th of the section is all that packing costs.
  std::vector<double> radii;
  solver->visit([&](const mpm::ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) radii.push_back(1e3 * static_cast<double>(b.position[0][i]));
  });
  for (std::size_t i = 0; i < radii.size(); ++i)
    EXPECT_NEAR(*section->x.from + (*section->x.to - *section->x.from) * state.x[i] / 65535.0, radii[i],
                0.01);
}

TEST_F(SectionTest, ARunWithoutStatesSaysHowToMakeThem) {
  write_run(folder / "mpm", true);
  write_run(folder / "bare", false);
  const auto sections =
      compare::fields::sections_of(compare::compare_runs({folder / "mpm", folder / "bare"}));
  ASSERT_EQ(sections.size(), 1u);
  EXPECT_THAT(sections[0].panels[1].missing,
              testing::HasSubstr("flowrest mpm roussel-slump --model elasto-viscoplastic"));
  EXPECT_THAT(compare::fields::sections_of(compare::compare_runs({folder / "bare"})), testing::IsEmpty());
}

TEST_F(SectionTest, ThinsOutWhatIsTooMuchForAPage) {
  write_run(folder / "mpm", true);
  const auto sections = compare::fields::sections_of(compare::compare_runs({folder / "mpm"}), 2, 2000);
  ASSERT_EQ(sections.size(), 1u);
  EXPECT_LE(sections[0].panels[0].frames[0].x.size(), 200u);
  EXPECT_GE(sections[0].panels[0].frames[0].x.size(), 80u);
}
