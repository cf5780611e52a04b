#include "mpm/benchmark/feature_costs.h"

#include <cstdio>
#include <filesystem>

#include "mpm/benchmark/turns.h"
#include "mpm/output/gauges.h"
#include "mpm/output/run.h"

namespace flowrest::mpm::bench {

namespace {

constexpr int turns = 15, steps_per_turn = 12;

struct Paired {
  double first_ns = 0.0, ratio = 0.0;  ///< per particle-step of the first; second over first
};

double time_of(FlowingSlump& slump) { return time_of_steps(slump, steps_per_turn, cpu_seconds); }

Paired compare(FlowingSlump without, FlowingSlump with_it) {
  std::vector<double> first, ratio;
  for (int turn = 0; turn < turns; ++turn) {
    first.push_back(time_of(without));
    ratio.push_back(time_of(with_it) / first.back());
  }
  return {median(first), median(ratio)};
}

void print(const char* what, const Paired& p) {
  std::printf("  %-64s %7.1f ns  x %.2f\n", what, p.first_ns, p.ratio);
  std::fflush(stdout);
}

/// Measures as often as a run does, every 50 ms.
Paired gauge_cost(FlowingSlump slump) {
  const Gauges gauges(slump.scene());
  std::vector<double> step, ratio;
  for (int turn = 0; turn < turns; ++turn) {
    step.push_back(time_of(slump));
    const double begin = cpu_seconds();
    gauges.measure(slump.solver(), 0.0);
    const double once = (cpu_seconds() - begin) / slump.particles() * 1e9;
    ratio.push_back(1.0 + once * slump.step() / 0.05 / step.back());
  }
  return {median(step), median(ratio)};
}

/// CPU seconds of a whole short run with its outputs.
double run_seconds(const std::vector<std::string>& set) {
  scenes::Overrides overrides;
  overrides.set = set;
  const scenes::Scene scene = scenes::load_scene("roussel-slump", overrides);
  const auto directory = std::filesystem::temp_directory_path() / "flowrest-feature-costs";
  std::filesystem::remove_all(directory);
  RunOptions options;
  options.directory = directory;
  options.quiet = true;
  const double begin = cpu_seconds();
  run(scene, options);
  const double seconds = cpu_seconds() - begin;
  std::filesystem::remove_all(directory);
  return seconds;
}

void print_output_costs() {
  const std::vector<std::string> silent = {"mpm.threads=1",
                                           "time.end=2",
                                           "output.history_interval=2",
                                           "output.profile_interval=2",
                                           "output.snapshot_interval=2",
                                           "output.checkpoint_interval=2"};
  const std::pair<const char*, const char*> features[] = {
      {"gauges every 50 ms, axisymmetric 10 mm", "output.history_interval=0.05"},
      {"profiles every 0.25 s", "output.profile_interval=0.25"},
      {"snapshots every second", "output.snapshot_interval=1"},
      {"checkpoints every second", "output.checkpoint_interval=1"}};
  for (const auto& [what, key] : features) {
    std::vector<double> first, ratio;
    for (int turn = 0; turn < 5; ++turn) {
      first.push_back(run_seconds(silent));
      ratio.push_back(run_seconds(with(silent, {key})) / first.back());
    }
    std::printf("  %-64s %7.2f s   x %.2f\n", what, median(first), median(ratio));
  }
}

}  // namespace

void print_feature_costs() {
  const auto base = quarter_44k();
  const auto added = [&](const std::vector<std::string>& more) {
    return compare(FlowingSlump(base), FlowingSlump(with(base, more)));
  };
  std::printf("what a feature costs (without it, CPU time per particle-step; factor with it)\n");
  print("smooth B-bar for the cell average",
        compare(FlowingSlump(with(base, {"mpm.b_bar=cell-average"})), FlowingSlump(base)));
  print("density correction",
        compare(FlowingSlump(with(base, {"mpm.density_correction=0"})), FlowingSlump(base)));
  print("thixotropy", added({"thixotropy.flocculation_rate=0.4", "thixotropy.deflocculation_coefficient=0.15",
                             "thixotropy.initial_flocculation=0.5"}));
  print("Papanastasiou's law for the elasto-viscoplastic one", added({"material.model=papanastasiou"}));
  print("APIC that acts over 20 ms, for one that acts in every step",
        compare(FlowingSlump(base), FlowingSlump(base, {}, 0.02)));
  print("a wall of friction for one that is held by the grid (both over 20 ms)",
        compare(FlowingSlump(base, {}, 0.02),
                FlowingSlump(with(base, {"walls.base={ friction = 0.3 }"}), {}, 0.02)));
  print("gauges every 50 ms", gauge_cost(FlowingSlump(base)));
  print("linear-flip for quadratic-apic", added({"mpm.scheme=linear-flip"}));
  print("double for float", compare(FlowingSlump(with(base, {"mpm.precision=float"})), FlowingSlump(base)));
  const auto linear =
      with(base, {"mpm.scheme=linear-flip"});  // centroids go with linear functions, as in `paper`
  print("B-bar by cell average for the centroid's (linear-flip)",
        compare(FlowingSlump(linear, [](SolverSettings& s) { s.dilatation = Dilatation::centroid; }),
                FlowingSlump(linear)));
  print("the third dimension (per particle-step, for axisymmetric)",
        compare(FlowingSlump({"mpm.threads=1", "mpm.cell=0.0025"}), FlowingSlump(base)));
  print_output_costs();
}

}  // namespace flowrest::mpm::bench
