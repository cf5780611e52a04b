#include "mpm/material/flow_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/test_random.h"

using namespace flowrest::mpm;
using flowrest::mpm::test::Random;

namespace {

constexpr double unit = std::numeric_limits<double>::epsilon();

/// One state of the elasto-viscoplastic law before its return.
struct State {
  FlowParameters<double> flow;
  double trial, shear, dt, lambda;
};

/// A state anywhere that a scene may lead to: alpha zero, next to zero, and up to 1e6.
State random_state(Random& random) {
  State s{};
  s.flow.yield_stress = random.log_between(1e-3, 1e4);
  s.flow.plastic_viscosity = random.chance(0.1) ? 0.0 : random.log_between(1e-3, 1e3);
  s.flow.flocculation_growth = random.chance(0.2) ? 0.0 : random.log_between(1e-5, 10.0);
  const double pick = random.uniform();
  s.flow.deflocculation = pick < 0.05 ? 0.0 : pick < 0.1 ? 1e-12 : random.log_between(1e-9, 1e6);
  s.dt = random.log_between(1e-6, 1e-2);
  s.shear = random.log_between(1e3, 1e6) * s.dt;
  s.lambda = random.chance(0.2) ? 0.0 : random.log_between(1e-6, 1e6);
  s.trial = (1.0 + s.lambda + s.flow.flocculation_growth * s.dt) * s.flow.yield_stress *
            random.log_between(0.5, 1e3);
  return s;
}

/// The balance of Yu et al. 2026, Eq. 42, as it stands, in long double: what the trial exceeds the
/// viscoplastic stress by.
long double excess_at(const State& s, long double rate) {
  const long double lambda_trial =
      static_cast<long double>(s.lambda) + static_cast<long double>(s.flow.flocculation_growth) * s.dt;
  const long double lambda =
      lambda_trial / (1.0L + static_cast<long double>(s.dt) * s.flow.deflocculation * rate);
  return static_cast<long double>(s.trial) -
         (static_cast<long double>(s.shear) + s.flow.plastic_viscosity) * rate -
         (1.0L + lambda) * s.flow.yield_stress;
}

/// Its root, by bisection to the last place: the balance falls through zero once (it is concave and positive
/// at zero).
long double exact_rate(const State& s) {
  if (excess_at(s, 0.0L) <= 0.0L) return 0.0L;
  long double low = 0.0L;
  long double high =
      static_cast<long double>(s.trial) / (static_cast<long double>(s.shear) + s.flow.plastic_viscosity);
  for (int i = 0; i < 400; ++i) {
    const long double middle = low > 0.0L && high > 4.0L * low ? std::sqrt(low * high) : 0.5L * (low + high);
    if (middle <= low || middle >= high) break;
    (excess_at(s, middle) > 0.0L ? low : high) = middle;
  }
  return 0.5L * (low + high);
}

/// How much a relative change of the data by one moves the rate, relatively: what no method in this precision
/// can beat. d(rate) = d(balance) / slope, the balance's terms each uncertain by round-off.
double condition(const State& s, long double rate) {
  const long double viscosity = static_cast<long double>(s.shear) + s.flow.plastic_viscosity;
  const long double growth = static_cast<long double>(s.dt) * s.flow.deflocculation;
  const long double lambda_trial =
      static_cast<long double>(s.lambda) + static_cast<long double>(s.flow.flocculation_growth) * s.dt;
  const long double lambda = lambda_trial / (1.0L + growth * rate);
  const long double slope = viscosity - lambda * s.flow.yield_stress * growth / (1.0L + growth * rate);
  const long double terms = s.trial + viscosity * rate + (1.0L + lambda) * s.flow.yield_stress;
  return static_cast<double>(terms / (std::abs(slope) * rate));
}

template <bool Thixotropic>
Relaxed<double> relax(const State& s) {
  return ElastoViscoplastic<Thixotropic>::template relax<double>(s.flow, s.trial, s.shear, s.dt, s.lambda,
                                                                 0.0);
}

/// The root of a falling function between `low` and `high`.
template <class Function>
long double root(Function f, long double low, long double high) {
  for (int i = 0; i < 400; ++i) {
    const long double middle = low > 0.0L && high > 4.0L * low ? std::sqrt(low * high) : 0.5L * (low + high);
    if (middle <= low || middle >= high) break;
    (f(middle) > 0.0L ? low : high) = middle;
  }
  return 0.5L * (low + high);
}

}  // namespace

