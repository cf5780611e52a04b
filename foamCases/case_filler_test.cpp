#include "foamCases/case_filler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "foamCases/apparatus/apparatus.h"
#include "foamCases/step_rules.h"
#include "foamCases/test_scene.h"
#include "foamCases/wedge_grid.h"
#include "runs/run_directory.h"

namespace flowrest::foam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::roussel_slump;
using testing::TemporaryFolder;
using testing::text_of;

/// "key value;" lines of a dictionary, comments left out.
std::map<std::string, std::string> entries(const std::string& text) {
  std::map<std::string, std::string> result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto end = line.find(';');
    std::istringstream words(line.substr(0, end));
    std::string key;
    words >> key >> std::ws;
    if (end == std::string::npos || key.starts_with("//")) continue;
    std::getline(words, result[key]);
  }
  return result;
}

double largest(const scenes::Scene& scene) { return largest_step(*case_of(scene)); }

std::string refusal(const std::string& model, const std::vector<std::string>& set) {
  try {
    check_supported(roussel_slump(model, set));
  } catch (const scenes::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CaseFiller, TheCommittedCaseIsTheRousselSlump) {
  EXPECT_EQ(text_of(cases_folder() / "slump" / "sceneParameters"),
            scene_parameters(roussel_slump("papanastasiou"), false))
      << "foamCases/slump/sceneParameters is what `flowrest foam roussel-slump --model papanastasiou` writes";
}

/// Small enough to read, and to run while one waits.
scenes::Scene committed_quarter() {
  return roussel_slump("papanastasiou",
                       {"geometry.dimension=quarter", "foam.cell=0.03", "foam.laws=built-in"});
}

TEST(CaseFiller, TheCommittedQuarterIsTheRousselSlumpOnCoarseCells) {
  EXPECT_EQ(text_of(cases_folder() / "slump-quarter" / "sceneParameters"),
            scene_parameters(committed_quarter(), false))
      << "foamCases/slump-quarter/sceneParameters is what `flowrest foam roussel-slump --model papanastasiou "
         "--set "
         "geometry.dimension=quarter --set foam.cell=0.03 --set foam.laws=built-in` writes";
  const auto quarter = committed_quarter();
  EXPECT_THAT(text_of(cases_folder() / "slump-quarter" / "0.orig" / "alpha.concrete"),
              HasSubstr(case_of(quarter)->initial_fraction() + ";"))
      << "and so is 0.orig/alpha.concrete";
}

TEST(CaseFiller, TheCommittedDuctIsTheStepDown) {
  EXPECT_EQ(
      text_of(cases_folder() / "duct" / "sceneParameters"),
      scene_parameters(scenes::load_scene("poiseuille-step-down", {{}, scenes::Model::papanastasiou}), false))
      << "foamCases/duct/sceneParameters is what `flowrest foam poiseuille-step-down --model papanastasiou "
         "--set "
         "foam.laws=built-in` writes";
}

/// What a scene's case gets in place of a file of its folder; empty where it is not written.
std::string written_file(const scenes::Scene& scene, const fs::path& path) {
  for (const CaseFile& file : case_of(scene)->files())
    if (file.path == path) return file.text;
  return "";
}

/// Coarse, so that they can be read and run while one waits.
scenes::Scene committed_vessel(const std::string& kind) {
  if (kind == "dam-break")
    return scenes::load_scene("dam-break", {{"foam.cell=0.04"}, scenes::Model::newtonian});
  if (kind == "l-box")
    return scenes::load_scene("mix-a-lbox-sf0", {{"foam.cell=0.025"}, scenes::Model::papanastasiou});
  return scenes::load_scene("mix-a-vfunnel-sf0", {{"foam.cell=0.02"}, scenes::Model::elasto_viscoplastic});
}

TEST(CaseFiller, TheCommittedVesselsAreScenesOnCoarseCells) {
  for (const char* kind : {"dam-break", "l-box", "v-funnel"}) {
    const auto scene = committed_vessel(kind);
    EXPECT_EQ(case_of(scene)->folder(), kind);
    EXPECT_EQ(text_of(cases_folder() / kind / "sceneParameters"), scene_parameters(scene, true))
        << "foamCases/" << kind << "/sceneParameters is what `flowrest foam " << scene.name
        << "` writes with --set foam.cell=" << scene.foam.cell << " --model "
        << scenes::to_string(scene.material.model);
    EXPECT_EQ(text_of(cases_folder() / kind / "system" / "blockMeshDict"),
              written_file(scene, "system/blockMeshDict"));
    const auto baffles = cases_folder() / kind / "system" / "createBafflesDict";
    EXPECT_EQ(std::filesystem::exists(baffles) ? text_of(baffles) : "",
              written_file(scene, "system/createBafflesDict"));
  }
}

TEST(CaseFiller, AVesselsConcreteStandsInABoxBetweenWallsOfTheScene) {
  const auto scene = scenes::load_scene(
      "mix-a-lbox-sf0", {{"walls.base={friction=0.4}", "time.end=3"}, scenes::Model::elasto_viscoplastic});
  const auto text = scene_parameters(scene, true);
  for (const char* entry :
       {"fillLow             (-1000 -1000 -1000);", "fillHigh            (0.1 1000 0.6);",
        "baseWall            { type coulombFriction; friction 0.4; }", "gravity             (0 0 -9.81);",
        "endTime             3;", "type            shearRate;", "flocculation plasticShearRate"})
    EXPECT_THAT(text, HasSubstr(entry));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("airRises")));
}

