#include "scenes/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/names.h"
#include "scenes/range.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

using Json = nlohmann::ordered_json;

/// Upper ends of ranges: far past anything physical, near enough that no product of a few of them overflows.
constexpr double longest = 1e6;          // m
constexpr double largest_stress = 1e15;  // Pa
constexpr double largest_time = 1e12;    // s
constexpr std::int64_t most_names = 16;  // models in a list of runs
constexpr std::size_t most_force_steps = 10000;

std::string must_be(const std::string& what, const Value& value) {
  return fmt::format("must be {}, not {}", what, value.what());
}

// ---- reading one value: each returns what is wrong, or nothing

std::string read_number(const Value& value, const Range& range, double& number) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.content)) {
    number = static_cast<double>(*integer);
  } else if (const auto* given = std::get_if<double>(&value.content)) {
    number = *given;
  } else {
    return must_be("a number", value);
  }
  if (!std::isfinite(number)) return fmt::format("is {}; allowed: finite numbers, {}", number, range.text());
  if (!range.holds(number)) return fmt::format("is {:g}; allowed: {}", number, range.text());
  return {};
}

std::string read_integer(const Value& value, std::int64_t low, std::int64_t high, std::int64_t& integer) {
  const auto* given = std::get_if<std::int64_t>(&value.content);
  if (!given) return must_be("an integer", value);
  if (*given < low || *given > high) return fmt::format("is {}; allowed: {} to {}", *given, low, high);
  integer = *given;
  return {};
}

template <class Choice>
std::string read_choice(const Value& value, Choice& choice) {
  const auto* name = std::get_if<std::string>(&value.content);
  if (!name) return must_be("a string", value) + "; allowed: " + joined(all_names<Choice>());
  if (const auto named = choice_named<Choice>(*name)) {
    choice = *named;
    return {};
  }
  const std::string near = nearest(*name, all_names<Choice>());
  return fmt::format("is {}{}; allowed: {}", quoted(*name),
                     near.empty() ? "" : ", nearest is " + quoted(near), joined(all_names<Choice>()));
}

std::string read_models(const Value& value, std::vector<Model>& models) {
  std::vector<Value> items;
  if (const auto* array = std::get_if<std::vector<Value>>(&value.content)) {
    items = *array;
  } else if (std::holds_alternative<std::string>(value.content)) {
    items = {value};
  } else {
    return must_be("an array of models", value) + "; allowed: " + joined(all_names<Model>());
  }
  if (std::ssize(items) > most_names) return "names a model more than once";
  models.clear();
  for (const Value& item : items) {
    Model model{};
    if (const std::string wrong = read_choice(item, model); !wrong.empty()) return "(an item) " + wrong;
    if (std::find(models.begin(), models.end(), model) != models.end()) {
      return fmt::format("names {} twice; allowed: each model once", to_string(model));
    }
    models.push_back(model);
  }
  return {};
}

std::string read_force_step(const Value& item, std::pair<double, double>& step) {
  const auto* pair = std::get_if<std::vector<Value>>(&item.content);
  if (!pair || pair->size() != 2) return "must hold [time, N/m3] pairs";
  std::string wrong = read_number((*pair)[0], from(0.0, largest_time), step.first);
  if (!wrong.empty()) return "(a time) " + wrong;
  wrong = read_number((*pair)[1], from(-largest_stress, largest_stress), step.second);
  if (!wrong.empty()) return "(a force) " + wrong;
  return {};
}

std::string read_body_force(const Value& value, std::vector<std::pair<double, double>>& force) {
  const auto* array = std::get_if<std::vector<Value>>(&value.content);
  if (!array) {
    double constant = 0.0;
    if (!std::holds_alternative<std::int64_t>(value.content) &&
        !std::holds_alternative<double>(value.content)) {
      return must_be("a number or an array of [time, N/m3] pairs", value);
    }
    const std::string wrong = read_number(value, from(-largest_stress, largest_stress), constant);
    force = {{0.0, constant}};
    return wrong;
  }
  if (array->empty() || array->size() > most_force_steps) {
    return fmt::format("has {} pairs; allowed: 1 to {}", array->size(), most_force_steps);
  }
  force.clear();
  for (const Value& item : *array) {
    std::pair<double, double> step;
    if (const std::string wrong = read_force_step(item, step); !wrong.empty()) return wrong;
    if (force.empty() && step.first != 0.0) {
      return fmt::format("starts at {:g} s; allowed: pairs that start at time 0", step.first);
    }
    if (!force.empty() && step.first <= force.back().first) {
      return fmt::format("goes from {:g} s to {:g} s; allowed: ascending times", force.back().first,
                         step.first);
    }
    force.push_back(step);
  }
  return {};
}

