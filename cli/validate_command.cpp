#include "cli/validate_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>

#include "mpm/output/run.h"
#include "runs/process.h"
#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::cli {

namespace {

namespace fs = std::filesystem;

struct ValidateOptions {
  std::vector<std::string> scenes, set;
  std::string output = "out/validation", model;
  double coarsening = 4.0 / 3.0;  ///< of the second resolution
};

/// A published number, as a row of scenes/published.csv.
struct Published {
  std::string scene, quantity, mark, source;
  std::optional<double> measured, paper;
  double allowed = 0.0;
};

/// @throws RunError with the line at fault.
std::vector<Published> read_published() {
  const fs::path path = scenes::scenes_folder() / "published.csv";
  std::ifstream file(path);
  if (!file) throw runs::RunError(path.string() + ": no such file; expected: the published values");
  std::vector<Published> rows;
  int number = 0;
  bool header = true;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line[0] == '#' || std::exchange(header, false)) continue;
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (cells.size() != 7)
      throw runs::RunError(
          fmt::format("{}:{}: has {} cells; expected: 7", path.string(), number, cells.size()));
    const auto value = [&](std::size_t i) -> std::optional<double> {
      if (cells[i].empty()) return std::nullopt;
      try {
        return std::stod(cells[i]);
      } catch (const std::exception&) {
        throw runs::RunError(fmt::format("{}:{}: '{}' is no number; expected: a number or nothing",
                                         path.string(), number, cells[i]));
      }
    };
    rows.push_back({cells[0], cells[1], cells[5], cells[6], value(2), value(3), value(4).value_or(0.0)});
  }
  return rows;
}

/// When a column first passes a threshold, interpolated between rows of the history; nothing where it never
/// does.
std::optional<double> first_passing(const runs::Table& history, const std::string& column, double threshold,
                                    bool upwards) {
  const auto& time = history.at("time_s");
  const auto& value = history.at(column);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (upwards ? value[i] < threshold : value[i] > threshold) continue;
    if (i == 0 || value[i] == value[i - 1]) return time[i];
    return std::lerp(time[i - 1], time[i], (threshold - value[i - 1]) / (value[i] - value[i - 1]));
  }
  return std::nullopt;
}

/// The value that a run gives for a published quantity.
std::optional<double> value_of(const runs::Run& run, const scenes::Scene& scene,
                               const std::string& quantity) {
  constexpr double clear =
      3.0;  // mm of material that still hides the light: the depth at which fronts are read
  if (quantity == "arrival_s")
    return first_passing(run.history, "front_mm", 1e3 * scene.l_box().channel_length - 1e-6, true);
  if (quantity == "light_s") return first_passing(run.history, "thinnest_sight_mm", clear, false);
  if (quantity == "rest_s")
    return run.info["rest_time_s"].is_number() ? std::optional<double>(run.info["rest_time_s"])
                                               : std::nullopt;
  return run.history.at(quantity).back();
}

/// One scene at one resolution.
runs::Run make_run(const std::string& name, double coarsening, const ValidateOptions& options,
                   scenes::Scene& scene) {
  scenes::Overrides overrides;
  overrides.set = options.set;
  if (!options.model.empty()) overrides.model = scenes::model_from_name(options.model);
  scene = scenes::load_scene(name, overrides);
  if (coarsening != 1.0) {
    overrides.set.push_back(fmt::format("mpm.cell={}", coarsening * scene.mpm.cell));
    scene = scenes::load_scene(name, overrides);
  }
  mpm::RunOptions run;
  run.directory = fs::path(options.output) / fmt::format("{}-{:.4g}mm", name, 1e3 * scene.mpm.cell);
  const runs::InterruptGuard guard;
  run.interrupted = [] { return runs::InterruptGuard::count() > 0; };
  const mpm::RunResult result = mpm::run(scene, run);
  if (result.status == runs::Status::interrupted) throw CLI::RuntimeError(130);
  return runs::read_run(run.directory);
}

std::string text(const std::optional<double>& value) { return value ? fmt::format("{:.4g}", *value) : ""; }

