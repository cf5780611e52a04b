#include "mpm/output/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <utility>

#include "mpm/cost.h"
#include "mpm/gauges/gauges.h"
#include "mpm/output/checkpoint.h"
#include "mpm/output/hand_over.h"
#include "mpm/output/noise.h"
#include "mpm/output/sections.h"
#include "mpm/output/snapshot.h"
#include "mpm/plain/solver.h"
#include "mpm/sampling/feed.h"
#include "mpm/sampling/sampling.h"
#include "mpm/solver/kernels.h"
#include "mpm/solver/settings.h"
#include "runs/command.h"
#include "runs/console.h"
#include "runs/depth.h"
#include "runs/earlier_run.h"
#include "runs/machine.h"
#include "runs/progress.h"
#include "runs/resolution.h"
#include "runs/run_folder.h"
#include "runs/verdict.h"
#include "scenes/pieces.h"
#include "scenes/step_limits.h"

namespace flowrest::mpm {

namespace {

/// More energy made by the discretisation than this share of the energy scale is an instability.
constexpr double energy_made_allowed = 0.05;
/// Time over which APIC's transfer acts once in scenes with walls of any shape, s. A duct between such walls,
/// five cells wide, carries 0.66 of what it should with plain APIC, 0.88 with this and 0.90 with 0.05.
constexpr double relaxation_time_beside_walls = 0.02;

/// When a run ends, s: where a row of the history falls on time.end but for round-off, the time that the row
/// has in a longer run.
double end_of(const scenes::Scene& scene) {
  const double interval = scene.output.history_interval;
  const double row = std::round(scene.time.end / interval) * interval;
  return row > 0.0 && std::abs(row - scene.time.end) <= 1e-12 * scene.time.end ? row : scene.time.end;
}

/// Where a run stands between the rows of its history.
struct Rows {
  double last;  ///< s
  double next;  ///< s
};
Rows rows_about(const RunState& state, const scenes::Scene& scene) {
  const double interval = scene.output.history_interval;
  return {(state.histories - 1.0) * interval, state.histories * interval};
}

class MpmRun {
 public:
  /// `start`: what the run begins with in place of the scene's body. `open` opens the run directory; what is
  /// missing is said before.
  MpmRun(const scenes::Scene& scene, const RunOptions& options, const std::optional<Checkpoint>& checkpoint,
         const std::optional<runs::MaterialState>& start, const std::function<runs::RunWriter()>& open)
      : scene_(scene),
        pieces_(scenes::pieces_of(scene)),
        options_(options),
        settings_(with_instruction_set(settings_of(scene), options.instruction_set)),
        feeds_(settings_, scene.mpm.particles_per_cell.back(), pieces_.whole_over_computed > 1.0,
               scene.thixotropy ? scene.thixotropy->initial_flocculation : 0.0),
        gauges_(scene_, pieces_),
        rest_(scene_),
        noise_(settings_.dimension, settings_.cell),
        factor_(pieces_.whole_over_computed),
        // Before anything is written: seeding may need a program that is missing.
        solver_(checkpoint     ? make(checkpoint->solver)
                : start        ? make(seeds_of_state(scene, *start))
                : feeds_.any() ? make(feeds_.due(0.0, first_feed_step))
                               : make(seeds_of(scene))),
        writer_(open()),
        sections_(options.directory, pieces_, settings_.cell,
                  checkpoint ? checkpoint->run.last_profile : -1.0),
        snapshots_(options.directory / "particles", scene, checkpoint ? checkpoint->run.last_snapshot : -1.0),
        progress_(fmt::format("mpm {} {}", scene.name, scenes::to_string(scene.material.model)),
                  scene.time.end, options.quiet) {
    if (checkpoint) {
      take_up(*checkpoint);
    } else {
      state_.largest_pressure = scenes::pressure_at_rest(scene);
      if (start) begin_with(*start);
      std::filesystem::remove(options.directory / "checkpoint.h5");
      writer_.info()["occupied_cells_at_start"] = solver_->occupied_cells();
    }
  }

