// The plug-in's laws in one cell of the real interFoam, sheared between two plates that move apart or stand
// still, against closed forms. The cell's velocity stays nought, so its shear rate is that of the plates.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "foamCases/case_fields.h"
#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "foamCases/openfoam.h"
#include "foamCases/plug_in.h"
#include "foamCases/sampler.h"
#include "foamCases/test_scene.h"
#include "runs/process.h"

namespace flowrest::foam {
namespace {

namespace fs = std::filesystem;

constexpr double height = 0.1, yield = 100.0, viscosity = 30.0, density = 2000.0;

class OneCell : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = testing::what_openfoam_lacks(); !missing.empty()) GTEST_SKIP() << missing;
    if (!find_plug_in())
      GTEST_SKIP() << "the rheology plug-in was not built: OpenFOAM's headers are missing (scripts/setup "
                      "fetches them)";
  }

  scenes::Scene scene(const std::string& model, double end, std::vector<std::string> set) {
    set.insert(set.end(),
               {fmt::format("geometry.height={}", height), fmt::format("foam.cell={}", height),
                fmt::format("mpm.cell={}", height), fmt::format("time.end={}", end),
                "forces.body_force=[[0.0, 0.0]]", fmt::format("output.snapshot_interval={}", end)});
    return scenes::load_scene("poiseuille-step-down", {set, scenes::model_from_name(model)});
  }

  static std::string plates(double rate) {
    const double speed = 0.5 * rate * height;
    return fmt::format("plates {{ type fixedValue; value nonuniform List<vector> 2 (({} 0 0) ({} 0 0)); }}",
                       -speed, speed);
  }

  static void replace(const fs::path& path, const std::string& what, const std::string& by) {
    std::string text = testing::text_of(path);
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what << " in " << path;
    text.replace(at, what.size(), by);
    std::ofstream(path, std::ios::binary) << text;
  }

  /// Shears the cell at a rate (1/s) from the beginning.
  void shear(const scenes::Scene& what, double rate) {
    fill_case(what, case_, find_plug_in());
    replace(case_ / "system" / "controlDict", "writeFormat     binary;", "writeFormat     ascii;");
    replace(case_ / "0.orig" / "U", "plates { type $plateWall; }", plates(rate));
    start("Allrun");
  }

  /// Goes on with what the case holds, the plates at a new rate, to a later time.
  void go_on(double rate, double end, const std::string& old_end) {
    const auto last = time_directories(case_).back().second;
    std::string text = testing::text_of(last / "U");
    const auto begin = text.find("plates"), stop = text.find('}', begin);
    text.replace(begin, stop - begin + 1, plates(rate));
    std::ofstream(last / "U", std::ios::binary) << text;
    replace(case_ / "sceneParameters", "endTime             " + old_end + ";",
            fmt::format("endTime {};", end));
    start(openfoam_program("interFoam"));
  }

  void start(const fs::path& program) {
    runs::Process process(program.is_absolute() ? program : case_ / program, {}, case_,
                          folder_.path() / "log", openfoam_environment());
    ASSERT_TRUE(process.wait(120.0)) << "it takes too long";
    ASSERT_TRUE(process.poll()->good()) << testing::text_of(folder_.path() / "log");
  }

  /// A field of the one cell at the end.
  std::vector<double> field(const std::string& name, int components) const {
    return read_internal_field(time_directories(case_).back().second / name, 1, components);
  }
  double time() const { return time_directories(case_).back().first; }

  testing::TemporaryFolder folder_;
  fs::path case_ = folder_.path() / "case";
};

const std::vector<std::string> thixotropy = {"thixotropy.flocculation_rate=39",
                                             "thixotropy.deflocculation_coefficient=0.6",
                                             "thixotropy.initial_flocculation=1.8"};

std::vector<std::string> with(std::vector<std::string> set, const std::string& more) {
  set.push_back(more);
  return set;
}

TEST_F(OneCell, RegularisedLawsHaveTheirViscosity) {
  for (const double rate : {1e-3, 0.3}) {
    shear(scene("papanastasiou", 0.1, {"material.regularisation_time=10", "foam.max_time_step=0.05"}), rate);
    EXPECT_NEAR(field("nu1", 1)[0] * density, viscosity - yield * std::expm1(-10.0 * rate) / rate, 1e-6)
        << rate;
    fs::remove_all(case_);
    shear(scene("bi-viscous", 0.1, {"material.critical_shear_rate=0.1", "foam.max_time_step=0.05"}), rate);
    EXPECT_NEAR(field("nu1", 1)[0] * density, viscosity + yield / std::max(rate, 0.1), 1e-6) << rate;
    fs::remove_all(case_);
  }
}

