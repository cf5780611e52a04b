#include "scenes/scene.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenes/pieces.h"
#include "scenes/test_scenes.h"

namespace flowrest::scenes::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Every resolved setting is the same.
void expect_equal(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.runs, b.runs);
  EXPECT_EQ(a.geometry, b.geometry);
  EXPECT_EQ(a.material, b.material);
  EXPECT_EQ(a.thixotropy, b.thixotropy);
  EXPECT_EQ(a.base, b.base);
  EXPECT_EQ(a.mould, b.mould);
  EXPECT_EQ(a.forces, b.forces);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.output, b.output);
  EXPECT_EQ(a.gauges, b.gauges);
  EXPECT_EQ(a.mpm, b.mpm);
  EXPECT_EQ(a.foam, b.foam);
}

void expect_round_trip(const Scene& scene) {
  SCOPED_TRACE(resolved_toml(scene));
  const Scene again = parse_scene(resolved_toml(scene), "again.toml");
  expect_equal(scene, again);
  EXPECT_EQ(resolved_json(scene), resolved_json(again));
}

TEST(Scene, EverySceneInTheFolderCanBeUsed) {
  const std::vector<SceneSummary> summaries = list_scenes();
  EXPECT_GE(summaries.size(), 2u);
  for (const SceneSummary& summary : summaries) {
    SCOPED_TRACE(summary.name);
    EXPECT_EQ(summary.error, "");
    EXPECT_NE(summary.title, "");
    expect_round_trip(load_scene(summary.name));
  }
}

TEST(Scene, ReadsWhatIsGiven) {
  const Scene scene = parse_scene(slump_text, "some/folder/slump.toml");
  EXPECT_EQ(scene.name, "slump");
  EXPECT_EQ(scene.path, "some/folder/slump.toml");
  EXPECT_EQ(scene.source, slump_text);
  EXPECT_EQ(name_of(scene.geometry.apparatus), "slump");
  EXPECT_THAT(scene.runs.mpm, ElementsAre(Model::elasto_viscoplastic));
  EXPECT_THAT(scene.runs.foam, ElementsAre(Model::papanastasiou));
  EXPECT_TRUE(scene.runs.exact);
  EXPECT_DOUBLE_EQ(scene.slump().domain_radius, 0.45);
  EXPECT_DOUBLE_EQ(scene.material.yield_stress, 50.0);  // an integer in the text
  EXPECT_DOUBLE_EQ(scene.time.end, 60.0);
  EXPECT_FALSE(scene.thixotropy);
}

TEST(Scene, ResolvesWhatIsNotGiven) {
  const Scene duct = parse_scene(duct_text, "duct.toml");
  EXPECT_EQ(duct.geometry.dimension, Dimension::plane);
  EXPECT_THAT(duct.runs.mpm, ElementsAre(Model::elasto_viscoplastic));
  EXPECT_THAT(duct.runs.foam, IsEmpty());
  EXPECT_FALSE(duct.time.stop_at_rest);
  EXPECT_THAT(duct.mpm.particles_per_cell, ElementsAre(3, 3));
  EXPECT_DOUBLE_EQ(duct.foam.cell, 0.01);
  EXPECT_FALSE(duct.mpm.time_step);
  EXPECT_FALSE(duct.material.critical_shear_rate);
  EXPECT_NEAR(duct.material.bulk_modulus(), 0.33e6, 1e-6);

  const Scene slump = parse_scene(replaced(slump_text, "gravity = 9.81\n", "\n"), "slump.toml");
  EXPECT_DOUBLE_EQ(slump.forces.gravity, 9.81);
  EXPECT_DOUBLE_EQ(slump.material.critical_shear_rate.value(), 0.01);
}