  RunResult run() {
    try {
      describe();
      return loop();
    } catch (const std::exception&) {
      const runs::Failure failure = runs::failure_at_hand(cost(scene_).memory);
      note_failure(failure);
      runs::throw_again(failure);
    }
  }

 private:
  static SolverSettings with_instruction_set(SolverSettings s, const std::string& set) {
    s.instruction_set = set;
    return s;
  }

  void begin_with(const runs::MaterialState& start) {
    state_.time = start.time;
    for (const runs::Parcel& p : start.parcels)
      state_.largest_speed =
          std::max(state_.largest_speed, std::hypot(p.velocity[0], p.velocity[1], p.velocity[2]));
  }

  void take_up(const Checkpoint& checkpoint) {
    state_ = checkpoint.run;
    feeds_.skip_to(state_.time);
    noise_.restore(checkpoint.noise_meter);
    if (const auto history = options_.directory / "history.csv"; std::filesystem::exists(history))
      resolution_.continue_from(runs::read_csv(history));
    if (state_.calm_since >= 0.0) rest_.restore(state_.time, state_.calm_since);
    cpu_begin_ -= state_.cpu;
    wall_begin_ -= state_.wall;
    stages_before_ = state_.stages;
    // Their interval may be another one from here on.
    state_.checkpoints = 0.0;
    while (state_.checkpoints * scene_.output.checkpoint_interval * (1.0 - 1e-12) <= last_row())
      state_.checkpoints += 1.0;
  }

  template <class From>
  std::unique_ptr<Solver> make(const From& from) const {
    if (options_.method == Method::fast) return make_solver(settings_, from);
    if (const std::string what = plain::not_served(settings_); !what.empty())
      throw scenes::SceneError(
          fmt::format("{}: --method plain does not compute {}", scene_.path.string(), what));
    return plain::make_solver(settings_, from);
  }

  RunResult loop() {
    if (state_.histories == 0.0) {
      gauge();
      state_.initial_energy = total_energy();
      output();
    } else {
      measure();
      // What came to rest in the row that it is gone on from goes no further.
      const bool at_row = state_.steps > 0.0 && state_.time == last_row();
      if (at_row) rest_.add(state_.time, measures_.overstress_p99);
      const bool rests = at_row && rest_.at_rest();
      if (rests || state_.time >= end_) checkpoint();  // under the settings that it has now
      if (rests) return stop(runs::Status::at_rest, resolution_.limit_of_rest());
    }
    while (state_.time < end_) {
      if (options_.interrupted())
        return stop(runs::Status::interrupted,
                    "interrupted; go on with: " + runs::command_to_resume("mpm", options_.directory));
      advance();
      if (due(state_.histories, scene_.output.history_interval) || state_.time >= end_) {
        gauge();
        output();
        if (rest_.at_rest()) return stop(runs::Status::at_rest, resolution_.limit_of_rest());
      }
    }
    return stop(runs::Status::end_time, "");
  }

  double last_row() const { return rows_about(state_, scene_).last; }
  double next_row() const { return rows_about(state_, scene_).next; }
  /// Whether the steps since the last row are those of a longer run, too: the last ones before an end between
  /// two rows are shortened to meet it.
  bool is_shared_with_longer_runs() const { return next_row() <= end_ || state_.time == last_row(); }

  bool due(double made, double interval) const { return state_.time >= made * interval * (1.0 - 1e-12); }

  /// Time that the fastest wave needs across a cell, s.
  double cell_crossing_time() const {
    const double stiffening = 1.0 + settings_.state.exponent * std::max(state_.largest_pressure, 0.0) /
                                        settings_.state.bulk_modulus;
    const double sound = scene_.material.longitudinal_speed() * std::sqrt(stiffening);
    return settings_.cell / (sound + state_.largest_speed);
  }

  /// The step: fixed, or Courant-controlled with the stiffest pressure's sound speed and the largest speed
  /// (NUMERICS: the stable limit counts |v| too), shortened a little so that it lands on the next row of the
  /// history.
  double next_step() const {
    double step = scene_.mpm.time_step ? *scene_.mpm.time_step : scene_.mpm.cfl * cell_crossing_time();
    if (!scene_.mpm.time_step && settings_.explicit_fluid)
      step = std::min(step, scenes::step_limits(scene_).viscous);
    const double target = std::min(end_, next_row());
    const double left = target - state_.time;
    if (step >= left * (1.0 - 1e-12)) return left;
    return step > 0.5 * left ? 0.5 * left : step;
  }

