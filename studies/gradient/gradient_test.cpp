// flowrest gradient: what it leaves, what it refuses, and that nothing that is not finite passes.
#include "studies/gradient/gradient.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "compare/input_part.h"
#include "runs/errors.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::studies::gradient;
using testing::HasSubstr;

namespace {

class GradientTest : public testing::Test {
 protected:
  Options slump() const {
    Options o;
    o.scene = "roussel-slump";
    o.set = {"mpm.cell=0.025", "time.end=0.2", "mpm.threads=1"};
    o.of = {"spread_mm"};
    o.by = {"material.yield_stress", "material.plastic_viscosity"};
    o.output = folder.path() / "run";
    o.quiet = true;
    return o;
  }
  /// What a call says that is refused; "" where it is not. Nothing may be written.
  std::string refusal(const Options& options) const {
    try {
      compute(options);
    } catch (const scenes::SceneError& error) {
      EXPECT_FALSE(std::filesystem::exists(options.output)) << error.what();
      return error.what();
    }
    return "";
  }
  nlohmann::json left() const {
    std::ifstream file(folder.path() / "run" / "gradient.json");
    return nlohmann::json::parse(file);
  }

  runs::TemporaryFolder folder;
};

}  // namespace

TEST_F(GradientTest, LeavesWhatItFoundInFilesThatOthersRead) {
  Options o = slump();
  o.sigma = {"material.yield_stress=10%", "material.plastic_viscosity=5"};
  o.check = true;
  const Result result = compute(o);
  write(result);
  const auto json = left();
  EXPECT_EQ(json["quantity"], "smooth_spread_mm");
  EXPECT_EQ(json["asked_for"], "spread_mm");
  EXPECT_EQ(json["unit"], "mm");
  EXPECT_EQ(json["derivatives"][0]["unit"], "mm / (Pa)");
  EXPECT_LT(json["derivatives"][0]["value"].get<double>(), 0.0);
  EXPECT_NEAR(json["derivatives"][0]["elasticity"].get<double>(),
              json["derivatives"][0]["value"].get<double>() * 50.0 / json["value"].get<double>(), 1e-12);
  EXPECT_EQ(json["check"]["word"], "agrees");
  EXPECT_LT(json["check"]["relative_error"].get<double>(), 1e-4);
  EXPECT_GT(json["cost"]["forward_cpu_s"].get<double>(), 0.0);
  // sqrt((d1 s1)^2 + (d2 s2)^2), with shares that sum to one.
  const double one = json["derivatives"][0]["value"].get<double>() * 5.0,
               two = json["derivatives"][1]["value"].get<double>() * 5.0;
  EXPECT_NEAR(json["input_uncertainty"]["standard"].get<double>(), std::hypot(one, two), 1e-9);
  double shares = 0.0;
  for (const auto& of : json["input_uncertainty"]["of"]) shares += of["share"].get<double>();
  EXPECT_NEAR(shares, 1.0, 1e-12);
  EXPECT_EQ(compare::input_parts(runs::read_run(folder.path() / "run")).size(), 1U);
  for (const char* name :
       {"gradient.csv", "gradient_over_time.csv", "gradient.html", "history.csv", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "run" / name)) << name;
  // Made again in its own folder, backwards, it is the same.
  o.mode = "reverse";
  const Result again = compute(o);
  EXPECT_EQ(again.mode, "reverse");
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(again.gradients[0].by[k].value, result.gradients[0].by[k].value,
                1e-10 * std::abs(result.gradients[0].by[k].value));
}

