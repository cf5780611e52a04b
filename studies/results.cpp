#include "studies/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "compare/exact/exact_run.h"
#include "compare/words.h"
#include "runs/verdict.h"
#include "scenes/text.h"
#include "studies/quantities.h"
#include "studies/soundness.h"

namespace flowrest::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

std::string plain(const std::string& toml) {
  const bool quoted = toml.size() >= 2 && toml.front() == '"';
  return quoted ? toml.substr(1, toml.size() - 2) : toml;
}

/// A run that was read, with its point.
struct Read {
  Result result;
  std::optional<runs::Run> run;
};

void describe_run(Result& r, const runs::Run& run) {
  r.cpu = run.info.value("cpu_s", 0.0);
  r.wall = run.info.value("wall_s", 0.0);
  r.memory = run.info.value("peak_memory_bytes", 0.0);
  if (const auto p = run.info.find("provenance"); p != run.info.end()) {
    r.version = p->value("git_hash", "");
    r.machine = p->value("cpu", "");
  }
}

void judge(Result& r, const runs::Run& run) {
  const std::string verdict = run.info.value("verdict", "");
  const std::string wrong = unsound(run, *r.point.scene);
  const runs::Doubt doubt = runs::doubt_of(verdict);
  if (!wrong.empty() && (verdict == "sound" || doubt.under_resolved)) {
    r.verdict = Verdict::unsound;  // too few cells are no excuse for what cannot be
    r.reason = wrong;
  } else if (verdict != "sound") {
    r.verdict = doubt.under_resolved && !doubt.noisy ? Verdict::under_resolved : Verdict::noisy;
    r.reason = wrong.empty() ? verdict : fmt::format("{}; {}", verdict, wrong);
  } else {
    r.verdict = Verdict::sound;
  }
}

Read read_point(const Folder& folder, const Point& point) {
  Read read;
  read.result.point = point;
  const Outcome outcome = outcome_of(folder, point);
  read.result.reason = outcome.reason;
  switch (outcome.ending) {
    case Ending::missing:
      return read;
    case Ending::refused:
      read.result.verdict = Verdict::refused;
      return read;
    case Ending::crashed:
      read.result.verdict = Verdict::crashed;
      return read;
    case Ending::too_long:
      read.result.verdict = Verdict::too_long;
      return read;
    case Ending::stopped:
    case Ending::finished:
      break;
  }
  read.run = runs::read_run(folder.run(point.id));
  describe_run(read.result, *read.run);
  if (outcome.ending == Ending::stopped)
    read.result.verdict = Verdict::stopped;
  else
    judge(read.result, *read.run);
  return read;
}

bool is_usable(const Read& read) {
  return read.run && (is_worth_its_error(read.result.verdict) || read.result.verdict == Verdict::noisy);
}

/// The reference's runs and what they say.
class ReferenceReader {
 public:
  ReferenceReader(const Folder& folder, const Study& study, std::vector<Read> runs,
                  std::vector<std::string>& notes)
      : folder_(folder), study_(study), runs_(std::move(runs)), notes_(notes) {
    using Kind = Reference::Kind;
    switch (study.reference.kind) {
      case Kind::none:
        break;
      case Kind::run:
        read_run_reference();
        break;
      case Kind::exact:
        read_exact();
        break;
      case Kind::richardson:
        read_richardson();
        break;
      case Kind::stated:
        for (const auto& [quantity, value] : study.reference.values)
          values_[quantity] = {value, stated_uncertainty(quantity), "stated: " + study.reference.source};
        break;
    }
    for (const std::string& quantity : study.quantities)
      if (is_difference(quantity) && run_)
        values_[quantity] = {0.0, difference_uncertainty(quantity),
                             "a difference from the reference's profile"};
  }

  const std::map<std::string, ReferenceValue>& values() const { return values_; }
  const runs::Run* run() const { return run_ ? &*run_ : nullptr; }

 private:
  std::optional<double> stated_uncertainty(const std::string& quantity) const {
    const auto found = study_.reference.uncertainty.find(quantity);
    return found == study_.reference.uncertainty.end() ? std::nullopt : std::optional(found->second);
  }

