#pragma once

#include <limits>

#include "mpm/material/deviator.h"
#include "mpm/material/flow_law.h"
#include "mpm/solver/kernels.h"

/// Strain to stress for a tile of particles, whatever the law.
namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// A tile's state while its stress is updated.
template <class T, int Dim>
struct Strain {
  T* gradient[Dim][Dim];  ///< 1/s
  T* hoop;                ///< 1/s, axisymmetric only
  T* dilatation;          ///< 1/s, averaged
  T* deviator[Deviator<T, Dim>::components];
  T* ratio;
  T* pressure;
  T* rate;
  T* lambda;
  T* shear;   ///< G dt, Pa s
  T* trial;   ///< Pa
  T* stress;  ///< Pa
};

template <class T, int Dim>
FLOWREST_INLINE VelocityGradient<T, Dim> gradient_of(const Strain<T, Dim>& s, int q, bool axisymmetric) {
  VelocityGradient<T, Dim> l;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) l.g[i][j] = s.gradient[i][j][q];
  l.hoop = axisymmetric ? s.hoop[q] : T(0);
  return l;
}

/// Volume, pressure and the elastic trial. For an explicit fluid the "trial" is 2 D*, whose invariant is the
/// shear rate.
template <class T, int Dim, bool Axisymmetric, StressRate Rate, bool Explicit>
void make_trial(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  const T dt = step.step;
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const VelocityGradient<T, Dim> l = gradient_of(s, q, Axisymmetric);
    const T dilatation = dt * s.dilatation[q];
    // Yu et al. 2026, Eq. 30, to second order.
    const T ratio = s.ratio[q] * (T(1) + dilatation + T(0.5) * dilatation * dilatation);
    const auto state = step.state.at(ratio);
    const Deviator<T, Dim> rate = l.strain_rate_deviator();
    Deviator<T, Dim> dev;
    if constexpr (Explicit) {
      dev = rate.scaled(T(2));
    } else {
      if constexpr (Dim == 2) {
        dev = {s.deviator[0][q], s.deviator[1][q], s.deviator[2][q]};
      } else {
        dev = {s.deviator[0][q], s.deviator[1][q], s.deviator[2][q], s.deviator[3][q], s.deviator[4][q]};
      }
      if constexpr (Rate == StressRate::hughes_winget) {
        dev = rotated(dev, l, dt);
      } else {
        dev = jaumann(dev, l, dt);
      }
      dev = dev.plus(rate, T(2) * state.shear * dt);  // Eq. 37
    }
    s.ratio[q] = ratio;
    s.pressure[q] = state.pressure;
    s.shear[q] = state.shear * dt;
    s.trial[q] = square_root(dev.half_square());
    s.deviator[0][q] = dev.xx;
    s.deviator[1][q] = dev.yy;
    s.deviator[2][q] = dev.xy;
    if constexpr (Dim == 3) {
      s.deviator[3][q] = dev.xz;
      s.deviator[4][q] = dev.yz;
    }
  }
}

template <class T, int Dim, class Law>
void relax_closed(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const T lambda = Law::thixotropic ? s.lambda[q] : T(0);
    const Relaxed<T> r =
        Law::template relax<T>(step.flow, s.trial[q], s.shear[q], step.step, lambda, s.rate[q]);
    s.stress[q] = r.stress;
    s.rate[q] = r.rate;
    if constexpr (Law::thixotropic) s.lambda[q] = r.lambda;
  }
}

/// Staggered thixotropy of the fluids: lambda with the last step's rate, returned with the yield stress it
/// gives.
template <class T, int Dim, bool Thixotropic>
FLOWREST_INLINE T fluid_yield(const StepParameters<T>& step, const Strain<T, Dim>& s, int q) {
  if constexpr (!Thixotropic) {
    return step.flow.yield_stress;
  } else {
    return step.flow.yield_stress * (T(1) + s.lambda[q]) + step.flow.grown;
  }
}

template <class T, int Dim, bool Power>
void flocculate(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  const T dt = step.step;
#pragma omp simd
  for (int q = 0; q < count; ++q) s.lambda[q] = flocculated<Power>(step.flow, dt, s.lambda[q], s.rate[q]);
}

/// Newton's method on all particles of a tile at once until the slowest has converged.
template <class T, int Dim, bool Thixotropic, bool Power>
void relax_papanastasiou(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  using Law = Papanastasiou<Thixotropic>;
  if constexpr (Thixotropic) flocculate<T, Dim, Power>(step, s, count);
  const T tolerance = sizeof(T) == 8 ? T(1e-14) : T(2e-6);  // of the trial's stress
  for (int iteration = 0; iteration < 100; ++iteration) {
    T change = T(0);
#pragma omp simd reduction(max : change)
    for (int q = 0; q < count; ++q) {
      const T before = s.rate[q];
      const auto next = Law::template iterate<T>(step.flow, fluid_yield<T, Dim, Thixotropic>(step, s, q),
                                                 s.trial[q], s.shear[q], before);
      const T relative = (next.residual > T(0) ? next.residual : -next.residual) / (s.trial[q] + T(1e-30));
      // A particle that balances stays as it is, so that its result does not depend on its neighbours in the
      // tile.
      s.rate[q] = relative > tolerance ? next.rate : before;
      change = change > relative ? change : relative;
    }
    if (!(change > tolerance)) break;
  }
#pragma omp simd
  for (int q = 0; q < count; ++q) s.stress[q] = s.trial[q] - s.shear[q] * s.rate[q];
}