TEST(Scene, GaugesAreDefinedAsTheStandardApparatusHasThemAndScaleWithTheBody) {
  for (const char* name : {"roussel-slump", "mix-a-lbox-sf0", "mix-a-vfunnel-sf0", "poiseuille-10"})
    EXPECT_EQ(load_scene(name).gauges, Gauges{}) << name;

  EXPECT_EQ(load_scene("dam-break").gauges.front_depth, 0.003);

  // A hundredth as large: lengths a hundredth, times a tenth.
  const Overrides small{{"geometry.cone_height=0.003", "geometry.cone_radius_top=0.0005",
                         "geometry.cone_radius_bottom=0.001", "mpm.cell=0.0002", "foam.cell=0.0002"},
                        {}};
  const Gauges copy = parse_scene(slump_text, "s.toml", small).gauges;
  EXPECT_DOUBLE_EQ(copy.spread_depth, 3e-5);
  EXPECT_DOUBLE_EQ(copy.rest_rate, 5e-5);
  EXPECT_DOUBLE_EQ(copy.still_speed, 1e-5);
  EXPECT_DOUBLE_EQ(copy.rest_shear_rate, 0.5);
  EXPECT_DOUBLE_EQ(copy.rate_window, 0.2);

  const Gauges box = load_scene("mix-a-lbox-sf0", {{"geometry.reservoir_height=0.3"}, {}}).gauges;
  EXPECT_DOUBLE_EQ(box.front_depth, 0.0015);
  EXPECT_DOUBLE_EQ(box.end_length, 0.01);
  const Gauges funnel =
      load_scene("mix-a-vfunnel-sf0", {{"geometry.taper_height=0.2", "geometry.neck_height=0.1"}, {}}).gauges;
  EXPECT_DOUBLE_EQ(funnel.light_depth, 0.0015);
  const Gauges on_the_moon = parse_scene(slump_text, "s.toml", {{"forces.gravity=1.09"}, {}}).gauges;
  EXPECT_DOUBLE_EQ(on_the_moon.spread_depth, 0.003);
  EXPECT_DOUBLE_EQ(on_the_moon.rate_window, 6.0);
  EXPECT_EQ(parse_scene(slump_text, "s.toml", {{"forces.gravity=0"}, {}}).gauges, Gauges{});
}

TEST(Scene, WhatGaugesAreDefinedByCanBeGiven) {
  const Scene scene = parse_scene(slump_text, "s.toml", {{"gauges.spread_depth=0.005"}, {}});
  EXPECT_DOUBLE_EQ(scene.gauges.spread_depth, 0.005);
  EXPECT_DOUBLE_EQ(scene.gauges.rest_rate, 5e-4);
  expect_round_trip(scene);
}

TEST(Scene, ANewtonianFluidNeedsNoYieldStress) {
  std::string text = replaced(duct_text, "yield_stress = 100\n", "model = \"newtonian\"\n");
  EXPECT_DOUBLE_EQ(parse_scene(text, "duct.toml").material.yield_stress, 0.0);
  text += "[runs]\nmpm = [\"newtonian\", \"elasto-viscoplastic\"]\n";
  EXPECT_THAT(complaint(text),
              HasSubstr("material.yield_stress is missing; needed by the model elasto-viscoplastic"));
}

TEST(Scene, AnElasticBodyNeedsNeitherYieldStressNorViscosity) {
  std::string text = replaced(duct_text, "yield_stress = 100", "yield_stress = 0");
  text = replaced(text, "plastic_viscosity = 30", "plastic_viscosity = 0");
  EXPECT_EQ(complaint(text), "");
}

TEST(Scene, TheSchemePaperRunsAtItsPublishedStepUnlessToldOtherwise) {
  EXPECT_DOUBLE_EQ(parse_scene(slump_text, "s.toml", {{"mpm.scheme=paper"}, {}}).mpm.time_step.value(), 5e-4);
  const Overrides slower{{"mpm.scheme=paper", "mpm.time_step=1e-4"}, {}};
  EXPECT_DOUBLE_EQ(parse_scene(slump_text, "s.toml", slower).mpm.time_step.value(), 1e-4);
}

TEST(Scene, AnUnstableStepMayBeAllowed) {
  const std::string step = "mpm.time_step=1e-2";
  EXPECT_THAT(complaint(slump_text, {{step}, {}}), HasSubstr("past the acoustic limit"));
  EXPECT_EQ(complaint(slump_text, {{step, "mpm.allow_unstable_step=true"}, {}}), "");
}

TEST(Scene, EveryModelThatWillRunIsHeldToTheViscousLimit) {
  std::vector<std::string> set = {"mpm.time_step=1e-5", "mpm.fluid_update=explicit",
                                  "runs.mpm=[\"elasto-viscoplastic\"]"};
  EXPECT_EQ(complaint(slump_text, {set, {}}), "");
  set.push_back("runs.mpm=[\"elasto-viscoplastic\", \"bi-viscous\"]");
  EXPECT_THAT(complaint(slump_text, {set, {}}),
              HasSubstr("past the viscous limit of 7.59076e-06 s of an explicit bi-viscous"));
  set.push_back("mpm.time_step=7e-6");
  EXPECT_EQ(complaint(slump_text, {set, {}}), "");
}

