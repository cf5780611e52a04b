// Derivatives of runs: forward and reverse against each other, against differences, and against what is known.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mpm/derivatives/gradient.h"
#include "mpm/derivatives/revolve.h"
#include "runs/csv.h"
#include "runs/temporary_folder.h"
#include "scenes/number_at.h"

namespace flowrest::mpm {
namespace {

using derivatives::Quantity;
using derivatives::Readings;
using derivatives::Recording;
using derivatives::Variations;

/// A scene's run, recorded, and its keys.
struct Recorded {
  scenes::Scene scene;
  std::vector<scenes::NumberAt> keys;
  std::unique_ptr<Variations> variations;
  Recording recording;
  std::vector<Quantity> quantities;
  runs::Table last;  ///< history.csv

  Recorded(const std::string& name, const std::vector<std::string>& set, const std::vector<std::string>& by,
           const std::vector<std::string>& of) {
    std::vector<std::string> all = set;
    all.emplace_back("mpm.precision=double");
    all.emplace_back("mpm.threads=1");
    scene = scenes::load_scene(name, scenes::overrides_of_command_line(all));
    std::vector<double> values;
    for (const std::string& path : by) {
      keys.push_back(scenes::number_at(scene, path));
      values.push_back(keys.back().value);
    }
    variations = std::make_unique<Variations>(by, values, [this](const std::vector<double>& at) {
      auto numbers = keys;
      for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k].value = at[k];
      return scenes::with_numbers(scene, numbers);
    });
    for (const std::string& one : of)
      quantities.push_back(derivatives::quantity_named(one, variations->centre()));
    const runs::TemporaryFolder folder;
    RunOptions options;
    options.directory = folder.path() / "run";
    options.quiet = true;
    derivatives::record(options, recording);
    run(scene, options);
    last = runs::read_csv(options.directory / "history.csv");
  }

  Readings forwards() const { return forward(*variations, recording, quantities).back(); }
  Readings backwards(double memory, derivatives::ReverseCost& cost) const {
    return reverse(*variations, recording, quantities, memory, cost);
  }
  /// The readings with one key moved by a share of its value.
  std::vector<double> with(std::size_t key, double share) const {
    std::vector<double> values = variations->values();
    values[key] *= 1.0 + share;
    const auto other = variations->moved(values);
    return replayed(*other, variations->centre(), recording, quantities).back();
  }
};

/// Both ways, by all keys, to `allowed` of each derivative.
void expect_the_same_both_ways(const Recorded& run, double memory = 4e9, double allowed = 1e-10) {
  derivatives::ReverseCost cost;
  const Readings one = run.forwards(), other = run.backwards(memory, cost);
  for (std::size_t q = 0; q < run.quantities.size(); ++q) {
    EXPECT_EQ(one.value[q], other.value[q]);
    for (std::size_t k = 0; k < run.keys.size(); ++k) {
      EXPECT_NE(one.slope[q][k], 0.0) << run.keys[k].path;
      EXPECT_NEAR(other.slope[q][k], one.slope[q][k], allowed * std::abs(one.slope[q][k]))
          << run.quantities[q].name << " by " << run.keys[k].path;
    }
  }
}

const std::vector<std::string> small_slump = {"mpm.cell=0.025", "time.end=0.25"};

/// Settings with others, which take the place of those of the same key.
std::vector<std::string> with(std::vector<std::string> set, const std::vector<std::string>& more) {
  for (const std::string& one : more) {
    const std::string key = one.substr(0, one.find('=') + 1);
    std::erase_if(set, [&](const std::string& earlier) { return earlier.rfind(key, 0) == 0; });
    set.push_back(one);
  }
  return set;
}

}  // namespace

TEST(Derivatives, AreTheSameForwardsAndBackwardsForEveryLaw) {
  for (const laws::Law law : laws::every_law) {
    SCOPED_TRACE(laws::name_of(law));
    std::vector<std::string> keys = {"material.plastic_viscosity", "material.density",
                                     "material.youngs_modulus", "material.poisson_ratio", "forces.gravity"};
    const std::string name = laws::name_of(law);
    std::vector<std::string> set =
        with(small_slump, {"material.model=" + name, "runs.mpm=" + name, "runs.foam=" + name});
    if (laws::has_yield_stress(law)) keys.emplace_back("material.yield_stress");
    if (laws::needs(law, laws::Parameter::critical_shear_rate)) {
      set.emplace_back("material.critical_shear_rate=0.5");
      keys.emplace_back("material.critical_shear_rate");
    }
    if (laws::needs(law, laws::Parameter::regularisation_time)) {
      set.emplace_back("material.regularisation_time=2");
      keys.emplace_back("material.regularisation_time");
    }
    if (laws::needs(law, laws::Parameter::flow_index)) {
      set.emplace_back("material.flow_index=0.8");
      keys.emplace_back("material.flow_index");
    }
    expect_the_same_both_ways({"roussel-slump", set, keys, {"rms_radius_mm", "spread_mm", "height_mm"}});
  }
}

