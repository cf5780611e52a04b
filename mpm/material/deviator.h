#pragma once

#include "mpm/simd/math.h"

/// Symmetric traceless tensors and velocity gradients, over any scalar.
namespace flowrest::mpm {

/// A symmetric traceless tensor; zz follows from the trace. In two dimensions xz and yz vanish and are not
/// carried; zz is the hoop component of an axisymmetric body or the one normal to the plane.
template <class T, int Dim>
struct Deviator;

template <class T>
struct Deviator<T, 2> {
  static constexpr int components = 3;
  T xx{}, yy{}, xy{};
  FLOWREST_INLINE T zz() const { return -(xx + yy); }
  /// Half of the double contraction with itself, s:s / 2.
  FLOWREST_INLINE T half_square() const { return T(0.5) * (xx * xx + yy * yy + zz() * zz()) + xy * xy; }
  FLOWREST_INLINE Deviator scaled(T a) const { return {xx * a, yy * a, xy * a}; }
  FLOWREST_INLINE Deviator plus(const Deviator& o, T a) const {
    return {xx + a * o.xx, yy + a * o.yy, xy + a * o.xy};
  }
};

template <class T>
struct Deviator<T, 3> {
  static constexpr int components = 5;
  T xx{}, yy{}, xy{}, xz{}, yz{};
  FLOWREST_INLINE T zz() const { return -(xx + yy); }
  FLOWREST_INLINE T half_square() const {
    return T(0.5) * (xx * xx + yy * yy + zz() * zz()) + xy * xy + xz * xz + yz * yz;
  }
  FLOWREST_INLINE Deviator scaled(T a) const { return {xx * a, yy * a, xy * a, xz * a, yz * a}; }
  FLOWREST_INLINE Deviator plus(const Deviator& o, T a) const {
    return {xx + a * o.xx, yy + a * o.yy, xy + a * o.xy, xz + a * o.xz, yz + a * o.yz};
  }
};

/// Velocity gradient of one particle: gradient[i][j] = d v_i / d x_j, 1/s; `hoop` is v_r / r where
/// axisymmetric, else 0.
template <class T, int Dim>
struct VelocityGradient {
  T g[Dim][Dim];
  T hoop{};
  FLOWREST_INLINE T divergence() const {
    T sum = hoop;
    for (int i = 0; i < Dim; ++i) sum += g[i][i];
    return sum;
  }
  /// Deviator of the strain rate D = sym(L); with it shear rates are sqrt(2 D*:D*), Yu et al. 2026, Eq. 32.
  FLOWREST_INLINE Deviator<T, Dim> strain_rate_deviator() const {
    const T third = divergence() * T(1.0 / 3.0);
    if constexpr (Dim == 2) {
      return {g[0][0] - third, g[1][1] - third, T(0.5) * (g[0][1] + g[1][0])};
    } else {
      return {g[0][0] - third, g[1][1] - third, T(0.5) * (g[0][1] + g[1][0]), T(0.5) * (g[0][2] + g[2][0]),
              T(0.5) * (g[1][2] + g[2][1])};
    }
  }
};

/// The incremental rotation of Hughes and Winget (1980), R = (I - W dt/2)^-1 (I + W dt/2): stress turns
/// rigidly with the spin W = skw(L), its invariants unchanged to round-off at any step.
template <class T>
FLOWREST_INLINE Deviator<T, 2> rotated(const Deviator<T, 2>& s, const VelocityGradient<T, 2>& l, T dt) {
  const T t = T(0.25) * dt * (l.g[0][1] - l.g[1][0]);  // W_xy dt / 2 = tan(angle / 2)
  const T scale = T(1) / (T(1) + t * t);
  const T cosine = (T(1) - t * t) * scale, sine = T(2) * t * scale;  // R = [c s; -s c]
  const T cc = cosine * cosine, ss = sine * sine, cs = cosine * sine;
  return {cc * s.xx + ss * s.yy + T(2) * cs * s.xy, ss * s.xx + cc * s.yy - T(2) * cs * s.xy,
          cs * (s.yy - s.xx) + (cc - ss) * s.xy};
}

template <class T>
FLOWREST_INLINE Deviator<T, 3> rotated(const Deviator<T, 3>& s, const VelocityGradient<T, 3>& l, T dt) {
  const T a = T(0.25) * dt * (l.g[2][1] - l.g[1][2]);  // q = axial vector of W dt / 2
  const T b = T(0.25) * dt * (l.g[0][2] - l.g[2][0]);
  const T c = T(0.25) * dt * (l.g[1][0] - l.g[0][1]);
  const T scale = T(2) / (T(1) + a * a + b * b + c * c);
  // R = I + scale (Q + Q Q), Q the cross-product matrix of q.
  const T r00 = T(1) - scale * (b * b + c * c), r01 = scale * (a * b - c), r02 = scale * (a * c + b);
  const T r10 = scale * (a * b + c), r11 = T(1) - scale * (a * a + c * c), r12 = scale * (b * c - a);
  const T r20 = scale * (a * c - b), r21 = scale * (b * c + a), r22 = T(1) - scale * (a * a + b * b);
  const T zz = s.zz();
  const T m00 = r00 * s.xx + r01 * s.xy + r02 * s.xz, m01 = r00 * s.xy + r01 * s.yy + r02 * s.yz,
          m02 = r00 * s.xz + r01 * s.yz + r02 * zz;
  const T m10 = r10 * s.xx + r11 * s.xy + r12 * s.xz, m11 = r10 * s.xy + r11 * s.yy + r12 * s.yz,
          m12 = r10 * s.xz + r11 * s.yz + r12 * zz;
  return {m00 * r00 + m01 * r01 + m02 * r02, m10 * r10 + m11 * r11 + m12 * r12,
          m00 * r10 + m01 * r11 + m02 * r12, m00 * r20 + m01 * r21 + m02 * r22,
          m10 * r20 + m11 * r21 + m12 * r22};
}

/// The Jaumann rate taken explicitly, s + dt (W s - s W), Yu et al. 2026, Eq. 37: objective to first order in
/// the step.
template <class T>
FLOWREST_INLINE Deviator<T, 2> jaumann(const Deviator<T, 2>& s, const VelocityGradient<T, 2>& l, T dt) {
  const T w = T(0.5) * dt * (l.g[0][1] - l.g[1][0]);
  return {s.xx + T(2) * w * s.xy, s.yy - T(2) * w * s.xy, s.xy + w * (s.yy - s.xx)};
}

template <class T>
FLOWREST_INLINE Deviator<T, 3> jaumann(const Deviator<T, 3>& s, const VelocityGradient<T, 3>& l, T dt) {
  const T xy = T(0.5) * dt * (l.g[0][1] - l.g[1][0]);
  const T xz = T(0.5) * dt * (l.g[0][2] - l.g[2][0]);
  const T yz = T(0.5) * dt * (l.g[1][2] - l.g[2][1]);
  const T zz = s.zz();
  return {s.xx + T(2) * (xy * s.xy + xz * s.xz), s.yy + T(2) * (yz * s.yz - xy * s.xy),
          s.xy + xy * (s.yy - s.xx) + xz * s.yz + yz * s.xz, s.xz + xz * (zz - s.xx) + xy * s.yz - yz * s.xy,
          s.yz + yz * (zz - s.yy) - xy * s.xz - xz * s.xy};
}

}  // namespace flowrest::mpm