TEST(Scene, ParticlesPerCellKeepTheirSpacingInEveryDimension) {
  const auto particles = [](const std::string& given, const std::string& dimension) {
    const Overrides overrides{{"mpm.particles_per_cell=" + given, "geometry.dimension=" + dimension}, {}};
    return parse_scene(slump_text, "s.toml", overrides).mpm.particles_per_cell;
  };
  EXPECT_THAT(particles("9", "axisymmetric"), ElementsAre(3, 3));
  EXPECT_THAT(particles("9", "quarter"), ElementsAre(3, 3, 3));
  EXPECT_THAT(particles("8", "full"), ElementsAre(2, 2, 2));
  EXPECT_THAT(particles("27", "quarter"), ElementsAre(3, 3, 3));
  EXPECT_THAT(particles("27", "plane"), ElementsAre(3, 3));
  EXPECT_THAT(particles("64", "plane"), ElementsAre(8, 8));
  EXPECT_THAT(particles("64", "full"), ElementsAre(4, 4, 4));
  EXPECT_THAT(particles("1", "axisymmetric"), ElementsAre(1, 1));
  EXPECT_THAT(particles("[4, 1]", "axisymmetric"), ElementsAre(4, 1));
  EXPECT_THAT(particles("[2, 3, 4]", "full"), ElementsAre(2, 3, 4));
}

TEST(Scene, CarriageReturnsAndAByteOrderMarkChangeNothing) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : slump_text) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_equal(parse_scene(text, "s.toml"), parse_scene(slump_text, "s.toml"));
  EXPECT_THAT(complaint(replaced(text, "cfl", "clf")), HasSubstr("wrong.toml:36:1: unknown key \"mpm.clf\""));
}

TEST(Scene, ABodyForceMayBeConstant) {
  const Scene scene = parse_scene(duct_text, "d.toml", {{"forces.body_force=2000"}, {}});
  EXPECT_THAT(scene.forces.body_force, ElementsAre(std::pair(0.0, 2000.0)));
}

TEST(Scene, ResolvedSettingsReadBackAsTheSameScene) {
  const std::vector<std::vector<std::string>> variants = {
      {},
      {"geometry.dimension=quarter", "mpm.scheme=linear-flip", "mpm.precision=float",
       "mpm.seed=9223372036854775807", "mpm.b_bar=cell-average"},
      {"mpm.scheme=paper", "walls.base=slip", "material.critical_shear_rate=0.123456789012345678"},
      {"material.bulk_modulus=123456.789", "material.poisson_ratio=0.499", "runs.mpm=[]", "runs.exact=false"},
      {"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
       "thixotropy.initial_flocculation=1.8", "time.stop_at_rest=false"},
      {"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
       "thixotropy.initial_flocculation=1.8", "thixotropy.breakdown_exponent=0.70000000000000001",
       "thixotropy.ageing_rate=0.012345678901234567", "thixotropy.ageing_time=3141.5926535897932",
       "thixotropy.initial_age=599.9"},
      {"title=\"a \\\"quoted\\\" \\\\ title\\twith a tab\"", "mpm.allow_unstable_step=true",
       "mpm.time_step=1", "foam.max_time_step=1e-3", "foam.cell=0.007", "mpm.fluid_update=explicit",
       "mpm.seeding=jittered"},
      {"walls.base={ friction = 0.3 }", "walls.mould={ friction = 0.123456789012345678 }", "runs.foam=[]",
       "geometry.mould_lift_velocity=0.15"},
      {"walls.base={ friction = 0 }", "walls.mould=slip", "runs.foam=[]"},
  };
  for (const auto& set : variants) expect_round_trip(parse_scene(slump_text, "slump.toml", {set, {}}));
  expect_round_trip(parse_scene(duct_text, "duct.toml"));
}

TEST(Scene, EverySceneOfTheFolderCanBeUsedAndReadsBack) {
  const auto scenes = list_scenes();
  EXPECT_GE(scenes.size(), 30u);
  for (const SceneSummary& summary : scenes) {
    EXPECT_EQ(summary.error, "") << summary.name;
    if (summary.error.empty()) expect_round_trip(load_scene(summary.name));
  }
  expect_round_trip(load_scene("mix-a-lbox-sf0", {{"geometry.gate_lift_velocity=0.123456789012345678"}, {}}));
}