/// Newton's method on some particles at once, each within what is known to hold its root and by bisection
/// where it would leave that, until the slowest has converged. A particle that balances stays as it is, so that
/// its result does not depend on its neighbours.
template <class T, int Dim, class Law>
void relax_bracketed(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  constexpr int most = 64;                                      // at once
  constexpr T tolerance = sizeof(T) == 8 ? T(1e-14) : T(2e-6);  // of the trial's stress
  for (int first = 0; first < count; first += most) {
    const int particles = count - first < most ? count - first : most;
    T low[most], high[most], lambda[most];
#pragma omp simd
    for (int i = 0; i < particles; ++i) {
      const int q = first + i;
      const Relaxed<T> start = Law::template start<T>(step.flow, s.trial[q], s.shear[q], step.step,
                                                      Law::thixotropic ? s.lambda[q] : T(0), s.rate[q]);
      s.rate[q] = start.rate;
      lambda[i] = start.lambda;
      low[i] = T(-1);  // no lower end is known yet
      // There the elastic relaxation alone takes more than all; not 0 where there is nothing to take.
      high[i] = T(1) + T(2) * s.trial[q] / s.shear[q];
    }
    for (int iteration = 0; iteration < 300; ++iteration) {
      T change = T(0);
#pragma omp simd reduction(max : change)
      for (int i = 0; i < particles; ++i) {
        const int q = first + i;
        const T rate = s.rate[q], below = low[i], above = high[i];
        const auto at =
            Law::template balance<T>(step.flow, s.trial[q], s.shear[q], step.step, lambda[i], rate);
        const T relative = (at.residual > T(0) ? at.residual : -at.residual) / (s.trial[q] + T(1e-30));
        const T new_below = at.residual > T(0) ? rate : below;
        const T new_above = at.residual > T(0) ? above : minimum(above, rate);
        const T tried = maximum(rate + at.residual / at.slope, T(0));
        const T next =
            tried > new_below && tried < new_above ? tried : T(0.5) * (maximum(new_below, T(0)) + new_above);
        const bool moves = tried != rate && next > new_below && next < new_above;
        const bool goes_on = relative > tolerance && moves;
        low[i] = new_below;
        high[i] = new_above;
        s.rate[q] = goes_on ? next : rate;
        change = goes_on && relative > change ? relative : change;
      }
      if (!(change > tolerance)) break;
    }
#pragma omp simd
    for (int i = 0; i < particles; ++i) {
      const int q = first + i;
      s.stress[q] = s.trial[q] - s.shear[q] * s.rate[q];
      if constexpr (Law::thixotropic)
        s.lambda[q] = Law::template lambda_at<T>(step.flow, step.step, lambda[i], s.rate[q]);
    }
  }
}

/// Explicit fluid: the stress of the present rate. `Curve` is `T(flow, yield, rate)`.
template <class T, int Dim, bool Thixotropic, bool Power, class Curve>
void relax_explicit(const StepParameters<T>& step, const Strain<T, Dim>& s, int count, const Curve& curve) {
  if constexpr (Thixotropic) flocculate<T, Dim, Power>(step, s, count);
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const T rate = s.trial[q];
    const T yield = fluid_yield<T, Dim, Thixotropic>(step, s, q);
    s.rate[q] = rate;
    s.stress[q] = curve(step.flow, yield, rate);
  }
}

template <class T, int Dim, bool Thixotropic, bool Power>
void relax_explicit_by_law(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  using Flow = FlowParameters<T>;
  switch (step.law) {
    case Law::papanastasiou:
      return relax_explicit<T, Dim, Thixotropic, Power>(step, s, count, [](const Flow& p, T yield, T rate) {
        return papanastasiou_stress(p, yield, rate);
      });
    case Law::herschel_bulkley:
      return relax_explicit<T, Dim, Thixotropic, Power>(step, s, count, [](const Flow& p, T yield, T rate) {
        return herschel_bulkley_stress(p, yield, rate);
      });
    case Law::elasto_viscoplastic:  // never explicit
    case Law::bi_viscous:
    case Law::newtonian:
      return relax_explicit<T, Dim, Thixotropic, Power>(
          step, s, count, [](const Flow& p, T yield, T rate) { return bi_viscous_stress(p, yield, rate); });
  }
}

template <class T, int Dim, bool Thixotropic, bool Power>
void relax_by_law(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  if (step.explicit_fluid) return relax_explicit_by_law<T, Dim, Thixotropic, Power>(step, s, count);
  switch (step.law) {
    case Law::elasto_viscoplastic:
      // A flow index of 1 keeps its closed form, unless breakdown goes by another power.
      return !Power && step.flow.flow_index == T(1)
                 ? relax_closed<T, Dim, ElastoViscoplastic<Thixotropic>>(step, s, count)
                 : relax_bracketed<T, Dim, ElastoViscoplasticPower<Thixotropic, Power>>(step, s, count);
    case Law::papanastasiou:
      return relax_papanastasiou<T, Dim, Thixotropic, Power>(step, s, count);
    case Law::bi_viscous:
      return relax_closed<T, Dim, BiViscous<Thixotropic, Power>>(step, s, count);
    case Law::herschel_bulkley:
      return relax_bracketed<T, Dim, HerschelBulkley<Thixotropic, Power>>(step, s, count);
    case Law::newtonian:
      return relax_closed<T, Dim, Newtonian>(step, s, count);
  }
}

template <class T, int Dim>
void relax(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  if (!step.thixotropic) return relax_by_law<T, Dim, false, false>(step, s, count);
  step.flow.breakdown_exponent == T(1) ? relax_by_law<T, Dim, true, false>(step, s, count)
                                       : relax_by_law<T, Dim, true, true>(step, s, count);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
