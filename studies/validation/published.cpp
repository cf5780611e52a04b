#include "studies/validation/published.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <utility>

#include "compare/exact/creep.h"
#include "compare/exact/solutions.h"
#include "runs/csv.h"
#include "runs/run_directory.h"
#include "scenes/pieces.h"
#include "scenes/text.h"

namespace flowrest::studies::validation {

namespace {

namespace fs = std::filesystem;
using runs::RunError;

constexpr std::pair<Mark, const char*> marks[] = {{Mark::independent, ""},
                                                  {Mark::calibrated, "calibrated"},
                                                  {Mark::circular, "circular"},
                                                  {Mark::exact, "exact"}};

/// A table of scenes/, whose rows may leave out cells at their end but for the first `least`.
runs::CsvText read_rows(const fs::path& path, std::size_t least) {
  if (!fs::exists(path)) throw RunError(path.string() + ": no such file; it comes with the scenes");
  runs::CsvText table = runs::read_csv_text(path);
  const std::size_t columns = table.header.cells.size();
  for (auto& row : table.rows) {
    if (row.cells.size() < least || row.cells.size() > columns)
      throw RunError(
          fmt::format("{}: has {} cells; expected: {}", table.place(row), row.cells.size(),
                      least == columns ? fmt::format("{}", least) : fmt::format("{} to {}", least, columns)));
    row.cells.resize(columns);
  }
  return table;
}

std::optional<double> number_in(const runs::CsvText& table, const std::string& cell,
                                const std::string& place) {
  if (cell.empty()) return std::nullopt;
  const auto value = table.number(cell);
  if (!value || !std::isfinite(*value))
    throw RunError(fmt::format("{}: '{}' is no number; expected: a number or nothing", place, cell));
  return value;
}

Mark mark_in(const std::string& cell, const std::string& place) {
  std::vector<std::string> allowed;
  for (const auto& [mark, name] : marks) {
    if (cell == name) return mark;
    if (*name) allowed.emplace_back(name);
  }
  throw RunError(
      fmt::format("{}: '{}' is no mark; allowed: {} or nothing", place, cell, scenes::joined(allowed)));
}

}  // namespace

std::string to_string(Mark mark) {
  if (mark == Mark::independent) return "independent";
  for (const auto& [known, name] : marks)
    if (known == mark) return name;
  throw std::logic_error("a mark without a name");
}

std::vector<Published> read_published() {
  constexpr std::size_t least = 7;  // the model may be left out
  std::vector<Published> published;
  const auto table = read_rows(scenes::scenes_folder() / "published.csv", least);
  for (const auto& row : table.rows) {
    const auto& cells = row.cells;
    const std::string place = table.place(row);
    Published p;
    p.scene = cells[0];
    p.quantity = cells[1];
    p.measured = number_in(table, cells[2], place);
    p.paper = number_in(table, cells[3], place);
    p.allowed = number_in(table, cells[4], place).value_or(0.0);
    p.mark = mark_in(cells[5], place);
    p.source = cells[6];
    if (cells.size() > least && !cells[least].empty()) p.model = scenes::model_from_name(cells[least]);
    published.push_back(std::move(p));
  }
  return published;
}

std::vector<PaperItem> read_paper_items() {
  std::vector<PaperItem> items;
  constexpr std::size_t columns = 4;
  for (const auto& row : read_rows(scenes::scenes_folder() / "papers.csv", columns).rows)
    items.push_back({row.cells[0], row.cells[1], row.cells[2], row.cells[3]});
  return items;
}

std::vector<Published> exact_numbers(const std::string& name, const scenes::Scene& scene) {
  const auto gauged = scenes::pieces_of(scene).gauged;
  const auto* plates = std::get_if<scenes::PlatesGauge>(&gauged);
  if (!plates || scene.forces.body_force.empty()) return {};
  const scenes::Material& material = scene.material;
  const double height = plates->height, force = scene.forces.body_force.back().second;
  const bool stepped = scene.forces.body_force.size() > 1;
  std::set<scenes::Model> models(scene.runs.mpm.begin(), scene.runs.mpm.end());
  models.insert(scene.runs.foam.begin(), scene.runs.foam.end());
  std::vector<Published> numbers;
  for (const scenes::Model model : models) {
    constexpr double tolerance = 0.01;
    Published p;
    p.scene = name;
    p.quantity = "plug_velocity_m_s";
    p.mark = Mark::exact;
    p.source = "closed form";
    p.model = model;
    if (laws::creeps(model)) {
      if (!material.suits(model)) continue;
      scenes::Material of_model = material;
      of_model.model = model;
      p.paper = compare::exact::duct_creep(of_model.flow_curve(), height, force);
    } else {
      if (stepped) continue;  // what stops has no velocity to be held against
      const compare::exact::DuctFlow flow{
          {material.density, material.yield_stress, material.plastic_viscosity, material.flow_index},
          height,
          force};
      p.paper = flow.plug_velocity();
    }
    p.allowed = tolerance * *p.paper;
    numbers.push_back(p);
  }
  return numbers;
}

}  // namespace flowrest::studies::validation