TEST(Scene, StructureIsRousselsAndAgelessUnlessGiven) {
  const Scene usual = load_scene("mix-a-slump-sf0");
  EXPECT_EQ(usual.thixotropy->breakdown_exponent, 1.0);
  EXPECT_EQ(usual.grown_yield_stress(1e6), 0.0);
  EXPECT_DOUBLE_EQ(usual.local_yield_stress(0.5, 10.0), 1.5 * usual.material.yield_stress);
  const std::vector<std::string> aged{"thixotropy.ageing_rate=0.02", "thixotropy.initial_age=600"};
  const Scene linear = load_scene("mix-a-slump-sf0", {aged, {}});
  EXPECT_DOUBLE_EQ(linear.local_yield_stress(0.5, 10.0), 1.5 * usual.material.yield_stress + 0.02 * 610.0);
  auto curved = aged;
  curved.emplace_back("thixotropy.ageing_time=3000");
  EXPECT_NEAR(load_scene("mix-a-slump-sf0", {curved, {}}).grown_yield_stress(10.0),
              60.0 * std::expm1(610.0 / 3000.0), 1e-12);
  EXPECT_EQ(load_scene("mix-a-slump-sf0", {{"thixotropy.ageing_rate=0", "thixotropy.ageing_time=1e-3"}, {}})
                .grown_yield_stress(10.0),
            0.0);
  curved.emplace_back("material.model=newtonian");
  EXPECT_EQ(load_scene("mix-a-slump-sf0", {curved, {}}).grown_yield_stress(10.0), 0.0)
      << "what has no yield stress";
}

TEST(Scene, AVariantGivesOnlyWhatDiffers) {
  const Scene fresh = load_scene("mix-a-slump-sf0"), rested = load_scene("mix-a-slump-sf600");
  EXPECT_EQ(rested.thixotropy->initial_flocculation, 2.8);
  EXPECT_EQ(rested.material, fresh.material);
  EXPECT_EQ(rested.geometry, fresh.geometry);
  EXPECT_EQ(rested.base, fresh.base);
  EXPECT_EQ(fresh.base.law, Wall::friction);
  EXPECT_EQ(fresh.base.friction, 0.3);
}

TEST(Scene, ResolvedJsonHasTheSameKeys) {
  const auto json = nlohmann::json::parse(resolved_json(parse_scene(duct_text, "duct.toml")));
  EXPECT_EQ(json["kind"], "duct");
  EXPECT_EQ(json["geometry"], nlohmann::json::parse(R"({"dimension": "plane", "height": 0.5})"));
  EXPECT_EQ(json["forces"]["body_force"], nlohmann::json::parse("[[0.0, 2000.0], [12.0, 360.0]]"));
  EXPECT_FALSE(json["material"].contains("regularisation_time"));
  EXPECT_FALSE(json.contains("thixotropy"));
}

TEST(Overrides, TakeTomlValuesAndBareWords) {
  const Scene scene =
      parse_scene(slump_text, "s.toml",
                  {{"mpm.cell=0.005", "mpm.cell = 0.004", "mpm.scheme=linear-flip", "mpm.precision=\"float\"",
                    "title=Two words", "runs.mpm=[\"newtonian\", 'papanastasiou']", "runs.foam=bi-viscous",
                    "time.stop_at_rest=false"},
                   {}});
  EXPECT_DOUBLE_EQ(scene.mpm.cell, 0.004);
  EXPECT_EQ(scene.mpm.scheme, Scheme::linear_flip);
  EXPECT_EQ(scene.mpm.precision, Precision::single_precision);
  EXPECT_EQ(scene.title, "Two words");
  EXPECT_THAT(scene.runs.mpm, ElementsAre(Model::newtonian, Model::papanastasiou));
  EXPECT_THAT(scene.runs.foam, ElementsAre(Model::bi_viscous));
  EXPECT_FALSE(scene.time.stop_at_rest);
}

TEST(Overrides, TheModelOfTheCommandLineWins) {
  const Scene scene =
      parse_scene(slump_text, "s.toml", {{"material.model=bi-viscous"}, Model::papanastasiou});
  EXPECT_EQ(scene.material.model, Model::papanastasiou);
}