TEST(ElastoViscoplastic, ThixotropicReturnIsTheExactRootOverRandomStates) {
  Random random(20);
  int yielding = 0, to_tolerance = 0, ill_conditioned = 0;
  double worst = 0.0, worst_against_condition = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const State s = random_state(random);
    const long double exact = exact_rate(s);
    const Relaxed<double> r = relax<true>(s);
    if (exact == 0.0L) continue;
    ++yielding;
    const double error = static_cast<double>(std::abs(r.rate - exact) / exact);
    const double forbidden = unit * condition(s, exact);
    worst_against_condition = std::max(worst_against_condition, error / forbidden);
    // Round-off alone moves the root of an ill-conditioned state (at yield, or where alpha makes the balance
    // flat) by more than 1e-12: there the error is held against the condition.
    if (4.0 * forbidden > 1e-12) {
      ++ill_conditioned;
      ASSERT_LE(error, 4.0 * forbidden) << "rate " << r.rate << ", exact " << static_cast<double>(exact)
                                        << ", alpha " << s.flow.deflocculation;
    } else {
      ++to_tolerance;
      worst = std::max(worst, error);
      ASSERT_LE(error, 1e-12) << "rate " << r.rate << ", exact " << static_cast<double>(exact) << ", alpha "
                              << s.flow.deflocculation;
    }
  }
  RecordProperty("worst_relative_error", std::to_string(worst));
  EXPECT_GT(to_tolerance, 100000) << "of " << yielding << " yielding states, " << ill_conditioned
                                  << " ill conditioned";
  std::printf(
      "    %d states to 1e-12 (worst %.2g), %d bound by their condition (worst %.2g of unit round-off times "
      "it)\n",
      to_tolerance, worst, ill_conditioned, worst_against_condition);
}

TEST(ElastoViscoplastic, WithoutThixotropyTheReturnIsLinear) {
  Random random(21);
  for (int i = 0; i < 100000; ++i) {
    State s = random_state(random);
    s.lambda = s.flow.flocculation_growth = s.flow.deflocculation = 0.0;
    const long double exact = exact_rate(s);
    const Relaxed<double> r = relax<false>(s);
    ASSERT_NEAR(r.rate, static_cast<double>(exact), 1e-15 * s.trial / (s.shear + s.flow.plastic_viscosity));
    ASSERT_EQ(r.lambda, 0.0);
    if (exact == 0.0L) {
      ASSERT_EQ(r.rate, 0.0);
    }
    const Relaxed<double> thixotropic = relax<true>(s);
    ASSERT_NEAR(r.rate, thixotropic.rate, 4.0 * unit * r.rate)
        << "with lambda and alpha zero both are one law";
  }
}

TEST(ElastoViscoplastic, StressNeverPassesWhatTheFlowLawAllows) {
  Random random(22);
  for (int i = 0; i < 200000; ++i) {
    const State s = random_state(random);
    const Relaxed<double> r = relax<true>(s);
    // Yu et al. 2026, Eq. 20: tau <= (1 + lambda) tau0 + eta rate, an equality where it flows.
    const double allowed = (1.0 + r.lambda) * s.flow.yield_stress + s.flow.plastic_viscosity * r.rate;
    ASSERT_LE(r.stress, allowed + 16.0 * unit * s.trial) << "rate " << r.rate << ", lambda " << r.lambda;
    ASSERT_GE(r.stress, 0.0);
    ASSERT_LE(r.stress, s.trial);
    ASSERT_GE(r.lambda, 0.0);
    ASSERT_LE(r.lambda, s.lambda + s.flow.flocculation_growth * s.dt);
    ASSERT_GE(r.rate, 0.0);
    const Relaxed<double> plain = relax<false>(s);
    ASSERT_LE(plain.stress, std::max(s.flow.yield_stress + s.flow.plastic_viscosity * plain.rate, 0.0) +
                                4.0 * unit * s.trial);
  }
}

TEST(ElastoViscoplastic, BelowYieldNothingButFlocculationHappens) {
  Random random(23);
  for (int i = 0; i < 10000; ++i) {
    State s = random_state(random);
    const double lambda = s.lambda + s.flow.flocculation_growth * s.dt;
    s.trial = (1.0 + lambda) * s.flow.yield_stress * random.uniform();
    const Relaxed<double> r = relax<true>(s);
    ASSERT_EQ(r.stress, s.trial);
    ASSERT_EQ(r.rate, 0.0);
    ASSERT_EQ(r.lambda, lambda);
    s.trial = s.flow.yield_stress * random.uniform();
    ASSERT_EQ(relax<false>(s).stress, s.trial);
    ASSERT_EQ(relax<false>(s).rate, 0.0);
  }
}

