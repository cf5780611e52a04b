#include "compare/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/words.h"
#include "runs/run_directory.h"
#include "studies/gradient/gradient.h"
#include "studies/page.h"

namespace flowrest::studies::gradient {

namespace {

using report::Bars;
using report::Chapter;
using report::Curve;
using report::Page;
using report::Plot;
using report::Table;
using report::Text;

/// Keys in the order of how much they matter to a quantity.
std::vector<std::size_t> by_weight(const Gradient& g) {
  std::vector<std::size_t> order(g.by.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(g.by[a].elasticity) > std::abs(g.by[b].elasticity);
  });
  return order;
}

Bars tornado(const Gradient& g) {
  Bars bars;
  bars.id = id_for("tornado-" + g.quantity.name);
  bars.title = fmt::format("What {} hangs on", g.quantity.name);
  bars.caption = "The elasticity is by how many per cent the quantity changes for one per cent of a key.";
  bars.x = {.name = "elasticity", .unit = "% per %"};
  Bars::Group group{.name = g.quantity.name};
  for (const std::size_t k : by_weight(g)) {
    bars.categories.push_back(g.by[k].key.path);
    group.values.push_back(g.by[k].elasticity);
  }
  bars.groups = {group};
  return bars;
}

Plot over_time(const Result& result, std::size_t q) {
  const Gradient& g = result.gradients[q];
  Plot plot;
  plot.id = id_for("time-" + g.quantity.name);
  plot.title = fmt::format("How the derivatives of {} build up", g.quantity.name);
  plot.caption =
      "Each point is the elasticity of a run that ends there. Where it swings without end, the derivative is one "
      "of the steps and not of the physics.";
  plot.x = {.name = "length of the run", .unit = "s"};
  plot.y = {.name = "elasticity", .unit = "% per %"};
  for (std::size_t k = 0; k < g.by.size(); ++k) {
    Curve curve;
    curve.name = g.by[k].key.path;
    curve.colour = static_cast<int>(k % 7);
    curve.dash = static_cast<int>(k / 7);
    for (const auto& row : result.over_time) {
      if (!std::isfinite(row.value[q]) || row.value[q] == 0.0) continue;
      curve.x.push_back(row.time);
      curve.y.push_back(row.slope[q][k] * g.by[k].key.value / row.value[q]);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

/// A figure over the steps of the keys, a curve for each that was checked: what is above 0 of `points(derivative)`, pairs
/// of a relative step and a value.
template <class Points>
Plot over_steps(const Gradient& g, const Points& points) {
  Plot plot;
  plot.x = {.name = "step of the key", .unit = "% of its value", .logarithmic = true};
  for (std::size_t k = 0; k < g.by.size(); ++k) {
    const Derivative& d = g.by[k];
    if (!d.check) continue;
    Curve curve;
    curve.name = d.key.path;
    curve.colour = static_cast<int>(k % 7);
    curve.marks = true;
    for (const auto& [step, value] : points(d)) {
      if (!(value > 0.0)) continue;
      curve.x.push_back(100.0 * step);
      curve.y.push_back(value);
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}
using StepsAndValues = std::vector<std::pair<double, double>>;

Plot taylor(const Gradient& g) {
  Plot plot = over_steps(g, [](const Derivative& d) {
    StepsAndValues points;
    for (const Remainder& r : d.check->remainders) points.emplace_back(r.relative_step, r.with);
    return points;
  });
  plot.id = id_for("taylor-" + g.quantity.name);
  plot.title = fmt::format("Taylor remainders of {}", g.quantity.name);
  plot.caption =
      "What is left of a change after the derivative's share is taken off. It falls as the square of the step where "
      "the derivative is right, down to round-off.";
  plot.y = {.name = "remainder", .unit = g.quantity.unit, .logarithmic = true};
  return plot;
}

/// How far finite differences of any step are from the derivative.
Plot plateau(const Gradient& g) {
  Plot plot = over_steps(g, [](const Derivative& d) {
    StepsAndValues points;
    for (const CentralDifference& c : d.check->differences)
      points.emplace_back(c.relative_step, std::abs(c.value / d.value - 1.0));
    return points;
  });
  plot.id = id_for("differences-" + g.quantity.name);
  plot.title = fmt::format("Central differences of {}", g.quantity.name);
  plot.caption = "Of perturbed runs with the same steps, less the derivative, over the derivative.";
  plot.y = {.name = "relative difference", .logarithmic = true};
  return plot;
}

Table derivatives(const Gradient& g) {
  Table table;
  table.id = id_for("derivatives-" + g.quantity.name);
  table.title = fmt::format("Derivatives of {}", g.quantity.name);
  table.columns = {
      {.name = "Key", .text = true},
      {.name = "Value", .format = {report::Format::Kind::significant, 4}},
      {.name = "Unit", .text = true},
      {.name = "Derivative", .format = {report::Format::Kind::significant, 5}},
      {.name = "Elasticity", .format = {report::Format::Kind::significant, 4}},
      {.name = "Central difference", .format = {report::Format::Kind::significant, 5}},
      {.name = "Taylor slope", .format = {report::Format::Kind::significant, 3}},
      {.name = "Standard uncertainty", .format = {report::Format::Kind::significant, 3}},
      {.name = "Share of u input", .unit = "%", .format = {report::Format::Kind::significant, 3}}};
  for (const std::size_t k : by_weight(g)) {
    const Derivative& d = g.by[k];
    Table::Row row;
    const auto or_nothing = [](bool there, double x) { return there ? Table::Cell(x) : Table::Cell(); };
    row.cells = {d.key.path,
                 d.key.value,
                 d.key.unit,
                 d.value,
                 d.elasticity,
                 or_nothing(d.check.has_value(), d.check ? d.check->central_difference : 0.0),
                 or_nothing(d.check && !d.check->linear, d.check ? d.check->taylor_slope : 0.0),
                 or_nothing(d.sigma.has_value(), d.sigma.value_or(0.0)),
                 or_nothing(d.sigma.has_value(), 100.0 * g.input_share(d))};
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string answer(const Gradient& g) {
  const Derivative& first = g.by[by_weight(g).front()];
  std::string text = fmt::format("{} is {:.5g} {}. It hangs most on {}: 1 % more of it gives {:+.3g} %.",
                                 g.quantity.name, g.value, g.quantity.unit, first.key.path, first.elasticity);
  if (g.column)
    text += fmt::format(" Its column {} reads {:.5g} {}.", g.quantity.column, *g.column, g.quantity.unit);
  if (g.has_sigma())
    text += fmt::format(" The keys' uncertainties make ± {:.3g} {} of it.", g.input_uncertainty(),
                        g.quantity.unit);
  return text;
}

}  // namespace

std::string page_of(const Result& result) {
  Page page;
  page.kind = "gradient";
  page.title = result.scene.title;
  page.provenance = runs::provenance();
  page.data = json_of(result);
  for (const Gradient& g : result.gradients) {
    if (!g.doubt.empty())
      page.words.emplace_back(
          Text{fmt::format("The gradient of {} {}.", g.quantity.name, g.doubt), Text::Style::warning});
    page.words.emplace_back(report::Answer{fmt::format("What does {} hang on?", g.quantity.name), answer(g)});
  }
  const Cost& c = result.cost;
  page.words.emplace_back(report::Answer{
      "What did it cost?", fmt::format("The run took {} of CPU, its derivatives {} ({}, {} steps).",
                                       compare::words::duration(c.forward_cpu),
                                       compare::words::duration(c.gradient_cpu), result.mode, c.steps)});
  page.figure = tornado(result.gradients.front());
  for (std::size_t q = 0; q < result.gradients.size(); ++q) {
    const Gradient& g = result.gradients[q];
    Chapter chapter;
    chapter.id = id_for(g.quantity.name);
    chapter.heading = g.quantity.name;
    chapter.blocks.emplace_back(Text{fmt::format("It is {}.", g.quantity.meaning)});
    if (q > 0) chapter.blocks.emplace_back(tornado(g));
    chapter.blocks.emplace_back(derivatives(g));
    if (result.over_time.size() > 1 && !g.reaches) chapter.blocks.emplace_back(over_time(result, q));
    const bool checked = std::any_of(g.by.begin(), g.by.end(), [](const Derivative& d) { return !!d.check; });
    if (checked) {
      chapter.blocks.emplace_back(taylor(g));
      chapter.blocks.emplace_back(plateau(g));
    } else {
      chapter.blocks.emplace_back(
          Text{fmt::format(
                   "Checked along one direction of all keys: the derivative is {:.6g}, a central difference "
                   "{:.6g}. --check checks each key.",
                   g.directional, g.directional_difference),
               Text::Style::soft});
    }
    page.chapters.push_back(std::move(chapter));
  }
  return report::render(page);
}

}  // namespace flowrest::studies::gradient
