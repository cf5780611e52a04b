#include "compare/apparatus/apparatus.h"

#include <fmt/format.h>

#include <set>
#include <variant>

#include "compare/apparatus/dam_break.h"
#include "compare/apparatus/duct.h"
#include "compare/apparatus/l_box.h"
#include "compare/apparatus/printing.h"
#include "compare/apparatus/slump.h"
#include "compare/apparatus/v_funnel.h"
#include "compare/exact/solution_run.h"
#include "compare/findings.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;
using report::Format;
using report::Table;

const ApparatusReport& report_of(const scenes::Apparatus& apparatus) {
  return std::visit([](const auto& one) -> const ApparatusReport& { return own_report(one); }, apparatus);
}

ApparatusReport::ApparatusReport(const scenes::Apparatus& apparatus)
    : name_(scenes::name_of(apparatus)),
      judged_by_(scenes::main_gauge_of(apparatus)),
      rests_(std::visit([](const auto& one) { return one.rests; }, apparatus)) {}

void ApparatusReport::describe(Comparison& comparison) const {
  describe_growth(comparison);
  comparison.fair = fair_runs;
}

std::string ApparatusReport::measures_caption(const Comparison& comparison) const {
  const Thresholds& o = comparison.thresholds;
  std::set<std::string> references;
  for (const RunView& view : comparison.runs)
    if (!view.measures.overshoot_reference_run.empty())
      references.insert(view.measures.overshoot_reference_run);
  const std::string& name = gauge().name;
  return fmt::format(
      "A run is at rest by shear rate once the 99th percentile of the shear rate stays below {:g} 1/s, and "
      "by {} rate "
      "once the {} grows by less than {:g} mm/s over {:g} s, up to the end of its record. A dash: not "
      "measured, or "
      "never. These thresholds are customary, not criteria: a fluid that creeps for ever passes them too. "
      "The volume of a "
      "material point run includes its elastic compression. {}",
      o.rest_shear_rate, name, name, 1e3 * o.rest_spread_rate, o.rate_window,
      references.empty()
          ? fmt::format("No run of the elasto-viscoplastic law is among these, so there is no arrested {} to "
                        "count from.",
                        name)
          : "Arrested " + name + ": that of " + words::listed({references.begin(), references.end()}) + ".");
}

std::vector<RunColumn> ApparatusReport::measure_columns(const Comparison& comparison) const {
  std::vector<RunColumn> columns;
  for (const Reading& reading : readings()) {
    const auto part = [quantity = reading.quantity](std::optional<double> ReadValue::*member) {
      return [=](const RunView& view) {
        const auto found = view.measures.readings.find(quantity);
        return found == view.measures.readings.end() ? Table::Cell() : cell(found->second.*member);
      };
    };
    const Format format = reading.unit == "mm"  ? lengths(comparison)
                          : reading.unit == "s" ? times(comparison, 2)
                                                : significant(3);
    columns.push_back({{capitalised(reading.name), reading.unit, format}, part(&ReadValue::value)});
    columns.push_back(
        {{"± of " + reading.name, reading.unit, reading.unit == "mm" ? lengths(comparison) : significant(2)},
         part(&ReadValue::uncertainty)});
  }
  columns.push_back({{"Recorded until", "s", times(comparison, 1)}, [](const RunView& view) {
                       return view.exact ? Table::Cell() : cell(view.measures.end);
                     }});
  columns.push_back(
      measure_column("Rest by shear rate", "s", times(comparison, 1), &Measures::rest_by_shear_rate));
  return columns;
}

std::string ApparatusReport::residual_caption(const Comparison& comparison) const {
  return fmt::format(
      "Measured: the median slope of the {} over the last {:g} s (of a short record, its last fifth).",
      gauge().name, comparison.thresholds.residual_window);
}

Json ApparatusReport::measures_json(const Measures& m) const {
  Json json;
  for (const Reading& reading : readings()) {
    const auto found = m.readings.find(reading.quantity);
    if (found == m.readings.end()) continue;
    json[reading.quantity] = scaled(found->second.value);
    json[reading.quantity + "_uncertainty"] = scaled(found->second.uncertainty);
  }
  json["rest_by_shear_rate_s"] = scaled(m.rest_by_shear_rate);
  json["residual_mm_s"] = scaled(m.residual, 1e3);
  json["overshoot_reference_run"] = m.overshoot_reference_run;
  return json;
}

std::vector<exact::ExactRun> ApparatusReport::write_exact_runs(const scenes::Scene& scene,
                                                               const std::filesystem::path&,
                                                               std::optional<double>, runs::Replace) const {
  exact::refuse(scene, "none is known for this kind of scene");
}

namespace {

[[noreturn]] void refuse_film(const scenes::Scene& scene) {
  exact::refuse(scene, "a thin film spreads from a slump about its axis");
}

}  // namespace

void ApparatusReport::check_film(const scenes::Scene& scene) const { refuse_film(scene); }

exact::ExactRun ApparatusReport::write_film_run(const scenes::Scene& scene, const std::filesystem::path&,
                                                bool, runs::Replace) const {
  refuse_film(scene);
}

}  // namespace flowrest::compare