TEST(ElastoViscoplastic, FlocculationAtRestIsExact) {
  FlowParameters<double> flow;
  flow.yield_stress = 50.0;
  flow.flocculation_growth = 0.39 / 50.0;
  flow.deflocculation = 0.15;
  double lambda = 1.8;
  const double dt = 0x1p-10;
  for (int i = 0; i < 10240; ++i)
    lambda = ElastoViscoplastic<true>::relax<double>(flow, 20.0, 1e5 * dt, dt, lambda, 0.0).lambda;
  EXPECT_NEAR(lambda, 1.8 + 10.0 * 0.39 / 50.0, 1e-12);
}

TEST(ElastoViscoplastic, LambdaDecaysInSteadySimpleShearAsTheClosedForm) {
  // d lambda / dt = A / tau0 - alpha rate lambda at a constant rate. In simple shear the elastic trial is the
  // last stress plus G rate dt; after the elastic rise the plastic rate is the imposed one, to within the
  // stress' slow fall over G.
  FlowParameters<double> flow;
  flow.yield_stress = 50.0;
  flow.plastic_viscosity = 10.0;
  flow.flocculation_growth = 0.39 / 50.0;
  flow.deflocculation = 0.15;
  const double imposed = 2.0, modulus = 1e6, initial = 1.8;
  const auto error = [&](double dt) {
    double lambda = initial;
    double stress = (1.0 + lambda) * flow.yield_stress + flow.plastic_viscosity * imposed;
    const int steps = static_cast<int>(std::lround(5.0 / dt));
    double worst = 0.0;
    for (int i = 1; i <= steps; ++i) {
      const auto r = ElastoViscoplastic<true>::relax<double>(flow, stress + modulus * imposed * dt,
                                                             modulus * dt, dt, lambda, 0.0);
      stress = r.stress;
      lambda = r.lambda;
      const double rate = flow.deflocculation * imposed, floor = flow.flocculation_growth / rate;
      const double exact = floor + (initial - floor) * std::exp(-rate * i * dt);
      worst = std::max(worst, std::abs(lambda - exact));
    }
    return worst;
  };
  EXPECT_LT(error(1e-3), 5e-4);
  EXPECT_NEAR(std::log2(error(4e-2) / error(2e-2)), 1.0, 0.05) << "implicit Euler is of first order";
}

TEST(ElastoViscoplastic, SinglePrecisionFollowsDouble) {
  Random random(24);
  for (int i = 0; i < 20000; ++i) {
    const State s = random_state(random);
    if (s.flow.deflocculation * s.dt * s.trial > 1e20) continue;
    FlowParameters<float> flow;
    flow.yield_stress = static_cast<float>(s.flow.yield_stress);
    flow.plastic_viscosity = static_cast<float>(s.flow.plastic_viscosity);
    flow.flocculation_growth = static_cast<float>(s.flow.flocculation_growth);
    flow.deflocculation = static_cast<float>(s.flow.deflocculation);
    const auto r =
        ElastoViscoplastic<true>::relax<float>(flow, static_cast<float>(s.trial), static_cast<float>(s.shear),
                                               static_cast<float>(s.dt), static_cast<float>(s.lambda), 0.0f);
    ASSERT_TRUE(std::isfinite(r.rate) && std::isfinite(r.stress) && std::isfinite(r.lambda));
    const long double exact = exact_rate(s);
    if (exact == 0.0L) continue;
    const double allowed = 1.2e-7 * 8.0 * condition(s, exact);
    if (allowed > 0.1) continue;
    ASSERT_NEAR(r.rate / static_cast<double>(exact), 1.0, allowed) << "alpha " << s.flow.deflocculation;
  }
}

namespace {

/// A Papanastasiou fluid's step, of any start of the iteration.
struct Regularised {
  FlowParameters<double> flow;
  double trial, shear;
  long double exact_rate() const {
    const auto balance = [&](long double x) {
      return static_cast<long double>(trial) -
             (static_cast<long double>(shear) + flow.plastic_viscosity) * x +
             flow.yield_stress * std::expm1(-static_cast<long double>(flow.regularisation_time) * x);
    };
    return root(balance, 0.0L, static_cast<long double>(trial) / shear);
  }
  /// As the kernel does it: until the balance holds to 1e-14 of the trial.
  std::pair<double, int> iterated(double start) const {
    double rate = start;
    for (int i = 1; i <= 100; ++i) {
      const auto next = Papanastasiou<false>::iterate<double>(flow, flow.yield_stress, trial, shear, rate);
      if (!(std::abs(next.residual) / (trial + 1e-30) > 1e-14)) return {rate, i};
      rate = next.rate;
    }
    return {rate, 101};
  }
  /// How much a relative change of the trial moves the rate, relatively.
  double condition(double rate) const {
    const double slope =
        shear + flow.plastic_viscosity +
        flow.yield_stress * flow.regularisation_time * std::exp(-flow.regularisation_time * rate);
    return trial / (slope * rate);
  }
};

Regularised random_regularised(Random& random) {
  Regularised r{};
  r.flow.yield_stress = random.log_between(0.1, 1e4);
  r.flow.plastic_viscosity = random.chance(0.1) ? 0.0 : random.log_between(1e-2, 1e3);
  r.flow.regularisation_time = random.log_between(1e-2, 1e6);
  r.shear = random.log_between(1.0, 1e3);
  r.trial = r.flow.yield_stress * random.log_between(1e-6, 1e2);
  return r;
}

}  // namespace

