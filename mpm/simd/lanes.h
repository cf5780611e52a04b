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
struct RecordOf<float, 16, true> {
  typedef float type __attribute__((vector_size(64), aligned(4), may_alias));
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

/// Two records of eight in a register of sixteen.
template <class T>
FLOWREST_INLINE Record<T, 16> twice(const Record<T, 8>& r) {
  return __builtin_shufflevector(r, r, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
}
template <class T>
FLOWREST_INLINE Record<T, 16> pair_of(T a, T b) {
  return Record<T, 16>{a, a, a, a, a, a, a, a, b, b, b, b, b, b, b, b};
}
template <class T>
FLOWREST_INLINE Record<T, 8> half_of(const Record<T, 16>& r, int half) {
  return half == 0 ? __builtin_shufflevector(r, r, 0, 1, 2, 3, 4, 5, 6, 7)
                   : __builtin_shufflevector(r, r, 8, 9, 10, 11, 12, 13, 14, 15);
}

/// The records of four particles, each of four numbers: in one register where it is wide enough.
template <class T, bool Fits = fits_register<T, 16>>
struct FourRecords {
  Record<T> of[4];

  /// From each number's values for the four particles.
  FLOWREST_INLINE FourRecords(const Record<T>& a, const Record<T>& b, const Record<T>& c, const Record<T>& d)
      : of{a, b, c, d} {
    transpose<T>(of);
  }
  /// Every particle's record times its own factor.
  FLOWREST_INLINE FourRecords times(const T* factors) const {
    FourRecords out = *this;
#pragma GCC unroll 4
    for (int n = 0; n < 4; ++n) out.of[n] *= factors[n];
    return out;
  }
  /// Every `stride` numbers one particle's record of `first` and then that of `second`.
  static FLOWREST_INLINE void write_pairs(T* to, int stride, const FourRecords& first,
                                          const FourRecords& second) {
#pragma GCC unroll 4
    for (int n = 0; n < 4; ++n) {
      record_at(to + n * stride) = first.of[n];
      record_at(to + n * stride + 4) = second.of[n];
    }
  }
};

template <class T>
struct FourRecords<T, true> {
  Record<T, 16> all;

  FLOWREST_INLINE FourRecords(const Record<T>& a, const Record<T>& b, const Record<T>& c,
                              const Record<T>& d) {
    const Record<T, 8> ab = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
    const Record<T, 8> cd = __builtin_shufflevector(c, d, 0, 1, 2, 3, 4, 5, 6, 7);
    all = __builtin_shufflevector(ab, cd, 0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
  }
  FLOWREST_INLINE FourRecords times(const T* factors) const {
    // Read as a whole register, of which the first four count (the workspace has room behind): the compiler
    // widens a narrow one in memory.
    const Record<T, 16>& f = record_at<16>(factors);
    FourRecords out = *this;
    out.all *= __builtin_shufflevector(f, f, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    return out;
  }
  static FLOWREST_INLINE void write_pairs(T* to, int stride, const FourRecords& first,
                                          const FourRecords& second) {
    const Record<T, 16>&a = first.all, &b = second.all;
    record_at<8>(to) = __builtin_shufflevector(a, b, 0, 1, 2, 3, 16, 17, 18, 19);
    record_at<8>(to + stride) = __builtin_shufflevector(a, b, 4, 5, 6, 7, 20, 21, 22, 23);
    record_at<8>(to + 2 * stride) = __builtin_shufflevector(a, b, 8, 9, 10, 11, 24, 25, 26, 27);
    record_at<8>(to + 3 * stride) = __builtin_shufflevector(a, b, 12, 13, 14, 15, 28, 29, 30, 31);
  }
};

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