std::string read_particles(const Value& value, Draft& draft) {
  constexpr std::int64_t most_along_an_axis = 16;
  std::int64_t count = 0;
  if (const auto* array = std::get_if<std::vector<Value>>(&value.content)) {
    std::vector<int> axes;
    for (const Value& item : *array) {
      if (axes.size() == 3) break;
      const std::string wrong = read_integer(item, 1, most_along_an_axis, count);
      if (!wrong.empty()) return "(along an axis) " + wrong;
      axes.push_back(static_cast<int>(count));
    }
    if (array->size() != 2 && array->size() != 3) {
      return fmt::format("has {} entries; allowed: one number, or one entry for each axis (2 or 3)",
                         array->size());
    }
    draft.particles_per_cell = axes;
    draft.particles_for_each_axis = true;
    return {};
  }
  if (!std::holds_alternative<std::int64_t>(value.content)) {
    return must_be("an integer or an array of one integer for each axis", value);
  }
  std::string wrong =
      read_integer(value, 1, most_along_an_axis * most_along_an_axis * most_along_an_axis, count);
  draft.particles_per_cell = {static_cast<int>(count)};
  draft.particles_for_each_axis = false;
  return wrong;
}

std::string read_wall(const Value& value, Wall& wall) {
  if (const auto* foreign = std::get_if<Foreign>(&value.content); foreign && foreign->what == "a table") {
    return "is a table: walls with friction are not built yet; allowed: " + joined(all_names<Wall>());
  }
  return read_choice(value, wall);
}

// ---- one line of the table below for each type

template <class T>
using Access = T& (*)(Draft&);