TEST(CaseFiller, AGateIsAPlateBeforeTheOpeningOfAnLBoxThatHasOne) {
  auto scene = scenes::load_scene("mix-a-lbox-sf0", {{"geometry.gate_lift_velocity=0.3"}, std::nullopt});
  EXPECT_THAT(scene_parameters(scene, true), HasSubstr("velocity        0.3;  // m/s"));
  EXPECT_THAT(written_file(scene, "system/createBafflesDict"),
              HasSubstr("origin      (0.10001 -0.001 -0.001);"));
  auto open = scene.l_box();
  open.gate_lift_velocity.reset();
  scene.geometry.apparatus = open;
  EXPECT_THAT(scene_parameters(scene, true), ::testing::Not(HasSubstr("liftedGate")));
  EXPECT_EQ(written_file(scene, "system/createBafflesDict"), "");
  // A case that was filled with a gate is filled again without.
  const TemporaryFolder folder;
  const std::filesystem::path plug_in = "libflowrestRheology.so";
  fill_case(committed_vessel("l-box"), folder.path(), plug_in);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "system" / "createBafflesDict"));
  fill_case(scene, folder.path(), plug_in);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "system" / "createBafflesDict"));
}

TEST(CaseFiller, TakesEveryNumberFromTheScene) {
  const auto scene = roussel_slump(
      "bi-viscous",
      {"foam.cell=0.02", "time.end=7", "material.density=2000", "material.yield_stress=80",
       "material.plastic_viscosity=20", "material.critical_shear_rate=0.05", "walls.base=slip",
       "forces.gravity=1.6", "foam.max_courant=0.1", "foam.outer_correctors=3",
       "geometry.cone_radius_bottom=0.12", "output.history_interval=0.5", "output.snapshot_interval=2"});
  const auto values = entries(scene_parameters(scene, false));
  const auto number = [&](const std::string& key) { return std::stod(values.at(key)); };
  EXPECT_EQ(values.at("baseWall"), "{ type slip");
  EXPECT_EQ(values.at("gravity"), "(0 0 -1.6)");
  EXPECT_EQ(values.at("transportModel"), "HerschelBulkley");
  EXPECT_DOUBLE_EQ(number("nu0"), (20.0 + 80.0 / 0.05) / 2000.0);
  EXPECT_DOUBLE_EQ(number("tau0"), 80.0 / 2000.0);
  EXPECT_DOUBLE_EQ(number("k"), 20.0 / 2000.0);
  EXPECT_EQ(number("concreteDensity"), 2000.0);
  EXPECT_EQ(number("endTime"), 7.0);
  EXPECT_EQ(number("maxCourant"), 0.1);
  EXPECT_EQ(number("outerCorrectors"), 3.0);
  EXPECT_DOUBLE_EQ(number("maxDeltaT"), 0.02 * 0.02 * 2000.0 / 20.0);
  EXPECT_EQ(number("coneRadiusBottom"), 0.12);
  EXPECT_EQ(number("sampleInterval"), 0.25);  // of the profiles, which come oftener here
  EXPECT_EQ(number("snapshotInterval"), 2.0);
  EXPECT_EQ(number("coneCells"), 14.0);
  EXPECT_EQ(number("baseCells"), 1.0);
  EXPECT_DOUBLE_EQ(number("baseHeight"), 0.02);
  EXPECT_DOUBLE_EQ(number("halfWidth"), 0.45 * std::tan(std::acos(-1.0) / 72.0));
  EXPECT_DOUBLE_EQ(number("minusHalfWidth"), -number("halfWidth"));
}