  /// A step of Courant number 0.75, the default, is plain APIC; a shorter one smooths as much a second. The
  /// smoothing carries momentum into walls of any shape, whose nodes mirror nothing: beside them it acts
  /// more slowly (docs/method/walls.md).
  double apic_relaxation_time() const {
    const double whole = 0.75 * cell_crossing_time();
    const double usual = settings_.walls.empty() ? whole : std::max(whole, relaxation_time_beside_walls);
    return scene_.mpm.apic_relaxation_time.value_or(usual);
  }

  void advance() {
    const double step = next_step(), relaxation_time = apic_relaxation_time();
    solver_->set_apic_relaxation_time(relaxation_time);
    solver_->set_time(state_.time);
    const StepResult result = solver_->step(step, acceleration_at(scene_, state_.time));
    state_.step = step;
    state_.steps += 1.0;
    state_.largest_speed = result.largest_speed;
    state_.largest_pressure = result.largest_pressure;
    state_.dissipated += factor_ * result.dissipated;
    state_.work += factor_ * result.wall_work;
    if (!scene_.forces.body_force.empty())
      state_.work += factor_ * step * acceleration_at(scene_, state_.time)[0] * result.momentum;
    const double target = std::min(end_, next_row());
    const double begin = state_.time;
    state_.time = step >= target - state_.time ? target : state_.time + step;
    if (options_.on_step) options_.on_step({begin, step, state_.time, relaxation_time});
    feed(step);
    if (noise_.add(*solver_, step)) state_.noise.add(state_.time, noise_.noise());
    if (result.largest_speed > fastest_)
      throw runs::NumericsError(fmt::format(
          "a particle moves at {:.3g} m/s, faster than sound ({:.3g} m/s) and than any fall in this scene: "
          "the step or the material is unstable",
          result.largest_speed, scene_.material.longitudinal_speed()));
  }

  /// Lets in what is due. What it brings counts as work.
  void feed(double step) {
    const std::vector<Seed> come = feeds_.due(state_.time, step);
    if (come.empty()) return;
    for (const Seed& seed : come) {
      const auto& v = seed.velocity;
      const double height = (seed.cell[2] + seed.position[2]) * settings_.cell;
      state_.work += factor_ * seed.volume * settings_.density *
                     (0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + scene_.forces.gravity * height);
    }
    solver_->exchange({}, {}, come);
  }

  double total_energy() const {
    const Energies& e = measures_.energies;
    return e.kinetic + e.potential + e.elastic;
  }

  void gauge() {
    measure();
    check_bounds();
  }

  void measure() {
    measures_ = gauges_.measure(*solver_, state_.time);
    Energies& e = measures_.energies;
    e.dissipated = state_.dissipated;
    if (state_.steps > 0.0) e.numerical = state_.initial_energy + state_.work - total_energy() - e.dissipated;
  }

  void check_bounds() const {
    const double scale = std::max({std::abs(state_.initial_energy), state_.work, state_.dissipated});
    if (measures_.energies.numerical < -energy_made_allowed * scale)
      throw runs::NumericsError(
          fmt::format("the discretisation has made {:.3g} J of {:.3g} J: the step is unstable",
                      -measures_.energies.numerical, scale));
    if (!pieces_.domain) return;
    const scenes::Domain& domain = *pieces_.domain;
    if (measures_.body.farthest > domain.radius)
      throw runs::NumericsError(fmt::format(
          "the material has reached geometry.domain_radius = {} m at {:.4g} s: enlarge the domain",
          domain.radius, state_.time));
    if (measures_.highest > domain.height)
      throw runs::NumericsError(fmt::format(
          "the material has risen to geometry.domain_height = {} m at {:.4g} s", domain.height, state_.time));
  }

