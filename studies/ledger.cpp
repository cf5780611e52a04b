#include "studies/ledger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>

#include "compare/measures/gauges.h"
#include "runs/csv.h"
#include "runs/output_file.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::studies::ledger {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> header = {"date",  "commit",    "sources", "quantity",    "solver", "settings",
                                         "value", "reference", "error",   "uncertainty", "cpu_s"};

/// Date, commit and sources of what runs now.
Entry of_today() {
  const auto from = runs::provenance();
  Entry entry;
  entry.date = from.value("written", std::string()).substr(0, 10);
  entry.commit = from.value("git_hash", std::string()).substr(0, 12);
  entry.sources = from.value("sources", std::string()).substr(0, 12);
  return entry;
}

std::string number(const std::optional<double>& value) { return value ? fmt::format("{:.10g}", *value) : ""; }

std::string row_of(const Entry& e) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{:.3g}\n", e.date, e.commit, e.sources,
                     runs::csv_field(e.quantity), runs::csv_field(e.solver), runs::csv_field(e.settings),
                     number(e.value), number(e.reference), number(e.error), number(e.uncertainty), e.cpu);
}

/// Mean and standard deviation of errors relative to their references.
struct Scatter {
  std::size_t count = 0;
  double sum = 0.0, squares = 0.0;
  void add(double value) {
    ++count;
    sum += value;
    squares += value * value;
  }
  double bias() const { return sum / static_cast<double>(count); }
  double deviation() const {
    if (count < 2) return report::none;
    const auto n = static_cast<double>(count);
    return std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1.0)));
  }
};

/// The last row of every key, in the order in which keys first appear.
std::vector<const Entry*> last_rows(const std::vector<Entry>& entries) {
  std::vector<const Entry*> last;
  std::map<std::string, std::size_t> place;
  for (const Entry& entry : entries) {
    const auto [at, is_new] = place.try_emplace(entry.key(), last.size());
    if (is_new)
      last.push_back(&entry);
    else
      last[at->second] = &entry;
  }
  return last;
}

report::Table scatter_table(const std::vector<Entry>& entries) {
  std::vector<std::string> order;
  std::map<std::string, Scatter> scatter;
  for (const Entry* entry : last_rows(entries)) {
    if (!entry->reference || !(std::abs(*entry->reference) > 0.0)) continue;
    // What stands before the colon is the scene; the quantity comes after it.
    const auto colon = entry->quantity.rfind(": ");
    const std::string name =
        (colon == std::string::npos ? entry->quantity : entry->quantity.substr(colon + 2)) + ", " +
        entry->solver;
    if (scatter.find(name) == scatter.end()) order.push_back(name);
    scatter[name].add(100.0 * (entry->value - *entry->reference) / std::abs(*entry->reference));
  }
  report::Table table;
  table.id = "scatter";
  table.title = "Bias and scatter of each quantity";
  table.caption = "Differences to the references over all settings and scenes, latest rows only.";
  table.columns = {{"quantity", "", {}, true}, {"rows", ""}, {"bias", "%"}, {"scatter", "%"}};
  for (const std::string& name : order) {
    const Scatter& s = scatter.at(name);
    table.rows.push_back({{name, static_cast<double>(s.count), s.bias(),
                           s.count > 1 ? report::Table::Cell(s.deviation()) : report::Table::Cell()}});
  }
  return table;
}

