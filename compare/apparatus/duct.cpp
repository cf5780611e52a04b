#include "compare/apparatus/duct.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/exact/duct.h"
#include "compare/exact/solution_run.h"
#include "compare/findings.h"
#include "compare/measures/run_measures.h"
#include "compare/run_view.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;
using Topic = Finding::Topic;
using exact::Bingham;
using exact::DuctFlow;
using exact::ExactRun;
using exact::refuse;
using scenes::Scene;
using words::listed;

namespace {

std::string duct_sentence(const RunView& view) {
  const Measures& m = view.measures;
  const std::string doubt = doubt_in_brackets(view);
  const std::string largest =
      words::velocity(*std::max_element(view.gauge.value.begin(), view.gauge.value.end()));
  if (m.stop_after_step && m.cause != Cause::creep)
    return fmt::format("{} reaches {} and stops {} after the last change of force{}.", view.label, largest,
                       words::time(*m.stop_after_step), doubt);
  if (!m.residual) return fmt::format("{} reaches {}{}.", view.label, largest, doubt);
  return fmt::format("{} reaches {} and still moves at {}{}.", view.label, largest,
                     words::velocity(*m.residual), doubt);
}

class DuctReport : public ApparatusReport {
 public:
  DuctReport() : ApparatusReport(scenes::Duct{}) {}

  const Gauge& gauge() const override {
    static const Gauge gauge = {
        "plug velocity",
        "velocity",
        "plug_velocity_m_s",
        "m/s",
        1.0,
        1.0,
        "faster",
        "slower",
        "Velocity of the plug. The exact line is the steady state of each stage of the "
        "force."};
    return gauge;
  }
  const std::vector<Gauge>& further_gauges() const override {
    static const std::vector<Gauge> all = {flocculation()};
    return all;
  }
  const std::vector<Reading>& readings() const override {
    static const std::vector<Reading> all = {reading_named("plug_velocity_m_s"), reading_named("rest_s")};
    return all;
  }

  std::optional<double> predicted_creep(const RunView& view,
                                        const exact::RegularisedFluid& fluid) const override {
    const auto height = setting(view, "/geometry/height");
    const auto stages = body_forces(view);
    if (!height || stages.empty() || stages.back().second * *height > 2.0 * fluid.parameters.yield_stress)
      return std::nullopt;
    return exact::duct_creep(fluid, *height, stages.back().second);
  }

  std::string opening(const Comparison&, const RunView* arrested) const override {
    if (!arrested || !arrested->measures.stop_after_step) return "";
    return fmt::format("{} stops {} after the last change of force", arrested->label,
                       words::time(*arrested->measures.stop_after_step));
  }
  void describe(Comparison& comparison) const override {
    for (const RunView& view : comparison.runs)
      if (!view.exact && !view.gauge.empty()) tell(comparison, Topic::stop, duct_sentence(view));
    for (const RunView& view : comparison.runs)
      if (view.measures.stopping_bound)
        tell(comparison, Topic::stop,
             fmt::format("The exact material stops within {} of the last change of force.",
                         words::time(*view.measures.stopping_bound)));
    std::vector<std::string> errors;
    for (const Pair& pair : comparison.pairs) {
      if (pair.kind != "exact") continue;
      // Where the exact material is at rest there is nothing to be relative to.
      const auto steady = std::find_if(pair.at.begin(), pair.at.end(),
                                       [](const Pair::At& at) { return at.error.l2_relative > 0.0; });
      if (steady != pair.at.end())
        errors.push_back(fmt::format("{} by {} at {}", comparison.runs[pair.run].label,
                                     words::percent(steady->error.l2_relative), words::time(steady->time)));
    }
    if (!errors.empty())
      tell(comparison, Topic::apart,
           fmt::format("In L2 the profiles differ from the exact steady one: {}.", listed(errors)));
    tell(comparison, Topic::apart, split_sentence(comparison));
    tell(comparison, Topic::cause, square_sentence(comparison));
    tell(comparison, Topic::cause, cause_sentence(comparison));
    comparison.fair =
        "The steady profiles are exact, and any run may be held against them. How a flow stops has no closed "
        "form, but a bound "
        "that no exact material can pass. Under a force below yield a regularised fluid creeps for ever at a "
        "speed that its "
        "law alone fixes: compare it with that speed, and only what is beyond it with the solver. Codes "
        "agree on velocity "
        "profiles long before they agree on arrest: judge by both.";
  }