TEST(CaseFiller, ANewtonianFluidHasOneViscosity) {
  const auto values = entries(scene_parameters(roussel_slump("newtonian"), false));
  EXPECT_EQ(values.at("transportModel"), "Newtonian");
  EXPECT_DOUBLE_EQ(std::stod(values.at("nu")), 50.0 / 2300.0);
}

TEST(CaseFiller, TheStepNeverPassesASampleAndObeysTheScene) {
  EXPECT_DOUBLE_EQ(largest(roussel_slump("papanastasiou")), 0.0046);
  EXPECT_EQ(largest(roussel_slump("papanastasiou", {"foam.max_time_step=0.002"})), 0.002);
  EXPECT_EQ(largest(roussel_slump("papanastasiou", {"material.plastic_viscosity=0.1"})), 0.05);
}

/// The plug-in watches every run; only a slump's step grows, and only where nothing holds it.
TEST(CaseFiller, ASlumpsStepGrowsWhereThePlugInWatches) {
  const auto watched = [](const scenes::Scene& scene) { return entries(scene_parameters(scene, true)); };
  const auto slump = watched(roussel_slump("papanastasiou"));
  EXPECT_DOUBLE_EQ(std::stod(slump.at("least")), 0.0046);
  EXPECT_DOUBLE_EQ(std::stod(slump.at("most")), 0.4 * 0.05);  // two fifths of the history's interval
  EXPECT_DOUBLE_EQ(std::stod(slump.at("ofTime")), 0.004);
  EXPECT_DOUBLE_EQ(std::stod(slump.at("maxDeltaT")), 0.0046);
  EXPECT_EQ(slump.at("pressureCorrectors"), "12");
  EXPECT_DOUBLE_EQ(std::stod(watched(roussel_slump("papanastasiou", {"foam.step_growth=3"})).at("most")),
                   3 * 0.0046);
  for (const char* held : {"foam.step_growth=1", "foam.max_time_step=0.002"}) {
    const auto values = watched(roussel_slump("papanastasiou", {held}));
    EXPECT_EQ(values.at("least"), values.at("most")) << held;
    EXPECT_EQ(values.at("least"), values.at("maxDeltaT")) << held;
  }
  const auto duct = watched(scenes::load_scene("poiseuille-step-down", {{}, scenes::Model::papanastasiou}));
  EXPECT_EQ(duct.at("least"), duct.at("most"));
  EXPECT_EQ(duct.at("pressureCorrectors"), "6");
  EXPECT_EQ(watched(roussel_slump("elasto-viscoplastic")).at("pressureCorrectors"), "12");
  const auto unwatched = entries(scene_parameters(roussel_slump("papanastasiou"), false));
  EXPECT_FALSE(unwatched.contains("most"));
  EXPECT_EQ(unwatched.at("pressureCorrectors"), "6");
}

