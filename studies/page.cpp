#include "studies/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/words.h"
#include "runs/run_directory.h"
#include "studies/quantities.h"

namespace flowrest::studies {

namespace {

using report::Axis;
using report::Block;
using report::Chapter;
using report::Curve;
using report::Map;
using report::Plot;
using report::Table;
using report::Text;

std::string plain(const std::string& toml) {
  const bool quoted = toml.size() >= 2 && toml.front() == '"';
  return quoted ? toml.substr(1, toml.size() - 2) : toml;
}

/// What a run cost and how far off it is, in words.
std::string hover_of(const Result& r, const std::string& quantity) {
  std::string text =
      fmt::format("{}: error {}, {} of CPU", r.point.label, compare::words::percent(r.errors.at(quantity)),
                  compare::words::duration(r.cpu));
  if (r.memory > 0.0) text += fmt::format(", {:.0f} MB", 1e-6 * r.memory);
  if (r.verdict != Verdict::sound)
    text += fmt::format(" ({})", r.reason.empty() ? to_string(r.verdict) : r.reason);
  return text;
}

class StudyPage {
 public:
  StudyPage(const Results& results, const nlohmann::ordered_json& json) : results_(results) {
    page_.kind = "study";
    page_.title = results.study.title;
    page_.data = json;
    page_.provenance = runs::provenance();
    add_entries();
    add_words();
    if (results.study.purpose == Purpose::map)
      add_maps();
    else
      add_trade();
    add_runs();
    page_.chapters.push_back(
        {"source", "The study's file", {report::Details{"As it was read", {}, results.study.source}}});
  }

  report::Page page() && { return std::move(page_); }

 private:
  void add_entries() {
    constexpr int colours = 7, dashes = 8;
    int index = 0;
    for (const Sweep& sweep : results_.study.sweeps) {
      page_.entries.push_back({sweep.name, index % colours, index % dashes, {}, {}});
      ++index;
    }
  }

  int entry_of(const std::string& sweep) const {
    for (std::size_t i = 0; i < page_.entries.size(); ++i)
      if (page_.entries[i].name == sweep) return static_cast<int>(i);
    return -1;
  }

  void add_words() {
    bool first = true;
    for (const std::string& finding : results_.findings) {
      page_.words.push_back(Text{finding, first ? Text::Style::opening : Text::Style::plain});
      first = false;
    }
    for (const std::string& note : results_.notes) page_.words.push_back(Text{note, Text::Style::warning});
    if (!results_.cut.empty())
      page_.words.push_back(
          Text{fmt::format("This is the cut \"{}\" of the study.", results_.cut), Text::Style::soft});
  }

  std::vector<const Result*> points_with_error(const std::string& quantity) const {
    std::vector<const Result*> points;
    for (const Result& r : results_.results)
      if (r.point.role == Point::Role::point && r.errors.contains(quantity) && r.cpu > 0.0)
        points.push_back(&r);
    return points;
  }

  /// A line of its own look, which is no sweep.
  int add_entry(const std::string& name, int colour, int dash) {
    if (const int there = entry_of(name); there >= 0) return there;
    page_.entries.push_back({name, colour, dash, {}, {}});
    return static_cast<int>(page_.entries.size()) - 1;
  }

  /// The line under which nothing cheaper of one solver lies.
  void add_front(Plot& plot, const std::string& quantity, Solver solver) {
    std::vector<const Result*> front;
    for (const Result* r : points_with_error(quantity))
      if (r->point.solver == solver && r->pareto.contains(quantity) && r->pareto.at(quantity))
        front.push_back(r);
    if (front.size() < 2) return;
    std::sort(front.begin(), front.end(), [](auto* a, auto* b) { return a->cpu < b->cpu; });
    Curve curve;
    curve.entry = solver == Solver::mpm ? add_entry("MPM: nothing cheaper is as good", -1, 1)
                                        : add_entry("OpenFOAM: nothing cheaper is as good", -1, 2);
    for (const Result* r : front) {
      curve.x.push_back(r->cpu);
      curve.y.push_back(percent_of(r->errors.at(quantity)));
    }
    plot.curves.push_back(std::move(curve));
  }

  /// Errors on a logarithmic axis: none is so small that it says more than the digits it is computed with.
  static double percent_of(double error) { return 100.0 * std::max(error, 1e-6); }

  Plot trade_of(const std::string& quantity) {
    Plot plot;
    plot.id = "trade-" + id_for(quantity);
    plot.title = fmt::format("Error of {} against CPU time", quantity);
    plot.x = Axis{"CPU time", "s", true};
    plot.y = Axis{"error", "%", true};
    for (const Sweep& sweep : results_.study.sweeps) {
      Curve curve;
      curve.entry = entry_of(sweep.name);
      curve.line = false;
      curve.marks = true;
      for (const Result* r : points_with_error(quantity)) {
        if (r->point.sweep != sweep.name) continue;
        curve.x.push_back(r->cpu);
        curve.y.push_back(percent_of(r->errors.at(quantity)));
        curve.hover.push_back(hover_of(*r, quantity));
      }
      if (!curve.x.empty()) plot.curves.push_back(std::move(curve));
    }
    for (const Solver solver : {Solver::mpm, Solver::foam}) add_front(plot, quantity, solver);
    add_floor(plot, quantity);
    return plot;
  }

