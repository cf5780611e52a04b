#include "scenes/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/case.h"
#include "scenes/names.h"
#include "scenes/step_limits.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

/// Past these a run would fit no machine, or no lifetime.
constexpr double most_particles = 2e9;
constexpr double most_particle_steps = 1e18;
constexpr double most_outputs = 1e8;

/// Largest speed of a fall over that of sound. The material points are weakly compressible: at 1.0 a slump
/// lands soundly, pressed to 0.88 of its volume; from 1.1 on it is crushed and rebounds with energy that it
/// never had, however short the step (docs/measured/2026-11-28-limits-of-material-points.md).
constexpr double largest_fall_over_sound = 1.0;

/// Every model the scene may be run with.
std::vector<Model> models_in_use(const Scene& scene) {
  std::vector<Model> models = {scene.material.model};
  for (const auto& list : {scene.runs.mpm, scene.runs.foam}) {
    for (const Model model : list) {
      if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
    }
  }
  return models;
}

void check_dimension(const Case& c) {
  const Dimension dimension = c.scene().geometry.dimension;
  if (!c.usable({"geometry.dimension"})) return;
  const Apparatus& apparatus = c.scene().geometry.apparatus;
  const std::vector<Dimension> allowed = std::visit([](const auto& a) { return a.dimensions(); }, apparatus);
  if (std::find(allowed.begin(), allowed.end(), dimension) != allowed.end()) return;
  std::vector<std::string> names;
  for (const Dimension one : allowed) names.push_back(to_string(one));
  c.fault("geometry.dimension", fmt::format("geometry.dimension is {}, which does not suit a {}; allowed: {}",
                                            to_string(dimension), name_of(apparatus), joined(names)));
}

/// Faults of what a model needs and the scene does not give.
void check_models(const Case& c) {
  if (!c.usable({"material.model", "runs.mpm", "runs.foam"})) return;
  std::vector<laws::Parameter> known;
  for (const Model model : models_in_use(c.scene()))
    for (const laws::Parameter parameter : laws::every_parameter) {
      const std::string path = fmt::format("material.{}", laws::key_of(parameter));
      if (!laws::needs(model, parameter) || laws::has_default(parameter) || !c.usable({path}) ||
          c.given.gives(path))
        continue;
      if (std::find(known.begin(), known.end(), parameter) != known.end()) continue;  // once is enough
      known.push_back(parameter);
      std::string instead;
      if (parameter == laws::Parameter::critical_shear_rate) {
        if (c.given.gives("material.regularisation_time")) continue;
        instead = ": critical_shear_rate or regularisation_time, of which it is the inverse";
      }
      c.fault(path, fmt::format("{} is missing; needed by the model {}{}", path, to_string(model), instead));
    }
}

/// A power of the shear rate that a model would pass over in silence is refused.
void check_flow_index(const Case& c) {
  const double index = c.scene().material.flow_index;
  if (!c.usable({"material.flow_index", "material.model", "runs.mpm", "runs.foam"}) || index == 1.0) return;
  std::vector<std::string> able;
  for (const Model model : laws::every_law)
    if (laws::needs(model, laws::Parameter::flow_index)) able.push_back(to_string(model));
  for (const Model model : models_in_use(c.scene())) {
    if (laws::needs(model, laws::Parameter::flow_index)) continue;
    c.fault("material.flow_index",
            fmt::format("material.flow_index is {:g}, which the model {} does not have; allowed: 1, or only "
                        "{} as material.model and in runs",
                        index, to_string(model), joined(able)));
    return;
  }
}

void check_foam_runs(const Case& c) {
  const std::vector<Model>& models = c.scene().runs.foam;
  if (!c.usable({"runs.foam"}) || models.empty()) return;
  const bool fluids = !std::all_of(models.begin(), models.end(), laws::can_rest);
  if (fluids && c.usable({"material.plastic_viscosity", "foam.max_time_step"}) &&
      c.scene().material.plastic_viscosity == 0.0 && !c.scene().foam.max_time_step) {
    c.fault("material.plastic_viscosity",
            "material.plastic_viscosity is 0, on which the step of a fluid in OpenFOAM depends; allowed: "
            "greater than 0 "
            "or foam.max_time_step where runs.foam names a fluid");
  }
}

