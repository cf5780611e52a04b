#pragma once

#include "mpm/simd/math.h"

/// Registers as values: a node record of four, and as many particles as one register holds. Part of the
/// kernels, which are compiled once per instruction set, each time in the namespace FLOWREST_KERNEL_SPACE:
/// nothing here or in what includes it may use library templates, whose instances a linker would merge across
/// instruction sets.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Four values of one node record, or the eight of a pair.
template <class T, int Values>
struct RecordOf;
template <>
struct RecordOf<float, 4> {
  typedef float type __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct RecordOf<float, 8> {
  typedef float type __attribute__((vector_size(32), aligned(4), may_alias));
};
template <>
struct RecordOf<double, 4> {
  typedef double type __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct RecordOf<double, 8> {
  typedef double type __attribute__((vector_size(64), aligned(8), may_alias));
};
template <class T, int Values = 4>
using Record = typename RecordOf<T, Values>::type;

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

template <int Values = 4, class T>
FLOWREST_INLINE Record<T, Values>& record_at(T* p) {
  return *reinterpret_cast<Record<T, Values>*>(p);
}
template <int Values = 4, class T>
FLOWREST_INLINE const Record<T, Values>& record_at(const T* p) {
  return *reinterpret_cast<const Record<T, Values>*>(p);
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
