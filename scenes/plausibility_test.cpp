#include "scenes/plausibility.h"

#include <cmath>
#include <numbers>

#include "scenes/test_scenes.h"

/// Slips of units run on in silence unless they are noted; what is plausible is left in peace.
namespace flowrest::scenes::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Notes = std::vector<std::string>;

Notes notes_of(const std::string& scene, const std::vector<std::string>& set) {
  return plausibility_notes(load_scene(scene, {set, std::nullopt}));
}

Notes slump_with(const std::vector<std::string>& set) { return notes_of("roussel-slump", set); }

TEST(Plausibility, NoSceneThatShipsIsImplausible) {
  for (const SceneSummary& summary : list_scenes()) {
    const Scene scene = load_scene(summary.name);
    EXPECT_THAT(plausibility_notes(scene), IsEmpty()) << summary.name;
    for (const auto& models : {scene.runs.mpm, scene.runs.foam})
      for (const Model model : models)
        EXPECT_THAT(plausibility_notes(load_scene(summary.name, {{}, model})), IsEmpty()) << summary.name;
  }
}

TEST(Plausibility, PastesMortarsAndSmallCopiesAreLeftInPeace) {
  EXPECT_THAT(
      slump_with({"material.yield_stress=0.5", "material.plastic_viscosity=0.05", "material.density=1900"}),
      IsEmpty());
  EXPECT_THAT(slump_with({"geometry.cone_height=0.003", "geometry.cone_radius_top=0.0005",
                          "geometry.cone_radius_bottom=0.001", "geometry.domain_radius=0.0045",
                          "geometry.domain_height=0.0035", "material.yield_stress=0.5",
                          "material.plastic_viscosity=0.05", "material.youngs_modulus=1000",
                          "mpm.cell=0.0002", "foam.cell=0.0002"}),
              IsEmpty())
      << "an exact copy of the cone, a hundredth its size";
  EXPECT_THAT(slump_with({"material.yield_stress=0", "material.plastic_viscosity=0", "runs.foam=[]"}),
              IsEmpty())
      << "0 is meant";
  EXPECT_THAT(slump_with({"forces.gravity=0", "material.yield_stress=0"}), IsEmpty());
}

TEST(Plausibility, EachSlipOfAUnitIsNotedWithTheUnitThatExplainsIt) {
  const std::vector<std::tuple<std::string, std::string, std::string>> slips = {
      {"material.density=2.3", "material.density is 2.3 kg/m3", "in t/m3 or g/cm3 that would be 2300 kg/m3"},
      {"material.yield_stress=0.05", "material.yield_stress is 0.05 Pa", "in kPa that would be 50 Pa"},
      {"material.yield_stress=50000", "material.yield_stress is 50000 Pa", "in mPa that would be 50 Pa"},
      {"material.plastic_viscosity=50000", "material.plastic_viscosity is 50000 Pa s",
       "in mPa s that would be 50 Pa s"},
      {"forces.gravity=981", "forces.gravity is 981 m/s2", "in cm/s2 that would be 9.81 m/s2"},
      {"geometry.mould_lift_velocity=100", "geometry.mould_lift_velocity is 100 m/s",
       "in mm/s that would be 0.1 m/s"}};
  for (const auto& [setting, value, explanation] : slips)
    // Ten times as stiff under a hundred times the weight: else the reader itself refuses it as crushed.
    EXPECT_THAT(slump_with({setting, "material.youngs_modulus=1e8"}),
                Contains(AllOf(HasSubstr(value), HasSubstr(explanation))))
        << setting;
}

TEST(Plausibility, AModulusInMegapascalIsNotedWhereNothingElseRefusesIt) {
  EXPECT_THAT(notes_of("poiseuille-step-down", {"material.youngs_modulus=0.1"}),
              Contains(AllOf(HasSubstr("material.youngs_modulus is 0.1 Pa"),
                             HasSubstr("in MPa that would be 100000 Pa"))));
  EXPECT_THAT(slump_with({"material.youngs_modulus=0.1", "runs.mpm=[]"}),
              Contains(HasSubstr("in MPa that would be 100000 Pa")));
  EXPECT_THAT(notes_of("poiseuille-step-down", {"material.youngs_modulus=2000", "material.yield_stress=1000",
                                                "forces.body_force=10000"}),
              ElementsAre(HasSubstr("only after a shear strain of 1.45")));
  EXPECT_THAT(notes_of("poiseuille-newtonian", {}), IsEmpty()) << "a fluid's modulus is a means";
}