TEST(CaseFiller, RefusesWhatTheCaseCannotRun) {
  EXPECT_EQ(refusal("elasto-viscoplastic", {}), "accepted");
  EXPECT_THAT(refusal("papanastasiou", {"geometry.dimension=plane"}),
              HasSubstr("allowed: axisymmetric, quarter"));
  EXPECT_EQ(refusal("papanastasiou", {"geometry.dimension=quarter"}), "accepted");
  EXPECT_THAT(refusal("papanastasiou", {"geometry.domain_height=0.301"}), HasSubstr("at least 0.31 m"));
  EXPECT_THAT(refusal("papanastasiou", {"foam.cell=0.0001"}), HasSubstr("at most 5e+06 are allowed"));
  EXPECT_EQ(refusal("bi-viscous", {}), "accepted");
}

TEST(CaseFiller, ADuctIsAColumnOfCellsUnderTheForcesOfTheScene) {
  const auto scene =
      scenes::load_scene("poiseuille-step-down", {{"foam.cell=0.02"}, scenes::Model::papanastasiou});
  check_supported(scene);
  const auto text = scene_parameters(scene, true);
  for (const char* entry :
       {"ductHeight          0.5;", "ductCells           25;", "cellWidth           0.02;",
        "endTime             20;", "plateWall           noSlip;", "concreteDensity     2000;",
        "injectionRateSuSp { U ((2000 0 0) 0); }", "injectionRateSuSp { U ((360 0 0) 0); }"})
    EXPECT_THAT(text, HasSubstr(entry));
  // The sources do not overlap, and leave out no step's end.
  const auto source = [&](const std::string& name, const std::string& key) {
    const auto at = text.find(key, text.find(name));
    return std::stod(text.substr(at + key.size()));
  };
  const double step = largest(scene);
  const double first = source("from0", "timeStart"), second = source("from1", "timeStart");
  EXPECT_GT(first, 0.0);
  EXPECT_LT(first, 0.01 * step);
  EXPECT_NEAR(second, 12.0, 0.01 * step);
  EXPECT_GE(first + source("from0", "duration"), 12.0);
  EXPECT_LT(first + source("from0", "duration"), second);
  EXPECT_GT(second + source("from1", "duration"), 20.0);
}

TEST(CaseFiller, TellsThePlugInEverythingOfTheLaw) {
  const auto text = scene_parameters(
      roussel_slump("papanastasiou",
                    {"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                     "thixotropy.initial_flocculation=1.8", "foam.mixing=saturating", "foam.full_at=0.3",
                     "foam.strain_rate=concrete", "material.yield_stress=80"}),
      true);
  for (const char* entry :
       {"transportModel      PapanastasiouBingham;", "yieldStress         80;", "plasticViscosity    50;",
        "regularisationTime    100;", "flocculationRate            0.39;",
        "deflocculationCoefficient   0.15;", "initialFlocculation         1.8;",
        "mixing              saturating;", "fullAt              0.3;", "strainRate          concrete;",
        "wetting             geometric;", "historyObjects      (alpha.concrete U flocculation);",
        "rheologyLibraries   (\"$FOAM_CASE/libflowrestRheology.so\");"})
    EXPECT_THAT(text, HasSubstr(entry));
  for (const char* entry : {"breakdownExponent", "ageingRate", "ageingTime", "initialAge"})
    EXPECT_THAT(text, ::testing::Not(HasSubstr(entry))) << "what a scene does not have";
  const std::vector<std::string> aged = {
      "thixotropy.flocculation_rate=0.39",   "thixotropy.deflocculation_coefficient=0.15",
      "thixotropy.initial_flocculation=1.8", "thixotropy.breakdown_exponent=0.7",
      "thixotropy.ageing_rate=0.02",         "thixotropy.ageing_time=3000",
      "thixotropy.initial_age=600"};
  for (const char* model : {"papanastasiou", "elasto-viscoplastic"})
    EXPECT_THAT(scene_parameters(roussel_slump(model, aged), true),
                ::testing::AllOf(HasSubstr("breakdownExponent           0.7;"),
                                 HasSubstr("ageingRate                  0.02;  // Pa/s"),
                                 HasSubstr("ageingTime                  3000;  // s"),
                                 HasSubstr("initialAge                  600;  // s")));
  EXPECT_THAT(scene_parameters(roussel_slump("bi-viscous", {"foam.mixing=mass-weighted"}), true),
              ::testing::AllOf(HasSubstr("transportModel      biViscousBingham;"),
                               HasSubstr("criticalShearRate     0.01;"), HasSubstr("massWeighted;"),
                               ::testing::Not(HasSubstr("thixotropy"))));
  EXPECT_THAT(scene_parameters(roussel_slump("newtonian"), true),
              ::testing::AllOf(HasSubstr("transportModel      NewtonianConcrete;"),
                               HasSubstr("yieldStress         0;"), HasSubstr("plasticViscosity    50;")));
}

