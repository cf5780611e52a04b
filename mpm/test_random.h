#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace flowrest::mpm::test {

/// Random numbers that are the same on every platform for the same seed (standard distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double between(double lowest, double highest) { return lowest + (highest - lowest) * uniform(); }
  /// Uniform in the logarithm; both bounds positive.
  double log_between(double lowest, double highest) { return lowest * std::pow(highest / lowest, uniform()); }
  int integer(int lowest, int highest) {
    return lowest + static_cast<int>(engine_() % static_cast<std::uint64_t>(highest - lowest + 1));
  }
  bool chance(double probability) { return uniform() < probability; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace flowrest::mpm::test
