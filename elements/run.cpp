#include "elements/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "elements/fields.h"
#include "elements/readings.h"
#include "runs/console.h"
#include "runs/gauges.h"
#include "runs/machine.h"
#include "runs/progress.h"

namespace flowrest::elements {

namespace {

using Json = nlohmann::ordered_json;

/// Elements and steps of the coarser twin over those of the run.
constexpr double grid_factor = 1.5;
/// Rounding of the rounded twin over that of the run.
constexpr double rounding_factor = 4.0;

/// Of one length: what the coarser twin says of grid and step, taken as of first order in both, and what the
/// more rounded one says of the rounding, which is of first order. It never falls: where two runs cross they
/// agree by chance. m
struct Uncertainty {
  double grid = 0.0, rounding = 0.0;
  double sum() const { return grid + rounding; }
  void grow_to(const Uncertainty& other) {
    grid = std::max(grid, other.grid);
    rounding = std::max(rounding, other.rounding);
  }
};

/// A run and its twins, in step.
class Runs {
 public:
  Runs(const Problem& problem, const Resolution& resolution) : problem_(problem), run_(problem, resolution) {
    Resolution other = resolution.coarser(grid_factor);
    coarser_.emplace(problem, other);
    if (!problem.is_rounded()) return;
    other.rounding *= rounding_factor;
    rounder_.emplace(problem, other);
  }

  const Follower& run() const { return run_; }

  /// All to a time; the run's own steps end at `stop` at the latest.
  void reach(double time, double stop) {
    run_.reach(time, stop);
    coarser_->reach(time, problem_.end);
    if (rounder_) rounder_->reach(time, problem_.end);
  }

  Uncertainty uncertainty(double time, double Reading::*length) const {
    const double value = run_.at(time).*length, coarse = coarser_->at(time).*length;
    Uncertainty uncertainty{std::abs(value - coarse) / (grid_factor - 1.0), 0.0};
    if (rounder_)
      uncertainty.rounding = std::abs(rounder_->at(time).*length - coarse) / (rounding_factor - 1.0);
    return uncertainty;
  }

 private:
  Problem problem_;
  Follower run_;
  std::optional<Follower> coarser_, rounder_;
};

/// The k-th time of an interval, the end of the run at the latest.
double time_of(double k, double interval, double end) {
  const double time = k * interval;
  return time < end * (1.0 - 1e-12) ? time : end;
}

std::string model_name(const Problem& problem) {
  if (!laws::can_rest(problem.flow.law)) return laws::name_of(problem.flow.law);
  return problem.flow.parameters.flow_index == 1.0 ? "bingham" : "herschel-bulkley, not regularised";
}

class ElementRun {
 public:
  ElementRun(const scenes::Scene& scene, const Problem& problem, const RunOptions& options,
             runs::RunFolder folder)
      : problem_(problem),
        options_(options),
        resolution_(resolution_of(problem, options.columns)),
        runs_(problem, resolution_),
        writer_(std::move(folder)),
        fields_(options.directory / "fields"),
        progress_("elements " + scene.name, problem.end, options.quiet) {
    describe();
  }

  RunResult run() {
    try {
      return loop();
    } catch (const std::exception&) {
      const runs::Failure failure = runs::failure_at_hand(0.0);
      summarise();
      writer_.fail(failure);
      progress_.finish("failed");
      runs::throw_again(failure);
    }
  }

 private:
  void describe() {
    auto& info = writer_.info();
    info["model"] = model_name(problem_);
    info["label"] = "finite elements, " + model_name(problem_);
    info["source"] =
        "two-dimensional momentum by finite elements, rigid and incompressible (elements/README.md)";
    const auto resolution = [](const Resolution& r) {
      return Json{{"columns", r.columns}, {"rows", r.rows}, {"step_over_time", r.step_over_time}};
    };
    info["elements"] = {{"run", resolution(resolution_)},
                        {"coarser", resolution(resolution_.coarser(grid_factor))}};
    if (problem_.is_rounded())
      info["elements"]["rounding_1_s"] = {{"run", resolution_.rounding},
                                          {"more_rounded", rounding_factor * resolution_.rounding}};
    writer_.write();
  }

  RunResult loop() {
    for (double row = 0.0;; ++row) {
      if (options_.interrupted())
        return stop(runs::Status::interrupted, "interrupted; it can only be made anew");
      const double time = time_of(row, problem_.history_interval, problem_.end);
      reach(time);
      add_row(time);
      add_profile(time);
      if (time == problem_.end) return stop(runs::Status::end_time, "");
    }
  }

  double next_field() const { return time_of(fields_made_ + 1.0, problem_.field_interval, problem_.end); }

  /// All runs to a row's time, with the fields that fall due on the way.
  void reach(double time) {
    while (last_field_ < next_field() && next_field() <= time) {
      last_field_ = next_field();
      runs_.reach(last_field_, last_field_);
      fields_.write(runs_.run().slump());
      ++fields_made_;
    }
    runs_.reach(time, next_field());
  }