  /// How far the next coarser run of the reference is from it in the same measure.
  std::optional<double> difference_uncertainty(const std::string& quantity) const {
    if (const auto stated = stated_uncertainty(quantity)) return stated;
    const runs::Run* twin = nullptr;
    for (const Read& r : runs_)
      if (is_usable(r) && r.run->directory != run_->directory) twin = &*r.run;
    return twin ? measure(*twin, quantity, &*run_) : std::nullopt;
  }

  void read_run_reference() {
    const Read *reference = nullptr, *twin = nullptr;
    for (const Read& r : runs_) (r.result.point.role == Point::Role::reference ? reference : twin) = &r;
    if (!reference || !is_usable(*reference)) {
      notes_.push_back("The reference run is missing or unusable: no error can be given.");
      return;
    }
    run_ = reference->run;
    for (const std::string& quantity : study_.quantities) {
      const auto value = is_difference(quantity) ? std::nullopt : measure(*run_, quantity);
      if (!value) continue;
      ReferenceValue v{*value, stated_uncertainty(quantity), reference->result.point.label};
      const auto other = twin && is_usable(*twin) ? measure(*twin->run, quantity) : std::nullopt;
      if (!v.uncertainty && other) {
        v.uncertainty = std::abs(*other - *value);
        v.words += "; uncertain by its difference from " + twin->result.point.label;
      }
      values_[quantity] = v;
    }
  }

  void read_exact() {
    const Point& any = runs_.front().result.point;  // see collect: the scene itself
    const auto written = compare::exact::write_exact_runs(*any.scene, folder_.root / "reference");
    const std::string wanted = study_.reference.solution;
    std::vector<std::string> names;
    for (const auto& exact : written) {
      names.push_back(exact.directory.filename().string());
      if (!wanted.empty() && names.back() != wanted) continue;
      run_ = runs::read_run(exact.directory);
      break;
    }
    if (!run_)
      throw scenes::SceneError(fmt::format("{}: the scene has no solution {}; allowed: {}",
                                           study_.reference.where.text(), scenes::quoted(wanted),
                                           scenes::joined(names)));
    for (const std::string& quantity : study_.quantities)
      if (const auto value = is_difference(quantity) ? std::nullopt : measure(*run_, quantity))
        values_[quantity] = {*value, stated_uncertainty(quantity).value_or(0.0), run_->label()};
  }

  void read_richardson() {
    std::vector<const Read*> usable;
    for (const Read& r : runs_)
      if (is_usable(r)) usable.push_back(&r);
    if (usable.size() < 3) {
      notes_.push_back(
          fmt::format("Only {} of the {} runs that the reference is extrapolated from can be used: no error "
                      "can be given.",
                      usable.size(), runs_.size()));
      return;
    }
    const auto cell = [](const Read* r) { return std::stod(r->result.point.varied.back().value); };
    std::sort(usable.begin(), usable.end(), [&](auto* a, auto* b) { return cell(a) < cell(b); });
    run_ = usable.front()->run;
    for (const std::string& quantity : study_.quantities) {
      if (is_difference(quantity)) continue;
      std::vector<compare::GridValue> grids;
      for (std::size_t i = 0; i < 3; ++i)
        if (const auto value = measure(*usable[i]->run, quantity)) grids.push_back({cell(usable[i]), *value});
      if (grids.size() < 3) continue;
      const auto g = compare::grid_convergence(grids[0], grids[1], grids[2]);
      const bool extrapolate = g.convergence == compare::Convergence::monotone && *g.order >= 0.5;
      values_[quantity] = {
          extrapolate ? *g.extrapolated : grids[0].value, g.uncertainty,
          fmt::format("{} of {} = {:g}, {:g} and {:g}: {}",
                      extrapolate ? "Richardson extrapolation" : "the finest, not extrapolated,",
                      study_.reference.refine, grids[2].cell, grids[1].cell, grids[0].cell, g.words())};
    }
  }

  const Folder& folder_;
  const Study& study_;
  std::vector<Read> runs_;
  std::vector<std::string>& notes_;
  std::map<std::string, ReferenceValue> values_;
  std::optional<runs::Run> run_;
};

void add_errors(Result& r, const runs::Run& run, const Study& study, const ReferenceReader& reference) {
  for (const std::string& quantity : study.quantities) {
    const auto value = measure(run, quantity, reference.run());
    if (!value) continue;
    r.values[quantity] = *value;
    const auto known = reference.values().find(quantity);
    if (known == reference.values().end()) continue;
    if (is_difference(quantity))
      r.errors[quantity] = *value;
    else if (known->second.value != 0.0)
      r.errors[quantity] = std::abs(*value / known->second.value - 1.0);
  }
}