  void output() {
    const runs::Row layer = resolution_.add(state_.time, measures_.layer);
    writer_.history(gauges_.row(state_.time, state_.step, measures_, layer));
    if (options_.on_row) options_.on_row(state_.time);
    while (due(state_.histories, scene_.output.history_interval)) state_.histories += 1.0;
    if (due(state_.profiles, scene_.output.profile_interval)) {
      writer_.profile(state_.time, measures_.body.coordinate, measures_.body.value);
      sections_.write(state_.time, *solver_);
      state_.last_profile = state_.time;
      while (due(state_.profiles, scene_.output.profile_interval)) state_.profiles += 1.0;
    }
    if (due(state_.snapshots, scene_.output.snapshot_interval)) {
      snapshots_.write(state_.time, *solver_);
      state_.last_snapshot = state_.time;
      while (due(state_.snapshots, scene_.output.snapshot_interval)) state_.snapshots += 1.0;
    }
    rest_.add(state_.time, measures_.overstress_p99);
    noise_.begin();
    keep_checkpoint();
    std::string progress = fmt::format("t = {:.2f} s, {}", state_.time, measures_.body.words);
    if (const auto growth = rest_.growth_to_come())
      progress += fmt::format(", growth to come {:.2g} %", 100.0 * *growth);
    progress_.update(state_.time, progress);
  }

  /// At its interval, and where the run ends, so that it can be prolonged: in its last row that a longer run
  /// has, too.
  void keep_checkpoint() {
    const bool is_due = due(state_.checkpoints, scene_.output.checkpoint_interval) && state_.time > 0.0;
    while (due(state_.checkpoints, scene_.output.checkpoint_interval)) state_.checkpoints += 1.0;
    if (!is_shared_with_longer_runs()) return;
    if (is_due || next_row() > end_ || rest_.at_rest()) checkpoint();
  }

  /// m/s2
  double driving_acceleration() const {
    double driving = 0.0;
    for (const double a : acceleration_at(scene_, state_.time)) driving = std::max(driving, std::abs(a));
    return driving;
  }

  void checkpoint() {
    state_.calm_since = rest_.calm_since().value_or(-1.0);
    state_.cpu = runs::cpu_seconds() - cpu_begin_;
    state_.wall = runs::wall_seconds() - wall_begin_;
    state_.stages = stage_times();
    write_checkpoint(options_.directory, state_, *solver_, scenes::resolved_toml(scene_), noise_.state());
  }

  /// Of the whole run.
  StageTimes stage_times() const {
    const StageTimes& now = solver_->stage_times();
    StageTimes t = stages_before_;
    t.particles_to_grid += now.particles_to_grid;
    t.nodes += now.nodes;
    t.grid_to_particles += now.grid_to_particles;
    t.sorting += now.sorting;
    t.volumes += now.volumes;
    return t;
  }

  void describe() {
    auto& info = writer_.info();
    info["scheme"] = scenes::to_string(scene_.mpm.scheme);
    if (options_.method == Method::plain) info["method"] = "plain";
    info["precision"] = scenes::to_string(scene_.mpm.precision);
    info["instruction_set"] = solver_->instruction_set();
    info["threads"] = solver_->threads();
    info["cell_m"] = settings_.cell;
    info["particles"] = solver_->particle_count();
    writer_.write();
  }