  void add_profile(double time) {
    const double interval = problem_.profile_interval;
    if (time < time_of(profiles_made_, interval, problem_.end)) return;
    const DepthProfile depths = runs_.run().profile(time);
    writer_.profile(time, depths.radius, depths.depth);
    while (profiles_made_ * interval * (1.0 - 1e-12) <= time) ++profiles_made_;
  }

  void add_row(double time) {
    row_ = runs_.run().at(time);
    uncertainty_.grow_to(runs_.uncertainty(time, &Reading::spread));
    of_height_.grow_to(runs_.uncertainty(time, &Reading::height));
    using namespace runs::column;
    runs::Row row;
    row.add(runs::column::time, time)
        .add(spread, row_.spread)
        .add(spread_at_half_depth, row_.spread_half)
        .add(spread_at_twice_depth, row_.spread_double)
        .add(height, row_.height)
        .add(volume, row_.volume)
        .add(spread_uncertainty, uncertainty_.sum())
        .add(spread_by_grid, uncertainty_.grid)
        .add(spread_by_rounding, uncertainty_.rounding)
        .add(height_uncertainty, of_height_.sum());
    writer_.history(row);
    progress_.update(time, fmt::format("t = {:.2f} s, {}", time, shown()));
  }

  std::string shown() const {
    return fmt::format("{} ± {}", runs::shown_length("spread", row_.spread, problem_.spread_depth),
                       runs::millimetres(uncertainty_.sum(), problem_.spread_depth));
  }

  void summarise() {
    const StepRecord& record = runs_.run().slump().record();
    auto& info = writer_.info();
    info["simulated_s"] = row_.time;
    info["gauge"] = 1e3 * row_.spread;
    info["gauge_uncertainty"] = 1e3 * uncertainty_.sum();
    info["steps"] = record.steps;
    info["elements"]["iterations"] = record.iterations;
    info["elements"]["repeated_steps"] = record.repeated;
    info["elements"]["fronts_let_down"] = record.closed;
    info["elements"]["largest_divergence_1_s"] = record.largest_divergence;
    info["elements"]["volume_corrected"] = record.volume_corrected;
    info["wall_s"] = runs::wall_seconds() - wall_begin_;
    info["cpu_s"] = runs::cpu_seconds() - cpu_begin_;
  }

  RunResult stop(runs::Status status, const std::string& reason) {
    summarise();
    writer_.finish(status, reason, "sound");
    progress_.finish(fmt::format("{} at {:.2f} s, {}; {:.1f} CPU s", runs::to_string(status), row_.time,
                                 shown(), writer_.info()["cpu_s"].get<double>()));
    return {status, fmt::format("{}: {} at {:g} s, {}", writer_.info()["label"].get<std::string>(), shown(),
                                row_.time, runs::shown_length("centre", row_.height, problem_.spread_depth))};
  }

  Problem problem_;
  RunOptions options_;
  Resolution resolution_;
  Runs runs_;
  runs::RunWriter writer_;
  FieldWriter fields_;
  runs::Progress progress_;
  Reading row_;
  Uncertainty uncertainty_, of_height_;          ///< of the spread, of the height
  double fields_made_ = 0.0, last_field_ = 0.0;  ///< their number; s
  double profiles_made_ = 0.0;
  double cpu_begin_ = runs::cpu_seconds(), wall_begin_ = runs::wall_seconds();
};

}  // namespace

Resolution resolution_of(const Problem& problem, int columns) {
  constexpr double standard_columns = 60.0, creep_strain = 6e-3, rounding_over_rate = 1e-3;
  Resolution resolution;
  resolution.columns = columns;
  resolution.rows = std::max(2, static_cast<int>(std::lround(6.0 * columns / standard_columns)));
  resolution.step_over_time = 0.03 * standard_columns / columns;
  const auto& material = problem.flow.parameters;
  // The rate at which what flows resists as much as what holds; without a yield stress none.
  const double yields_at =
      std::pow(material.yield_stress / material.plastic_viscosity, 1.0 / material.flow_index);
  resolution.rounding = creep_strain / problem.end;
  if (material.yield_stress > 0.0 || material.flow_index == 1.0)
    resolution.rounding = std::min(resolution.rounding, rounding_over_rate * yields_at);
  return resolution;
}

RunResult run(const scenes::Scene& scene, const RunOptions& options) {
  const Problem problem = problem_of(scene);
  runs::RunFolder folder(options.directory, scene, "exact", options.replace,
                         {{"method", "elements"}, {"columns", options.columns}});
  if (folder.is_finished()) return {runs::Status::end_time, folder.finished_words()};
  return ElementRun(scene, problem, options, std::move(folder)).run();
}

}  // namespace flowrest::elements
