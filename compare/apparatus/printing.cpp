#include "compare/apparatus/printing.h"

#include "compare/findings.h"

namespace flowrest::compare {

namespace {

class PrintingReport : public ApparatusReport {
 public:
  PrintingReport() : ApparatusReport(scenes::Printing{}) {}

  /// It is printed until its end.
  bool motion_is_news() const override { return false; }

  const Gauge& gauge() const override {
    static const Gauge gauge = millimetres(
        "strand's width", "strand_width_mm", "wider", "narrower",
        "Width: of the section behind the nozzle, from 1.6 to 2.6 of its diameters behind its axis, the "
        "largest of its rows.");
    return gauge;
  }
  const std::vector<Gauge>& further_gauges() const override {
    static const std::vector<Gauge> all = {
        millimetres("strand's height", "strand_height_mm", "higher", "lower",
                    "Height: of that section, the largest of its columns."),
        millimetres("width on the bed", "base_width_mm", "wider", "narrower",
                    "Width of the section's lowest row, one cell high."),
        {"area over balance", "area", "area_over_balance", "", 1.0, 1.0, "larger", "smaller",
         "The section's area over what the nozzle has fed per length of its way."},
        flocculation()};
    return all;
  }
  const std::vector<Reading>& readings() const override {
    static const std::vector<Reading> all = {
        reading_named("strand_width_mm"), reading_named("strand_height_mm"),
        reading_named("section_area_mm2"), reading_named("area_over_balance")};
    return all;
  }

  std::string readings_sentence(const Comparison& comparison, const RunView& view) const override {
    const auto width = reading_of(comparison, view, "strand_width_mm");
    const auto height = reading_of(comparison, view, "strand_height_mm");
    if (!width || !height) return view.label + ": no section was laid.";
    return view.label + ": the strand is " + *width + " wide and " + *height + " high" +
           doubt_in_brackets(view) + ".";
  }
  void describe(Comparison& comparison) const override {
    for (const RunView& view : comparison.runs)
      if (!view.exact && !view.gauge.empty())
        tell(comparison, Finding::Topic::stop, readings_sentence(comparison, view));
    tell(comparison, Finding::Topic::context, flocculation_sentence(comparison));
    comparison.fair = fair_runs;
  }
  std::string stop_question() const override { return "How wide and how high is the strand?"; }
};

}  // namespace

const ApparatusReport& own_report(const scenes::Printing&) {
  static const PrintingReport report;
  return report;
}

}  // namespace flowrest::compare
