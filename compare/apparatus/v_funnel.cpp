#include "compare/apparatus/v_funnel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/exact/funnel.h"
#include "compare/exact/solution_run.h"
#include "compare/findings.h"
#include "runs/columns.h"

namespace flowrest::compare {

using Topic = Finding::Topic;

namespace {

class VFunnelReport : public ApparatusReport {
 public:
  VFunnelReport() : ApparatusReport(scenes::VFunnel{}) {}

  /// It runs empty.
  bool motion_is_news() const override { return false; }

  const Gauge& gauge() const override {
    static const Gauge gauge = {"discharged fraction",
                                "discharged",
                                "discharged_fraction",
                                "%",
                                1.0,
                                100.0,
                                "more",
                                "less",
                                "Discharged: the share of the mass that is below the outlet."};
    return gauge;
  }
  const std::vector<Gauge>& further_gauges() const override {
    static const Gauge sight =
        millimetres("thinnest line of sight", "thinnest_sight_mm", "thicker", "thinner",
                    "The least material on any line of sight through the outlet: light "
                    "is seen once it is below {depth:g} mm.");
    static const std::vector<Gauge> all = {sight, flocculation()};
    return all;
  }
  const std::vector<Reading>& readings() const override {
    static const std::vector<Reading> all = {reading_named("light_s"), reading_named("discharged_fraction"),
                                             reading_named("rest_s")};
    return all;
  }

  std::string opening(const Comparison& comparison, const RunView*) const override {
    return event_clause(comparison, "light_s", "light is seen through the funnel", "shows no light");
  }
  std::string readings_sentence(const Comparison& comparison, const RunView& view) const override {
    const std::string doubt = doubt_in_brackets(view);
    const auto light = reading_of(comparison, view, "light_s");
    const auto rest = reading_of(comparison, view, "rest_s");
    std::string text = light ? fmt::format("{}: light is seen after {}", view.label, *light)
                             : fmt::format("{}: no light is seen", view.label);
    if (!view.gauge.empty())
      text += fmt::format("; {:.0f} % of the mass has run out by {}", 100.0 * view.gauge.value.back(),
                          words::time(view.gauge.end()));
    if (rest) text += fmt::format("; at rest after {}", *rest);
    return text + doubt + ".";
  }
  void describe(Comparison& comparison) const override {
    for (const RunView& view : comparison.runs)
      if (!view.exact && !view.gauge.empty())
        tell(comparison, Topic::stop, readings_sentence(comparison, view));
    tell(comparison, Topic::apart, events_apart(comparison, "light_s", "light is seen"));
    tell(comparison, Topic::context, flocculation_sentence(comparison));
    comparison.fair = fair_runs;
  }
  /// It slides, so that neither its yield stress nor its structure count.
  std::vector<exact::ExactRun> write_exact_runs(const scenes::Scene& scene,
                                                const std::filesystem::path& directory,
                                                std::optional<double> flocculation,
                                                runs::Replace replace) const override {
    if (flocculation)
      exact::refuse(scene, "--flocculation is given, and a plug that slides does not ask for it");
    if (scene.base.law == scenes::Wall::no_slip)
      exact::refuse(scene, "walls that hold shear it; allowed: slip, or a friction");
    const auto& v = scene.v_funnel();
    const exact::Funnel funnel{v.height(), v.neck_height, v.depth,
                               [v](double height) { return v.width_at(height); }};
    const double friction = scene.base.law == scenes::Wall::friction ? scene.base.friction : 0.0;
    std::vector<exact::ExactRun> made;
    for (const bool seals : {false, true}) {
      const auto folder = directory / (seals ? "neck-seals" : "neck-lets-go");
      const std::string label = seals ? "sliding plug, neck seals" : "sliding plug, neck lets go";
      runs::RunWriter writer = exact::open_run(folder, scene, std::nullopt, replace);
      writer.info()["label"] = label;
      writer.info()["source"] =
          "unsteady Bernoulli flow with Coulomb friction on the walls, without viscosity";
      const exact::FunnelFlow flow(funnel, scene.material.density, scene.forces.gravity, friction,
                                   seals ? exact::Neck::seals : exact::Neck::lets_go);
      double suction = 0.0, nearly_all = std::numeric_limits<double>::quiet_NaN();
      constexpr double most = 0.9;
      for (const auto& state : flow.run(scene.time.end, scene.output.history_interval)) {
        suction = std::max(suction, state.suction);
        if (std::isnan(nearly_all) && state.discharged >= most) nearly_all = state.time;
        writer.history(runs::Row()
                           .add(runs::column::time, state.time)
                           .add(runs::column::discharged, state.discharged)
                           .add(runs::column::suction, suction));
      }
      writer.finish(runs::Status::end_time, "", "sound");
      made.push_back({folder, fmt::format("{}: 90 % has run out after {:.2f} s; suction at most {:.0f} Pa",
                                          label, nearly_all, suction)});
    }
    return made;
  }
  std::string stop_question() const override { return "When is light seen, and does it run empty?"; }

  std::string measures_caption(const Comparison& comparison) const override {
    return fmt::format(
        "Light is seen once some line of sight through the outlet holds less than {:g} mm of material. ± is "
        "the difference to another grid, taken on to zero cell size at first order. A dash: not measured, or "
        "never.",
        1e3 * comparison.gauges.light_depth);
  }
};

}  // namespace

const ApparatusReport& own_report(const scenes::VFunnel&) {
  static const VFunnelReport report;
  return report;
}

}  // namespace flowrest::compare