TEST_F(OneCell, AHerschelBulkleyFluidHasItsViscosity) {
  for (const double n : {0.5, 1.3})
    for (const double rate : {1e-3, 0.3, 5.0}) {
      shear(scene("herschel-bulkley", 0.1,
                  {"material.regularisation_time=10", fmt::format("material.flow_index={}", n),
                   "runs.mpm=herschel-bulkley", "runs.foam=herschel-bulkley", "foam.max_time_step=0.05"}),
            rate);
      EXPECT_NEAR(
          field("nu1", 1)[0] * density,
          viscosity * std::pow(std::hypot(rate, 0.1), n - 1.0) - yield * std::expm1(-10.0 * rate) / rate,
          1e-6)
          << n << " at " << rate;
      fs::remove_all(case_);
    }
}

/// Sheared at a constant rate lambda falls as exp(-alpha rate t) to A_thix / (tau0 alpha rate).
TEST_F(OneCell, FlocculationDecaysInFlowAndGrowsAtRest) {
  const double rate = 2.0, end = 1.0;
  shear(scene("papanastasiou", end, with(thixotropy, "foam.max_time_step=0.002")), rate);
  const double fall = 0.6 * rate, balance = 0.39 / fall;
  const double expected = balance + (1.8 - balance) * std::exp(-fall * time());
  EXPECT_NEAR(field("flocculation", 1)[0], expected, 1e-3 * expected);
  const double lambda = field("flocculation", 1)[0];
  EXPECT_NEAR(field("nu1", 1)[0] * density,
              viscosity - (1.0 + lambda) * yield * std::expm1(-10.0 * rate) / rate, 1e-4);
  // At rest, from the state just written: growth at A_thix / tau0, exactly.
  const double begin = time();
  go_on(0.0, 3.0, "1");
  EXPECT_NEAR(field("flocculation", 1)[0], lambda + 0.39 * (time() - begin), 1e-9);
}

/// With the power m of the rate: exp(-alpha rate^m t), to A_thix / (tau0 alpha rate^m); to first order in the step.
TEST_F(OneCell, FlocculationDecaysByAPowerOfTheRate) {
  const double rate = 2.0;
  for (const double m : {0.5, 1.7}) {
    auto set = with(thixotropy, "foam.max_time_step=0.002");
    set.push_back(fmt::format("thixotropy.breakdown_exponent={}", m));
    shear(scene("papanastasiou", 1.0, set), rate);
    const double fall = 0.6 * std::pow(rate, m), balance = 0.39 / fall;
    const double expected = balance + (1.8 - balance) * std::exp(-fall * time());
    EXPECT_NEAR(field("flocculation", 1)[0], expected, 3e-3 * expected) << m;
    fs::remove_all(case_);
  }
}

const std::vector<std::string> ageing = {"thixotropy.ageing_rate=25", "thixotropy.ageing_time=2",
                                         "thixotropy.initial_age=0.5"};
/// Pa, that the yield stress has grown by.
double grown(double time) { return 25.0 * 2.0 * std::expm1((0.5 + time) / 2.0); }

/// Perrot's growth adds to what flocs hold, whatever the flow has broken down.
TEST_F(OneCell, AgeAddsToTheYieldStressOfFluids) {
  const double rate = 2.0;
  auto set = with(thixotropy, "foam.max_time_step=0.002");
  set.insert(set.end(), ageing.begin(), ageing.end());
  for (const char* model : {"papanastasiou", "bi-viscous"}) {
    const auto aged = scene(model, 1.0, set);
    shear(aged, rate);
    const double lambda = field("flocculation", 1)[0], full = (1.0 + lambda) * yield + grown(time());
    const double regularised = std::string(model) == "papanastasiou" ? -std::expm1(-10.0 * rate) : 1.0;
    EXPECT_NEAR(field("nu1", 1)[0] * density, viscosity + full * regularised / rate, 1e-4) << model;
    EXPECT_GT(grown(time()), 50.0) << "enough to be seen";
    fs::remove_all(case_);
  }
}

/// Sheared for long past yield: tau0 + K rate^n.
TEST_F(OneCell, TheElastoViscoplasticStressHasThePowerOfTheRate) {
  const double rate = 0.1, modulus = 1e4;
  for (const double n : {0.5, 1.3}) {
    shear(scene("elasto-viscoplastic", 0.3,
                {fmt::format("material.bulk_modulus={}", modulus * 2.9 / (3.0 * (1.0 - 0.9))),
                 "material.poisson_ratio=0.45", "foam.max_time_step=0.0005",
                 fmt::format("material.flow_index={}", n), "runs.mpm=elasto-viscoplastic",
                 "runs.foam=elasto-viscoplastic"}),
          rate);
    const auto stress = field("stress", 6);
    double square = 0.0;  // xx xy xz yy yz zz
    for (const int i : {0, 3, 5}) square += 0.5 * stress[i] * stress[i];
    for (const int i : {1, 2, 4}) square += stress[i] * stress[i];
    const double expected = yield + viscosity * std::pow(rate, n);
    EXPECT_NEAR(std::sqrt(square), expected, 1e-3 * expected) << n;
    fs::remove_all(case_);
  }
}