void check_thixotropy(const Case& c) {
  if (!c.scene().thixotropy || !c.usable({"material.yield_stress"})) return;
  if (c.scene().material.yield_stress == 0.0) {
    c.fault(
        "material.yield_stress",
        "the yield stress is 0, but flocculation grows at flocculation_rate / yield_stress; allowed: a yield "
        "stress greater than 0 in scenes with [thixotropy]");
  }
}

/// An age without a rate would be passed over in silence; and growth is exponential.
void check_ageing(const Case& c) {
  if (!c.scene().thixotropy) return;
  for (const char* path : {"thixotropy.ageing_time", "thixotropy.initial_age"})
    if (c.usable({path, "thixotropy.ageing_rate"}) && c.given.gives(path) &&
        !c.given.gives("thixotropy.ageing_rate"))
      c.fault(path,
              fmt::format("{} is given without thixotropy.ageing_rate, of which it says how it goes on; "
                          "allowed: both, or neither",
                          path));
  if (!c.usable({"thixotropy.ageing_rate", "thixotropy.ageing_time", "thixotropy.initial_age", "time.end"}))
    return;
  constexpr double most = 1e9;  // Pa, of set concrete
  const Thixotropy& thixotropy = *c.scene().thixotropy;
  const double grown = thixotropy.ageing().grown(c.scene().time.end);
  if (grown <= most) return;
  c.fault(
      thixotropy.ageing_time ? "thixotropy.ageing_time" : "thixotropy.ageing_rate",
      fmt::format("the yield stress grows with age by {:.3g} Pa until time.end; allowed: at most {:g} Pa, "
                  "with a smaller thixotropy.ageing_rate or initial_age, or a longer ageing_time",
                  grown, most));
}

bool step_is_known(const Case& c) {
  for (const Key& key : keys())
    if (key.section == "geometry" && key.suits(c.scene().geometry.apparatus) && !c.usable({key.path()}))
      return false;
  return c.usable({"material.model",
                   "material.density",
                   "forces.gravity",
                   "material.youngs_modulus",
                   "material.bulk_modulus",
                   "material.poisson_ratio",
                   "material.equation_of_state_exponent",
                   "material.yield_stress",
                   "material.plastic_viscosity",
                   "material.flow_index",
                   "material.regularisation_time",
                   "material.critical_shear_rate",
                   "thixotropy.flocculation_rate",
                   "thixotropy.initial_flocculation",
                   "thixotropy.ageing_rate",
                   "thixotropy.ageing_time",
                   "thixotropy.initial_age",
                   "mpm.cell",
                   "mpm.particles_per_cell",
                   "mpm.cfl",
                   "mpm.time_step",
                   "mpm.scheme",
                   "mpm.fluid_update",
                   "time.end"});
}

/// Of no concern to OpenFOAM, whose concrete does not give way at all.
void check_fall(const Case& c) {
  if (!c.usable({"runs.mpm"}) || c.scene().runs.mpm.empty()) return;
  const double fall = free_fall_speed(c.scene()), sound = c.scene().material.longitudinal_speed();
  if (fall <= largest_fall_over_sound * sound) return;
  const double stiffer = std::pow(fall / (largest_fall_over_sound * sound), 2);
  c.fault(
      c.given.gives("material.bulk_modulus") ? "material.bulk_modulus" : "material.youngs_modulus",
      fmt::format(
          "the material is so soft that a fall from its own height ends at {:.3g} m/s, faster than sound in "
          "it ({:.3g} m/s): it would be crushed; allowed: moduli at least {:.3g} times as large, or less "
          "gravity",
          fall, sound, stiffer));
}

void check_acoustic_step(const Case& c) {
  const StepLimits limits = step_limits(c.scene());
  const Mpm& mpm = c.scene().mpm;
  const double limit = limits.largest_cfl * limits.acoustic;
  if (mpm.time_step && *mpm.time_step > limit) {
    const bool given = c.given.gives("mpm.time_step");
    c.fault(
        given ? "mpm.time_step" : "mpm.scheme",
        fmt::format(
            "{} of {:g} s is past the acoustic limit of {:g} s ({:g} cell / c, with cell = {:g} m and c = "
            "{:g} m/s under the material's own weight); allowed: at most {:g}, a coarser mpm.cell, or "
            "mpm.allow_unstable_step = true",
            given ? "mpm.time_step" : "the time step of the scheme paper", *mpm.time_step, limit,
            limits.largest_cfl, mpm.cell, mpm.cell / limits.acoustic, limit));
  } else if (!mpm.time_step && mpm.cfl > limits.largest_cfl) {
    c.fault("mpm.cfl",
            fmt::format("mpm.cfl is {:g}, past the acoustic limit of {:g} at a Poisson ratio of {:g}; "
                        "allowed: at most {:g}, or mpm.allow_unstable_step = true",
                        mpm.cfl, limits.largest_cfl, c.scene().material.poisson_ratio, limits.largest_cfl));
  }
}