TEST(Derivatives, AreTheSameForwardsAndBackwardsInEveryDimensionAndOnEveryFloor) {
  for (const char* dimension : {"axisymmetric", "plane", "quarter"})
    for (const char* floor : {"\"no-slip\"", "{ friction = 0.3 }", "{ friction = 10 }"}) {
      SCOPED_TRACE(std::string(dimension) + ", " + floor);
      std::vector<std::string> keys = {"material.yield_stress", "material.plastic_viscosity"};
      if (std::string(floor) == "{ friction = 0.3 }") keys.emplace_back("walls.base.friction");
      std::vector<std::string> set =
          with(small_slump, {std::string("geometry.dimension=") + dimension,
                             std::string("walls.base=") + floor, "material.yield_stress=400"});
      if (std::string(dimension) == "quarter") set[0] = "mpm.cell=0.04";
      expect_the_same_both_ways({"roussel-slump", set, keys, {"rms_radius_mm", "mean_height_mm"}});
    }
}

TEST(Derivatives, AreTheSameForwardsAndBackwardsWithStructure) {
  for (const char* law : {"elasto-viscoplastic", "papanastasiou"}) {
    SCOPED_TRACE(law);
    expect_the_same_both_ways(
        {"roussel-slump",
         with(small_slump,
              {std::string("material.model=") + law, "thixotropy.flocculation_rate=0.5",
               "thixotropy.deflocculation_coefficient=0.1", "thixotropy.initial_flocculation=0.6",
               "thixotropy.breakdown_exponent=0.8", "thixotropy.ageing_rate=5", "thixotropy.initial_age=2"}),
         {"material.yield_stress", "thixotropy.flocculation_rate", "thixotropy.deflocculation_coefficient",
          "thixotropy.initial_flocculation", "thixotropy.breakdown_exponent", "thixotropy.ageing_rate",
          "thixotropy.initial_age"},
         {"rms_radius_mm", "flocculation_mean"}});
  }
}

/// Fed while it goes, by a nozzle that moves, with speeds that change.
TEST(Derivatives, AreTheSameForwardsAndBackwardsInPrinting) {
  expect_the_same_both_ways({"printing-5",
                             {"mpm.cell=0.00833", "geometry.layer_length=0.08", "time.end=0.15",
                              "process.extrusion_velocity=[[0, 0.03], [0.05, 0.04]]"},
                             {"process.printing_velocity", "process.extrusion_velocity[0]",
                              "process.extrusion_velocity[1]", "material.yield_stress"},
                             {"mean_height_mm", "kinetic_energy_J"}},
                            4e9, 1e-9);
}

TEST(Derivatives, HangOnNoStateThatWasKept) {
  const Recorded run("roussel-slump", small_slump, {"material.yield_stress", "material.plastic_viscosity"},
                     {"rms_radius_mm"});
  derivatives::ReverseCost all, few;
  const Readings one = run.backwards(4e9, all), other = run.backwards(4e5, few);
  EXPECT_LT(few.snapshots, 12U);
  EXPECT_GT(few.recomputed_steps, all.recomputed_steps);
  EXPECT_EQ(one.slope, other.slope);
}

/// A duct's velocity is linear in its force, and a difference's plateau that of a derivative (Zhang et al. 2026,
/// appendix B.1).
TEST(Derivatives, OfADuctFollowItsForce) {
  const Recorded run("poiseuille-newtonian", {"time.end=0.02"}, {"forces.body_force"},
                     {"plug_velocity_m_s", "mean_velocity_m_s"});
  const Readings at = run.forwards();
  for (std::size_t q = 0; q < 2; ++q)
    EXPECT_NEAR(at.slope[q][0] * run.keys[0].value, at.value[q], 1e-5 * at.value[q]);
}