TEST(CaseFiller, CopiesTheCaseAndNothingARunLeftInIt) {
  const TemporaryFolder cases, target;
  fs::copy(cases_folder() / "slump", cases.path() / "slump", fs::copy_options::recursive);
  fs::create_directories(cases.path() / "slump" / "12.5");
  fs::create_directories(cases.path() / "slump" / "constant" / "polyMesh");
  setenv("FLOWREST_FOAM_CASES", cases.path().c_str(), 1);
  const auto scene = roussel_slump("bi-viscous");
  fill_case(scene, target.path() / "case", "/where/the/plug-in/is.so");
  unsetenv("FLOWREST_FOAM_CASES");
  const fs::path filled = target.path() / "case";
  EXPECT_EQ(text_of(filled / "sceneParameters"), scene_parameters(scene, true));
  EXPECT_EQ(fs::read_symlink(filled / "libflowrestRheology.so"), "/where/the/plug-in/is.so");
  for (const char* part : {"0/U", "0/p_rgh", "0/alpha.concrete", "system/controlDict", "Allrun", "case.foam"})
    EXPECT_TRUE(fs::exists(filled / part)) << part;
  EXPECT_FALSE(fs::exists(filled / "12.5"));
  EXPECT_FALSE(fs::exists(filled / "constant" / "polyMesh"));
}

TEST(CaseFiller, AFolderThatItDidNotMakeIsLeftAlone) {
  const TemporaryFolder target;
  std::ofstream(target.path() / "mine") << "work of years";
  try {
    fill_case(roussel_slump("papanastasiou"), target.path(), std::nullopt);
    FAIL() << "it wrote over another folder";
  } catch (const runs::RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no case that `flowrest foam` made"));
  }
  EXPECT_FALSE(fs::exists(target.path() / "system"));
  EXPECT_EQ(text_of(target.path() / "mine"), "work of years");
  // Its own it fills again.
  fill_case(roussel_slump("papanastasiou"), target.path() / "case", std::nullopt);
  EXPECT_NO_THROW(fill_case(roussel_slump("bi-viscous"), target.path() / "case", std::nullopt));
}

TEST(CaseFiller, SaysWhereItLookedForACase) {
  const TemporaryFolder empty;
  setenv("FLOWREST_FOAM_CASES", empty.path().c_str(), 1);
  try {
    fill_case(roussel_slump("papanastasiou"), empty.path() / "case", std::nullopt);
    FAIL() << "a case was found where there is none";
  } catch (const runs::RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr((empty.path() / "slump").string() + ": no OpenFOAM case is there"));
  }
  unsetenv("FLOWREST_FOAM_CASES");
}

}  // namespace
}  // namespace flowrest::foam