/// The reference's uncertainty as a share of its value: what an error cannot be told from.
double relative_uncertainty(const std::string& quantity, const ReferenceValue& reference) {
  if (is_difference(quantity)) return reference.uncertainty.value_or(0.0);
  return reference.value != 0.0 ? reference.uncertainty.value_or(0.0) / std::abs(reference.value) : 0.0;
}

/// Marks the runs of one solver that no cheaper one is as good as. Errors below the reference's uncertainty
/// cannot be told apart: there the cheapest wins.
void mark_pareto(Results& results, const std::string& quantity, Solver solver) {
  std::vector<Result*> candidates;
  for (Result& r : results.results)
    if (r.point.role == Point::Role::point && r.point.solver == solver && r.errors.contains(quantity) &&
        is_worth_its_error(r.verdict))
      candidates.push_back(&r);
  const double floor = relative_uncertainty(quantity, results.reference.at(quantity));
  const auto seen = [&](const Result* r) { return std::max(r->errors.at(quantity), floor); };
  std::sort(candidates.begin(), candidates.end(),
            [&](auto* a, auto* b) { return std::pair(a->cpu, seen(a)) < std::pair(b->cpu, seen(b)); });
  double best = std::numeric_limits<double>::infinity();
  for (Result* r : candidates) {
    r->pareto[quantity] = seen(r) < best;
    best = std::min(best, seen(r));
  }
}

/// What two runs of a sweep differ in, if it is one setting alone (or one choice of several).
std::optional<std::pair<std::string, std::pair<std::string, std::string>>> only_difference(const Result& a,
                                                                                           const Result& b) {
  std::string key, from, to;
  int differences = 0;
  std::set<std::string> keys;
  for (const auto* settings : {&a.point.varied, &b.point.varied})
    for (const Setting& s : *settings) keys.insert(s.key);
  const auto value = [](const Settings& settings, const std::string& k) {
    for (const Setting& s : settings)
      if (s.key == k) return plain(s.value);
    return std::string("as in the scene");
  };
  for (const std::string& k : keys) {
    const std::string x = value(a.point.varied, k), y = value(b.point.varied, k);
    if (x == y) continue;
    ++differences;
    key += (key.empty() ? "" : " and ") + k;
    from += (from.empty() ? "" : ", ") + x;
    to += (to.empty() ? "" : ", ") + y;
  }
  // Several settings may change together where one of the runs is the scene as it is.
  const bool together = differences > 1 && (a.point.varied.empty() || b.point.varied.empty());
  if (differences != 1 && !together) return std::nullopt;
  return std::pair(key, std::pair(from, to));
}

std::vector<Price> prices_of(const Results& results) {
  struct Samples {
    std::vector<double> cpu, memory;
    std::map<std::string, std::vector<double>> change, error_change;
  };
  std::map<std::vector<std::string>, Samples> all;
  for (std::size_t i = 0; i < results.results.size(); ++i)
    for (std::size_t j = i + 1; j < results.results.size(); ++j) {
      const Result &a = results.results[i], &b = results.results[j];
      if (a.point.role != Point::Role::point || b.point.role != Point::Role::point ||
          a.point.sweep != b.point.sweep || a.values.empty() || b.values.empty() || !(a.cpu > 0.0))
        continue;
      const auto difference = only_difference(a, b);
      if (!difference) continue;
      Samples& s =
          all[{a.point.sweep, difference->first, difference->second.first, difference->second.second}];
      s.cpu.push_back(b.cpu / a.cpu);
      if (a.memory > 0.0 && b.memory > 0.0) s.memory.push_back(b.memory / a.memory);
      for (const auto& [quantity, value] : a.values) {
        if (b.values.contains(quantity) && value != 0.0 && !is_difference(quantity))
          s.change[quantity].push_back(b.values.at(quantity) / value - 1.0);
        if (a.errors.contains(quantity) && b.errors.contains(quantity))
          s.error_change[quantity].push_back(b.errors.at(quantity) - a.errors.at(quantity));
      }
    }
  std::vector<Price> prices;
  for (const auto& [name, s] : all) {
    Price price{name[0], name[1], name[2], name[3], s.cpu.size(), median(s.cpu), 0.0, {}, {}};
    if (!s.memory.empty()) price.memory_ratio = median(s.memory);
    for (const auto& [quantity, v] : s.change) price.change[quantity] = median(v);
    for (const auto& [quantity, v] : s.error_change) price.error_change[quantity] = median(v);
    prices.push_back(std::move(price));
  }
  return prices;
}

