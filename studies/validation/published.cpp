#include "studies/validation/published.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "compare/exact/creep.h"
#include "compare/exact/solutions.h"
#include "runs/run_directory.h"
#include "scenes/text.h"

namespace flowrest::studies::validation {

namespace {

namespace fs = std::filesystem;
using runs::RunError;

constexpr std::pair<Mark, const char*> marks[] = {{Mark::independent, ""},
                                                  {Mark::calibrated, "calibrated"},
                                                  {Mark::circular, "circular"},
                                                  {Mark::exact, "exact"}};

/// Cells of a line; a quoted one may hold commas.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else if (c != '\r')
      cells.back() += c;
  }
  return cells;
}

/// The rows of a table of scenes/ under its header, each with the place it was read at.
struct Rows {
  std::vector<std::string> header;
  std::vector<std::pair<std::string, std::vector<std::string>>> rows;
};

Rows read_rows(const fs::path& path, std::size_t least) {
  std::ifstream file(path);
  if (!file) throw RunError(path.string() + ": no such file; it comes with the scenes");
  Rows table;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    auto cells = cells_of(line);
    if (table.header.empty()) {
      table.header = std::move(cells);
      continue;
    }
    const std::string place = fmt::format("{}:{}", path.string(), number);
    if (cells.size() < least || cells.size() > table.header.size())
      throw RunError(fmt::format("{}: has {} cells; expected: {}", place, cells.size(),
                                 least == table.header.size()
                                     ? fmt::format("{}", least)
                                     : fmt::format("{} to {}", least, table.header.size())));
    cells.resize(table.header.size());
    table.rows.emplace_back(place, std::move(cells));
  }
  return table;
}

std::optional<double> number_in(const std::string& cell, const std::string& place) {
  if (cell.empty()) return std::nullopt;
  std::size_t read = 0;
  double value = 0.0;
  try {
    value = std::stod(cell, &read);
  } catch (const std::exception&) {
    read = 0;
  }
  if (read != cell.size() || !std::isfinite(value))
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
  for (const auto& [place, cells] : read_rows(scenes::scenes_folder() / "published.csv", least).rows) {
    Published p;
    p.scene = cells[0];
    p.quantity = cells[1];
    p.measured = number_in(cells[2], place);
    p.paper = number_in(cells[3], place);
    p.allowed = number_in(cells[4], place).value_or(0.0);
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
  for (const auto& [place, cells] : read_rows(scenes::scenes_folder() / "papers.csv", columns).rows)
    items.push_back({cells[0], cells[1], cells[2], cells[3]});
  return items;
}

std::vector<Published> exact_numbers(const std::string& name, const scenes::Scene& scene) {
  if (scene.kind != scenes::Kind::duct || scene.forces.body_force.empty()) return {};
  const scenes::Material& material = scene.material;
  const double height = scene.duct().height, force = scene.forces.body_force.back().second;
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
    if (model == scenes::Model::papanastasiou || model == scenes::Model::bi_viscous) {
      const bool smooth = model == scenes::Model::papanastasiou;
      const auto time = smooth ? material.regularisation_time : material.critical_shear_rate;
      if (!time) continue;
      using Fluid = compare::exact::RegularisedFluid;
      p.paper = compare::exact::duct_creep(
          {smooth ? Fluid::Law::papanastasiou : Fluid::Law::bi_viscous, material.yield_stress,
           material.plastic_viscosity, smooth ? *time : 1.0 / *time},
          height, force);
    } else {
      if (stepped) continue;  // what stops has no velocity to be held against
      const compare::exact::DuctFlow flow{
          {material.density, material.yield_stress, material.plastic_viscosity}, height, force};
      p.paper = flow.plug_velocity();
    }
    p.allowed = tolerance * *p.paper;
    numbers.push_back(p);
  }
  return numbers;
}

}  // namespace flowrest::studies::validation