/// Elastic up to yield at G rate, then to tau0 + eta rate; the strains are small, so the turning of the
/// stress is not seen.
TEST_F(OneCell, TheElastoViscoplasticStressFollowsItsClosedForm) {
  const double rate = 0.1, modulus = 1e4;  // yields at 0.1 s, then eta / G = 3 ms
  const std::vector<std::string> set{
      fmt::format("material.bulk_modulus={}", modulus * 2.9 / (3.0 * (1.0 - 0.9))),
      "material.poisson_ratio=0.45", "foam.max_time_step=0.0005"};
  const auto s = scene("elasto-viscoplastic", 0.05, set);
  ASSERT_NEAR(s.material.shear_modulus(), modulus, 1e-6 * modulus);
  shear(s, rate);
  EXPECT_NEAR(field("stress", 6)[1], modulus * rate * time(), 0.01) << "Pa, half way to yield";
  EXPECT_EQ(field("plasticShearRate", 1)[0], 0.0);
  go_on(rate, 0.15, "0.05");
  EXPECT_NEAR(field("stress", 6)[1], yield + viscosity * rate, 0.02) << "Pa, in steady flow";
  EXPECT_NEAR(field("plasticShearRate", 1)[0], rate, 1e-3 * rate);
  // Stopped, the overstress relaxes and the yield stress stays: at rest under load, for as long as one likes.
  replace(case_ / "sceneParameters", "endTime 0.15;", "endTime             0.15;");
  go_on(0.0, 1.0, "0.15");
  const double held = field("stress", 6)[1];
  EXPECT_NEAR(held, yield, 0.02);
  EXPECT_LT(field("plasticShearRate", 1)[0], 1e-10);
  EXPECT_NEAR(field("stress", 6)[0], -field("stress", 6)[3], 1e-9) << "the deviator has no trace in shear";
}

/// Thixotropy in the same return map: growth at rest, and in flow the balance of growth and breakdown.
TEST_F(OneCell, TheElastoViscoplasticLawCarriesFlocculation) {
  shear(scene("elasto-viscoplastic", 0.5, with(thixotropy, "foam.max_time_step=0.01")), 0.0);
  EXPECT_NEAR(field("flocculation", 1)[0], 1.8 + 0.39 * time(), 1e-9);
  fs::remove_all(case_);
  const double rate = 2.0, fall = 0.6 * rate, balance = 0.39 / fall;
  shear(scene("elasto-viscoplastic", 1.0, with(thixotropy, "foam.max_time_step=0.001")), rate);
  const double lambda = field("flocculation", 1)[0];
  EXPECT_NEAR(lambda, balance + (1.8 - balance) * std::exp(-fall * time()), 5e-3 * lambda);
  const auto stress = field("stress", 6);
  const double tau = std::sqrt(0.5 * (stress[0] * stress[0] + stress[3] * stress[3] + stress[5] * stress[5]) +
                               stress[1] * stress[1]);
  EXPECT_NEAR(tau, (1.0 + lambda) * yield + viscosity * field("plasticShearRate", 1)[0], 1e-6 * tau);
}

/// The same return with breakdown by a power of the rate, and with age, which flow leaves.
TEST_F(OneCell, TheElastoViscoplasticLawAgesAndBreaksDownByAPower) {
  const double rate = 2.0;
  for (const double m : {0.5, 1.7}) {
    auto set = with(thixotropy, "foam.max_time_step=0.001");
    set.insert(set.end(), ageing.begin(), ageing.end());
    set.push_back(fmt::format("thixotropy.breakdown_exponent={}", m));
    shear(scene("elasto-viscoplastic", 1.0, set), rate);
    const double lambda = field("flocculation", 1)[0], flow = field("plasticShearRate", 1)[0];
    const double fall = 0.6 * std::pow(rate, m), balance = 0.39 / fall;
    EXPECT_NEAR(lambda, balance + (1.8 - balance) * std::exp(-fall * time()), 2e-2 * lambda) << m;
    const auto stress = field("stress", 6);
    const double tau =
        std::sqrt(0.5 * (stress[0] * stress[0] + stress[3] * stress[3] + stress[5] * stress[5]) +
                  stress[1] * stress[1]);
    EXPECT_NEAR(tau, (1.0 + lambda) * yield + grown(time()) + viscosity * flow, 1e-6 * tau) << m;
    fs::remove_all(case_);
  }
}

}  // namespace
}  // namespace flowrest::foam