  void add_floor(Plot& plot, const std::string& quantity) {
    const ReferenceValue& reference = results_.reference.at(quantity);
    const double scale = is_difference(quantity) ? 1.0 : std::abs(reference.value);
    const double floor = reference.uncertainty && scale > 0.0 ? 100.0 * *reference.uncertainty / scale : 0.0;
    plot.caption = reference.words + ".";
    if (!(floor > 0.0) || plot.curves.empty()) return;
    double low = plot.curves.front().x.front(), high = low;
    for (const Curve& curve : plot.curves)
      for (const double x : curve.x) {
        low = std::min(low, x);
        high = std::max(high, x);
      }
    Curve line;
    line.entry = add_entry("uncertainty of the reference", -1, 3);
    line.x = {low, high};
    line.y = {floor, floor};
    plot.curves.push_back(std::move(line));
    plot.caption += " Below its uncertainty errors cannot be told apart: there the cheapest wins.";
  }

  void add_trade() {
    if (results_.limit) add_limit();
    std::vector<Block> others;
    for (const std::string& quantity : results_.study.quantities) {
      if (!results_.reference.contains(quantity) || points_with_error(quantity).empty()) continue;
      if (!page_.figure)
        page_.figure = trade_of(quantity);
      else
        others.push_back(trade_of(quantity));
    }
    if (!others.empty()) page_.chapters.push_back({"others", "Other quantities", std::move(others)});
    if (!results_.prices.empty())
      page_.chapters.push_back({"choices", "What each choice costs and buys", {prices()}});
  }

  void add_limit() {
    const LimitWish& wish = *results_.study.limit;
    Plot plot;
    plot.id = "limit";
    plot.title = fmt::format("{} against {}", wish.quantity, wish.key);
    plot.x = Axis{wish.key, "", true};
    plot.y = Axis{wish.quantity, unit_of(wish.quantity)};
    plot.caption = results_.limit_basis;
    std::map<double, Curve> by_cell;
    double low = 0.0, high = 0.0;
    for (const Result& r : results_.results)
      for (const Setting& s : r.point.varied) {
        if (s.key != wish.key || r.point.role != Point::Role::point || !r.values.contains(wish.quantity))
          continue;
        const double x = std::stod(s.value), cell = r.point.scene->mpm.cell;
        Curve& curve = by_cell[cell];
        curve.entry =
            add_entry(fmt::format("cells of {:g} mm", 1e3 * cell), static_cast<int>(by_cell.size()) % 7, 0);
        curve.marks = true;
        curve.x.push_back(x);
        curve.y.push_back(r.values.at(wish.quantity));
        low = low > 0.0 ? std::min(low, x) : x;
        high = std::max(high, x);
      }
    for (auto& [cell, curve] : by_cell) plot.curves.push_back(std::move(curve));
    const auto level = [&](const std::string& name, double y, int dash) {
      Curve line;
      line.entry = add_entry(name, -1, dash);
      line.x = {low, high};
      line.y = {y, y};
      plot.curves.push_back(std::move(line));
    };
    const int decimals = compare::words::decimals_down_to(results_.limit->uncertainty);
    level(fmt::format("limit, {:.{}f} with an uncertainty of {:.{}f}", results_.limit->value, decimals,
                      results_.limit->uncertainty, decimals),
          results_.limit->value, 1);
    if (!wish.compare_to_name.empty()) level(wish.compare_to_name, wish.compare_to, 2);
    page_.figure = std::move(plot);
  }

  Table prices() const {
    Table table;
    table.id = "prices";
    table.title = "What each choice costs and buys";
    table.caption = "Medians over all pairs of runs that differ in nothing else.";
    table.columns = {
        {"change", "", {}, true, "change"}, {"pairs", ""}, {"CPU time", "times"}, {"memory", "times"}};
    for (const std::string& q : results_.study.quantities) {
      table.columns.push_back({q, "% change", {}, false, q + "_change_percent"});
      table.columns.push_back({"error of " + q, "% points", {}, false, q + "_error_change_percent"});
    }
    const auto cell = [](const std::map<std::string, double>& map, const std::string& key) -> Table::Cell {
      const auto found = map.find(key);
      if (found == map.end()) return std::monostate{};
      return 100.0 * found->second;
    };
    for (const Price& p : results_.prices) {
      Table::Row row;
      row.cells = {fmt::format("{}: {} {} to {}", p.sweep, p.key, p.from, p.to), static_cast<double>(p.pairs),
                   p.cpu_ratio, p.memory_ratio > 0.0 ? Table::Cell(p.memory_ratio) : Table::Cell()};
      for (const std::string& q : results_.study.quantities) {
        row.cells.push_back(cell(p.change, q));
        row.cells.push_back(cell(p.error_change, q));
      }
      table.rows.push_back(std::move(row));
    }
    return table;
  }