std::string verdict(const Published& p, const std::optional<double>& ours,
                    const std::optional<double>& uncertainty) {
  const std::optional<double> target = p.measured ? p.measured : p.paper;
  if (!target) return "nothing to compare with";
  if (!ours) return "**never happens**";
  const double miss = std::abs(*ours - *target);
  if (uncertainty && *uncertainty > p.allowed)
    return fmt::format("**unresolved**: the resolutions differ by more than {:g}", p.allowed);
  if (miss > p.allowed) return fmt::format("**misses** by {:.3g}, allowed {:g}", miss, p.allowed);
  if (p.mark == "circular") return "agrees, but the yield stress was computed back from it";
  if (p.mark == "calibrated") return "agrees; calibrated by the paper";
  return "agrees";
}

std::string row(const Published& p, const std::optional<double>& fine, const std::optional<double>& coarse,
                double cpu) {
  const std::optional<double> uncertainty =
      fine && coarse ? std::optional(std::abs(*fine - *coarse)) : std::nullopt;
  const std::optional<double> target = p.measured ? p.measured : p.paper;
  const std::optional<double> difference = fine && target ? std::optional(*fine - *target) : std::nullopt;
  return fmt::format("| `{}` | {} | {} | {} | {} | {} | {} | {} | {} | {:.0f} |\n", p.scene, p.quantity,
                     text(p.measured), text(p.paper), text(fine), text(difference), text(uncertainty), p.mark,
                     verdict(p, fine, uncertainty), cpu);
}

constexpr const char* head =
    "| scene | quantity | measured | paper's MPM | ours | difference | two resolutions differ by | mark | "
    "verdict | "
    "CPU s |\n|---|---|---|---|---|---|---|---|---|---|\n";

void validate(const ValidateOptions& options) {
  std::vector<Published> published = read_published();
  std::vector<std::string> names = options.scenes;
  if (names.empty())
    for (const Published& p : published)
      if (std::find(names.begin(), names.end(), p.scene) == names.end()) names.push_back(p.scene);
  for (const std::string& name : names)
    if (std::none_of(published.begin(), published.end(),
                     [&](const Published& p) { return p.scene == name; })) {
      scenes::load_scene(name);  // says so where there is no such scene
      throw scenes::SceneError(
          name + ": nothing published is known of it; allowed: a scene of scenes/published.csv");
    }
  fs::create_directories(options.output);
  std::string report = fmt::format("# Scenes against published values\n\n{}", head);
  for (const std::string& name : names) {
    scenes::Scene scene;
    const runs::Run coarse = make_run(name, options.coarsening, options, scene);
    const runs::Run fine = make_run(name, 1.0, options, scene);
    for (const Published& p : published) {
      if (p.scene != name) continue;
      const std::string line = row(p, value_of(fine, scene, p.quantity), value_of(coarse, scene, p.quantity),
                                   fine.info["cpu_s"].get<double>());
      report += line;
      fmt::print("{}", line);
      std::fflush(stdout);
    }
    // After each scene, so that an interrupted validation leaves what it has.
    runs::write_atomically(fs::path(options.output) / "validation.md", report);
  }
  fmt::print("{}\n", (fs::path(options.output) / "validation.md").string());
}

}  // namespace

void add_validate_command(CLI::App& app) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App* command =
      app.add_subcommand("validate", "Run scenes at two resolutions and hold them against published values");
  command->add_option("scene", options->scenes, "Scenes of scenes/published.csv, by name (all of them)");
  command->add_option("--model", options->model, "The model to run, in place of material.model");
  command->add_option("--set", options->set, "KEY=VALUE: override a key in all of them")
      ->allow_extra_args(false);
  command->add_option("--coarsening", options->coarsening, "Cell of the second resolution over the scene's")
      ->check(CLI::Range(1.01, 4.0))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Folder that receives the runs and validation.md")
      ->capture_default_str();
  command->callback([options] { validate(*options); });
}

}  // namespace flowrest::cli