/// What a command line's overrides are refused for.
std::string refusal_of(const std::vector<std::string>& set, const std::string& model = "") {
  try {
    overrides_of_command_line(set, model);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CommandLineOverrides, NoSettingIsDroppedForAnother) {
  EXPECT_EQ(refusal_of({"mpm.cell=0.02", "foam.cell=0.02"}), "accepted");
  EXPECT_EQ(refusal_of({"mpm.cell=0.02", "mpm.cell=0.02"}), "accepted");
  EXPECT_EQ(refusal_of({"mpm.cell=0.02", "mpm.cell = 0.01"}),
            "--set mpm.cell = 0.01: mpm.cell is given twice, before as 0.02; allowed: one value");
  EXPECT_THAT(refusal_of({"material.youngs_modulus=1e5", "material.bulk_modulus=1e5"}),
              testing::HasSubstr("are both given; allowed: one of them"));
  EXPECT_EQ(refusal_of({"material.model=bi-viscous"}, "bi-viscous"), "accepted");
  EXPECT_EQ(refusal_of({"material.model=\"bi-viscous\""}, "bi-viscous"), "accepted");
  EXPECT_THAT(refusal_of({"material.model=bi-viscous"}, "newtonian"),
              testing::HasSubstr("material.model is given beside --model newtonian; allowed: one of them"));
  EXPECT_THAT(refusal_of({"material.model=nonsense"}, "newtonian"), testing::HasSubstr("one of them"));
  EXPECT_THAT(refusal_of({}, "nonsense"), testing::HasSubstr("unknown model"));
}

TEST(CommandLineOverrides, AModelThatRunsOverruleIsRefused) {
  const auto refusal = [](const std::vector<std::string>& set) -> std::string {
    try {
      check_model_has_effect(load_scene("roussel-slump", {set, std::nullopt}), set);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({}), "accepted");
  EXPECT_EQ(refusal({"material.model=newtonian", "runs.mpm=newtonian", "runs.foam=newtonian"}), "accepted");
  EXPECT_THAT(refusal({"material.model=newtonian"}),
              testing::HasSubstr("for example --set runs.mpm=newtonian"));
}

TEST(Overrides, AModulusTakesThePlaceOfTheOtherOne) {
  const Scene scene = parse_scene(slump_text, "s.toml", {{"material.bulk_modulus=1e5"}, {}});
  EXPECT_NEAR(scene.material.bulk_modulus(), 1e5, 1e-6);
}

TEST(Overrides, AreRefusedByName) {
  const auto refusal = [](const std::string& setting) { return complaint(slump_text, {{setting}, {}}); };
  EXPECT_THAT(refusal("mpm.cel=0.005"),
              HasSubstr("--set mpm.cel=0.005: unknown key \"mpm.cel\", nearest is cell"));
  EXPECT_THAT(refusal("mpn.cell=0.005"),
              HasSubstr("--set mpn.cell=0.005: unknown section \"mpn\", nearest is mpm"));
  EXPECT_THAT(refusal("cell=0.005"),
              HasSubstr("--set cell=0.005: unknown key \"cell\", cell belongs to [mpm]"));
  EXPECT_THAT(refusal("mpm={cell=0.005}"), HasSubstr("--set mpm={cell=0.005}: sets a whole table"));
  EXPECT_THAT(refusal("mpm.cell"), HasSubstr("--set mpm.cell: has no value; allowed: KEY=VALUE"));
  EXPECT_THAT(refusal("mpm.cell="), HasSubstr("--set mpm.cell=: mpm.cell must be a number, not a string"));
  EXPECT_THAT(refusal("mpm.cell=-1"),
              HasSubstr("--set mpm.cell=-1: mpm.cell is -1; allowed: greater than 0"));
  EXPECT_THAT(refusal("mpm.cell=nan"), HasSubstr("--set mpm.cell=nan: mpm.cell is nan"));
  EXPECT_THAT(refusal("mpm.cell=fine"),
              HasSubstr("--set mpm.cell=fine: mpm.cell must be a number, not a string"));
  EXPECT_THAT(refusal("mpm.scheme=papr"),
              HasSubstr("--set mpm.scheme=papr: mpm.scheme is \"papr\", nearest is \"paper\""));
  EXPECT_THAT(refusal("extends=roussel-slump"), HasSubstr("cannot change what a scene extends"));
  EXPECT_THAT(refusal("title=a \xff b"), HasSubstr("is not valid UTF-8"));
  EXPECT_THAT(refusal("=1"), HasSubstr("--set =1: unknown key \"\""));
  EXPECT_THAT(refusal(""), HasSubstr("has no value"));
  EXPECT_THAT(refusal("material.density=1\nmpm.cell=2"),
              HasSubstr("--set material.density=1\\x0ampm.cell=2: material.density must be a number"));
  EXPECT_THAT(refusal("runs.mpm=[\"newtonian\", 3]"),
              HasSubstr("--set runs.mpm=[\"newtonian\", 3]: runs.mpm must be a string, not an integer"));
}

/// A folder of scenes of its own, which FLOWREST_SCENES names.
class SceneFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "flowrest-scenes-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    setenv("FLOWREST_SCENES", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("FLOWREST_SCENES");
    std::filesystem::remove_all(folder_);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  static std::string refusal(const std::string& scene) {
    try {
      load_scene(scene);
    } catch (const SceneError& error) {
      return error.what();
    }
    return {};
  }

  std::filesystem::path folder_;
};

TEST_F(SceneFolder, ASceneIsFoundByNameAndByPath) {
  const std::string path = write("small-slump.toml", slump_text);
  EXPECT_EQ(scenes_folder(), folder_);
  EXPECT_EQ(load_scene("small-slump").path, path);
  EXPECT_EQ(load_scene("small-slump").name, "small-slump");
  EXPECT_EQ(load_scene(path).title, "A slump");
}

TEST_F(SceneFolder, WhereNoScenesAreThatIsSaid) {
  EXPECT_EQ(refusal("roussel-slump"),
            "unknown scene \"roussel-slump\": no scenes are in " + folder_.string() +
                "; allowed: a path to a .toml file, or FLOWREST_SCENES naming the folder of the scenes");
}

TEST_F(SceneFolder, AnUnknownSceneIsRefusedWithTheNearest) {
  write("small-slump.toml", slump_text);
  write("large-duct.toml", duct_text);
  EXPECT_EQ(
      refusal("smal-slump"),
      "unknown scene \"smal-slump\", nearest is small-slump; allowed: a path to a .toml file, or large-duct, "
      "small-slump");
  EXPECT_EQ(refusal("missing.toml"), "missing.toml: no such file");
  EXPECT_EQ(refusal(folder_.string() + "/"), folder_.string() + "/: not a file; allowed: a TOML file");
}

TEST_F(SceneFolder, IsListedWithWhatCannotBeUsed) {
  write("b.toml", slump_text);
  write("a.toml", "title = 3\n");
  write("notes.txt", "no scene");
  const std::vector<SceneSummary> summaries = list_scenes();
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries[0].name, "a");
  EXPECT_THAT(summaries[0].error, HasSubstr("a.toml:1:1: kind is missing"));
  EXPECT_EQ(summaries[0].error.find('\n'), std::string::npos);
  EXPECT_EQ(summaries[1].title, "A slump");
  EXPECT_EQ(summaries[1].error, "");
}