report::Table latest_table(const std::vector<Entry>& entries) {
  report::Table table;
  table.id = "latest";
  table.title = "Latest rows";
  table.caption = "Moved: how far the error grew since the row before; a star says beyond its uncertainty.";
  table.columns = {{"quantity", "", {}, true}, {"solver", "", {}, true},
                   {"settings", "", {}, true}, {"error", ""},
                   {"uncertainty", ""},        {"moved", ""},
                   {"commit", "", {}, true},   {"date", "", {}, true}};
  std::map<std::string, std::vector<const Entry*>> rows;
  for (const Entry& entry : entries) rows[entry.key()].push_back(&entry);
  for (const Entry* last : last_rows(entries)) {
    const auto& all = rows.at(last->key());
    report::Table::Row row;
    report::Table::Cell moved;
    if (all.size() > 1) {
      const auto change = changes({*all[all.size() - 2]}, {*last}).front();
      moved = change.growth;
      if (change.worse()) row.badge = "worse";
    }
    row.cells = {last->quantity,
                 last->solver,
                 last->settings,
                 last->error,
                 last->uncertainty ? report::Table::Cell(*last->uncertainty) : report::Table::Cell(),
                 moved,
                 last->commit,
                 last->date};
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Errors over the commits, a curve a solver and settings.
report::Plot plot_of(const std::string& quantity, const std::vector<const Entry*>& rows,
                     const std::vector<std::string>& commits, std::size_t index) {
  report::Plot plot;
  plot.id = fmt::format("quantity-{}", index);
  plot.title = quantity;
  plot.x = {.name = "commits, oldest first"};
  plot.y = {.name = "error"};
  std::map<std::string, std::size_t> curves;
  for (const Entry* row : rows) {
    const std::string name = row->solver + (row->settings.empty() ? "" : ", " + row->settings);
    const auto [at, is_new] = curves.try_emplace(name, plot.curves.size());
    if (is_new) {
      report::Curve curve;
      curve.name = name;
      curve.colour = static_cast<int>(plot.curves.size() % 7);
      curve.dash = static_cast<int>(plot.curves.size() / 7 % 8);
      curve.marks = true;
      plot.curves.push_back(std::move(curve));
    }
    report::Curve& curve = plot.curves[at->second];
    const auto place = std::find(commits.begin(), commits.end(), row->commit) - commits.begin();
    curve.x.push_back(static_cast<double>(place));
    curve.y.push_back(row->error);
    curve.hover.push_back(row->date + ", commit " + row->commit);
  }
  return plot;
}

}  // namespace

std::vector<Entry> entries_of(const std::vector<verification::Finding>& findings) {
  std::vector<Entry> entries;
  for (const auto& finding : findings)
    for (const auto& grid : finding.grids) {
      if (!grid.measured) continue;
      Entry entry = of_today();
      entry.quantity = finding.of.name + ": " + finding.of.norm;
      entry.solver = finding.of.variant;
      entry.settings = fmt::format("{} {:g}", finding.of.refined, grid.grid);
      entry.value = grid.measured->value;
      entry.reference = finding.of.exact_value;
      entry.error = grid.measured->error;
      // What a computation is uncertain by once its case is exactly known: its round-off.
      entry.uncertainty = finding.of.round_off;
      entry.cpu = grid.cpu;
      entries.push_back(std::move(entry));
    }
  return entries;
}

std::vector<Entry> entries_of(const validation::Validation& validation) {
  std::vector<Entry> entries;
  for (const auto& scene : validation.scenes)
    for (const validation::Number& number : scene.numbers) {
      const auto target = number.published.target();
      if (!number.ours || !target) continue;
      Entry entry = of_today();
      entry.quantity = scene.name + ": " + number.published.quantity;
      entry.solver = (number.solver == Solver::mpm ? "MPM " : "OpenFOAM ") + scenes::to_string(number.model);
      entry.value = *number.ours;
      entry.reference = target;
      entry.error = std::abs(*number.ours - *target);
      entry.uncertainty = number.uncertainty;
      for (const validation::Found& run : scene.runs)
        if (run.wanted.solver == number.solver && run.wanted.model == number.model && !run.wanted.coarse) {
          entry.cpu = run.cpu;
          entry.settings = fmt::format("cell {:g}", run.wanted.cell);
        }
      entries.push_back(std::move(entry));
    }
  return entries;
}

std::vector<Entry> read(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  const runs::CsvText text = runs::read_csv_text(path);
  if (text.header.cells != header)
    throw runs::RunError(fmt::format("{}: its columns are not a ledger's; needed: {}",
                                     text.place(text.header), runs::csv_header(header)));
  std::vector<Entry> entries;
  for (const auto& row : text.rows) {
    const auto cell = [&](std::size_t i) { return i < row.cells.size() ? row.cells[i] : std::string(); };
    const auto optional = [&](std::size_t i) {
      return cell(i).empty() ? std::nullopt : text.number(cell(i));
    };
    const auto needed = [&](std::size_t i) {
      const auto value = text.number(cell(i));
      if (!value) throw runs::RunError(fmt::format("{}: {} is no number", text.place(row), header[i]));
      return *value;
    };
    entries.push_back({cell(0), cell(1), cell(2), cell(3), cell(4), cell(5), needed(6), optional(7),
                       needed(8), optional(9), needed(10)});
  }
  return entries;
}

std::size_t append(const fs::path& path, const std::vector<Entry>& entries) {
  const std::vector<Entry> there = read(path);
  std::string rows;
  std::size_t added = 0;
  for (const Entry& entry : entries) {
    const bool known = std::any_of(there.begin(), there.end(), [&](const Entry& e) {
      return e.key() == entry.key() && e.sources == entry.sources;
    });
    if (known) continue;
    rows += row_of(entry);
    ++added;
  }
  if (added == 0) return 0;
  std::error_code error;
  std::string text;
  if (fs::exists(path, error)) {
    std::ifstream file(path, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(file), {});
    if (!text.empty() && text.back() != '\n') text += '\n';
  } else {
    if (path.has_parent_path()) fs::create_directories(path.parent_path());
    text = runs::csv_header(header) + "\n";
  }
  runs::write_atomically(path, text + rows);
  return added;
}

std::vector<Change> changes(const std::vector<Entry>& ledger, const std::vector<Entry>& now) {
  constexpr double told_apart = 0.01;  // of an error that does not say how well it is known
  std::map<std::string, const Entry*> last;
  for (const Entry& entry : ledger) last[entry.key()] = &entry;
  std::vector<Change> all;
  for (const Entry& entry : now) {
    const auto before = last.find(entry.key());
    if (before == last.end()) continue;
    Change change{*before->second, entry};
    change.growth = entry.error - change.before.error;
    change.bound = std::hypot(change.before.uncertainty.value_or(0.0), entry.uncertainty.value_or(0.0)) +
                   told_apart * std::abs(change.before.error);
    all.push_back(std::move(change));
  }
  return all;
}

std::shared_ptr<Asked> add_options(CLI::App& command) {
  auto asked = std::make_shared<Asked>();
  auto* file = command.add_option(
      "--ledger", asked->file, "An accuracy ledger: say what got worse since its last rows, and add these");
  command
      .add_flag("--compare-only", asked->compare_only,
                "Add no rows to the ledger, and do not fail for what got worse")
      ->needs(file);
  return asked;
}

bool enter(const Asked& asked, const std::vector<Entry>& now) {
  if (asked.file.empty()) return true;
  std::size_t worse = 0, known = 0;
  for (const Change& change : changes(read(asked.file), now)) {
    ++known;
    if (!change.worse()) continue;
    ++worse;
    fmt::print("!! worse than at {}: {}: {:.4g}, was {:.4g}; told apart from {:.2g} on\n",
               change.before.commit, change.now.key(), change.now.error, change.before.error, change.bound);
  }
  fmt::print("Of {} rows {} stand in {}; {} got worse\n", now.size(), known, asked.file, worse);
  if (asked.compare_only) return true;
  fmt::print("{} rows added\n", append(asked.file, now));
  return worse == 0;
}

report::Page page_of(const std::vector<Entry>& entries) {
  report::Page page;
  page.kind = "ledger";
  page.title = "Accuracy, commit by commit";
  page.provenance = runs::provenance();
  std::vector<std::string> commits, quantities;
  std::map<std::string, std::vector<const Entry*>> by_quantity;
  for (const Entry& entry : entries) {
    if (std::find(commits.begin(), commits.end(), entry.commit) == commits.end())
      commits.push_back(entry.commit);
    auto& rows = by_quantity[entry.quantity];
    if (rows.empty()) quantities.push_back(entry.quantity);
    rows.push_back(&entry);
  }
  page.words.push_back(report::Text{fmt::format("{} rows of {} quantities over {} commits.", entries.size(),
                                                quantities.size(), commits.size()),
                                    report::Text::Style::opening});
  nlohmann::ordered_json data = nlohmann::ordered_json::array();
  for (const Entry& e : entries)
    data.push_back({{"date", e.date},
                    {"commit", e.commit},
                    {"sources", e.sources},
                    {"quantity", e.quantity},
                    {"solver", e.solver},
                    {"settings", e.settings},
                    {"value", e.value},
                    {"error", e.error}});
  page.data = {{"format", "flowrest ledger"}, {"format_version", 1}, {"rows", std::move(data)}};
  page.chapters.push_back({"latest-rows", "What is known today", {latest_table(entries)}});
  page.chapters.push_back({"bias", "Bias and scatter", {scatter_table(entries)}});
  report::Chapter plots{"over-commits", "Over the commits", {}};
  for (std::size_t i = 0; i < quantities.size(); ++i)
    plots.blocks.push_back(plot_of(quantities[i], by_quantity.at(quantities[i]), commits, i));
  page.chapters.push_back(std::move(plots));
  return page;
}

}  // namespace flowrest::studies::ledger