TEST_F(GradientTest, RefusesBeforeItWritesAndSaysWhatIsAllowed) {
  const auto with = [&](const auto& change) {
    Options o = slump();
    change(o);
    return refusal(o);
  };
  EXPECT_THAT(with([](Options& o) { o.by = {"geometry.cone_height"}; }),
              HasSubstr("allowed: keys of [material]"));
  EXPECT_THAT(with([](Options& o) { o.by = {"material.regularisation_time"}; }),
              HasSubstr("no effect on this run"));
  EXPECT_THAT(with([](Options& o) { o.by = {"material.yield"}; }), HasSubstr("no such key"));
  EXPECT_THAT(with([](Options& o) {
                o.by = {"material.yield_stress", "material.yield_stress"};
              }),
              HasSubstr("twice"));
  EXPECT_THAT(with([](Options& o) { o.of = {"strand_width_mm"}; }), HasSubstr("allowed: smooth_spread_mm"));
  EXPECT_THAT(with([](Options& o) { o.of = {"spread_mm=soon"}; }), HasSubstr("the value that is reached"));
  EXPECT_THAT(with([](Options& o) { o.sigma = {"material.yield_stress=-1"}; }), HasSubstr("above 0"));
  EXPECT_THAT(with([](Options& o) { o.sigma = {"forces.gravity=1%"}; }), HasSubstr("not among --by"));
  EXPECT_THAT(with([](Options& o) { o.set.emplace_back("mpm.scheme=linear-flip"); }),
              HasSubstr("quadratic-apic"));
  EXPECT_THAT(with([](Options& o) { o.set.emplace_back("mpm.precision=float"); }),
              HasSubstr("allowed for derivatives"));
  EXPECT_THAT(with([](Options& o) {
                o.of = {"spread_mm=300"};
                o.mode = "reverse";
              }),
              HasSubstr("allowed: --mode forward"));
}

TEST_F(GradientTest, TakesNoRunOfSomebodyElse) {
  const Options o = slump();
  mpm::RunOptions run;
  run.directory = o.output;
  run.quiet = true;
  std::vector<std::string> set = o.set;
  set.emplace_back("mpm.precision=double");
  mpm::run(scenes::load_scene(o.scene, scenes::overrides_of_command_line(set)), run);
  EXPECT_THROW(compute(o), runs::RunError);
  Options forced = o;
  forced.force = true;
  EXPECT_EQ(compute(forced).gradients.size(), 1U);
}

/// Random scenes, settings and keys: each ends with numbers that are finite, or with a named cause.
TEST_F(GradientTest, PassesNothingThatIsNotFinite) {
  std::mt19937 random(7);
  const auto any = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const std::vector<std::string> keys = {"material.yield_stress", "material.plastic_viscosity",
                                         "material.density", "material.youngs_modulus", "forces.gravity"};
  int made = 0;
  for (int i = 0; i < 16; ++i) {
    Options o = slump();
    o.output = folder.path() / std::to_string(i);
    const char* models[] = {"elasto-viscoplastic", "papanastasiou", "bi-viscous"};
    o.model = models[random() % 3];
    o.set = {"mpm.cell=0.03",
             "time.end=0.06",
             "mpm.threads=1",
             "material.regularisation_time=3",
             "material.critical_shear_rate=0.1",
             "material.yield_stress=" + std::to_string(std::pow(10.0, any(-2.0, 4.0))),
             "material.plastic_viscosity=" + std::to_string(std::pow(10.0, any(-2.0, 4.0))),
             "material.poisson_ratio=" + std::to_string(any(0.0, 0.49)),
             "mpm.cfl=" + std::to_string(any(0.1, 1.5))};
    if (random() % 2 == 0) o.set.push_back("walls.base={ friction = " + std::to_string(any(0.0, 2.0)) + " }");
    o.by = {keys[random() % keys.size()]};
    o.of = {random() % 2 == 0 ? "spread_mm" : "kinetic_energy_J"};
    o.mode = random() % 2 == 0 ? "forward" : "reverse";
    try {
      const Result result = compute(o);
      ++made;
      for (const Derivative& d : result.gradients[0].by) EXPECT_TRUE(std::isfinite(d.value)) << o.by[0];
    } catch (const scenes::SceneError& error) {
      EXPECT_THAT(error.what(), HasSubstr("allowed"));
    } catch (const runs::NumericsError& error) {
      EXPECT_GT(std::string(error.what()).size(), 20U);
    }
  }
  EXPECT_GT(made, 8);
}