TEST(Plausibility, LengthsInMillimetresAreNotedEach) {
  const Notes notes = slump_with({"geometry.cone_height=300", "geometry.cone_radius_top=50",
                                  "geometry.cone_radius_bottom=100", "geometry.domain_radius=450",
                                  "geometry.domain_height=350", "mpm.cell=10", "foam.cell=10",
                                  "material.youngs_modulus=1e9"});
  EXPECT_EQ(notes.size(), 5u);
  EXPECT_THAT(notes, Contains(AllOf(HasSubstr("geometry.cone_height is 300 m"),
                                    HasSubstr("in mm that would be 0.3 m"))));
  EXPECT_THAT(
      notes_of("mix-a-lbox-sf0", {"geometry.rebar_diameter=0.3", "geometry.width=2", "mpm.cell=0.06"}),
      Contains(HasSubstr("geometry.rebar_diameter is 0.3 m")));
}

struct Holding {
  std::string scene, says;
  double stress;  ///< Pa, from which on nothing flows
  std::vector<std::string> set = {};
};

TEST(Plausibility, AYieldStressThatLetsNothingFlowIsNotedInEveryKindOfScene) {
  const double root_3 = std::numbers::sqrt3, weight = 2400.0 * 9.81;
  const std::vector<Holding> holdings = {
      {"roussel-slump", "holds the cone: nothing will flow", 2300.0 * 9.81 * 0.3 / root_3},
      {"mix-a-lbox-sf0", "holds the reservoir: nothing will flow", weight * 0.6 / root_3},
      {"dam-break",
       "holds the column: nothing will flow",
       1000.0 * 9.8 * 0.6 / root_3,
       {"material.model=elasto-viscoplastic", "runs.mpm=[\"elasto-viscoplastic\"]"}},
      {"poiseuille-step-down", "holds the duct: nothing will flow", 2000.0 * 0.5 / 2.0},
      {"mix-a-vfunnel-sf0", "holds the material in the funnel: nothing will flow", weight * 0.6 / root_3},
      {"mix-a-vfunnel-sf0",
       "holds the material in the funnel: nothing will flow",
       weight * (0.6 / 0.15) * 0.5 * 0.065,
       {"walls.base=no-slip"}}};
  for (const Holding& h : holdings) {
    const auto with = [&h](double factor) {
      auto set = h.set;
      set.push_back("material.yield_stress=" + std::to_string(factor * h.stress));
      set.push_back("material.youngs_modulus=1e6");
      return notes_of(h.scene, set);
    };
    EXPECT_THAT(with(1.001), ElementsAre(HasSubstr(h.says))) << h.scene;
    EXPECT_THAT(with(0.999), IsEmpty()) << h.scene;
  }
}

TEST(Plausibility, FlocculationAddsToWhatHolds) {
  EXPECT_THAT(
      notes_of("mix-a-slump-sf0", {"thixotropy.initial_flocculation=50"}),
      ElementsAre(AllOf(HasSubstr("holds the cone: nothing will flow"), HasSubstr("with its flocculation"))));
}

TEST(Plausibility, AgeAddsToWhatHolds) {
  const Notes notes =
      notes_of("mix-a-slump-sf0", {"thixotropy.ageing_rate=1", "thixotropy.initial_age=4000"});
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], AllOf(HasSubstr("holds the cone: nothing will flow"), HasSubstr("age, and")));
  EXPECT_THAT(notes_of("mix-a-slump-sf0", {"thixotropy.ageing_rate=0.1", "thixotropy.ageing_time=1.5"}),
              Contains(AllOf(HasSubstr("thixotropy.ageing_time is 1.5 s, which is implausible"),
                             HasSubstr("in h that would be 5400 s"))));
}

TEST(Plausibility, ARegularisedFluidCreepsEvenThen) {
  EXPECT_THAT(slump_with({"material.yield_stress=5000", "material.model=papanastasiou"}),
              ElementsAre(HasSubstr("nothing will flow, but for the creep of a regularised fluid")));
  EXPECT_THAT(slump_with({"material.yield_stress=5000", "material.model=newtonian"}), IsEmpty());
  EXPECT_THAT(notes_of("poiseuille-step-down", {"material.yield_stress=5000", "walls.base=slip"}), IsEmpty())
      << "between plates that let it slip it moves all the same";
}

}  // namespace
}  // namespace flowrest::scenes::test
