// Walls with friction in the real interFoam: a layer on an inclined plane, a column of cells that is periodic
// along it. Its momentum is known exactly, whatever the law: friction gives mu times its weight or, where it
// sticks, all that pulls at it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "foamCases/case_fields.h"
#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "foamCases/openfoam.h"
#include "foamCases/plug_in.h"
#include "foamCases/test_scene.h"
#include "runs/process.h"

namespace flowrest::foam {
namespace {

namespace fs = std::filesystem;

constexpr double depth = 0.1, gravity = 9.81, density = 2000.0;
constexpr double incline = 0.52359877559829882;  // 30 degrees
constexpr std::size_t layers = 5;

class InclinedLayer : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = testing::what_openfoam_lacks(); !missing.empty()) GTEST_SKIP() << missing;
    if (!find_plug_in())
      GTEST_SKIP() << "the rheology plug-in was not built: OpenFOAM's headers are missing (scripts/setup "
                      "fetches them)";
  }

  void replace(const std::string& file, const std::string& what, const std::string& by) const {
    std::string text = testing::text_of(case_ / file);
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what << " in " << file;
    text.replace(at, what.size(), by);
    std::ofstream(case_ / file, std::ios::binary) << text;
  }

  /// Lets a layer go from rest; its velocities are then known every 0.1 s.
  void release(double end, const std::string& model, double yield_stress, double friction) {
    const auto scene = scenes::load_scene(
        "poiseuille-step-down",
        {{fmt::format("geometry.height={}", depth), fmt::format("foam.cell={}", depth / layers),
          "mpm.cell=0.02", fmt::format("time.end={}", end),
          // interFoam's modified pressure would take up a gravity along a periodic column.
          fmt::format("forces.body_force=[[0.0, {}]]", density * gravity * std::sin(incline)),
          "output.snapshot_interval=0.1", "material.regularisation_time=1000",
          fmt::format("material.density={}", density), fmt::format("material.yield_stress={}", yield_stress),
          "foam.laws=plug-in", "foam.max_time_step=0.002"},
         scenes::model_from_name(model)});
    fs::remove_all(case_);
    fill_case(scene, case_, find_plug_in());
    // The lower plate is the incline; over the layer there is nothing.
    replace("system/blockMeshDict", "faces ((0 1 5 4) (3 7 6 2)); }",
            "faces ((0 1 5 4)); } lid { type patch; faces ((3 7 6 2)); }");
    replace("0.orig/U", "plates { type $plateWall; }",
            fmt::format("plates {{ type coulombFriction; friction {}; }} lid {{ type zeroGradient; }}",
                        friction));
    replace("0.orig/p_rgh", "plates {", "lid { type prghPressure; p uniform 0; value uniform 0; } plates {");
    replace("0.orig/alpha.concrete", "plates {", "lid { type zeroGradient; } plates {");
    replace("constant/g", "(0 0 0)", fmt::format("(0 {} 0)", -gravity * std::cos(incline)));
    runs::Process process(case_ / "Allrun", {}, case_, folder_.path() / "log", openfoam_environment());
    EXPECT_TRUE(process.wait(120.0)) << "it takes too long";
    EXPECT_TRUE(process.poll()->good()) << testing::text_of(folder_.path() / "log");
  }

  /// Of the layers from below upwards, down the incline, m/s.
  std::vector<double> velocity_at(double time) const {
    const auto times = time_directories(case_);
    const auto found = std::min_element(times.begin(), times.end(), [&](const auto& a, const auto& b) {
      return std::abs(a.first - time) < std::abs(b.first - time);
    });
    const auto all = read_internal_field(found->second / "U", layers, 3);
    std::vector<double> along(layers);
    for (std::size_t i = 0; i < layers; ++i) along[i] = all[3 * i];
    return along;
  }
  double mean_at(double time) const {
    const auto velocity = velocity_at(time);
    return std::accumulate(velocity.begin(), velocity.end(), 0.0) / layers;
  }

  testing::TemporaryFolder folder_;
  fs::path case_ = folder_.path() / "case";
};

/// g (sin - mu cos) from the time on at which it has begun to slide, with a plug that does not shear where
/// the yield stress is above the wall's.
TEST_F(InclinedLayer, SlidesWithWhatFrictionLeaves) {
  constexpr double friction = 0.3;
  const double expected = gravity * (std::sin(incline) - friction * std::cos(incline));
  for (const char* model : {"papanastasiou", "bi-viscous", "elasto-viscoplastic"}) {
    release(0.6, model, 100.0, friction);  // it shears for a while before the wall gives way
    EXPECT_NEAR((mean_at(0.6) - mean_at(0.4)) / 0.2, expected, 0.01 * expected) << model;
    EXPECT_GT(velocity_at(0.6).back() - velocity_at(0.6).front(), 0.1) << model;
  }
  for (const char* model : {"papanastasiou", "elasto-viscoplastic"}) {
    release(0.4, model, 2000.0, friction);
    EXPECT_NEAR((mean_at(0.4) - mean_at(0.2)) / 0.2, expected, 0.01 * expected) << model;
    EXPECT_NEAR(velocity_at(0.4).back(), velocity_at(0.4).front(), 1e-3) << model;
  }
}

TEST_F(InclinedLayer, SticksBelowTheAngleOfFriction) {
  for (const char* model : {"papanastasiou", "elasto-viscoplastic"}) {
    release(0.8, model, 2000.0, 0.7);  // tan 30 degrees is 0.577
    EXPECT_LT(std::abs(mean_at(0.8)), 2e-4 * gravity * std::sin(incline) * 0.8) << model;
  }
}

TEST_F(InclinedLayer, FallsFreelyWithoutFriction) {
  const double expected = gravity * std::sin(incline);
  for (const char* model : {"papanastasiou", "elasto-viscoplastic"}) {
    release(0.2, model, 2000.0, 0.0);
    EXPECT_NEAR((mean_at(0.2) - mean_at(0.1)) / 0.1, expected, 1e-3 * expected) << model;
  }
}

}  // namespace
}  // namespace flowrest::foam