void describe_limit(Results& results, double cell, std::size_t count, double scatter, bool second_grid) {
  const LimitWish& wish = *results.study.limit;
  const compare::Limit& limit = *results.limit;
  const std::string unit = unit_of(wish.quantity);
  const int decimals = compare::words::decimals_down_to(limit.uncertainty);
  results.limit_words =
      fmt::format("As {} grows, {} tends to {:.{}f} {}, with an uncertainty of {:.{}f} {}.", wish.key,
                  wish.quantity, limit.value, decimals, unit, limit.uncertainty, decimals, unit);
  if (!wish.compare_to_name.empty())
    results.limit_words +=
        fmt::format(" The {}, {:.{}f} {}, is {} that.", wish.compare_to_name, wish.compare_to, decimals, unit,
                    std::abs(limit.value - wish.compare_to) <= limit.uncertainty ? "within" : "not within");
  results.limit_basis = fmt::format(
      "The limit is that of {} values on cells of {:g} m, whose distance from it falls as {}^-{:.2f}; {}.",
      count, cell, wish.key, limit.exponent,
      second_grid
          ? fmt::format("on the next coarser cells they differ by up to {:.{}f} {}", scatter, decimals, unit)
          : std::string("no second grid says how far they are converged"));
}

/// The limit from the runs on the finest cells; coarser ones say how uncertain each value is.
void find_limit(Results& results) {
  if (!results.study.limit) return;
  const LimitWish& wish = *results.study.limit;
  std::map<double, std::map<double, double>> by_cell;  // cell -> parameter -> value
  for (const Result& r : results.results) {
    if (r.point.role != Point::Role::point || !r.values.contains(wish.quantity)) continue;
    const auto parameter = std::find_if(r.point.varied.begin(), r.point.varied.end(),
                                        [&](const Setting& s) { return s.key == wish.key; });
    if (parameter == r.point.varied.end()) continue;
    const double cell = r.point.solver == Solver::mpm ? r.point.scene->mpm.cell : r.point.scene->foam.cell;
    by_cell[cell][std::stod(parameter->value)] = r.values.at(wish.quantity);
  }
  if (by_cell.empty() || by_cell.begin()->second.size() < 3) {
    results.notes.push_back("The limit needs three values on one grid: it cannot be given.");
    return;
  }
  const auto& finest = by_cell.begin()->second;
  double scatter = 0.0;
  if (by_cell.size() > 1)
    for (const auto& [x, value] : finest)
      if (const auto coarse = std::next(by_cell.begin())->second.find(x);
          coarse != std::next(by_cell.begin())->second.end())
        scatter = std::max(scatter, std::abs(coarse->second - value));
  std::vector<double> x, value;
  for (const auto& [parameter, v] : finest) {
    x.push_back(parameter);
    value.push_back(v);
  }
  results.limit = compare::limit_of_growing(x, value, scatter);
  describe_limit(results, by_cell.begin()->first, x.size(), scatter, by_cell.size() > 1);
}

void find_notes(Results& results) {
  std::map<Verdict, int> count;
  std::set<std::string> versions, machines;
  for (const Result& r : results.results) {
    ++count[r.verdict];
    if (!r.version.empty()) versions.insert(r.version);
    if (!r.machine.empty()) machines.insert(r.machine);
  }
  const auto note = [&](Verdict v, const std::string& text) {
    if (count[v] > 0)
      results.notes.push_back(fmt::format("{} of {} runs {}", count[v], results.results.size(), text));
  };
  note(Verdict::missing, "are missing: the study is not complete.");
  note(Verdict::unsound, "are silently wrong: they call themselves sound and are not.");
  note(Verdict::crashed, "crashed.");
  note(Verdict::too_long, "took longer than the study allows.");
  if (versions.size() > 1)
    results.notes.push_back(fmt::format("The runs were made by {} versions of flowrest.", versions.size()));
  if (machines.size() > 1)
    results.notes.push_back(fmt::format(
        "The runs were made on {} kinds of processor: their CPU times do not compare.", machines.size()));
  for (const auto& [quantity, reference] : results.reference)
    if (!reference.uncertainty)
      results.notes.push_back(fmt::format("Nothing says how uncertain the reference's {} is.", quantity));
}

