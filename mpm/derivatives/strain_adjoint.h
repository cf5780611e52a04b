#pragma once

#include "mpm/derivatives/dual.h"
#include "mpm/plain/inputs.h"

/// What a particle makes of its velocity gradient by itself, backwards.
namespace flowrest::mpm::derivatives {

/// The adjoint of the stages of plain::Body::step that ask no node: the gradient referred to the middle of the step, the
/// dilatation heeded, and the stress. Directions are differentiated by hand, the law by dual numbers of the few scalars
/// that it takes. Bars are derivatives of the final reading.
template <int Dim>
class StrainAdjoint {
 public:
  using Particle = plain::Particle<double, Dim>;
  using Tensor = plain::Tensor<double>;
  using Deviator = plain::Deviator<double>;
  struct Step {
    double time, length;  ///< s
  };
  /// What the grid has told a particle.
  struct Strain {
    Tensor gradient;  ///< 1/s, as gathered
    double filling = 0.0, coverage = 0.0;
  };

  StrainAdjoint(const SolverSettings& settings, const plain::Inputs<double>& inputs)
      : explicit_fluid_(settings.explicit_fluid),
        density_correction_(settings.density_correction),
        inputs_(inputs),
        numbers_(plain::numbers_of(inputs)) {}

  /// Of a particle as it was before the step: from the bar of its own dilatation and those of what it has `after`, to
  /// the bars of what the grid told it. Adds to the particle's `bar`, and to the `inputs`' (plain::visit_numbers).
  Strain back(const Step& step, const Particle& p, const Strain& told, double dilatation_bar,
              const Particle& after, Particle& bar, std::vector<double>& inputs) const {
    const Tensor l = plain::referred_to_midpoint(told.gradient, step.length);
    Tensor l_bar;
    stress_back(step, p, l, after, l_bar, bar, inputs);
    Strain bars;
    heeded_back(p, l, told, dilatation_bar, l_bar, bar, bars);
    // L = g - dt/2 g g
    const Tensor& g = told.gradient;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        double of_square = 0.0;
        for (std::size_t k = 0; k < 3; ++k) of_square += l_bar[i][k] * g[j][k] + g[k][i] * l_bar[k][j];
        bars.gradient[i][j] = l_bar[i][j] - 0.5 * step.length * of_square;
      }
    return bars;
  }

 private:
  /// What a law takes and makes beside directions: the trial stress' invariant (of an explicit fluid the shear rate), G
  /// dt, flocculation and the rate before; then the numbers of Inputs from the yield stress on.
  static constexpr int scalar_inputs = 4, law_numbers = 11, first_law_number = 4;
  using Scalar = Dual<scalar_inputs + law_numbers + 1>;

  laws::Relaxed<Scalar> scalar_law(const Step& step, const Scalar& invariant, double shear,
                                   const Particle& p) const {
    plain::Inputs<Scalar> lifted;
    lifted.friction.resize(inputs_.friction.size());
    lifted.material.law = inputs_.material.law;
    lifted.material.thixotropic = inputs_.material.thixotropic;
    int number = 0;
    plain::visit_numbers(lifted, [&](Scalar& x) {
      x = Scalar(numbers_[static_cast<std::size_t>(number)]);
      const int own = number - first_law_number;
      if (own >= 0 && own < law_numbers) x.d[static_cast<std::size_t>(scalar_inputs + own)] = 1.0;
      ++number;
    });
    const plain::Material<Scalar>& m = lifted.material;
    const Scalar dt(step.length), lambda = Scalar::input(p.flocculation, 2),
                                  before = Scalar::input(p.rate, 3);
    const Scalar grown = m.ageing.grown(Scalar(step.time) + dt);
    if (explicit_fluid_) return plain::flowing(m, dt, grown, invariant, lambda, before);
    return plain::relaxed(m, dt, grown, laws::Trial<Scalar>{invariant, Scalar::input(shear, 1)}, lambda,
                          before);
  }

  void heeded_back(const Particle& p, const Tensor& l, const Strain& told, double dilatation_bar,
                   Tensor& l_bar, Particle& bar, Strain& bars) const {
    using D = Dual<4>;
    const D dilatation = plain::heeded_dilatation<Dim>(D::input(l.trace(), 0), D::input(told.filling, 1),
                                                       D::input(told.coverage, 2),
                                                       D(density_correction_) * D::input(p.rate, 3));
    for (std::size_t i = 0; i < 3; ++i) l_bar[i][i] += dilatation_bar * dilatation.d[0];
    bars.filling = dilatation_bar * dilatation.d[1];
    bars.coverage = dilatation_bar * dilatation.d[2];
    bar.rate += dilatation_bar * dilatation.d[3];
  }

