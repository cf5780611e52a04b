#include "compare/apparatus/v_funnel.h"

#include <fmt/format.h>

#include "compare/findings.h"

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