TEST(Papanastasiou, IterationFindsTheRootFromEitherSide) {
  Random random(30);
  int most = 0;
  double worst = 0.0;
  for (int i = 0; i < 50000; ++i) {
    const Regularised r = random_regularised(random);
    const auto exact = static_cast<double>(r.exact_rate());
    const double allowed = 2e-14 * std::max(1.0, r.condition(exact));
    for (const double start :
         {0.0, exact, exact * random.log_between(1e-6, 1.0), exact * random.log_between(1.0, 1e6), 1e12}) {
      const auto [rate, iterations] = r.iterated(start);
      most = std::max(most, iterations);
      worst = std::max(worst, std::abs(rate / exact - 1.0) / allowed);
      ASSERT_NEAR(rate / exact, 1.0, allowed)
          << "from " << start << ", exact " << exact << ", m " << r.flow.regularisation_time
          << ", trial over yield " << r.trial / r.flow.yield_stress;
      ASSERT_LE(iterations, 60) << "from " << start << ", exact " << exact << ", m "
                                << r.flow.regularisation_time << ", trial over yield "
                                << r.trial / r.flow.yield_stress;
    }
  }
  std::printf("    at most %d iterations, worst error %.2g of what is allowed\n", most, worst);
}

TEST(Papanastasiou, SinglePrecisionBalancesToTheKernelsTolerance) {
  Random random(33);
  for (int i = 0; i < 50000; ++i) {
    const Regularised r = random_regularised(random);
    FlowParameters<float> flow;
    flow.yield_stress = static_cast<float>(r.flow.yield_stress);
    flow.plastic_viscosity = static_cast<float>(r.flow.plastic_viscosity);
    flow.regularisation_time = static_cast<float>(r.flow.regularisation_time);
    const auto trial = static_cast<float>(r.trial), shear = static_cast<float>(r.shear);
    const auto exact = static_cast<float>(r.exact_rate());
    for (const float start : {0.0f, exact, 0.3f * exact, 30.0f * exact}) {
      float rate = start;
      int iterations = 0;
      for (; iterations < 60; ++iterations) {
        const auto next = Papanastasiou<false>::iterate<float>(flow, flow.yield_stress, trial, shear, rate);
        if (!(std::abs(next.residual) / trial > 2e-6f)) break;
        rate = next.rate;
      }
      ASSERT_LT(iterations, 60) << "from " << start << ", exact " << exact << ", m "
                                << flow.regularisation_time;
      ASSERT_NEAR(rate / exact, 1.0, 4e-6 * std::max(1.0, r.condition(exact)))
          << "from " << start << ", exact " << exact;
    }
  }
}

TEST(Papanastasiou, StressOfTheRootIsTheFluidsOwn) {
  Random random(31);
  for (int i = 0; i < 10000; ++i) {
    const Regularised r = random_regularised(random);
    const double rate = r.iterated(0.0).first;
    const double exact = r.flow.plastic_viscosity * rate -
                         r.flow.yield_stress * std::expm1(-r.flow.regularisation_time * rate);
    ASSERT_NEAR(papanastasiou_stress(r.flow, r.flow.yield_stress, rate), exact,
                1e-14 * (r.flow.yield_stress + exact));
    ASSERT_NEAR(r.trial - r.shear * rate, exact, 1e-12 * (r.trial + r.flow.yield_stress))
        << "the step's balance";
  }
}

TEST(Papanastasiou, AtAnyRateItStaysUnderTheBinghamStress) {
  FlowParameters<double> flow;
  flow.yield_stress = 50.0;
  flow.plastic_viscosity = 20.0;
  for (const double m : {1.0, 100.0, 1e6}) {
    flow.regularisation_time = m;
    for (const double rate : {1e-9, 1e-4, 0.1, 10.0}) {
      const double stress = papanastasiou_stress(flow, 50.0, rate);
      EXPECT_LE(stress, 50.0 + 20.0 * rate);
      EXPECT_GT(stress, 20.0 * rate);
    }
  }
}

