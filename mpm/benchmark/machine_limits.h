#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <ctime>
#include <vector>

/// What one core of this machine can do at most: the yardsticks of every figure.
namespace flowrest::mpm::bench {

/// CPU seconds of this process, all threads.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Fused multiply-adds per CPU second of one core in double precision: independent chains, as wide as this
/// build's vectors.
inline double fma_per_second() {
#if defined(__AVX512F__)
  constexpr int lanes = 8;
#elif defined(__AVX__)
  constexpr int lanes = 4;
#else
  constexpr int lanes = 2;
#endif
  typedef double Wide __attribute__((vector_size(lanes * sizeof(double))));
  constexpr int chains = 8, rounds = 4'000'000;
  Wide chain[chains];
  for (int i = 0; i < chains; ++i) chain[i] = Wide{} + 1.0 + 0.1 * i;
  const Wide factor = Wide{} + 0.999999999, term = Wide{} + 1e-9;
  const double begin = cpu_seconds();
  for (int r = 0; r < rounds; ++r)
    for (auto& c : chain) c = c * factor + term;
  benchmark::DoNotOptimize(chain);
  return double(lanes) * chains * rounds / (cpu_seconds() - begin);
}

/// Bytes per CPU second that one core moves through memory, reading and writing.
inline double bytes_per_second() {
  std::vector<double> from(1 << 24, 1.0), to(1 << 24, 2.0);
  const double begin = cpu_seconds();
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] * 1.5;
  benchmark::DoNotOptimize(to.data());
  return 16.0 * static_cast<double>(from.size()) / (cpu_seconds() - begin);
}

struct Limits {
  double fma = fma_per_second(), bandwidth = bytes_per_second();
};

}  // namespace flowrest::mpm::bench