  /// What a solver is (scheme, model, precision) along one side, what is varied of the scene along the other.
  void add_maps() {
    Chapter chapter{"maps", "The map", {}};
    for (const Sweep& sweep : results_.study.sweeps) {
      Map map;
      map.id = "map-" + id_for(sweep.name);
      map.title = sweep.name;
      map.row_name = "scene";
      map.column_name = "solver";
      for (const Result& r : results_.results)
        if (r.point.sweep == sweep.name && r.point.role == Point::Role::point) add_cell(map, r);
      if (map.cells.empty()) continue;
      if (!page_.figure)
        page_.figure = std::move(map);
      else
        chapter.blocks.push_back(std::move(map));
    }
    if (!chapter.blocks.empty()) page_.chapters.push_back(std::move(chapter));
  }

  static std::size_t place_in(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    names.push_back(name);
    return names.size() - 1;
  }

  static void add_cell(Map& map, const Result& r) {
    std::string row, column;
    for (const Setting& s : r.point.varied) {
      const bool of_the_solver =
          s.key == "material.model" || s.key == "mpm.scheme" || s.key == "mpm.precision";
      std::string& side = of_the_solver ? column : row;
      if (!side.empty()) side += ", ";
      side += of_the_solver ? plain(s.value)
                            : fmt::format("{} {}", s.key.substr(s.key.rfind('.') + 1), plain(s.value));
    }
    Map::Cell cell;
    cell.row = place_in(map.rows, row.empty() ? "as in the scene" : row);
    cell.column = place_in(map.columns, column.empty() ? "as in the scene" : column);
    cell.verdict = seen(r.verdict);
    cell.text = to_string(r.verdict);
    cell.hover = r.reason;
    map.cells.push_back(std::move(cell));
  }

  static Map::Verdict seen(Verdict verdict) {
    switch (verdict) {
      case Verdict::sound:
        return Map::Verdict::sound;
      case Verdict::refused:
        return Map::Verdict::refused;
      case Verdict::stopped:
      case Verdict::too_long:
        return Map::Verdict::stopped;
      case Verdict::under_resolved:
      case Verdict::noisy:
      case Verdict::missing:
        return Map::Verdict::warning;
      case Verdict::unsound:
      case Verdict::crashed:
        return Map::Verdict::wrong;
    }
    return Map::Verdict::wrong;
  }

  void add_runs() {
    Table table;
    table.id = "runs";
    table.title = "Every run";
    table.columns = {{"run", "", {}, true, "run"},
                     {"verdict", "", {}, true, "verdict"},
                     {"CPU time", "s", {}, false, "cpu_s"},
                     {"memory", "MB", {}, false, "peak_memory_mb"}};
    for (const std::string& q : results_.study.quantities) {
      table.columns.push_back(
          {q, is_difference(q) ? "" : unit_of(q), {report::Format::Kind::significant, 4}, false, q});
      if (!is_difference(q)) table.columns.push_back({"error of " + q, "%", {}, false, q + "_error_percent"});
    }
    for (const Result& r : results_.results) table.rows.push_back(row_of(r));
    page_.chapters.push_back({"all-runs", "Every run", {std::move(table)}});
  }

  Table::Row row_of(const Result& r) const {
    Table::Row row;
    row.entry = entry_of(r.point.sweep);
    if (r.verdict != Verdict::sound) row.badge = to_string(r.verdict);
    row.cells = {r.point.label, r.reason.empty() ? to_string(r.verdict) : r.reason,
                 r.cpu > 0.0 ? Table::Cell(r.cpu) : Table::Cell(),
                 r.memory > 0.0 ? Table::Cell(1e-6 * r.memory) : Table::Cell()};
    for (const std::string& q : results_.study.quantities) {
      row.cells.push_back(r.values.contains(q) ? Table::Cell(r.values.at(q)) : Table::Cell());
      if (!is_difference(q))
        row.cells.push_back(r.errors.contains(q) ? Table::Cell(100.0 * r.errors.at(q)) : Table::Cell());
    }
    return row;
  }

  const Results& results_;
  report::Page page_;
};

}  // namespace

std::string id_for(const std::string& text) {
  std::string id;
  for (const char c : text) id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  return id;
}

report::Page study_page(const Results& results, const nlohmann::ordered_json& study_json) {
  return StudyPage(results, study_json).page();
}

}  // namespace flowrest::studies