/// The cheapest run of each solver that is within an error, in words.
void find_findings(Results& results) {
  for (const std::string& quantity : results.study.quantities) {
    if (is_difference(quantity) || !results.reference.contains(quantity)) continue;
    const ReferenceValue& reference = results.reference.at(quantity);
    results.findings.push_back(fmt::format(
        "Reference {} = {:.4g} {}{}: {}.", quantity, reference.value, unit_of(quantity),
        reference.uncertainty ? fmt::format(" with an uncertainty of {:.2g}", *reference.uncertainty) : "",
        reference.words));
  }
  const auto main = std::find_if(results.study.quantities.begin(), results.study.quantities.end(),
                                 [&](const auto& q) { return results.reference.contains(q); });
  // A study that seeks a limit varies what is simulated: nearness to the reference is no merit of a run's.
  if (main == results.study.quantities.end() || results.study.limit) return;
  const double floor = relative_uncertainty(*main, results.reference.at(*main));
  if (floor > 0.0)
    results.findings.push_back(
        fmt::format("Errors of {} below {} cannot be told apart: the reference itself is that "
                    "uncertain.",
                    *main, compare::words::percent(floor)));
  for (const double bound : {0.1, 0.05, 0.02, 0.01}) {
    if (bound < floor) break;
    for (const Solver solver : {Solver::mpm, Solver::foam}) {
      const Result* cheapest = nullptr;
      for (const Result& r : results.results)
        if (r.point.role == Point::Role::point && r.point.solver == solver && is_worth_its_error(r.verdict) &&
            r.errors.contains(*main) && r.errors.at(*main) <= bound && (!cheapest || r.cpu < cheapest->cpu))
          cheapest = &r;
      if (cheapest)
        results.findings.push_back(fmt::format("{} within {}: {} for {} of CPU.", *main,
                                               compare::words::percent(bound), cheapest->point.label,
                                               compare::words::duration(cheapest->cpu)));
    }
  }
}

}  // namespace

bool is_worth_its_error(Verdict verdict) {
  return verdict == Verdict::sound || verdict == Verdict::under_resolved;
}

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::sound:
      return "sound";
    case Verdict::under_resolved:
      return "under-resolved";
    case Verdict::noisy:
      return "noisy";
    case Verdict::refused:
      return "refused";
    case Verdict::stopped:
      return "stopped";
    case Verdict::unsound:
      return "silently wrong";
    case Verdict::crashed:
      return "crashed";
    case Verdict::too_long:
      return "too long";
    case Verdict::missing:
      return "missing";
  }
  throw std::logic_error("a verdict without a name");
}

Results collect(const Folder& folder, const Study& study, const std::vector<Point>& points,
                const std::string& cut) {
  Results results;
  results.study = study;
  results.cut = cut;
  std::vector<Read> reads, references;
  for (const Point& point : points)
    (point.role == Point::Role::point ? reads : references).push_back(read_point(folder, point));
  std::vector<Read> for_reference = references;
  if (study.reference.kind == Reference::Kind::exact)
    for (const Read& r : reads)
      if (r.result.point.scene && for_reference.empty()) for_reference.push_back(r);
  if (study.reference.kind == Reference::Kind::exact && for_reference.empty())
    throw scenes::SceneError(study.reference.where.text() + ": no point has a scene to solve exactly");
  const ReferenceReader reference(folder, study, std::move(for_reference), results.notes);
  results.reference = reference.values();
  for (auto* group : {&reads, &references})
    for (Read& r : *group) {
      if (r.run && r.result.verdict != Verdict::stopped) add_errors(r.result, *r.run, study, reference);
      results.results.push_back(std::move(r.result));
    }
  for (const auto& [quantity, value] : results.reference)
    for (const Solver solver : {Solver::mpm, Solver::foam}) mark_pareto(results, quantity, solver);
  results.prices = prices_of(results);
  find_limit(results);
  find_notes(results);
  find_findings(results);
  if (results.limit)
    results.findings.insert(results.findings.begin(), {results.limit_words, results.limit_basis});
  return results;
}

}  // namespace flowrest::studies