  /// s' = share (R s R^T + 2 G dt D*), share and the scalars by the law.
  void stress_back(const Step& step, const Particle& p, const Tensor& l, const Particle& after, Tensor& l_bar,
                   Particle& bar, std::vector<double>& inputs) const {
    const Deviator rate = plain::strain_rate_deviator(l);
    const bool fluid = explicit_fluid_;
    const double shear = fluid ? 0.0 : inputs_.material.state.shear(p.volume_ratio) * step.length;
    const Deviator trial = fluid ? 2.0 * rate : plain::rotated(p.stress, l, step.length) + 2.0 * shear * rate;
    const double invariant = trial.invariant();
    const Scalar size = Scalar::input(invariant, 0);
    const laws::Relaxed<Scalar> law = scalar_law(step, size, shear, p);
    const Scalar share = invariant > 0.0 ? law.stress / size : Scalar(1.0);
    const Deviator& s_bar = after.stress;
    const Scalar reading = Scalar(after.rate) * law.rate + Scalar(after.flocculation) * law.flocculation +
                           Scalar(dot(s_bar, trial)) * share;
    for (int i = 0; i < law_numbers; ++i)
      inputs[static_cast<std::size_t>(first_law_number + i)] +=
          reading.d[static_cast<std::size_t>(scalar_inputs + i)];
    bar.flocculation += reading.d[2];
    bar.rate += reading.d[3];
    Deviator trial_bar = share.v * s_bar;
    if (invariant > 0.0) {
      // Of sqrt(s:s / 2), whose third component is minus the sum of the others.
      const double half = 0.5 * reading.d[0] / invariant;
      const Deviator slope{2.0 * trial.xx + trial.yy, 2.0 * trial.yy + trial.xx, 2.0 * trial.xy,
                           2.0 * trial.xz, 2.0 * trial.yz};
      trial_bar = trial_bar + half * slope;
    }
    const double twice = fluid ? 2.0 : 2.0 * shear;
    const Deviator rate_bar = twice * trial_bar;
    const double third = (rate_bar.xx + rate_bar.yy) / 3.0;
    l_bar[0][0] += rate_bar.xx - third;
    l_bar[1][1] += rate_bar.yy - third;
    l_bar[2][2] -= third;
    add_symmetric(l_bar, 0, 1, 0.5 * rate_bar.xy);
    add_symmetric(l_bar, 0, 2, 0.5 * rate_bar.xz);
    add_symmetric(l_bar, 1, 2, 0.5 * rate_bar.yz);
    if (fluid) return;
    rotation_back(p.stress, l, step.length, trial_bar, bar.stress, l_bar);
    // G dt = G0 exp(-gamma (J - 1)) dt
    const double shear_bar = reading.d[1] + 2.0 * dot(trial_bar, rate);
    const auto& state = inputs_.material.state;
    bar.volume_ratio -= shear_bar * state.exponent * shear;
    inputs[2] += shear_bar * shear / state.shear_modulus;
    inputs[3] -= shear_bar * shear * (p.volume_ratio - 1.0);
  }

  static double dot(const Deviator& a, const Deviator& b) {
    return a.xx * b.xx + a.yy * b.yy + a.xy * b.xy + a.xz * b.xz + a.yz * b.yz;
  }
  static void add_symmetric(Tensor& to, std::size_t i, std::size_t j, double x) {
    to[i][j] += x;
    to[j][i] += x;
  }

  /// Of plain::rotated: R = I + c (Q + Q Q), c = 2 / (1 + q.q), q the axial vector of the spin over half a step.
  static void rotation_back(const Deviator& stress, const Tensor& l, double dt, const Deviator& turned_bar,
                            Deviator& stress_bar, Tensor& l_bar) {
    const double quarter = 0.25 * dt;
    const double q[3] = {quarter * (l[2][1] - l[1][2]), quarter * (l[0][2] - l[2][0]),
                         quarter * (l[1][0] - l[0][1])};
    const Tensor spin{{{{0.0, -q[2], q[1]}, {q[2], 0.0, -q[0]}, {-q[1], q[0], 0.0}}}};
    const Tensor square = spin * spin;
    const double scale = 2.0 / (1.0 + q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    Tensor r, transposed;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        r[i][j] = scale * (spin[i][j] + square[i][j]) + (i == j ? 1.0 : 0.0);
        transposed[j][i] = r[i][j];
      }
    const Deviator& t = turned_bar;
    const Tensor bar{
        {{{t.xx, 0.5 * t.xy, 0.5 * t.xz}, {0.5 * t.xy, t.yy, 0.5 * t.yz}, {0.5 * t.xz, 0.5 * t.yz, 0.0}}}};
    const Tensor s_bar = transposed * bar * r;
    stress_bar.xx += s_bar[0][0] - s_bar[2][2];
    stress_bar.yy += s_bar[1][1] - s_bar[2][2];
    stress_bar.xy += 2.0 * s_bar[0][1];
    stress_bar.xz += 2.0 * s_bar[0][2];
    stress_bar.yz += 2.0 * s_bar[1][2];
    const Tensor r_bar = bar * r * stress.tensor();  // half of it: both factors of R are alike
    Tensor spin_transposed;
    double scale_bar = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        spin_transposed[i][j] = spin[j][i];
        scale_bar += 2.0 * r_bar[i][j] * (spin[i][j] + square[i][j]);
      }
    const Tensor one = r_bar * spin_transposed, other = spin_transposed * r_bar;
    const auto of_spin = [&](std::size_t i, std::size_t j) {
      return 2.0 * scale * (r_bar[i][j] + one[i][j] + other[i][j]);
    };
    const double of_q[3] = {of_spin(2, 1) - of_spin(1, 2), of_spin(0, 2) - of_spin(2, 0),
                            of_spin(1, 0) - of_spin(0, 1)};
    const auto q_bar = [&](std::size_t i) { return quarter * (of_q[i] - scale_bar * scale * scale * q[i]); };
    l_bar[2][1] += q_bar(0);
    l_bar[1][2] -= q_bar(0);
    l_bar[0][2] += q_bar(1);
    l_bar[2][0] -= q_bar(1);
    l_bar[1][0] += q_bar(2);
    l_bar[0][1] -= q_bar(2);
  }

  bool explicit_fluid_;
  double density_correction_;
  plain::Inputs<double> inputs_;
  std::vector<double> numbers_;  ///< in the order of plain::visit_numbers
};

}  // namespace flowrest::mpm::derivatives