TEST(BiViscous, ReturnBalancesTheFluidsStressOnBothBranches) {
  Random random(40);
  int slow = 0, fast = 0;
  for (int i = 0; i < 100000; ++i) {
    FlowParameters<double> flow;
    flow.yield_stress = random.log_between(0.1, 1e4);
    flow.plastic_viscosity = random.log_between(1e-2, 1e3);
    flow.critical_shear_rate = random.log_between(1e-6, 10.0);
    const double shear = random.log_between(1.0, 1e3),
                 trial = flow.yield_stress * random.log_between(1e-3, 1e2);
    const auto r = BiViscous<false>::relax<double>(flow, trial, shear, 1e-3, 0.0, 0.0);
    (r.rate < flow.critical_shear_rate ? slow : fast) += 1;
    ASSERT_NEAR(r.stress, bi_viscous_stress(flow, flow.yield_stress, r.rate), 1e-13 * trial)
        << "rate " << r.rate;
    ASSERT_GE(r.rate, 0.0);
  }
  EXPECT_GT(slow, 10000);
  EXPECT_GT(fast, 10000);
}

TEST(BiViscous, IsContinuousAtTheCriticalRate) {
  FlowParameters<double> flow;
  flow.yield_stress = 50.0;
  flow.plastic_viscosity = 20.0;
  flow.critical_shear_rate = 0.01;
  const double shear = 70.0;
  const double critical = (shear + flow.plastic_viscosity) * flow.critical_shear_rate + flow.yield_stress;
  const auto at = [&](double trial) {
    return BiViscous<false>::relax<double>(flow, trial, shear, 1e-3, 0.0, 0.0);
  };
  EXPECT_NEAR(at(critical * (1.0 - 1e-12)).rate, 0.01, 1e-11);
  EXPECT_NEAR(at(critical * (1.0 + 1e-12)).rate, 0.01, 1e-11);
  EXPECT_NEAR(at(critical * (1.0 - 1e-12)).stress, at(critical * (1.0 + 1e-12)).stress, 1e-9);
}

TEST(BiViscous, ThixotropyRaisesTheYieldStressByTheNewLambda) {
  FlowParameters<double> flow;
  flow.yield_stress = 50.0;
  flow.plastic_viscosity = 20.0;
  flow.critical_shear_rate = 0.01;
  flow.flocculation_growth = 0.1;
  flow.deflocculation = 0.15;
  const double dt = 0.01, before = 3.0;
  const auto r = BiViscous<true>::relax<double>(flow, 500.0, 70.0, dt, 1.2, before);
  const double lambda = (1.2 + 0.1 * dt) / (1.0 + dt * 0.15 * before);
  EXPECT_DOUBLE_EQ(r.lambda, lambda);
  EXPECT_NEAR(r.stress, (1.0 + lambda) * 50.0 + 20.0 * r.rate, 1e-12);
}

TEST(Newtonian, StressIsViscosityTimesRate) {
  FlowParameters<double> flow;
  flow.yield_stress = 1e9;  // not read
  flow.plastic_viscosity = 20.0;
  for (const double trial : {1e-6, 1.0, 1e6}) {
    const auto r = Newtonian::relax<double>(flow, trial, 70.0, 1e-3, 0.0, 0.0);
    EXPECT_NEAR(r.stress, 20.0 * r.rate, 1e-15 * trial);
    EXPECT_DOUBLE_EQ(r.rate, trial / 90.0);
  }
}

TEST(FlowLaws, MeetWhereTheyAreOne) {
  // Without a yield stress all of them are Newtonian.
  FlowParameters<double> flow;
  flow.plastic_viscosity = 20.0;
  flow.regularisation_time = 100.0;
  flow.critical_shear_rate = 0.01;
  const double expected = Newtonian::relax<double>(flow, 12.0, 70.0, 1e-3, 0.0, 0.0).rate;
  EXPECT_DOUBLE_EQ(ElastoViscoplastic<false>::relax<double>(flow, 12.0, 70.0, 1e-3, 0.0, 0.0).rate, expected);
  EXPECT_DOUBLE_EQ(BiViscous<false>::relax<double>(flow, 12.0, 70.0, 1e-3, 0.0, 0.0).rate, expected);
  EXPECT_DOUBLE_EQ(Papanastasiou<false>::iterate<double>(flow, 0.0, 12.0, 70.0, 0.0).rate, expected);
}