TEST_F(SceneFolder, ASceneExtendsAnotherKeyByKey) {
  write("base.toml", slump_text);
  const std::string middle = write("middle.toml", "extends = \"base\"\n[mpm]\ncell = 0.005\n");
  const std::string path = write("deeper/leaf.toml",
                                 "title = \"Leaf\"\nextends = \"../middle.toml\"\n"
                                 "mpm.scheme = \"linear-flip\"\nmaterial.bulk_modulus = 2e5\n");
  const Scene scene = load_scene(path);
  EXPECT_EQ(scene.title, "Leaf");
  EXPECT_DOUBLE_EQ(scene.mpm.cell, 0.005);
  EXPECT_EQ(scene.mpm.scheme, Scheme::linear_flip);
  EXPECT_THAT(scene.mpm.particles_per_cell, ElementsAre(3, 3));
  EXPECT_DOUBLE_EQ(scene.slump().cone_height, 0.3);
  EXPECT_NEAR(scene.material.bulk_modulus(), 2e5, 1e-6);
  expect_round_trip(scene);
}

TEST_F(SceneFolder, FaultsOfAnExtendedSceneNameTheFileTheyAreIn) {
  const std::string base = write("base.toml", replaced(slump_text, "density = 2300.0", "density = -1"));
  const std::string leaf = write("leaf.toml", "extends = \"base\"\n[mpm]\nclel = 0.005\n");
  EXPECT_THAT(refusal(leaf), HasSubstr(base + ":13:11: material.density is -1"));
  EXPECT_THAT(refusal(leaf), HasSubstr(leaf + ":3:1: unknown key \"mpm.clel\", nearest is cell"));
  write("leaf.toml", "extends = \"base\"\n[material]\ndensity = 2000\n");
  EXPECT_EQ(refusal(leaf), "");
}

