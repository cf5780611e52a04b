#include <fmt/format.h>

#include <algorithm>

#include "runs/run_directory.h"
#include "studies/verification/verification.h"

namespace flowrest::studies::verification {

namespace {

using Json = nlohmann::ordered_json;
using report::Axis;
using report::Curve;
using report::Plot;
using report::Table;
using report::Text;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json finding_json(const Finding& f) {
  Json grids = Json::array();
  for (const auto& g : f.grids)
    grids.push_back({{"grid", g.grid},
                     {"error", g.measured ? Json(g.measured->error) : Json()},
                     {"value", g.measured ? Json(g.measured->value) : Json()},
                     {"trouble", g.measured ? "" : g.trouble},
                     {"doubt", g.doubt.word()},
                     {"wall_s", g.cpu}});
  Json orders = Json::array();
  for (const auto& order : f.orders) orders.push_back(optional_json(order));
  Json convergence;
  if (f.convergence)
    convergence = {{"behaviour", compare::to_string(f.convergence->convergence)},
                   {"words", f.convergence->words()},
                   {"order", optional_json(f.convergence->order)},
                   {"extrapolated", optional_json(f.convergence->extrapolated)},
                   {"fine_index", optional_json(f.convergence->fine_index)},
                   {"uncertainty", f.convergence->uncertainty}};
  return {{"case", f.of.name},
          {"variant", f.of.variant},
          {"against", f.of.against},
          {"norm", f.of.norm},
          {"refined", f.of.refined},
          {"grids", grids},
          {"observed_orders", orders},
          {"value", f.of.value_name},
          {"value_unit", f.of.value_unit},
          {"exact_value", optional_json(f.of.exact_value)},
          {"grid_convergence", convergence},
          {"largest_error_allowed", optional_json(f.of.largest_error)},
          {"least_order_allowed", optional_json(f.of.least_order)},
          {"judged", f.judged},
          {"passed", f.passed},
          {"verdict", f.verdict}};
}

Table::Cell cell(const std::optional<double>& value) {
  if (!value) return std::monostate{};
  return *value;
}

/// A number whose digits its uncertainty supports.
std::string with_uncertainty(double value, double uncertainty, const std::string& unit) {
  return fmt::format("{:.5g} with an uncertainty of {:.2g}{}{}", value, uncertainty, unit.empty() ? "" : " ",
                     unit);
}

Table::Row row_of(const Finding& f) {
  Table::Row row;
  const auto& finest = f.grids.back().measured;
  if (!f.passed && f.judged) row.badge = "fails";
  std::string converged;
  if (f.convergence) {
    converged = f.convergence->words();
    if (f.convergence->extrapolated && f.convergence->convergence == compare::Convergence::monotone)
      converged += fmt::format(
          "; {} extrapolates to {}", f.of.value_name,
          with_uncertainty(*f.convergence->extrapolated, f.convergence->uncertainty, f.of.value_unit));
  }
  row.cells = {f.of.name,
               f.of.variant,
               f.verdict,
               finest ? Table::Cell(finest->error) : Table::Cell(),
               f.orders.empty() ? Table::Cell() : cell(f.orders.back()),
               f.convergence ? cell(f.convergence->fine_index) : Table::Cell(),
               converged,
               f.of.norm,
               f.of.against};
  return row;
}

/// Errors against the grid of every variant of one case.
Plot plot_of(const std::string& name, const std::vector<const Finding*>& variants, std::size_t index) {
  Plot plot;
  plot.id = fmt::format("case-{}", index);
  plot.title = name;
  plot.x = Axis{variants.front()->of.refined, variants.front()->of.refined == "cell" ? "m" : "", true};
  plot.y = Axis{variants.front()->of.norm, "", true};
  plot.caption = fmt::format("Against {}.", variants.front()->of.against);
  for (const Finding* f : variants) {
    Curve curve;
    curve.name = f->of.variant;
    curve.marks = true;
    for (const auto& g : f->grids) {
      if (!g.measured) continue;
      curve.x.push_back(g.grid);
      curve.y.push_back(g.measured->error > 0.0 ? g.measured->error : report::none);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

std::string number(bool known, double value) { return known ? fmt::format("{:.17g}", value) : ""; }

std::string csv_row(const Finding& f, std::size_t i) {
  const auto& g = f.grids[i];
  const bool measured = g.measured.has_value(), ordered = i > 0 && i - 1 < f.orders.size() && f.orders[i - 1];
  const Measured m = g.measured.value_or(Measured{});
  const double order = ordered ? f.orders[i - 1].value_or(0.0) : 0.0;
  return fmt::format("{},{},{},{},{:.17g},{},{},{},{:.3g},{},{}\n", runs::csv_field(f.of.name),
                     runs::csv_field(f.of.variant), runs::csv_field(f.of.norm), runs::csv_field(f.of.refined),
                     g.grid, number(measured, m.error), number(measured, m.value), number(ordered, order),
                     g.cpu, runs::csv_field(f.verdict), runs::csv_field(measured ? "" : g.trouble));
}

}  // namespace

Json to_json(const std::vector<Finding>& findings) {
  Json json = {{"format", "flowrest verification"},
               {"format_version", 1},
               {"provenance", runs::provenance()},
               {"cases", Json::array()}};
  for (const Finding& f : findings) json["cases"].push_back(finding_json(f));
  return json;
}

std::string to_csv(const std::vector<Finding>& findings) {
  std::string text = "case,variant,norm,refined,grid,error,value,order_from_coarser,wall_s,verdict,trouble\n";
  for (const Finding& f : findings)
    for (std::size_t i = 0; i < f.grids.size(); ++i) text += csv_row(f, i);
  return text;
}

report::Page page_of(const std::vector<Finding>& findings) {
  report::Page page;
  page.kind = "verification";
  page.title = "Verification against what is exactly known";
  page.data = to_json(findings);
  page.provenance = runs::provenance();
  const auto judged = std::count_if(findings.begin(), findings.end(), [](const auto& f) { return f.judged; });
  const auto passed = std::count_if(findings.begin(), findings.end(), [](const auto& f) { return f.passed; });
  page.words.push_back(Text{fmt::format("{} of {} bounds hold.", passed, judged), Text::Style::opening});
  for (const Finding& f : findings)
    if (f.judged && !f.passed)
      page.words.push_back(
          Text{fmt::format("{}, {}: {}.", f.of.name, f.of.variant, f.verdict), Text::Style::warning});
  Table table;
  table.id = "verdicts";
  table.title = "Verdicts";
  table.caption = "Grid convergence indices after Celik et al. 2008, from the three finest grids.";
  table.columns = {
      {"case", "", {}, true},           {"variant", "", {}, true}, {"verdict", "", {}, true},
      {"error on the finest grid", ""}, {"observed order", ""},    {"grid convergence index", ""},
      {"convergence", "", {}, true},    {"norm", "", {}, true},    {"against", "", {}, true}};
  for (const Finding& f : findings) table.rows.push_back(row_of(f));
  page.chapters.push_back({"all-verdicts", "Verdicts", {std::move(table)}});
  std::vector<std::pair<std::string, std::vector<const Finding*>>> groups;
  for (const Finding& f : findings) {
    const auto there =
        std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == f.of.name; });
    if (there == groups.end())
      groups.push_back({f.of.name, {&f}});
    else
      there->second.push_back(&f);
  }
  report::Chapter plots{"plots", "Errors against the grid", {}};
  for (std::size_t i = 0; i < groups.size(); ++i) {
    Plot plot = plot_of(groups[i].first, groups[i].second, i);
    if (!page.figure)
      page.figure = std::move(plot);
    else
      plots.blocks.push_back(std::move(plot));
  }
  if (!plots.blocks.empty()) page.chapters.push_back(std::move(plots));
  return page;
}

}  // namespace flowrest::studies::verification
