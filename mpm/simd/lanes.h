#pragma once

#include "mpm/simd/math.h"

/// Registers as values: a node record of four, and as many particles as one register holds. Part of the
/// kernels, which are compiled once per instruction set, each time in the namespace FLOWREST_KERNEL_SPACE:
/// nothing here or in what includes it may use library templates, whose instances a linker would merge across
/// instruction sets.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// The widest register of this instruction set, and one that a few particles fill better.
constexpr int lane_bytes = FLOWREST_LANE_BYTES;
constexpr int narrow_lane_bytes = lane_bytes > 32 ? 32 : lane_bytes;

/// Four values of one node record, or the eight of a pair: one register where it is wide enough, otherwise
/// halves of it. The compiler has vectors wider than the instruction set too, but takes them through memory:
/// in double precision under AVX2 particles to grid took nine times as long for that.
template <class T, int Values>
constexpr bool fits_register = static_cast<int>(sizeof(T[Values])) <= lane_bytes;
template <class T, int Values, bool Fits = fits_register<T, Values>>
struct RecordOf;
template <>
struct RecordOf<float, 4, true> {
  typedef float type __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct RecordOf<float, 8, true> {
  typedef float type __attribute__((vector_size(32), aligned(4), may_alias));
};
template <>
struct RecordOf<double, 2, true> {
  typedef double type __attribute__((vector_size(16), aligned(8), may_alias));
};
template <>
struct RecordOf<double, 4, true> {
  typedef double type __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct RecordOf<double, 8, true> {
  typedef double type __attribute__((vector_size(64), aligned(8), may_alias));
};
template <class T, int Values = 4>
using Record = typename RecordOf<T, Values>::type;

template <class T, int Values>
struct __attribute__((may_alias)) Halves {
  using Half = Record<T, Values / 2>;
  Half low, high;

  Halves() = default;
  constexpr FLOWREST_INLINE Halves(const Half& l, const Half& h) : low(l), high(h) {}
  constexpr FLOWREST_INLINE Halves(T a, T b, T c, T d) : low{a, b}, high{c, d} { static_assert(Values == 4); }
  FLOWREST_INLINE T operator[](int i) const { return i < Values / 2 ? low[i] : high[i - Values / 2]; }
  FLOWREST_INLINE Halves& operator+=(const Halves& b) { return *this = *this + b; }
  FLOWREST_INLINE Halves& operator-=(const Halves& b) { return *this = *this - b; }
  FLOWREST_INLINE Halves& operator*=(T b) { return *this = *this * b; }
  FLOWREST_INLINE Halves& operator*=(const Halves& b) { return *this = *this * b; }
  friend FLOWREST_INLINE Halves operator+(const Halves& a, const Halves& b) {
    return {a.low + b.low, a.high + b.high};
  }
  friend FLOWREST_INLINE Halves operator-(const Halves& a, const Halves& b) {
    return {a.low - b.low, a.high - b.high};
  }
  friend FLOWREST_INLINE Halves operator-(const Halves& a) { return {-a.low, -a.high}; }
  friend FLOWREST_INLINE Halves operator*(const Halves& a, const Halves& b) {
    return {a.low * b.low, a.high * b.high};
  }
  friend FLOWREST_INLINE Halves operator*(const Halves& a, T b) { return {a.low * b, a.high * b}; }
  friend FLOWREST_INLINE Halves operator*(T a, const Halves& b) { return b * a; }
};
template <class T, int Values>
struct RecordOf<T, Values, false> {
  using type = Halves<T, Values>;
};

/// As many particles as a register of `Bytes` holds.
template <class T, int Bytes>
struct LanesOf {
  typedef T type __attribute__((vector_size(Bytes), aligned(sizeof(T)), may_alias));
};
template <class T, int Bytes = lane_bytes>
using Lanes = typename LanesOf<T, Bytes>::type;

template <int Values = 4, class T>
FLOWREST_INLINE Record<T, Values>& record_at(T* p) {
  return *reinterpret_cast<Record<T, Values>*>(p);
}
template <int Values = 4, class T>
FLOWREST_INLINE const Record<T, Values>& record_at(const T* p) {
  return *reinterpret_cast<const Record<T, Values>*>(p);
}
template <int Bytes = lane_bytes, class T>
FLOWREST_INLINE Lanes<T, Bytes>& lanes_at(T* p) {
  return *reinterpret_cast<Lanes<T, Bytes>*>(p);
}
template <int Bytes = lane_bytes, class T>
FLOWREST_INLINE const Lanes<T, Bytes>& lanes_at(const T* p) {
  return *reinterpret_cast<const Lanes<T, Bytes>*>(p);
}

/// Four records' numbers the other way round: row i takes number i of each.
template <class T>
FLOWREST_INLINE void transpose(Record<T> (&rows)[4]) {
  if constexpr (fits_register<T, 4>) {
    const Record<T> low_01 = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
    const Record<T> high_01 = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
    const Record<T> low_23 = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    const Record<T> high_23 = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    rows[0] = __builtin_shufflevector(low_01, low_23, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(low_01, low_23, 2, 3, 6, 7);
    rows[2] = __builtin_shufflevector(high_01, high_23, 0, 1, 4, 5);
    rows[3] = __builtin_shufflevector(high_01, high_23, 2, 3, 6, 7);
  } else {
    using Half = Record<T, 2>;
    const auto first = [](const Half& a, const Half& b) { return __builtin_shufflevector(a, b, 0, 2); };
    const auto second = [](const Half& a, const Half& b) { return __builtin_shufflevector(a, b, 1, 3); };
    const Record<T> a = rows[0], b = rows[1], c = rows[2], d = rows[3];
    rows[0] = {first(a.low, b.low), first(c.low, d.low)};
    rows[1] = {second(a.low, b.low), second(c.low, d.low)};
    rows[2] = {first(a.high, b.high), first(c.high, d.high)};
    rows[3] = {second(a.high, b.high), second(c.high, d.high)};
  }
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