  std::string measures_caption(const Comparison& comparison) const override {
    const Thresholds& o = comparison.thresholds;
    return fmt::format(
        "A duct has stopped once its plug stays below {:g} % of its largest velocity. A dash: not measured, "
        "or never.",
        100.0 * o.rest_velocity_fraction);
  }
  std::vector<RunColumn> measure_columns(const Comparison&) const override {
    std::vector<RunColumn> columns;
    columns = {
        measure_column("Plug velocity at the end", "m/s", significant(4), &Measures::gauge_end),
        measure_column("Stops after the last change of force", "s", fixed(2), &Measures::stop_after_step),
        measure_column("Exact bound", "s", fixed(2), &Measures::stopping_bound),
        measure_column("Rest by shear rate", "s", fixed(2), &Measures::rest_by_shear_rate)};
    return columns;
  }
  std::string residual_caption(const Comparison&) const override {
    return "Predicted: the steady velocity of the regularised law under the last force, from its flow curve.";
  }
  Json measures_json(const Measures& m) const override {
    Json json;
    json["plug_velocity_end_m_s"] = scaled(m.gauge_end);
    json["stop_after_step_s"] = scaled(m.stop_after_step);
    json["stopping_time_bound_s"] = scaled(m.stopping_bound);
    json["rest_by_shear_rate_s"] = scaled(m.rest_by_shear_rate);
    json["residual_m_s"] = scaled(m.residual);
    json["residual_scatter_m_s"] = scaled(m.residual_scatter);
    json["predicted_creep_m_s"] = scaled(m.predicted_creep);
    json["arbitrary_stop_lowest_m_s"] = scaled(m.stop_lowest);
    json["arbitrary_stop_highest_m_s"] = scaled(m.stop_highest);
    return json;
  }

  std::vector<ExactRun> write_exact_runs(const Scene& scene, const std::filesystem::path& directory,
                                         std::optional<double> flocculation,
                                         runs::Replace replace) const override {
    const Bingham material = exact::material_of(scene, flocculation);
    const double height = scene.duct().height;
    if (scene.base.law != scenes::Wall::no_slip)
      refuse(scene, "the steady profile holds between plates without slip");
    if (!(material.plastic_viscosity > 0.0))
      refuse(scene, "without a plastic viscosity the flow has no steady state");
    if (scene.forces.body_force.empty()) refuse(scene, "no body force drives the duct");

    runs::RunWriter writer = exact::open_run(directory / "steady", scene, flocculation, replace);
    const bool power = material.flow_index != 1.0;
    writer.info()["model"] = power ? "herschel-bulkley, not regularised" : "bingham";
    writer.info()["label"] = "exact, steady";
    writer.info()["source"] = power ? "Herschel and Bulkley's law over the linear stress between the plates"
                                    : "Yu et al. 2026, Eqs. 48-50";
    std::vector<double> coordinate, velocity;
    constexpr int points = 401;
    for (int i = 0; i < points; ++i)
      coordinate.push_back(height * (static_cast<double>(i) / (points - 1) - 0.5));
    std::string summary = "exact, steady:";
    const auto& force = scene.forces.body_force;
    double norm = 0.0;
    for (std::size_t stage = 0; stage < force.size(); ++stage) {
      const double end =
          stage + 1 < force.size() ? std::min(force[stage + 1].first, scene.time.end) : scene.time.end;
      if (!(end > force[stage].first)) break;
      const DuctFlow flow{material, height, force[stage].second};
      velocity.clear();
      for (const double y : coordinate) velocity.push_back(flow.velocity(y));
      // The steady state of a stage stands at the stage's end: how it comes about has no closed form.
      writer.history(runs::Row()
                         .add(runs::column::time, end)
                         .add(runs::column::plug_velocity, flow.plug_velocity())
                         .add(runs::column::mean_velocity, flow.mean_velocity()));
      writer.profile(end, coordinate, velocity);
      summary += fmt::format("{} plug {:.6f} m/s, mean {:.6f} m/s under {:g} N/m3", stage == 0 ? "" : ";",
                             flow.plug_velocity(), flow.mean_velocity(), force[stage].second);
      const double bound = exact::stopping_time_bound(material, height, force[stage].second, norm);
      if (norm > 0.0 && std::isfinite(bound)) {
        writer.info()["stopping_time_bound_s"] = bound;
        summary += fmt::format(", at rest within {:.2f} s", bound);
      }
      norm = flow.l2_norm();
    }
    writer.finish(runs::Status::end_time, "the steady state of each stage, at its end", "sound");
    return {{directory / "steady", summary}};
  }
};

}  // namespace

const ApparatusReport& own_report(const scenes::Duct&) {
  static const DuctReport report;
  return report;
}

}  // namespace flowrest::compare
