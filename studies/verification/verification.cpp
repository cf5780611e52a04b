#include "studies/verification/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <mutex>
#include <thread>

#include "compare/words.h"
#include "runs/cores.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "runs/run_directory.h"

namespace flowrest::studies::verification {

namespace {

namespace fs = std::filesystem;

/// One grid of one case.
struct Task {
  std::size_t finding = 0, grid = 0;
  double cost = 0.0;
};

/// All grids of all cases, the dear ones first. A grid half as wide costs eight times as much in two
/// dimensions and time.
std::vector<Task> tasks_of(const std::vector<Finding>& findings) {
  std::vector<Task> tasks;
  for (std::size_t f = 0; f < findings.size(); ++f)
    for (std::size_t g = 0; g < findings[f].grids.size(); ++g) {
      const double ratio = findings[f].grids.back().grid / findings[f].grids[g].grid;
      tasks.push_back({f, g, findings[f].of.cost * std::pow(ratio, 3.0)});
    }
  std::stable_sort(tasks.begin(), tasks.end(), [](const Task& a, const Task& b) { return a.cost > b.cost; });
  return tasks;
}

/// What a computation's run says of itself; nothing where it made none.
runs::Doubt doubt_of_run(const fs::path& directory) {
  std::ifstream file(directory / "run.json");
  const auto info = nlohmann::json::parse(file, nullptr, false);
  return info.is_object() ? runs::doubt_of(info.value("verdict", "")) : runs::Doubt{};
}

void compute(const Case& c, Finding::OnGrid& grid, const Workplace& place) {
  const auto begin = std::chrono::steady_clock::now();
  try {
    fs::create_directories(place.folder);
    const Measured measured = c.compute(grid.grid, place);
    if (std::isfinite(measured.error) && std::isfinite(measured.value))
      grid.measured = measured;
    else
      grid.trouble = "the result is not finite";
    grid.doubt = doubt_of_run(place.folder / "run");
  } catch (const std::exception& error) {
    grid.trouble = error.what();
  }
  grid.cpu = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::string bound_words(const Case& c) {
  std::string words;
  if (c.largest_error) words += fmt::format("error at most {:g}", *c.largest_error);
  if (c.least_order) words += fmt::format("{}order at least {:g}", words.empty() ? "" : ", ", *c.least_order);
  return words;
}

}  // namespace

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (auto* group : {duct_cases, slump_cases, body_cases, derivative_cases})
    for (Case& c : group()) cases.push_back(std::move(c));
  return cases;
}

void judge(Finding& f) {
  f.orders.clear();
  std::vector<compare::GridValue> values, errors;
  for (const auto& g : f.grids)
    if (g.measured) {
      values.push_back({g.grid, g.measured->value});
      errors.push_back({g.grid, g.measured->error});
    }
  for (std::size_t i = 1; i < errors.size(); ++i)
    f.orders.push_back(errors[i].value < f.of.round_off ? std::nullopt
                                                        : compare::observed_order(errors[i - 1], errors[i]));
  f.convergence.reset();
  if (values.size() >= 3) {
    const std::size_t n = values.size();
    f.convergence = compare::grid_convergence(values[n - 1], values[n - 2], values[n - 3]);
  }
  f.judged = f.of.largest_error || f.of.least_order;
  f.passed = false;
  if (errors.size() != f.grids.size()) {
    const auto failed =
        std::find_if(f.grids.begin(), f.grids.end(), [](const auto& g) { return !g.measured; });
    f.judged = true;
    f.verdict = fmt::format("fails: nothing at {:g}: {}", failed->grid, failed->trouble);
    return;
  }
  if (!f.judged) {
    f.verdict = "no bound is stated";
    return;
  }
  const double error = errors.back().value;
  const runs::Doubt& doubt = f.grids.back().doubt;
  const bool ordered = !f.orders.empty() && f.orders.back();
  const double order = ordered ? f.orders.back().value_or(0.0) : 0.0;
  const bool small = !f.of.largest_error || error <= *f.of.largest_error;
  // An error of zero has no order and wants none.
  const bool steep = !f.of.least_order || error == 0.0 || (ordered && order >= *f.of.least_order);
  f.passed = small && steep;
  f.verdict = fmt::format("{}: {}", f.passed ? "holds" : "fails", bound_words(f.of));
  if (!small) f.verdict += fmt::format("; the error is {:.3g}", error);
  if (!steep) f.verdict += ordered ? fmt::format("; the order is {:.2f}", order) : "; there is no order";
  if (doubt.any()) f.verdict += fmt::format("; its finest grid is {}: {}", doubt.word(), doubt.why);
}

std::vector<Finding> verify(const std::vector<Case>& cases, const fs::path& folder, const Options& options) {
  std::vector<Finding> findings;
  for (const Case& c : cases) {
    if (options.quick && !c.quick) continue;
    if (!options.only.empty() && c.name.find(options.only) == std::string::npos &&
        c.variant.find(options.only) == std::string::npos)
      continue;
    Finding& f = findings.emplace_back();
    f.of = c;
    for (const double grid : c.grids) f.grids.push_back({grid, std::nullopt, "not computed", 0.0});
  }
  const std::vector<Task> tasks = tasks_of(findings);
  const runs::InterruptGuard guard;
  const auto interrupted = [] { return runs::InterruptGuard::count() > 0; };
  runs::Progress progress("verify", static_cast<double>(tasks.size()), options.quiet);
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex lock;
  const auto work = [&] {
    for (std::size_t t = next++; t < tasks.size() && !interrupted(); t = next++) {
      Finding& f = findings[tasks[t].finding];
      compute(f.of, f.grids[tasks[t].grid], {folder / "runs" / fmt::format("{:03d}", t), interrupted});
      const std::lock_guard hold(lock);
      ++done;
      progress.update(static_cast<double>(done), fmt::format("{} of {} computations", done, tasks.size()));
    }
  };
  const int jobs = options.jobs > 0 ? options.jobs : runs::cores();
  std::vector<std::jthread> workers;
  for (int i = 0; i < jobs; ++i) workers.emplace_back(work);
  workers.clear();  // waits for them
  for (Finding& f : findings) judge(f);
  progress.finish(fmt::format("{} of {} computations", done, tasks.size()));
  return findings;
}

}  // namespace flowrest::studies::verification
