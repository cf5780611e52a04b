#pragma once

#include "mpm/simd/math.h"

/// Registers as values: a node record of four, and as many particles as one register holds. Part of the
/// kernels, which are compiled once per instruction set, each time in the namespace FLOWREST_KERNEL_SPACE:
/// nothing here or in what includes it may use library templates, whose instances a linker would merge across
/// instruction sets.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Four values of one node record.
template <class T>
struct RecordOf;
template <>
struct RecordOf<float> {
  typedef float type __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct RecordOf<double> {
  typedef double type __attribute__((vector_size(32), aligned(8), may_alias));
};
template <class T>
using Record = typename RecordOf<T>::type;

/// As many particles as one register of this instruction set holds.
template <class T>
struct LanesOf;
template <>
struct LanesOf<float> {
  typedef float type __attribute__((vector_size(FLOWREST_LANE_BYTES), aligned(4), may_alias));
};
template <>
struct LanesOf<double> {
  typedef double type __attribute__((vector_size(FLOWREST_LANE_BYTES), aligned(8), may_alias));
};
template <class T>
using Lanes = typename LanesOf<T>::type;

template <class T>
FLOWREST_INLINE Record<T>& record_at(T* p) {
  return *reinterpret_cast<Record<T>*>(p);
}
template <class T>
FLOWREST_INLINE const Record<T>& record_at(const T* p) {
  return *reinterpret_cast<const Record<T>*>(p);
}
template <class T>
FLOWREST_INLINE Lanes<T>& lanes_at(T* p) {
  return *reinterpret_cast<Lanes<T>*>(p);
}
template <class T>
FLOWREST_INLINE const Lanes<T>& lanes_at(const T* p) {
  return *reinterpret_cast<const Lanes<T>*>(p);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
