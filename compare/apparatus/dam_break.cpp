#include "compare/apparatus/dam_break.h"

#include "compare/findings.h"

namespace flowrest::compare {

namespace {

class DamBreakReport : public ApparatusReport {
 public:
  DamBreakReport() : ApparatusReport(scenes::DamBreak{}) {}

  /// Water never rests.
  bool motion_is_news() const override { return false; }

  const Gauge& gauge() const override {
    static const Gauge gauge = millimetres("front", "front_mm", "further", "shorter",
                                           "Front: the distance from the back wall at which the depth "
                                           "falls through {depth:g} mm; it ends at the end wall.");
    return gauge;
  }
  const std::vector<Gauge>& further_gauges() const override { return channel_gauges(); }
  const std::vector<Reading>& readings() const override {
    static const std::vector<Reading> all = {reading_named("front_mm"), reading_named("arrival_s")};
    return all;
  }

  std::string opening(const Comparison& comparison, const RunView*) const override {
    return event_clause(comparison, "arrival_s", "the front reaches the end wall",
                        "has not reached the end wall");
  }
  std::string readings_sentence(const Comparison& comparison, const RunView& view) const override {
    return arrival_sentence(comparison, view, false);
  }
  std::string stop_question() const override { return "How far does each run, and when?"; }
};

}  // namespace

const ApparatusReport& own_report(const scenes::DamBreak&) {
  static const DamBreakReport report;
  return report;
}

}  // namespace flowrest::compare
