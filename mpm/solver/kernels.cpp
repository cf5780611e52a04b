#include "mpm/solver/kernels.h"

#include <algorithm>
#include <stdexcept>

namespace flowrest::mpm {

#define FLOWREST_DECLARE_KERNELS(space)                \
  namespace space {                                    \
  Kernels<double> kernels_double(int, bool, Transfer); \
  Kernels<float> kernels_float(int, bool, Transfer);   \
  }
FLOWREST_DECLARE_KERNELS(kernels_generic)
#ifdef FLOWREST_X86_64
FLOWREST_DECLARE_KERNELS(kernels_avx2)
FLOWREST_DECLARE_KERNELS(kernels_avx512)
#endif

std::vector<std::string> instruction_sets() {
  std::vector<std::string> sets;
#ifdef FLOWREST_X86_64
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    sets.push_back("avx512");
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) sets.push_back("avx2");
#endif
  sets.push_back("generic");
  return sets;
}

template <class T>
Kernels<T> kernels(const std::string& instruction_set, int dimension, bool axisymmetric, Transfer transfer) {
  const auto sets = instruction_sets();
  if (std::find(sets.begin(), sets.end(), instruction_set) == sets.end())
    throw std::invalid_argument("this machine or build does not have the instruction set '" +
                                instruction_set + "'");
  const auto pick = [&](auto of_double, auto of_float) {
    if constexpr (sizeof(T) == sizeof(double)) {
      return of_double(dimension, axisymmetric, transfer);
    } else {
      return of_float(dimension, axisymmetric, transfer);
    }
  };
#ifdef FLOWREST_X86_64
  if (instruction_set == "avx512") return pick(kernels_avx512::kernels_double, kernels_avx512::kernels_float);
  if (instruction_set == "avx2") return pick(kernels_avx2::kernels_double, kernels_avx2::kernels_float);
#endif
  return pick(kernels_generic::kernels_double, kernels_generic::kernels_float);
}

template Kernels<double> kernels<double>(const std::string&, int, bool, Transfer);
template Kernels<float> kernels<float>(const std::string&, int, bool, Transfer);

}  // namespace flowrest::mpm