  void summarise() {
    auto& info = writer_.info();
    const double cpu = runs::cpu_seconds() - cpu_begin_, wall = runs::wall_seconds() - wall_begin_;
    const double particle_steps = state_.steps * static_cast<double>(solver_->particle_count());
    info["simulated_s"] = state_.time;
    info["gauge"] = measures_.body.main;
    info["steps"] = static_cast<std::int64_t>(state_.steps);
    info["wall_s"] = wall;
    info["cpu_s"] = cpu;
    info["particle_steps_per_cpu_s"] = cpu > 0.0 ? particle_steps / cpu : 0.0;
    info["bytes_per_particle"] =
        static_cast<double>(solver_->bytes()) / static_cast<double>(solver_->particle_count());
    const StageTimes t = stage_times();
    info["stage_wall_s"] = {{"particles_to_grid", t.particles_to_grid},
                            {"nodes", t.nodes},
                            {"grid_to_particles", t.grid_to_particles},
                            {"sorting", t.sorting},
                            {"volumes", t.volumes}};
    const auto seen = [](const NoiseSeen& n, double bound) {
      return nlohmann::ordered_json{{"bound_share_of_speed", bound}, {"above_s", n.time}, {"path_m", n.path}};
    };
    info["noise"] = {{"within_cells", seen(state_.noise.within_cells, NoiseRecord::within_cells_bound)},
                     {"between_steps", seen(state_.noise.between_steps, NoiseRecord::between_steps_bound)},
                     {"path_allowed_m", NoiseRecord::path_allowed * scene_.body_height()}};
    info["resolution"] = resolution_.json();
    const auto number_of = [](const std::optional<double>& value) {
      return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    info["growth_to_come"] = number_of(rest_.growth_to_come());
    info["rest_time_s"] = number_of(rest_.rest_time());
  }

  /// Speeds below which a particle does not move at all: what it would move in a step is lost when it is
  /// added to its place in its cell. m/s
  double speed_lost_to_rounding() const {
    const bool single = scene_.mpm.precision == scenes::Precision::single_precision;
    const double rounding = 0.5 * (single ? double{std::numeric_limits<float>::epsilon()}
                                          : std::numeric_limits<double>::epsilon());
    return state_.step > 0.0 ? rounding * settings_.cell / state_.step : 0.0;
  }

  /// Whether what is lost could have moved the body visibly, or is as fast as its fall: it may only seem to
  /// be at rest.
  bool may_rest_by_rounding() const {
    const double lost = speed_lost_to_rounding(), length = scene_.body_height();
    const double driving = driving_acceleration();
    const double fall = std::min(driving * scene_.time.end, std::sqrt(2.0 * driving * length));
    return lost * scene_.time.end > 0.01 * length || (driving > 0.0 && lost > 0.1 * fall);
  }

  /// "sound", or what makes the run's numbers doubtful.
  std::string verdict() const {
    std::optional<double> depth_cells;
    if (pieces_.profile.radial())
      depth_cells =
          runs::centre_depth({measures_.body.coordinate, measures_.body.value}, scene_.gauges.spread_depth) /
          settings_.cell;
    return runs::with_resolution(noise_verdict(),
                                 resolution_.fault(pieces_.passage / settings_.cell, depth_cells));
  }

  /// "sound", or "noisy: " and why.
  std::string noise_verdict() const {
    const scenes::StepLimits limits = scenes::step_limits(scene_);
    if (may_rest_by_rounding())
      return fmt::format(
          "noisy: with steps of {:.2g} s what moves slower than {:.2g} m/s stands still by round-off",
          state_.step, speed_lost_to_rounding());
    if (state_.step > limits.viscous)
      return fmt::format("noisy: the explicit fluid's step of {:.2g} s is past its viscous limit of {:.2g} s",
                         state_.step, limits.viscous);
    if (scene_.mpm.time_step && *scene_.mpm.time_step > limits.largest())
      return fmt::format("noisy: the step of {:.2g} s is past the stable limit of {:.2g} s",
                         *scene_.mpm.time_step, limits.largest());
    if (const std::string noise = state_.noise.fault(scene_.body_height()); !noise.empty())
      return "noisy: " + noise;
    return "sound";
  }

  RunResult stop(runs::Status status, const std::string& reason) {
    if (status == runs::Status::interrupted) {
      if (is_shared_with_longer_runs()) checkpoint();
    } else if (state_.last_profile != state_.time) {
      writer_.profile(state_.time, measures_.body.coordinate, measures_.body.value);
      sections_.write(state_.time, *solver_);
    }
    if (status == runs::Status::at_rest && state_.last_snapshot != state_.time)
      snapshots_.write(state_.time, *solver_);
    summarise();
    writer_.finish(status, reason, verdict());
    print_summary(status);
    return {status, reason, state_.time, measures_.body.main};
  }

  void note_failure(const runs::Failure& failure) {
    summarise();
    writer_.fail({failure.fault, fmt::format("at {:.6g} s: {}", state_.time, failure.reason)});
    progress_.finish("failed");
  }

  void print_summary(runs::Status status) {
    const auto& info = writer_.info();
    const double wall = info["wall_s"], cpu = info["cpu_s"], steps = state_.steps;
    progress_.finish(fmt::format(
        "{} at {:.2f} s, {}; {:.0f} steps/s, {:.3g} particle-steps per CPU s, {:.3g} simulated s per hour",
        runs::to_string(status), state_.time, measures_.body.words, steps / wall,
        info["particle_steps_per_cpu_s"].get<double>(), 3600.0 * state_.time / wall));
    if (options_.quiet) return;
    const StageTimes t = stage_times();
    const double listed = t.particles_to_grid + t.nodes + t.grid_to_particles + t.sorting + t.volumes;
    std::string stages = fmt::format("  wall time per stage ({} threads, {}, {:.2f} CPU s):\n",
                                     solver_->threads(), solver_->instruction_set(), cpu);
    for (const auto& [name, seconds] :
         {std::pair{"particles to grid", t.particles_to_grid}, std::pair{"nodes", t.nodes},
          std::pair{"grid to particles", t.grid_to_particles}, std::pair{"sorting", t.sorting},
          std::pair{"volumes", t.volumes}, std::pair{"gauges and output", std::max(0.0, wall - listed)}})
      if (seconds > 0.0)
        stages += fmt::format("    {:<18} {:9.2f} s {:5.1f} %\n", name, seconds, 100.0 * seconds / wall);
    runs::say(stderr, stages);
  }

  scenes::Scene scene_;
  scenes::Pieces pieces_;
  RunOptions options_;
  SolverSettings settings_;
  Feeds feeds_;
  Gauges gauges_;
  runs::Rest rest_;
  NoiseMeter noise_;
  double factor_;
  double end_ = end_of(scene_);  ///< s
  /// m/s, than which nothing moves that is computed stably.
  double fastest_ = 2.0 * scene_.material.longitudinal_speed() + scenes::free_fall_speed(scene_);
  double cpu_begin_ = runs::cpu_seconds(), wall_begin_ = runs::wall_seconds();
  std::unique_ptr<Solver> solver_;
  runs::RunWriter writer_;
  SectionWriter sections_;
  SnapshotWriter snapshots_;
  runs::Progress progress_;
  RunState state_;
  runs::Resolution resolution_;
  StageTimes stages_before_;  ///< of earlier legs
  Measures measures_;
};

/// The instruction set to go on with.
std::string instruction_set_of(const runs::EarlierRun& earlier, const std::string& wanted) {
  const std::string before = earlier.info.value("instruction_set", "");
  if (!wanted.empty() || before.empty()) return wanted;
  const auto& known = instruction_sets();
  if (std::find(known.begin(), known.end(), before) != known.end()) return before;
  throw runs::RunError(
      fmt::format("{}: this run was begun with the instruction set {}, which this machine lacks; allowed: "
                  "--instruction-set "
                  "with one of {}, with which it goes on otherwise rounded",
                  earlier.directory.string(), before, fmt::join(known, ", ")));
}

/// @throws runs::RunError where the checkpoint is not one from which a run with these settings comes.
void check_suits(const Checkpoint& checkpoint, const runs::EarlierRun& earlier, const scenes::Scene& scene) {
  const std::filesystem::path file = earlier.directory / "checkpoint.h5";
  for (const std::string& key : runs::differing_settings(scenes::parse_scene(checkpoint.scene, file), scene))
    if (key != "time.end" && key != "time.stop_at_rest" && key != "mpm.threads" &&
        key != "output.checkpoint_interval")
      throw runs::RunError(
          fmt::format("{}: it is of a run with another {} than run.json has", file.string(), key));
  const Rows rows = rows_about(checkpoint.run, scene);
  runs::check_end(earlier, scene, checkpoint.run.time == rows.last ? rows.last : rows.next);
  if (settings_of(scene).explicit_fluid && !scene.mpm.time_step &&
      scenes::step_limits(scene).viscous != scenes::step_limits(earlier.scene).viscous)
    throw runs::RunError(
        fmt::format("{}: with mpm.fluid_update = explicit and thixotropy every step hangs on time.end, so "
                    "that the run cannot "
                    "be prolonged; allowed: its own time.end, {:g} s",
                    earlier.directory.string(), earlier.scene.time.end));
}

}  // namespace

namespace {

/// Memory may run out before the run begins, too.
template <class Make>
RunResult within_memory(const scenes::Scene& scene, Make make) {
  try {
    return make();
  } catch (const std::bad_alloc&) {
    runs::throw_again(runs::failure_at_hand(cost(scene).memory));
  }
}

using Start = std::optional<runs::MaterialState>;

/// What a run begins with where that is not its scene's body.
Start start_of(const scenes::Scene& scene, const std::string& from, const RunOptions& options) {
  if (from.empty()) return std::nullopt;
  Start start = options.read_state(from, scene);
  runs::check_start(scene, *start);
  return start;
}

/// What makes a run another one beside its settings.
nlohmann::ordered_json beside_settings(const RunOptions& options, const Start& start) {
  auto beside = nlohmann::ordered_json::object();
  if (options.method == Method::plain) beside["method"] = "plain";
  if (start) beside["started_from"] = runs::started_from_json(*start);
  return beside;
}

/// What a finished run came to.
RunResult result_of(const runs::RunFolder& folder) {
  const auto& info = folder.earlier();
  const auto number = [&](const char* key) {
    return info.contains(key) && info[key].is_number() ? info[key].get<double>() : runs::nothing;
  };
  return {*runs::status_from(info.value("status", "")), info.value("reason", ""), number("simulated_s"),
          number("gauge")};
}

RunResult run_in(runs::RunFolder folder, const scenes::Scene& scene, const RunOptions& options,
                 const Start& start) {
  if (folder.is_finished()) {
    if (!options.quiet) runs::say(stderr, folder.finished_words() + "\n");
    return result_of(folder);
  }
  return within_memory(scene, [&] {
    return MpmRun(scene, options, std::nullopt, start, [&] { return runs::RunWriter(std::move(folder)); })
        .run();
  });
}

}  // namespace

RunResult run(const scenes::Scene& scene, const RunOptions& options) {
  const auto replace = options.force ? runs::Replace::anything : runs::Replace::failed;
  const Start start = start_of(scene, options.from, options);
  return run_in(runs::RunFolder(options.directory, scene, "mpm", replace, beside_settings(options, start)),
                scene, options, start);
}

RunResult resume(const RunOptions& options, const std::vector<std::string>& set) {
  const runs::EarlierRun earlier = runs::read_earlier_run(options.directory, "mpm");
  runs::FolderLock lock(options.directory);
  const scenes::Scene scene =
      runs::scene_to_go_on_with(earlier, set, {"mpm.threads", "output.checkpoint_interval"});
  RunOptions leg = options;
  if (earlier.info.value("method", "") == "plain") leg.method = Method::plain;
  if (leg.method == Method::plain && !options.instruction_set.empty())
    throw runs::RunError(fmt::format(
        "{}: this run is computed with --method plain, which has no instruction set; allowed with "
        "--resume: --set, --json, --quiet",
        options.directory.string()));
  if (leg.method == Method::fast) leg.instruction_set = instruction_set_of(earlier, options.instruction_set);
  if (auto checkpoint = read_checkpoint(options.directory)) {
    check_suits(*checkpoint, earlier, scene);
    const RunState state = checkpoint->run;
    const auto open = [&] {
      return runs::RunWriter::resume(std::move(lock), scene, {state.time, state.time, state.last_profile});
    };
    return within_memory(scene, [&] {
      MpmRun resumed(scene, leg, checkpoint, std::nullopt, open);
      checkpoint.reset();  // the solver has taken it up
      return resumed.run();
    });
  }
  if (earlier.finished())
    throw runs::RunError(fmt::format(
        "{}: this run is finished and has no checkpoint.h5 from which it could be prolonged; run it anew, in "
        "another folder",
        options.directory.string()));
  const Start start = start_of(scene, runs::started_from(earlier.info), options);
  return run_in(
      runs::RunFolder(std::move(lock), scene, "mpm", runs::Replace::unfinished, beside_settings(leg, start)),
      scene, leg, start);
}

}  // namespace flowrest::mpm
