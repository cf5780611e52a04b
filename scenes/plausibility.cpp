#include "scenes/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "scenes/pieces.h"
#include "scenes/settings.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

/// A unit in which a value may have been given by mistake.
struct Slip {
  const char* unit;
  double si;  ///< of one such unit
};

/// Values that people give with a meaning. A value of exactly 0 switches something off and is always one.
struct Rule {
  std::vector<const char*> keys;
  double low, high;  ///< SI, both allowed
  const char* who;   ///< has such values
  std::vector<Slip> slips = {};
  bool (*applies)(const Scene&) = +[](const Scene&) { return true; };
};

bool yields(const Scene& scene) { return scene.material.model != Model::newtonian; }
bool is_newtonian(const Scene& scene) { return !yields(scene); }
/// Of a fluid the modulus is a means of the method, and may be anything.
bool is_elastic(const Scene& scene) { return scene.material.model == Model::elasto_viscoplastic; }

const std::vector<Slip> of_length = {{"mm", 1e-3}, {"cm", 1e-2}};
const std::vector<Slip> of_speed = {{"mm/s", 1e-3}, {"cm/s", 1e-2}};
const std::vector<Slip> of_stress = {{"kPa", 1e3}, {"mPa", 1e-3}};

/// Wide enough for water, cement paste, mortar and concrete, fresh, from a laboratory's smallest copies to
/// casts.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = {
      {{"material.density"},
       300.0,
       6000.0,
       "from foamed concrete to heavy concrete",
       {{"t/m3 or g/cm3", 1e3}, {"g/m3", 1e-3}}},
      {{"material.yield_stress"},
       0.1,
       2e4,
       "from thin cement paste to concrete for printing",
       of_stress,
       yields},
      {{"material.plastic_viscosity"},
       1e-3,
       500.0,
       "from thin cement paste to the stiffest concrete",
       {{"mPa s", 1e-3}, {"kPa s", 1e3}},
       yields},
      {{"material.plastic_viscosity"},
       1e-4,
       1e4,
       "from water to syrup and bitumen",
       {{"mPa s", 1e-3}},
       is_newtonian},
      {{"material.youngs_modulus"},
       1e3,
       1e10,
       "from concrete as soft as it is computed with to water",
       {{"MPa", 1e6}, {"kPa", 1e3}},
       is_elastic},
      {{"thixotropy.flocculation_rate"}, 1e-3, 50.0, "from a slow mix to one with an accelerator", of_stress},
      {{"thixotropy.ageing_rate"}, 1e-4, 50.0, "from a slow mix to one with an accelerator", of_stress},
      {{"thixotropy.ageing_time"},
       100.0,
       1e6,
       "from a mix with an accelerator to one that is retarded",
       {{"min", 60.0}, {"h", 3600.0}}},
      {{"thixotropy.breakdown_exponent"}, 0.2, 2.0, "about Roussel's 1"},
      {{"geometry.cone_height", "geometry.cone_radius_top", "geometry.cone_radius_bottom", "geometry.height",
        "geometry.reservoir_length", "geometry.reservoir_height", "geometry.width", "geometry.channel_height",
        "geometry.rebar_distance", "geometry.top_width", "geometry.outlet_width", "geometry.depth",
        "geometry.taper_height", "geometry.neck_height", "geometry.fall_height", "geometry.column_length",
        "geometry.column_height"},
       1e-4,
       5.0,
       "from a model of a mould to a pour",
       of_length},
      {{"geometry.rebar_diameter"}, 1e-4, 0.2, "from a wire to a pile's bundle", of_length},
      {{"geometry.channel_length", "geometry.tank_length", "geometry.domain_radius",
        "geometry.domain_height"},
       1e-4,
       50.0,
       "from a model of a mould to a hall",
       of_length},
      {{"geometry.mould_lift_velocity", "geometry.gate_lift_velocity"},
       1e-5,
       2.0,
       "from a crawl to a snatch; a cone's is 0.1 to 0.3",
       of_speed},
      {{"forces.gravity"},
       0.1,
       50.0,
       "from a small moon to a small centrifuge",
       {{"cm/s2", 1e-2}, {"mm/s2", 1e-3}}},
  };
  return all;
}

/// "In kPa that would be 50 Pa", where some unit explains the value.
std::string explanation(const Rule& rule, double value, const std::string& unit) {
  std::vector<std::string> explained;
  for (const Slip& slip : rule.slips)
    if (const double meant = value * slip.si; meant >= rule.low && meant <= rule.high)
      explained.push_back(fmt::format("{}in {} that would be {:g} {}", explained.empty() ? "" : "and ",
                                      slip.unit, meant, unit));
  return explained.empty() ? "" : "; " + joined(explained);
}

void hold_to_rules(const Scene& scene, std::vector<std::string>& notes) {
  for (const auto& [key, json] : settings_of(scene)) {
    if (!json.is_number()) continue;
    const double value = json.get<double>();
    for (const Rule& rule : rules()) {
      const bool named = std::any_of(rule.keys.begin(), rule.keys.end(),
                                     [&key = *key](const char* name) { return key.path() == name; });
      if (!named || !rule.applies(scene) || value == 0.0 || (value >= rule.low && value <= rule.high))
        continue;
      notes.push_back(fmt::format("{} is {:g} {}, which is implausible: {:g} to {:g} {} is usual, {}{}",
                                  key->path(), value, key->unit, rule.low, rule.high, key->unit, rule.who,
                                  explanation(rule, value, key->unit)));
    }
  }
}

/// Pa, at the start.
double yield_stress_of(const Scene& scene) {
  return scene.local_yield_stress(scene.thixotropy ? scene.thixotropy->initial_flocculation : 0.0, 0.0);
}

/// " with its flocculation": what of it is not the material's own.
const char* sources_of_yield_stress(const Scene& scene) {
  const bool flocs = scene.thixotropy && scene.thixotropy->initial_flocculation > 0.0;
  if (scene.grown_yield_stress(0.0) > 0.0) return flocs ? " with its flocculation and age" : " with its age";
  return flocs ? " with its flocculation" : "";
}

void hold_to_load(const Scene& scene, std::vector<std::string>& notes) {
  const double yield = yield_stress_of(scene);
  const auto load = load_of(scene);
  if (!yields(scene) || !load || yield <= 0.0 || yield < load->stress) return;
  notes.push_back(fmt::format(
      "the yield stress holds {}: nothing will flow{}; it is {:.4g} Pa{}, and {} is {:.4g} Pa", load->what,
      scene.material.model == Model::elasto_viscoplastic ? "" : ", but for the creep of a regularised fluid",
      yield, sources_of_yield_stress(scene), load->rule, load->stress));
}

/// Concrete yields after a strain of a few per cent at most.
void hold_to_strain(const Scene& scene, std::vector<std::string>& notes) {
  const double yield = yield_stress_of(scene), shear_modulus = scene.material.shear_modulus();
  if (!is_elastic(scene) || !(yield > shear_modulus)) return;
  notes.push_back(
      fmt::format("the yield stress of {:.4g} Pa is reached only after a shear strain of {:.3g}, for the "
                  "shear modulus is {:.4g} "
                  "Pa: the material bends rather than flows; concrete yields below 0.1",
                  yield, yield / shear_modulus, shear_modulus));
}

}  // namespace

std::vector<std::string> plausibility_notes(const Scene& scene) {
  std::vector<std::string> notes;
  hold_to_rules(scene, notes);
  hold_to_load(scene, notes);
  hold_to_strain(scene, notes);
  return notes;
}

}  // namespace flowrest::scenes
