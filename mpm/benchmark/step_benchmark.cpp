// Whole steps of the material point solver, beside what this machine can do at most.
//
//   scripts/bench                                   everything
//   scripts/bench --benchmark_filter=full/44k       one of them
//
// `particle_steps` is per CPU second; `of_fma` is that rate over the machine's fused multiply-adds per
// second, measured in the same call, so that figures of different machines can be laid side by side.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "mpm/sampling/sampling.h"
#include "mpm/solver/settings.h"

namespace {

using namespace flowrest;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Fused multiply-adds per second of one core in double precision: independent chains, as wide as this
/// build's vectors.
double fma_per_second() {
  typedef double Wide __attribute__((vector_size(64)));
  Wide chain[8];
  for (int i = 0; i < 8; ++i) chain[i] = Wide{} + 1.0 + 0.1 * i;
  const Wide factor = Wide{} + 0.999999999, term = Wide{} + 1e-9;
  constexpr int rounds = 4'000'000;
  const double begin = seconds_now();
  for (int r = 0; r < rounds; ++r)
    for (auto& c : chain) c = c * factor + term;
  benchmark::DoNotOptimize(chain);
  return 8.0 * 8.0 * rounds / (seconds_now() - begin);
}

/// Bytes per second that one core moves through memory, reading and writing.
double bytes_per_second() {
  std::vector<double> from(1 << 24, 1.0), to(1 << 24, 2.0);
  const double begin = seconds_now();
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] * 1.5;
  benchmark::DoNotOptimize(to.data());
  return 16.0 * static_cast<double>(from.size()) / (seconds_now() - begin);
}

struct Case {
  std::string name;
  std::vector<std::string> set;
};

/// Steps of a slump in full flow: the state after `warm_up` s, so that particles are no longer a lattice.
void steps(benchmark::State& state, const Case& c, double fma, double bandwidth) {
  scenes::Overrides overrides;
  overrides.set = c.set;
  const scenes::Scene scene = scenes::load_scene("roussel-slump", overrides);
  const auto settings = mpm::settings_of(scene);
  const auto solver = mpm::make_solver(settings, mpm::seed_particles(scene));
  const double step = 0.5 * settings.cell / scene.material.longitudinal_speed();
  double time = 0.0;
  const auto advance = [&] {
    solver->step(step, mpm::acceleration_at(scene, time));
    time += step;
  };
  for (int i = 0; i < 60; ++i) advance();
  for (auto _ : state) advance();
  const auto particles = static_cast<double>(solver->particle_count());
  state.counters["particle_steps"] =
      benchmark::Counter(particles * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["particles"] = particles;
  state.counters["bytes_per_particle"] = static_cast<double>(solver->bytes()) / particles;
  state.counters["fma_per_s"] = fma;
  state.counters["bytes_per_s"] = bandwidth;
  state.counters["of_fma"] = benchmark::Counter(particles * static_cast<double>(state.iterations()) / fma,
                                                benchmark::Counter::kIsRate);
}

}  // namespace

int main(int argc, char** argv) {
  const double fma = fma_per_second(), bandwidth = bytes_per_second();
  const std::vector<std::string> quarter_44k = {"geometry.dimension=quarter", "mpm.cell=0.0063",
                                                "mpm.particles_per_cell=8", "mpm.threads=1"};
  const std::vector<std::string> quarter_1m = {"geometry.dimension=quarter", "mpm.cell=0.0022",
                                               "mpm.particles_per_cell=8", "mpm.threads=1"};
  std::vector<Case> cases;
  for (const auto& [size, base] : {std::pair{"44k", quarter_44k}, std::pair{"1M", quarter_1m}})
    for (const char* scheme : {"quadratic-apic", "linear-flip"})
      for (const char* precision : {"double", "float"}) {
        Case c{std::string("quarter/") + size + "/" + scheme + "/" + precision, base};
        c.set.push_back(std::string("mpm.scheme=") + scheme);
        c.set.push_back(std::string("mpm.precision=") + precision);
        cases.push_back(c);
      }
  cases.push_back({"quarter/44k/quadratic-apic/double/papanastasiou", quarter_44k});
  cases.back().set.push_back("material.model=papanastasiou");
  cases.push_back({"quarter/44k/quadratic-apic/double/thixotropic", quarter_44k});
  for (const char* key : {"thixotropy.flocculation_rate=0.4", "thixotropy.deflocculation_coefficient=0.15",
                          "thixotropy.initial_flocculation=0.5"})
    cases.back().set.push_back(key);
  cases.push_back({"axisymmetric/2k/quadratic-apic/double", {"mpm.threads=1"}});
  cases.push_back({"axisymmetric/33k/quadratic-apic/double", {"mpm.threads=1", "mpm.cell=0.0025"}});
  for (const auto& c : cases)
    benchmark::RegisterBenchmark(c.name.c_str(), [c, fma, bandwidth](benchmark::State& s) {
      steps(s, c, fma, bandwidth);
    })->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