TEST_F(SceneFolder, ACycleIsRefusedWithItsChain) {
  const std::string a = write("a.toml", "extends = \"b\"\n");
  const std::string b = write("b.toml", "\nextends = \"a.toml\"\n");
  EXPECT_EQ(refusal(a), b + ":2:11: extends itself: " + a + " extends " + b + " extends " + a);
  const std::string self = write("self.toml", "extends = \"self\"\n");
  EXPECT_EQ(refusal(self), self + ":1:11: extends itself: " + self + " extends " + self);
}

TEST_F(SceneFolder, WhatCannotBeExtendedIsRefusedOnce) {
  const std::string leaf = write("leaf.toml", "extends = \"bse\"\n");
  write("base.toml", slump_text);
  EXPECT_EQ(refusal(leaf),
            leaf +
                ":1:11: unknown scene \"bse\", nearest is base; allowed: a path to a .toml file, or "
                "base, leaf");
  write("leaf.toml", "extends = \"broken\"\n");
  const std::string broken = write("broken.toml", "title =\n");
  EXPECT_THAT(refusal(leaf), testing::StartsWith(broken + ":1:8: is not valid TOML"));
  EXPECT_EQ(refusal(leaf).find('\n'), std::string::npos);
}

TEST(Names, AreThoseOfTheScenes) {
  EXPECT_EQ(to_string(Model::elasto_viscoplastic), "elasto-viscoplastic");
  EXPECT_EQ(to_string(Scheme::quadratic_apic), "quadratic-apic");
  EXPECT_EQ(to_string(Precision::single_precision), "float");
  EXPECT_EQ(model_from_name("bi-viscous"), Model::bi_viscous);
  EXPECT_THAT([] { model_from_name("biviscous"); },
              testing::ThrowsMessage<SceneError>("unknown model \"biviscous\", nearest is \"bi-viscous\"; "
                                                 "allowed: elasto-viscoplastic, papanastasiou, "
                                                 "bi-viscous, herschel-bulkley, newtonian"));
}

TEST(Material, ModuliFollowFromYoungsModulus) {
  const Material material = parse_scene(slump_text, "s.toml").material;
  EXPECT_NEAR(material.bulk_modulus(), 1e5 / 1.2, 1e-9);
  EXPECT_NEAR(material.shear_modulus(), 1e5 / 2.6, 1e-9);
  EXPECT_NEAR(material.longitudinal_speed(), std::sqrt((1e5 / 1.2 + 4.0 / 3.0 * 1e5 / 2.6) / 2300.0), 1e-12);
}

TEST(Slump, VolumeIsThatOfAFrustum) {
  EXPECT_NEAR(parse_scene(slump_text, "s.toml").slump().volume(), 5.49779e-3, 1e-8);
}

TEST(Pieces, AreGaugedByWhatTheirApparatusIsJudgedBy) {
  for (const SceneSummary& listed : list_scenes()) {
    const Scene scene = load_scene(listed.name);
    EXPECT_EQ(pieces_of(scene).gauged.index(), static_cast<std::size_t>(scene.main_gauge())) << listed.name;
  }
}

TEST(Forces, ABodyForceHoldsFromItsTime) {
  const Forces forces = parse_scene(duct_text, "d.toml").forces;
  EXPECT_DOUBLE_EQ(forces.body_force_at(0.0), 2000.0);
  EXPECT_DOUBLE_EQ(forces.body_force_at(11.999), 2000.0);
  EXPECT_DOUBLE_EQ(forces.body_force_at(12.0), 360.0);
  EXPECT_DOUBLE_EQ(forces.body_force_at(100.0), 360.0);
}

}  // namespace
}  // namespace flowrest::scenes::test