Key number(std::string section, std::string name, std::string unit, Range range, Access<double> at,
           std::string meaning) {
  Key key{.section = std::move(section), .name = std::move(name), .unit = std::move(unit)};
  key.meaning = std::move(meaning);
  key.takes = "number, " + range.text();
  key.read = [=](const Value& value, Draft& draft) { return read_number(value, range, at(draft)); };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

Key optional_number(std::string section, std::string name, std::string unit, Range range,
                    Access<std::optional<double>> at, std::string meaning) {
  Key key = number(std::move(section), std::move(name), std::move(unit), range, nullptr, std::move(meaning));
  key.read = [=](const Value& value, Draft& draft) {
    double given = 0.0;
    std::string wrong = read_number(value, range, given);
    if (wrong.empty()) at(draft) = given;
    return wrong;
  };
  key.write = [=](Draft& draft) { return at(draft) ? Json(*at(draft)) : Json(); };
  return key;
}

template <class Integer>
Key integer(std::string section, std::string name, std::int64_t low, std::int64_t high, Access<Integer> at,
            std::string meaning) {
  Key key{.section = std::move(section), .name = std::move(name), .unit = ""};
  key.meaning = std::move(meaning);
  key.takes = fmt::format("integer, {} to {}", low, high);
  key.read = [=](const Value& value, Draft& draft) {
    std::int64_t given = 0;
    std::string wrong = read_integer(value, low, high, given);
    if (wrong.empty()) at(draft) = static_cast<Integer>(given);
    return wrong;
  };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

Key boolean(std::string section, std::string name, Access<bool> at, std::string meaning) {
  Key key{.section = std::move(section), .name = std::move(name), .unit = ""};
  key.meaning = std::move(meaning);
  key.takes = "true or false";
  key.read = [=](const Value& value, Draft& draft) -> std::string {
    const auto* given = std::get_if<bool>(&value.content);
    if (!given) return must_be("true or false", value);
    at(draft) = *given;
    return {};
  };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

template <class Choice>
Key choice(std::string section, std::string name, Access<Choice> at, std::string meaning) {
  Key key{.section = std::move(section), .name = std::move(name), .unit = ""};
  key.meaning = std::move(meaning);
  key.takes = "one of " + joined(all_names<Choice>());
  key.read = [=](const Value& value, Draft& draft) { return read_choice(value, at(draft)); };
  key.write = [=](Draft& draft) { return Json(to_string(at(draft))); };
  return key;
}

Key models(std::string name, Access<std::vector<Model>> at, std::string meaning) {
  Key key{.section = "runs", .name = std::move(name), .unit = ""};
  key.meaning = std::move(meaning);
  key.takes = "array of " + joined(all_names<Model>());
  key.read = [=](const Value& value, Draft& draft) { return read_models(value, at(draft)); };
  key.write = [=](Draft& draft) {
    Json names = Json::array();
    for (const Model model : at(draft)) names.push_back(to_string(model));
    return names;
  };
  return key;
}

Key title_key() {
  Key key{.section = "", .name = "title", .unit = ""};
  key.meaning = "what every report calls the scene";
  key.takes = "string";
  key.required = true;
  key.read = [](const Value& value, Draft& draft) -> std::string {
    const auto* text = std::get_if<std::string>(&value.content);
    if (!text) return must_be("a string", value);
    if (text->empty() || text->size() > 200) {
      return fmt::format("has {} bytes; allowed: 1 to 200", text->size());
    }
    draft.scene.title = *text;
    return {};
  };
  key.write = [](Draft& draft) { return Json(draft.scene.title); };
  return key;
}

Key extends_key() {
  Key key{.section = "", .name = "extends", .unit = ""};
  key.meaning = "another scene, by name or path, from which every key not given here is taken";
  key.takes = "string";
  key.fallback = "none";
  // Followed by the reader before any key is stored; here only its type is held to.
  key.read = [](const Value& value, Draft&) {
    return std::holds_alternative<std::string>(value.content) ? std::string{} : must_be("a string", value);
  };
  key.write = [](Draft&) { return Json(); };
  return key;
}

Key body_force_key() {
  Key key{.section = "forces", .name = "body_force", .unit = "N/m3"};
  key.meaning =
      "force along the duct: a constant, or pairs of the time from which it holds (s) and its value";
  key.takes = "number, or array of [time, force] with ascending times from 0";
  key.read = [](const Value& value, Draft& draft) {
    return read_body_force(value, draft.scene.forces.body_force);
  };
  key.write = [](Draft& draft) { return Json(draft.scene.forces.body_force); };
  return key;
}

Key particles_key() {
  Key key{.section = "mpm", .name = "particles_per_cell", .unit = ""};
  key.meaning =
      "particles in a full cell: an array with one entry for each axis, or a number that is a square or a "
      "cube; its "
      "root is taken along each axis, so that 9 stays [3, 3, 3] when the scene is run in 3D";
  key.takes = "integer, or array of integers";
  key.fallback = "3 along each axis";
  key.read = read_particles;
  key.write = [](Draft& draft) { return Json(draft.scene.mpm.particles_per_cell); };
  return key;
}

Key wall_key() {
  Key key = choice<Wall>(
      "walls", "base", [](Draft& d) -> Wall& { return d.scene.base; },
      "how the plate or plates hold the material");
  key.read = [](const Value& value, Draft& draft) { return read_wall(value, draft.scene.base); };
  return key;
}

Key required(Key key) {
  key.required = true;
  return key;
}

Key only(Kind kind, Key key) {
  key.only_kind = kind;
  return key;
}

Key fallback(std::string text, Key key) {
  key.fallback = std::move(text);
  return key;
}

Key rival(std::string path, Key key) {
  key.rival = std::move(path);
  return key;
}

Key slump_length(std::string name, Access<double> at, std::string meaning) {
  return only(Kind::slump, required(number("geometry", std::move(name), "m", above(0.0, longest), at,
                                           std::move(meaning))));
}

SlumpGeometry& slump_of(Draft& draft) { return std::get<SlumpGeometry>(draft.scene.geometry.shape); }
DuctGeometry& duct_of(Draft& draft) { return std::get<DuctGeometry>(draft.scene.geometry.shape); }

std::vector<Key> general_keys() {
  return {
      title_key(),
      required(choice<Kind>(
          "", "kind", [](Draft& d) -> Kind& { return d.scene.kind; }, "what is simulated")),
      extends_key(),
      fallback("the material's model, where no run is named",
               models(
                   "mpm", [](Draft& d) -> std::vector<Model>& { return d.scene.runs.mpm; },
                   "models that `flowrest run` computes with the material point solver")),
      fallback("none", models(
                           "foam", [](Draft& d) -> std::vector<Model>& { return d.scene.runs.foam; },
                           "models that `flowrest run` computes with OpenFOAM")),
      boolean(
          "runs", "exact", [](Draft& d) -> bool& { return d.scene.runs.exact; },
          "whether `flowrest run` adds the exact or asymptotic solution"),
  };
}

std::vector<Key> geometry_keys() {
  return {
      fallback("axisymmetric (slump), plane (duct)",
               choice<Dimension>(
                   "geometry", "dimension", [](Draft& d) -> Dimension& { return d.scene.geometry.dimension; },
                   "what is computed of the body: a slump may be axisymmetric, plane, quarter or full, "
                   "a duct is plane")),
      slump_length(
          "cone_height", [](Draft& d) -> double& { return slump_of(d).cone_height; },
          "height of the cone of material"),
      only(Kind::slump, required(number(
                            "geometry", "cone_radius_top", "m", from(0.0, longest),
                            [](Draft& d) -> double& { return slump_of(d).cone_radius_top; },
                            "radius of the cone at its top"))),
      slump_length(
          "cone_radius_bottom", [](Draft& d) -> double& { return slump_of(d).cone_radius_bottom; },
          "radius of the cone at the plate"),
      slump_length(
          "domain_radius", [](Draft& d) -> double& { return slump_of(d).domain_radius; },
          "radius of the OpenFOAM mesh; material that reaches it ends a run"),
      slump_length(
          "domain_height", [](Draft& d) -> double& { return slump_of(d).domain_height; },
          "height of the OpenFOAM mesh; material that reaches it ends a run"),
      only(Kind::duct,
           required(number(
               "geometry", "height", "m", above(0.0, longest),
               [](Draft& d) -> double& { return duct_of(d).height; }, "distance between the plates"))),
  };
}

std::vector<Key> material_keys() {
  return {
      fallback("elasto-viscoplastic",
               choice<Model>(
                   "material", "model", [](Draft& d) -> Model& { return d.scene.material.model; },
                   "what `flowrest mpm` and `flowrest foam` compute unless --model says otherwise")),
      required(number(
          "material", "density", "kg/m3", above(0.0, 1e6),
          [](Draft& d) -> double& { return d.scene.material.density; },
          "density at rest and without pressure")),
      fallback("needed by every model but newtonian",
               number(
                   "material", "yield_stress", "Pa", from(0.0, largest_stress),
                   [](Draft& d) -> double& { return d.scene.material.yield_stress; }, "yield stress tau0")),
      required(number(
          "material", "plastic_viscosity", "Pa s", from(0.0, largest_stress),
          [](Draft& d) -> double& { return d.scene.material.plastic_viscosity; }, "plastic viscosity eta")),
      fallback("needed, unless bulk_modulus is given",
               rival("material.bulk_modulus",
                     number(
                         "material", "youngs_modulus", "Pa", above(0.0, largest_stress),
                         [](Draft& d) -> double& { return d.scene.material.youngs_modulus; },
                         "Young's modulus E"))),
      fallback("from youngs_modulus, whose place it may take",
               rival("material.youngs_modulus",
                     optional_number(
                         "material", "bulk_modulus", "Pa", above(0.0, largest_stress),
                         [](Draft& d) -> std::optional<double>& { return d.bulk_modulus; },
                         "bulk modulus K at rest"))),
      required(number(
          "material", "poisson_ratio", "", between(0.0, 0.5),
          [](Draft& d) -> double& { return d.scene.material.poisson_ratio; }, "Poisson ratio nu")),
      number(
          "material", "equation_of_state_exponent", "", above(0.0, 100.0),
          [](Draft& d) -> double& { return d.scene.material.equation_of_state_exponent; },
          "exponent gamma of the equation of state (Yu et al. 2026, Eq. 6)"),
      fallback("needed by papanastasiou",
               optional_number(
                   "material", "regularisation_time", "s", above(0.0, largest_time),
                   [](Draft& d) -> std::optional<double>& { return d.scene.material.regularisation_time; },
                   "regularisation time m of papanastasiou")),
      fallback("1 / regularisation_time; needed by bi-viscous",
               optional_number(
                   "material", "critical_shear_rate", "1/s", above(0.0, largest_time),
                   [](Draft& d) -> std::optional<double>& { return d.scene.material.critical_shear_rate; },
                   "shear rate at which bi-viscous yields")),
  };
}

std::vector<Key> thixotropy_keys() {
  return {
      required(number(
          "thixotropy", "flocculation_rate", "Pa/s", from(0.0, 1e9),
          [](Draft& d) -> double& { return d.scene.thixotropy->flocculation_rate; },
          "flocculation rate A_thix (Yu et al. 2026, Eq. 12)")),
      required(number(
          "thixotropy", "deflocculation_coefficient", "", from(0.0, 1e9),
          [](Draft& d) -> double& { return d.scene.thixotropy->deflocculation_coefficient; },
          "deflocculation coefficient alpha (Yu et al. 2026, Eq. 12)")),
      required(number(
          "thixotropy", "initial_flocculation", "", from(0.0, 1e9),
          [](Draft& d) -> double& { return d.scene.thixotropy->initial_flocculation; },
          "flocculation lambda at the start (Yu et al. 2026, Eq. 11)")),
  };
}

std::vector<Key> wall_force_and_time_keys() {
  return {
      wall_key(),
      only(Kind::slump, fallback("9.81", number(
                                             "forces", "gravity", "m/s2", from(0.0, 1e5),
                                             [](Draft& d) -> double& { return d.scene.forces.gravity; },
                                             "gravity, downwards"))),
      only(Kind::duct, required(body_force_key())),
      required(number(
          "time", "end", "s", above(0.0, largest_time), [](Draft& d) -> double& { return d.scene.time.end; },
          "simulated time at which a run ends")),
      fallback("true (slump), false (duct)",
               boolean(
                   "time", "stop_at_rest", [](Draft& d) -> bool& { return d.scene.time.stop_at_rest; },
                   "whether an elasto-viscoplastic run ends as soon as it is at rest (a fluid never is)")),
      number(
          "time", "rest_bound", "", above(0.0, 1.0),
          [](Draft& d) -> double& { return d.scene.time.rest_bound; },
          "at rest: where the relative growth of the spread still to come is bounded by this"),
  };
}

Key interval(std::string name, Access<double> at, std::string meaning) {
  return number("output", std::move(name), "s", above(0.0, largest_time), at, std::move(meaning));
}

std::vector<Key> output_keys() {
  return {
      interval(
          "history_interval", [](Draft& d) -> double& { return d.scene.output.history_interval; },
          "simulated time between rows of history.csv"),
      interval(
          "profile_interval", [](Draft& d) -> double& { return d.scene.output.profile_interval; },
          "simulated time between profiles"),
      interval(
          "snapshot_interval", [](Draft& d) -> double& { return d.scene.output.snapshot_interval; },
          "simulated time between snapshots"),
      interval(
          "checkpoint_interval", [](Draft& d) -> double& { return d.scene.output.checkpoint_interval; },
          "simulated time between checkpoints"),
  };
}

std::vector<Key> mpm_keys() {
  return {
      choice<Scheme>(
          "mpm", "scheme", [](Draft& d) -> Scheme& { return d.scene.mpm.scheme; },
          "transfer between particles and grid"),
      required(number(
          "mpm", "cell", "m", above(0.0, longest), [](Draft& d) -> double& { return d.scene.mpm.cell; },
          "edge of a grid cell")),
      particles_key(),
      number(
          "mpm", "cfl", "", above(0.0, 100.0), [](Draft& d) -> double& { return d.scene.mpm.cfl; },
          "Courant number of the acoustic step"),
      fallback("from cfl; 5e-4 for paper",
               optional_number(
                   "mpm", "time_step", "s", above(0.0, largest_time),
                   [](Draft& d) -> std::optional<double>& { return d.scene.mpm.time_step; },
                   "a fixed step in place of cfl")),
      boolean(
          "mpm", "allow_unstable_step", [](Draft& d) -> bool& { return d.scene.mpm.allow_unstable_step; },
          "lets time_step and cfl pass the stable limit"),
      choice<Precision>(
          "mpm", "precision", [](Draft& d) -> Precision& { return d.scene.mpm.precision; },
          "floating-point numbers of the solver"),
      integer<int>(
          "mpm", "threads", 0, 4096, [](Draft& d) -> int& { return d.scene.mpm.threads; },
          "threads; 0 takes all cores"),
      choice<Seeding>(
          "mpm", "seeding", [](Draft& d) -> Seeding& { return d.scene.mpm.seeding; },
          "where particles start"),
      integer<std::uint64_t>(
          "mpm", "seed", 0, std::numeric_limits<std::int64_t>::max(),
          [](Draft& d) -> std::uint64_t& { return d.scene.mpm.seed; }, "seed of the jitter"),
      choice<FluidUpdate>(
          "mpm", "fluid_update", [](Draft& d) -> FluidUpdate& { return d.scene.mpm.fluid_update; },
          "how a fluid's stress is integrated: implicit has no viscous step limit"),
      number(
          "mpm", "flip_relaxation_time", "s", above(0.0, largest_time),
          [](Draft& d) -> double& { return d.scene.mpm.flip_relaxation_time; },
          "time over which linear-flip forgets a particle's own velocity"),
  };
}

std::vector<Key> foam_keys() {
  return {
      fallback("mpm.cell", number(
                               "foam", "cell", "m", above(0.0, longest),
                               [](Draft& d) -> double& { return d.scene.foam.cell; }, "edge of a mesh cell")),
      number(
          "foam", "max_courant", "", above(0.0, 10.0),
          [](Draft& d) -> double& { return d.scene.foam.max_courant; },
          "bound on the Courant number of flow and interface"),
      fallback("cell^2 density / plastic_viscosity",
               optional_number(
                   "foam", "max_time_step", "s", above(0.0, largest_time),
                   [](Draft& d) -> std::optional<double>& { return d.scene.foam.max_time_step; },
                   "bound on the step")),
      number(
          "foam", "air_density", "kg/m3", above(0.0, 1e6),
          [](Draft& d) -> double& { return d.scene.foam.air_density; }, "density of the air"),
      number(
          "foam", "air_kinematic_viscosity", "m2/s", above(0.0, 1e6),
          [](Draft& d) -> double& { return d.scene.foam.air_kinematic_viscosity; },
          "kinematic viscosity of the air; large, to tame its jets"),
      number(
          "foam", "wedge_angle", "degrees", above(0.0, 10.0),
          [](Draft& d) -> double& { return d.scene.foam.wedge_angle; },
          "angle of the whole wedge of an axisymmetric case"),
  };
}

std::vector<Key> every_key() {
  std::vector<Key> all;
  for (auto group : {general_keys, geometry_keys, material_keys, thixotropy_keys, wall_force_and_time_keys,
                     output_keys, mpm_keys, foam_keys}) {
    for (Key& key : group()) all.push_back(std::move(key));
  }
  return all;
}

}  // namespace

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"", "Above all sections"},
      {"runs", "What `flowrest run` makes of the scene"},
      {"geometry", "Shape and size"},
      {"material", "The material and its model"},
      {"thixotropy", "Structural build-up and breakdown; only in scenes that have it"},
      {"walls", "Contact with walls"},
      {"forces", "What drives the flow"},
      {"time", "When a run ends"},
      {"output", "Simulated time between outputs"},
      {"mpm", "The material point solver"},
      {"foam", "OpenFOAM"},
  };
  return all;
}

const std::vector<Key>& keys() {
  static const std::vector<Key> all = every_key();
  return all;
}

const Key* find_key(const std::string& path) {
  for (const Key& key : keys()) {
    if (key.path() == path) return &key;
  }
  return nullptr;
}

std::vector<std::string> key_names(const std::string& section, std::optional<Kind> kind) {
  std::vector<std::string> names;
  for (const Key& key : keys()) {
    const bool suits = !kind || !key.only_kind || key.only_kind == kind;
    if (key.section == section && suits) names.push_back(key.name);
  }
  return names;
}

}  // namespace flowrest::scenes