/// What is left of a change without the derivative's share falls faster than the change, and differences meet the
/// derivative. A slump bends where material yields, so that the remainders are of second order on the whole only.
TEST(Derivatives, LeaveRemaindersThatFallFasterThanTheStep) {
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {"roussel-slump", with(small_slump, {"time.end=0.5"})},
      {"roussel-slump", with(small_slump, {"time.end=0.5", "walls.base={ friction = 0.4 }"})},
      {"roussel-slump", with(small_slump, {"time.end=0.5", "geometry.dimension=plane"})}};
  for (const auto& [name, set] : cases) {
    SCOPED_TRACE(name);
    const Recorded run(name, set, {"material.plastic_viscosity"}, {"mean_height_mm"});
    const Readings at = run.forwards();
    const double value = at.value[0], slope = at.slope[0][0] * run.keys[0].value;
    const auto remainder = [&](double share) {
      return std::abs(run.with(0, share)[0] - value - share * slope);
    };
    EXPECT_LT(remainder(0.02), 0.02 * std::abs(0.02 * slope));
    EXPECT_LT(remainder(2e-4), 0.002 * std::abs(2e-4 * slope));
    const double difference = (run.with(0, 1e-5)[0] - run.with(0, -1e-5)[0]) / 2e-5;
    EXPECT_NEAR(difference, slope, 1e-5 * std::abs(slope));
  }
}

TEST(Derivatives, RefuseWhatTheyCannotGoThrough) {
  const auto refusal = [](const std::string& key) -> std::string {
    try {
      Recorded("roussel-slump", small_slump, {key}, {"rms_radius_mm"});
    } catch (const scenes::SceneError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("mpm.cell").find("mpm.cell changes the cells' size"), std::string::npos)
      << refusal("mpm.cell");
  EXPECT_NE(refusal("material.critical_shear_rate").find("no effect"), std::string::npos)
      << refusal("material.critical_shear_rate");
  EXPECT_NE(refusal("material.no_such_key").find("no such key"), std::string::npos);
  EXPECT_NE(refusal("material.model").find("not a number"), std::string::npos);
  const Recorded run("roussel-slump", small_slump, {"material.yield_stress"}, {"rms_radius_mm"});
  EXPECT_THROW(derivatives::quantity_named("strand_width_mm", run.variations->centre()), scenes::SceneError);
}

TEST(Derivatives, QuantitiesStandNextToTheirColumns) {
  const Recorded run("roussel-slump", with(small_slump, {"mpm.cell=0.01"}), {"material.yield_stress"},
                     {"spread_mm", "height_mm"});
  const auto value = run.forwards().value;
  EXPECT_NEAR(value[0], run.last.at("spread_mass_995_mm").back(), 5.0);
  EXPECT_NEAR(value[1], run.last.at("height_mm").back(), 10.0);
}

/// Every order of going back is one of all steps, from the last to the first, within its number of states.
TEST(Revolve, GoesBackEveryStepOnceWithinItsStates) {
  for (const std::size_t steps : {1UL, 2UL, 7UL, 100UL, 1000UL})
    for (const std::size_t snapshots : {0UL, 1UL, 3UL, 20UL, 2000UL}) {
      std::vector<std::size_t> kept = {0};
      std::size_t here = 0, next = steps, advanced = 0, most = 1;
      derivatives::Reversal reversal;
      reversal.advance_to = [&](std::size_t step) {
        ASSERT_GE(step, here);
        advanced += step - here;
        here = step;
      };
      reversal.keep = [&] {
        kept.push_back(here);
        most = std::max(most, kept.size());
      };
      reversal.restore = [&] { here = kept.back(); };
      reversal.drop = [&] { kept.pop_back(); };
      reversal.back = [&](std::size_t step) {
        EXPECT_EQ(here, step);
        EXPECT_EQ(step + 1, next);
        next = step;
      };
      derivatives::go_back(reversal, 0, steps, snapshots);
      EXPECT_EQ(next, 0U);
      EXPECT_LE(most, snapshots + 1);
      // Griewank and Walther 2000: with s states and r repeats (s + r)! / (s! r!) steps.
      if (snapshots == 3 && steps == 100) {
        EXPECT_LE(advanced, 8U * 100U);
      }
      if (snapshots == 2000) {
        EXPECT_LT(advanced, 2 * steps);
      }
    }
}

}  // namespace flowrest::mpm
