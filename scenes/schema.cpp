#include "scenes/schema.h"

#include <fmt/format.h>

#include <type_traits>

#include "scenes/key_types.h"

namespace flowrest::scenes {

namespace {

constexpr double standard_gravity = 9.81;  // m/s2

/// Places in the list of the apparatus of which something is so.
template <class IsSo>
std::vector<std::size_t> places_of(IsSo is_so) {
  std::vector<std::size_t> places;
  std::size_t place = 0;
  for_each_apparatus([&](const auto& a) {
    if (is_so(a)) places.push_back(place);
    ++place;
  });
  return places;
}

/// Where a setting is kept, as a function of the draft.
#define AT(setting)             \
  +[](Draft & draft) -> auto& { \
    return setting;             \
  }

/// The name of the scene's apparatus. Reading it gives the scene that apparatus.
Key apparatus_key() {
  Key key = plain_key("kind", "", "what is simulated", "one of " + joined(apparatus_names()));
  key.read = [](const Value& value, Draft& draft) {
    const auto* name = std::get_if<std::string>(&value.content);
    const Apparatus* known = name ? apparatus_named(*name) : nullptr;
    if (known) draft.take(*known);
    return Complaint{known ? "" : unknown_choice(value, apparatus_names()), value.where};
  };
  key.write = [](Draft& draft) { return nlohmann::ordered_json(name_of(draft.scene.geometry.apparatus)); };
  return key;
}

std::vector<Key> general_keys() {
  return {
      text("title", AT(draft.scene.title), "what every report calls the scene").needed(),
      apparatus_key().needed(),
      text("extends", AT(draft.extends),
           "another scene, by name or by path, from which every key not given here is taken")
          .otherwise("none"),
      models("runs.mpm", AT(draft.scene.runs.mpm),
             "models that `flowrest run` computes with the material point solver")
          .otherwise("material.model where no run is named"),
      models("runs.foam", AT(draft.scene.runs.foam), "models that `flowrest run` computes with OpenFOAM")
          .otherwise("none"),
      boolean("runs.exact", AT(draft.scene.runs.exact),
              "whether `flowrest run` adds the exact or asymptotic solution"),
      boolean("runs.elements", AT(draft.scene.runs.elements),
              "whether `flowrest run` adds a slump computed by finite elements, as a referee"),
      text(
          "runs.from", AT(draft.scene.runs.from),
          "the state that `flowrest run` starts them from, RUN@SECONDS or exact/second-order; RUN is a folder, "
          "named from here or in the folder that receives SCENE/RUN")
          .otherwise("they start with the scene's body"),
  };
}

/// "of a slump; of a duct": what every apparatus says of its dimensions.
std::string dimensions_of_all() {
  std::string text;
  for_each_apparatus(
      [&](const auto& a) { text += (text.empty() ? "" : "; ") + std::string(a.dimensions_meaning); });
  return text;
}

/// "axisymmetric (slump), half (l-box)": which apparatus share a choice, by its words, each in the order of
/// the list.
template <class Words>
std::string shared_by(const std::vector<std::string>& in_order, Words words) {
  std::string text;
  for (const std::string& choice : in_order) {
    std::vector<std::string> names;
    for_each_apparatus([&](const auto& a) {
      if (words(a) == choice) names.emplace_back(a.name);
    });
    if (!names.empty()) text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", choice, joined(names));
  }
  return text;
}

std::vector<Key> geometry_keys() {
  return {
      choice("geometry.dimension", AT(draft.scene.geometry.dimension),
             "what is computed of the body: " + dimensions_of_all())
          .otherwise(shared_by({"axisymmetric", "half", "quarter", "plane", "full"},
                               [](const auto& a) { return to_string(a.usual_dimension); })),
  };
}

std::vector<Key> material_keys() {
  return {
      choice("material.model", AT(draft.scene.material.model),
             "what `flowrest mpm` and `flowrest foam` compute unless --model says otherwise"),
      number("material.density", "kg/m3", above(0.0, 1e6), AT(draft.scene.material.density),
             "density at rest and without pressure")
          .needed(),
      number("material.yield_stress", "Pa", from(0.0, largest_stress), AT(draft.scene.material.yield_stress),
             "yield stress tau0")
          .otherwise("needed by every model but newtonian"),
      number(
          "material.plastic_viscosity", "Pa s", from(0.0, largest_stress),
          AT(draft.scene.material.plastic_viscosity),
          "plastic viscosity eta; where flow_index is not 1 the consistency K in Pa s^n, the stress that the "
          "flow adds to the yield stress at 1 1/s")
          .needed(),
      number(
          "material.flow_index", "", {0.3, 1.5}, AT(draft.scene.material.flow_index),
          "flow index n of elasto-viscoplastic and herschel-bulkley, the power of the shear rate: below 1 concrete thins as it is "
          "sheared faster, above 1 it thickens; other models have 1"),
      number("material.youngs_modulus", "Pa", above(0.0, largest_stress),
             AT(draft.scene.material.youngs_modulus), "Young's modulus E")
          .otherwise("needed unless bulk_modulus is given")
          .replaces("material.bulk_modulus"),
      number("material.bulk_modulus", "Pa", above(0.0, largest_stress), AT(draft.bulk_modulus),
             "bulk modulus K at rest, in place of youngs_modulus")
          .otherwise("from youngs_modulus")
          .replaces("material.youngs_modulus"),
      number("material.poisson_ratio", "", between(0.0, 0.5), AT(draft.scene.material.poisson_ratio),
             "Poisson ratio nu")
          .needed(),
      number("material.equation_of_state_exponent", "", above(0.0, 100.0),
             AT(draft.scene.material.equation_of_state_exponent),
             "exponent gamma of the equation of state (Yu et al. 2026, Eq. 6)"),
      number("material.regularisation_time", "s", above(0.0, largest_time),
             AT(draft.scene.material.regularisation_time),
             "regularisation time m of papanastasiou and herschel-bulkley")
          .otherwise("needed by papanastasiou and herschel-bulkley"),
      number("material.critical_shear_rate", "1/s", above(0.0, largest_time),
             AT(draft.scene.material.critical_shear_rate), "shear rate at which bi-viscous yields")
          .otherwise("1 / regularisation_time; needed by bi-viscous"),
  };
}

std::vector<Key> thixotropy_keys() {
  return {
      number("thixotropy.flocculation_rate", "Pa/s", from(0.0, 1e9),
             AT(draft.scene.thixotropy->flocculation_rate),
             "flocculation rate A_thix (Yu et al. 2026, Eq. 12)")
          .needed(),
      number("thixotropy.deflocculation_coefficient", "", from(0.0, 1e9),
             AT(draft.scene.thixotropy->deflocculation_coefficient),
             "deflocculation coefficient alpha (Yu et al. 2026, Eq. 12)")
          .needed(),
      number("thixotropy.initial_flocculation", "", from(0.0, 1e9),
             AT(draft.scene.thixotropy->initial_flocculation),
             "flocculation lambda at the start (Yu et al. 2026, Eq. 11)")
          .needed(),
      number("thixotropy.breakdown_exponent", "", above(0.0, 4.0),
             AT(draft.scene.thixotropy->breakdown_exponent),
             "power of the shear rate in 1/s by which flow breaks flocs down; 1 is that of Eq. 12"),
      number(
          "thixotropy.ageing_rate", "Pa/s", from(0.0, 1e9), AT(draft.scene.thixotropy->ageing_rate),
          "growth of the yield stress with age that flow does not take back, at age 0 (Perrot et al. 2016)"),
      number("thixotropy.ageing_time", "s", above(0.0, largest_time), AT(draft.scene.thixotropy->ageing_time),
             "time t_c of its exponential growth, ageing_rate t_c (exp(age / t_c) - 1)")
          .otherwise("infinite: it grows linearly"),
      number("thixotropy.initial_age", "s", from(0.0, largest_time), AT(draft.scene.thixotropy->initial_age),
             "age of the concrete at the start, counted from mixing"),
  };
}

std::vector<Key> wall_and_force_keys() {
  return {
      wall("walls.base", AT(draft.scene.base),
           "how the plate, the plates of a duct or the whole container hold the material"),
      number("forces.gravity", "m/s2", from(0.0, 1e5), AT(draft.scene.forces.gravity), "gravity, downwards")
          .otherwise(fmt::format("{:g}", standard_gravity))
          .only_with(places_of([](const auto& a) { return a.under_gravity; })),
  };
}

std::vector<Key> time_keys() {
  return {
      number("time.end", "s", above(0.0, largest_time), AT(draft.scene.time.end),
             "simulated time at which a run ends")
          .needed(),
      boolean("time.stop_at_rest", AT(draft.scene.time.stop_at_rest),
              "whether an elasto-viscoplastic run ends as soon as it is at rest (a fluid never is)")
          .otherwise(shared_by({"true", "false"}, [](const auto& a) { return a.rests ? "true" : "false"; })),
      number("time.rest_bound", "", above(0.0, 1.0), AT(draft.scene.time.rest_bound),
             "at rest: where the relative growth of the spread still to come is bounded by this"),
  };
}

std::vector<Key> output_keys() {
  return {
      number("output.history_interval", "s", above(0.0, largest_time),
             AT(draft.scene.output.history_interval), "simulated time between rows of history.csv"),
      number("output.profile_interval", "s", above(0.0, largest_time),
             AT(draft.scene.output.profile_interval), "simulated time between profiles"),
      number("output.snapshot_interval", "s", above(0.0, largest_time),
             AT(draft.scene.output.snapshot_interval), "simulated time between snapshots"),
      number("output.checkpoint_interval", "s", above(0.0, largest_time),
             AT(draft.scene.output.checkpoint_interval), "simulated time between checkpoints"),
  };
}

std::vector<Key> gauge_keys() {
  const auto judged_by = [](MainGauge gauge) {
    return places_of([gauge](const auto& a) { return a.main_gauge == gauge; });
  };
  const auto growing = places_of(
      [](const auto& a) { return a.main_gauge == MainGauge::spread || a.main_gauge == MainGauge::front; });
  const auto length = [&](const char* name, Access<double> at, const char* meaning, const char* fallback,
                          MainGauge gauge) {
    return number(std::string("gauges.") + name, "m", above(0.0, largest_length), at, meaning)
        .otherwise(fallback)
        .only_with(judged_by(gauge));
  };
  return {
      length("spread_depth", AT(draft.scene.gauges.spread_depth),
             "depth at which the spread is read; spread_1p5_mm and spread_6_mm at half and at twice of it",
             "cone_height / 100: 0.003 of an Abrams cone", MainGauge::spread),
      length("front_depth", AT(draft.scene.gauges.front_depth), "depth at which the front is read",
             "height of the body / 200: 0.003 of 0.6", MainGauge::front),
      length("end_length", AT(draft.scene.gauges.end_length),
             "length at either end over which the depth there is averaged",
             "height of the body / 30: 0.02 of 0.6", MainGauge::front),
      length("light_depth", AT(draft.scene.gauges.light_depth),
             "material on a line of sight that still hides the light",
             "height of the funnel / 200: 0.003 of 0.6", MainGauge::discharge),
      number("gauges.rest_rate", "m/s", above(0.0, 1e3), AT(draft.scene.gauges.rest_rate),
             "growth of spread or front that reports take for rest, as is customary")
          .otherwise("5e-4 of the standard apparatus, with the root of height times gravity")
          .only_with(growing),
      number("gauges.still_speed", "m/s", above(0.0, 1e3), AT(draft.scene.gauges.still_speed),
             "growth below which reports say of a law that can rest that it has come to rest")
          .otherwise("1e-4 of the standard apparatus, with the root of height times gravity")
          .only_with(growing),
      number("gauges.rest_shear_rate", "1/s", above(0.0, largest_time),
             AT(draft.scene.gauges.rest_shear_rate),
             "99th percentile of the shear rate that reports take for rest, as is customary")
          .otherwise("0.05 of the standard apparatus, with the root of gravity over height; 0.05 of a duct"),
      number("gauges.rate_window", "s", above(0.0, largest_time), AT(draft.scene.gauges.rate_window),
             "time over which reports take growth")
          .otherwise("2 of the standard apparatus, with the root of height over gravity; 2 of a duct"),
  };
}

std::vector<Key> mpm_keys() {
  return {
      choice("mpm.scheme", AT(draft.scene.mpm.scheme), "transfer between particles and grid"),
      number("mpm.cell", "m", above(0.0, largest_length), AT(draft.scene.mpm.cell), "edge of a grid cell")
          .needed(),
      particles("mpm.particles_per_cell",
                "particles in a full cell: one entry for each axis, or a square or a cube whose root is "
                "taken along "
                "each axis, so that 9 keeps its spacing, as [3, 3, 3], when the scene is run in 3D")
          .otherwise("3 along each axis"),
      number("mpm.cfl", "", above(0.0, 100.0), AT(draft.scene.mpm.cfl),
             "Courant number of the acoustic step"),
      number("mpm.time_step", "s", above(0.0, largest_time), AT(draft.scene.mpm.time_step),
             "a fixed step in place of cfl")
          .otherwise("from cfl; 5e-4 for the scheme paper"),
      boolean("mpm.allow_unstable_step", AT(draft.scene.mpm.allow_unstable_step),
              "lets time_step and cfl pass the stable limit"),
      choice("mpm.precision", AT(draft.scene.mpm.precision), "floating-point numbers of the solver"),
      integer("mpm.threads", 0, 4096, AT(draft.scene.mpm.threads),
              "threads; 0 takes as many as the particles can feed, of the cores that are ours (affinity, "
              "limits of control groups, OMP_NUM_THREADS)"),
      choice(
          "mpm.seeding", AT(draft.scene.mpm.seeding),
          "where particles start: on a lattice, at a random place in each of its sites, or at the centroids "
          "of an unstructured mesh by the program gmsh"),
      integer("mpm.seed", 0, std::numeric_limits<std::int64_t>::max(), AT(draft.scene.mpm.seed),
              "seed of the jitter"),
      choice("mpm.fluid_update", AT(draft.scene.mpm.fluid_update),
             "how a fluid's stress is integrated: implicit has no viscous step limit"),
      choice(
          "mpm.b_bar", AT(draft.scene.mpm.b_bar),
          "how volumetric strain and pressure are averaged: through the nodes by the functions' own weights, "
          "or over a cell's particles")
          .otherwise("smooth; ducts and linear-flip cell-average; neither with paper"),
      number("mpm.flip_relaxation_time", "s", above(0.0, largest_time),
             AT(draft.scene.mpm.flip_relaxation_time),
             "time over which linear-flip forgets a particle's own velocity"),
      number("mpm.apic_relaxation_time", "s", above(0.0, largest_time),
             AT(draft.scene.mpm.apic_relaxation_time),
             "time over which the transfer of quadratic-apic smooths velocities once, whatever the step")
          .otherwise(
              "that of a step of CFL 0.75, which is plain APIC; beside walls that do not lie along the "
              "grid 0.02"),
      number("mpm.density_correction", "", from(0.0, 100.0), AT(draft.scene.mpm.density_correction),
             "share of the volume by which particles overlap, or leave a gap at a floor that holds, that is "
             "taken "
             "back per unit of shear strain; 0 lets material that is sheared for long sink into itself and "
             "fronts roll over gaps")
          .otherwise("1; linear-flip 0.3; ducts and funnels 0; always 0 with paper"),
  };
}

std::vector<Key> foam_keys() {
  return {
      number("foam.cell", "m", above(0.0, largest_length), AT(draft.scene.foam.cell), "edge of a mesh cell")
          .otherwise("mpm.cell"),
      number("foam.max_courant", "", above(0.0, 10.0), AT(draft.scene.foam.max_courant),
             "bound on the Courant number of flow and interface"),
      number("foam.max_time_step", "s", above(0.0, largest_time), AT(draft.scene.foam.max_time_step),
             "bound on the step")
          .otherwise("cell^2 density / plastic_viscosity; elasto-viscoplastic: 1.5 cells at the speed of "
                     "shear waves"),
      number("foam.step_growth", "", from(1.0, 1e3), AT(draft.scene.foam.step_growth),
             "factor by which a slump's step may outgrow its bound, as a part of the time passed (plug-in, "
             "without "
             "foam.max_time_step); 1: never"),
      number("foam.air_density", "kg/m3", above(0.0, 1e6), AT(draft.scene.foam.air_density),
             "density of the air"),
      number("foam.air_kinematic_viscosity", "m2/s", above(0.0, 1e6),
             AT(draft.scene.foam.air_kinematic_viscosity),
             "kinematic viscosity of the air; large, to tame its jets"),
      number("foam.wedge_angle", "degrees", above(0.0, 10.0), AT(draft.scene.foam.wedge_angle),
             "angle of the whole wedge of an axisymmetric case"),
      integer(
          "foam.base_rows", 0, 64, AT(draft.scene.foam.base_rows),
          "rows of cells into which the lowest row of a slump's mesh is cut; 0: 4 with the plug-in, else 1"),
      number("foam.base_height", "m", above(0.0, largest_length), AT(draft.scene.foam.base_height),
             "height up to which a slump's rows are cut like the lowest")
          .otherwise("the deposit's depth with the plug-in about an axis, else foam.cell"),
      number("foam.air_rise_time", "s", from(0.0, largest_time), AT(draft.scene.foam.air_rise_time),
             "time in which air that a slump has rolled over rises through it (plug-in); 0: it stays")
          .otherwise("0.1 with the plug-in, else 0"),
      integer("foam.outer_correctors", 1, 50, AT(draft.scene.foam.outer_correctors),
              "how often a step is computed, each time with the viscosity, flux and front that it has found"),
      choice("foam.laws", AT(draft.scene.foam.laws),
             "whose laws a run takes: those of the rheology plug-in, OpenFOAM's own, or the best there are"),
      choice("foam.mixing", AT(draft.scene.foam.mixing),
             "how the stresses of concrete and air mix in a cell (plug-in)"),
      number("foam.full_at", "", from(1e-6, 1.0), AT(draft.scene.foam.full_at),
             "fraction of concrete from which its stress counts in full, of the mixing `saturating`"),
      choice("foam.wetting", AT(draft.scene.foam.wetting),
             "how much of a wall holds the concrete of a cell it does not fill (plug-in)"),
      choice("foam.face_weight", AT(draft.scene.foam.face_weight),
             "how the parts that concrete has in two cells make that of the face between them "
             "(elasto-viscoplastic, plug-in)"),
      choice("foam.strain_rate", AT(draft.scene.foam.strain_rate),
             "whose shear rate the law takes in cells with air (plug-in)"),
  };
}

#undef AT

/// Adds a key; one of the same path that another apparatus has already is one key for both.
void add_key(std::vector<Key>& all, Key key) {
  const auto same =
      std::find_if(all.begin(), all.end(), [&](const Key& known) { return known.path() == key.path(); });
  if (same == all.end()) {
    all.push_back(std::move(key));
    return;
  }
  same->read = [first = *same, second = key](const Value& value, Draft& draft) {
    return (second.suits(draft.scene.geometry.apparatus) ? second : first).read(value, draft);
  };
  same->write = [first = *same, second = key](Draft& draft) {
    return (second.suits(draft.scene.geometry.apparatus) ? second : first).write(draft);
  };
  same->only.insert(same->only.end(), key.only.begin(), key.only.end());
}

std::vector<Key> every_key() {
  std::vector<Key> all;
  for (auto group : {general_keys, geometry_keys, material_keys, thixotropy_keys, wall_and_force_keys,
                     time_keys, output_keys, gauge_keys, mpm_keys, foam_keys}) {
    for (Key& key : group()) all.push_back(std::move(key));
  }
  for_each_apparatus([&](const auto& a) {
    using A = std::remove_cvref_t<decltype(a)>;
    for (Key& key : A::keys()) add_key(all, std::move(key).only_with({index_of_apparatus<A>()}));
  });
  const auto place = [](const Key& key) {
    return std::find_if(sections().begin(), sections().end(),
                        [&](const Section& section) { return section.name == key.section; }) -
           sections().begin();
  };
  std::stable_sort(all.begin(), all.end(), [&](const Key& a, const Key& b) { return place(a) < place(b); });
  return all;
}

}  // namespace

void Draft::take(const Apparatus& apparatus) {
  scene.geometry.apparatus = apparatus;
  std::visit(
      [&](const auto& a) {
        scene.geometry.dimension = a.usual_dimension;
        if (a.under_gravity) scene.forces.gravity = standard_gravity;
        scene.time.stop_at_rest = a.rests;
      },
      apparatus);
}

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"", "Above all sections"},
      {"runs", "What `flowrest run` makes of the scene"},
      {"geometry", "Shape and size"},
      {"process", "How a strand is printed; only in scenes that print"},
      {"material", "The material and its model"},
      {"thixotropy", "Structural build-up and breakdown; only in scenes that have it"},
      {"walls", "Contact with walls"},
      {"forces", "What drives the flow"},
      {"time", "When a run ends"},
      {"output", "Simulated time between outputs"},
      {"gauges", "What gauges are defined by, in both solvers and in reports; scales with the body"},
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

std::vector<std::string> key_names(const std::string& section, const Apparatus* apparatus) {
  std::vector<std::string> names;
  for (const Key& key : keys()) {
    if (key.section == section && (!apparatus || key.suits(*apparatus))) names.push_back(key.name);
  }
  return names;
}

}  // namespace flowrest::scenes