/// A step that follows from cfl obeys the viscous limit by itself; a fixed one must be held to it, since past
/// it nothing blows up: the capped stress chatters silently.
void check_viscous_step(const Case& c) {
  const Mpm& mpm = c.scene().mpm;
  if (!mpm.time_step) return;
  std::vector<Model> models = c.scene().runs.mpm;
  if (std::find(models.begin(), models.end(), c.scene().material.model) == models.end()) {
    models.push_back(c.scene().material.model);
  }
  Scene scene = c.scene();
  for (const Model model : models) {
    scene.material.model = model;
    const double limit = step_limits(scene).viscous;
    if (*mpm.time_step <= limit) continue;
    c.fault(
        c.given.gives("mpm.time_step") ? "mpm.time_step" : "mpm.scheme",
        fmt::format(
            "the time step of {:g} s is past the viscous limit of {:g} s of an explicit {} fluid (density "
            "cell^2 / (6 eta_max)); allowed: at most {:g}, mpm.fluid_update = \"implicit\", or "
            "mpm.allow_unstable_step = true",
            *mpm.time_step, limit, to_string(model), limit));
  }
}

void check_b_bar(const Case& c) {
  const Mpm& mpm = c.scene().mpm;
  if (!c.usable({"mpm.scheme", "mpm.b_bar"}) || !mpm.b_bar || mpm.scheme == Scheme::quadratic_apic) return;
  const bool paper = mpm.scheme == Scheme::paper;
  if (!paper && *mpm.b_bar == BBar::cell_average) return;
  c.fault("mpm.b_bar",
          fmt::format("mpm.b_bar is {}, with the scheme {}; allowed: {}, or the scheme "
                      "quadratic-apic",
                      to_string(*mpm.b_bar), to_string(mpm.scheme),
                      paper ? "none, for it takes the strain at the cell's centre" : "cell-average"));
}

void check_size(const Case& c) {
  const MpmEstimate estimate = estimate_mpm(c.scene());
  if (!(estimate.particles <= most_particles)) {
    c.fault("mpm.cell",
            fmt::format("mpm.cell is {:g} m: the scene would have {:.3g} particles; allowed: at most {:g}",
                        c.scene().mpm.cell, estimate.particles, most_particles));
  } else if (!(estimate.particles * estimate.steps <= most_particle_steps)) {
    c.fault("time.end",
            fmt::format("the run would take {:.3g} steps of {:.3g} particles; allowed: at most {:g} "
                        "particle-steps",
                        estimate.steps, estimate.particles, most_particle_steps));
  }
}

void check_outputs(const Case& c) {
  const Output& output = c.scene().output;
  const std::pair<std::string, double> intervals[] = {
      {"output.history_interval", output.history_interval},
      {"output.profile_interval", output.profile_interval},
      {"output.snapshot_interval", output.snapshot_interval},
      {"output.checkpoint_interval", output.checkpoint_interval}};
  for (const auto& [path, interval] : intervals) {
    if (!c.usable({path, "time.end"}) || c.scene().time.end / interval <= most_outputs) continue;
    c.fault(path, fmt::format("{} is {:g} s: there would be {:.3g} outputs; allowed: at most {:g}", path,
                              interval, c.scene().time.end / interval, most_outputs));
  }
}

}  // namespace

void check(const Given& given, const Draft& draft, Faults& faults) {
  const Case c{given, draft, faults};
  check_dimension(c);
  std::visit([&](const auto& a) { a.check(c); }, draft.scene.geometry.apparatus);
  check_models(c);
  check_flow_index(c);
  check_foam_runs(c);
  check_thixotropy(c);
  check_ageing(c);
  check_b_bar(c);
  check_outputs(c);
  std::visit([&](const auto& a) { a.check_gauges(c); }, draft.scene.geometry.apparatus);
  if (!step_is_known(c)) return;
  check_fall(c);
  check_size(c);
  if (draft.scene.mpm.allow_unstable_step) return;
  check_acoustic_step(c);
  check_viscous_step(c);
}

}  // namespace flowrest::scenes
