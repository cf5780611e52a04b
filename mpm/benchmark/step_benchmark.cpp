// The material point solver's kernels and whole steps, beside what this machine can do at most.
//
//   scripts/bench                                   everything
//   scripts/bench --benchmark_filter=quarter/44k    one of them
//   scripts/bench --features                        what each feature of a scene costs
//   scripts/bench --threads                         what all cores give over one, and cost beside other work
//
// `particle_steps` is per CPU second; `of_fma` and `of_bandwidth` are its arithmetic (one fused multiply-add
// a particle-step) and its memory traffic (every byte stored, once) over the machine's limits, measured in
// the same call, so that figures of different machines can be laid side by side. `*_ns` is wall time per
// particle-step in each stage.
#include <benchmark/benchmark.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "mpm/benchmark/feature_costs.h"
#include "mpm/benchmark/flowing_slump.h"
#include "mpm/benchmark/machine_limits.h"
#include "mpm/benchmark/thread_gain.h"
#include "mpm/material/flow_law.h"

namespace {

using namespace flowrest::mpm;
using namespace flowrest::mpm::bench;

struct Case {
  std::string name;
  std::vector<std::string> set;
};

void steps(benchmark::State& state, FlowingSlump& slump, const Limits& limits) {
  const StageTimes before = slump.solver().stage_times();
  for (auto _ : state) slump.advance();
  const StageTimes& after = slump.solver().stage_times();
  using benchmark::Counter;
  const double particle_steps = slump.particles() * static_cast<double>(state.iterations());
  const double bytes = static_cast<double>(slump.solver().bytes());
  const auto stage_ns = [&](double StageTimes::*stage) {
    return (after.*stage - before.*stage) / particle_steps * 1e9;
  };
  state.counters["particles"] = slump.particles();
  state.counters["particle_steps"] = Counter(particle_steps, Counter::kIsRate);
  state.counters["of_fma"] = Counter(particle_steps / limits.fma, Counter::kIsRate);
  state.counters["of_bandwidth"] =
      Counter(bytes * static_cast<double>(state.iterations()) / limits.bandwidth, Counter::kIsRate);
  state.counters["bytes_per_particle"] = bytes / slump.particles();
  state.counters["p2g_ns"] = stage_ns(&StageTimes::particles_to_grid);
  state.counters["nodes_ns"] = stage_ns(&StageTimes::nodes);
  state.counters["g2p_ns"] = stage_ns(&StageTimes::grid_to_particles);
  state.counters["sort_ns"] = stage_ns(&StageTimes::sorting);
  state.counters["volumes_ns"] = stage_ns(&StageTimes::volumes);
}

/// The return of a law alone, on states around yield that fit in the first-level cache.
template <class Law>
void return_map(benchmark::State& state, const Limits& limits) {
  constexpr int count = 512;
  std::vector<double> trial(count), stress(count), rate(count), lambda(count, 0.5);
  for (int i = 0; i < count; ++i) trial[static_cast<std::size_t>(i)] = 150.0 * i / count;
  FlowParameters<double> flow;
  flow.yield_stress = 50.0;
  flow.plastic_viscosity = 50.0;
  flow.flocculation_growth = 0.4;
  flow.deflocculation = 0.15;
  for (auto _ : state) {
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) {
      const auto r = Law::template relax<double>(flow, trial[i], 20.0, 5e-4, lambda[i], 0.0);
      stress[i] = r.stress;
      rate[i] = r.rate;
    }
    benchmark::DoNotOptimize(stress.data());
    benchmark::DoNotOptimize(rate.data());
    benchmark::ClobberMemory();
  }
  const double returns = count * static_cast<double>(state.iterations());
  state.counters["returns"] = benchmark::Counter(returns, benchmark::Counter::kIsRate);
  state.counters["of_fma"] = benchmark::Counter(returns / limits.fma, benchmark::Counter::kIsRate);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& [size, base] : {std::pair{"44k", quarter_44k()}, std::pair{"1M", quarter_1m()}})
    for (const char* scheme : {"quadratic-apic", "linear-flip"})
      for (const char* precision : {"double", "float"})
        all.push_back(
            {std::string("quarter/") + size + "/" + scheme + "/" + precision,
             with(base, {std::string("mpm.scheme=") + scheme, std::string("mpm.precision=") + precision})});
  all.push_back({"axisymmetric/2k/quadratic-apic/double", {"mpm.threads=1"}});
  all.push_back({"axisymmetric/33k/quadratic-apic/double", {"mpm.threads=1", "mpm.cell=0.0025"}});
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--features") == 0) {
    print_feature_costs();
    return 0;
  }
  if (argc == 2 && std::strcmp(argv[1], "--threads") == 0) {
    print_thread_gain();
    return 0;
  }
  const Limits limits;
  std::printf("one core of this machine: %.3g fused multiply-adds/s in double precision, %.3g bytes/s\n",
              limits.fma, limits.bandwidth);
  const auto add_return = [&](const char* name, void (*run)(benchmark::State&, const Limits&)) {
    benchmark::RegisterBenchmark(name, [run, limits](benchmark::State& s) { run(s, limits); });
  };
  add_return("return_map/elasto-viscoplastic", return_map<ElastoViscoplastic<false>>);
  add_return("return_map/elasto-viscoplastic/thixotropic", return_map<ElastoViscoplastic<true>>);
  add_return("return_map/bi-viscous", return_map<BiViscous<false>>);
  // Seeded when first asked for, and kept: the library asks several times for one figure. The last one alone,
  // for a million particles take a while to seed and much room.
  const auto seeded = std::make_shared<std::pair<std::string, std::unique_ptr<FlowingSlump>>>();
  for (const auto& c : cases())
    benchmark::RegisterBenchmark(c.name.c_str(), [c, limits, seeded](benchmark::State& s) {
      if (seeded->first != c.name) {
        seeded->second.reset();
        *seeded = {c.name, std::make_unique<FlowingSlump>(c.set)};
      }
      steps(s, *seeded->second, limits);
    })->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
