#include "compare/apparatus/printing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "compare/findings.h"
#include "compare/run_view.h"
#include "runs/csv.h"
#include "scenes/scene.h"

namespace flowrest::compare {

namespace {

/// A section as a run recorded it last: rows from the bed up, m.
struct Section {
  double time = 0.0, x = 0.0;
  std::map<double, double> half_width;  ///< by height
};

/// The youngest stretch of the strand at the last time of sections.csv; nothing where a run has none.
std::optional<Section> last_section(const runs::Run& run) {
  const auto file = run.directory / "sections.csv";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const runs::Table table = runs::read_csv(file);
  if (table.rows() == 0) return std::nullopt;
  const auto &time = table.at("time_s"), &x = table.at("x_m"), &z = table.at("z_m"),
             &half = table.at("half_width_m");
  Section section;
  section.time = time.back();
  // Stretches are written from where the nozzle began.
  section.x = x.back();
  for (std::size_t i = 0; i < time.size(); ++i)
    if (time[i] == section.time && x[i] == section.x) section.half_width[z[i]] = half[i];
  return section;
}

/// Half widths over the height, all runs in one figure.
std::optional<report::Plot> outlines(const Comparison& comparison) {
  report::Plot plot;
  plot.id = "strand-sections";
  plot.title = "sections at the end";
  plot.caption =
      "Half the width over the height, of the stretch that was laid last, by what rows hold that are a cell high.";
  plot.x = {.name = "height", .unit = "mm", .from = 0.0};
  plot.y = {.name = "half the width", .unit = "mm", .from = 0.0};
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const auto section = last_section(comparison.runs[i].run);
    if (!section) continue;
    report::Curve curve;
    curve.entry = static_cast<int>(i);
    curve.marks = true;
    for (const auto& [z, half] : section->half_width) {
      curve.x.push_back(1e3 * z);
      curve.y.push_back(1e3 * half);
    }
    plot.curves.push_back(std::move(curve));
  }
  if (plot.curves.empty()) return std::nullopt;
  return plot;
}

/// What scenes/printed.csv says of a scene: what was measured, and the paper's error in per cent, by quantity.
struct Claim {
  std::optional<double> measured, paper_error;
};
std::map<std::string, Claim> claims_of(const std::string& scene) {
  std::map<std::string, Claim> claims;
  const auto file = scenes::scenes_folder() / "printed.csv";
  if (!std::filesystem::exists(file)) return claims;  // FLOWREST_SCENES names a folder of one's own
  const runs::CsvText text = runs::read_csv_text(file);
  for (const auto& row : text.rows) {
    if (row.cells.empty() || row.cells[0] != scene) continue;
    const auto number = [&](std::size_t i) {
      return i < row.cells.size() && !row.cells[i].empty() ? text.number(row.cells[i]) : std::nullopt;
    };
    if (row.cells.size() > 1) claims[row.cells[1]] = {number(2), number(3)};
  }
  return claims;
}

/// Ours beside what was measured, of which there is nothing yet, and what the paper says of itself.
std::optional<report::Table> beside_measured(const Comparison& comparison) {
  const auto claims = claims_of(word(comparison.runs.front().run.info, "/scene_name"));
  if (claims.empty()) return std::nullopt;
  report::Table table;
  table.id = "strand-measured";
  table.title = "beside what was measured";
  table.caption =
      "The measurements of Comminal et al. 2020 are in no source at hand: their column stays empty until scenes/printed.csv "
      "has them. The last column is what Zhang et al. 2026 (Table 5) say of their own simulation, and holds nothing against ours.";
  table.columns = {{.name = "Run", .text = true},
                   {.name = "Quantity", .text = true},
                   {.name = "Ours", .format = {report::Format::Kind::significant, 4}},
                   {.name = "Measured", .text = true},
                   {.name = "Off by", .text = true},
                   {.name = "The paper's error, its claim",
                    .unit = "%",
                    .format = {report::Format::Kind::significant, 3}}};
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    for (const auto& [quantity, claim] : claims) {
      if (!view.run.history.has(quantity) || view.run.history.rows() == 0) continue;
      const double ours = view.run.history.at(quantity).back();
      if (!std::isfinite(ours)) continue;
      table.rows.push_back(
          {{view.label, quantity, ours,
            claim.measured ? fmt::format("{:g}", *claim.measured) : std::string("not at hand"),
            claim.measured ? fmt::format("{:+.1f} %", 100.0 * (ours / *claim.measured - 1.0))
                           : std::string(""),
            claim.paper_error ? report::Table::Cell(*claim.paper_error) : report::Table::Cell()},
           static_cast<int>(i)});
    }
  }
  if (table.rows.empty()) return std::nullopt;
  return table;
}

/// Whether the section is what the nozzle feeds, to 1 %, in the last row and a quarter of the rows earlier.
std::string steady_sentence(const RunView& view) {
  const runs::Table& history = view.run.history;
  if (!history.has("area_over_balance")) return "";
  std::vector<double> shares;
  for (const double share : history.at("area_over_balance"))
    if (std::isfinite(share)) shares.push_back(share);
  if (shares.size() < 4) return view.label + ": too few sections to say whether the strand is steady.";
  const double last = shares.back(), earlier = shares[shares.size() - 1 - shares.size() / 4];
  const bool steady = std::abs(last - 1.0) < 0.01 && std::abs(earlier - 1.0) < 0.01;
  return fmt::format(
      "{}: {}. Its area is {:.1f} % of the balance, and was {:.1f} % a quarter of the rows earlier.",
      view.label, steady ? "steady" : "not steady yet", 100.0 * last, 100.0 * earlier);
}

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
  std::vector<report::Chapter> chapters(const Comparison& comparison) const override {
    report::Chapter chapter{"strand", "The strand", {}};
    if (auto plot = outlines(comparison)) chapter.blocks.emplace_back(std::move(*plot));
    for (const RunView& view : comparison.runs)
      if (const std::string text = steady_sentence(view); !text.empty())
        chapter.blocks.emplace_back(report::Text{text});
    if (auto table = beside_measured(comparison)) chapter.blocks.emplace_back(std::move(*table));
    if (chapter.blocks.empty()) return {};
    return {std::move(chapter)};
  }
  std::string stop_question() const override { return "How wide and how high is the strand?"; }
};

}  // namespace

const ApparatusReport& own_report(const scenes::Printing&) {
  static const PrintingReport report;
  return report;
}

}  // namespace flowrest::compare
