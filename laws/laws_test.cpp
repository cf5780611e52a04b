// The laws at a point.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "laws/equation_of_state.h"
#include "laws/law.h"
#include "laws/test_dual.h"

namespace flowrest::laws {
namespace {

using test::Dual;

constexpr double yield = 50.0, viscosity = 30.0, modulus = 4e4;
constexpr Parameters<double> concrete{yield, viscosity, 100.0, 0.01};

TEST(Laws, AreKnownByTheirNamesInTheOrderOfReports) {
  int order = 0;
  for (const Law law : every_law) {
    EXPECT_EQ(law_named(name_of(law)), law);
    EXPECT_EQ(order_of(name_of(law)), order++);
  }
  EXPECT_EQ(law_named("bingham"), std::nullopt);
  EXPECT_EQ(order_of("bingham"), order) << "behind all others";
  EXPECT_STREQ(name_of(Law::elasto_viscoplastic), "elasto-viscoplastic");
}

TEST(Laws, OnlyTheSolidRestsAndOnlyRegularisedFluidsCreep) {
  for (const Law law : every_law) {
    EXPECT_EQ(can_rest(law), law == Law::elasto_viscoplastic);
    EXPECT_EQ(creeps(law),
              law == Law::papanastasiou || law == Law::bi_viscous || law == Law::herschel_bulkley);
    EXPECT_EQ(has_yield_stress(law), law != Law::newtonian);
    EXPECT_TRUE(needs(law, Parameter::plastic_viscosity));
  }
}

TEST(Laws, RateAndStressAreEachOthersInverse) {
  for (const Law law : every_law)
    for (double rate = 1e-8; rate < 1e3; rate *= 3.0) {
      const FlowCurve curve{law, concrete};
      // Above its yield stress the solid's stress tells little of a small rate.
      const double lost = law == Law::elasto_viscoplastic ? 1e-16 * yield / (viscosity * rate) : 0.0;
      EXPECT_NEAR(curve.rate(curve.stress(rate)) / rate, 1.0, 1e-11 + 4.0 * lost)
          << name_of(law) << " at " << rate;
    }
}

TEST(Laws, TheTangentIsTheStresssDerivative) {
  for (const Law law : every_law)
    for (const double rate : {1e-4, 3e-3, 0.02, 1.0, 50.0}) {
      const Parameters<Dual> p{yield, viscosity, 100.0, 0.01};
      const Dual stress = visit(law, [&](auto own) { return own.stress(p, Dual{rate, 1.0}); });
      EXPECT_NEAR(stress.d, (FlowCurve{law, concrete}.tangent(rate)), 1e-12 * stress.d)
          << name_of(law) << " at " << rate;
    }
}

TEST(Laws, ViscositiesHaveTheirLimits) {
  const auto papanastasiou = [](double rate) { return Papanastasiou::viscosity(concrete, rate); };
  EXPECT_DOUBLE_EQ(papanastasiou(0.0), viscosity + 100.0 * yield);
  EXPECT_NEAR(papanastasiou(1e-12), viscosity + 100.0 * yield, 1e-6);
  EXPECT_NEAR(papanastasiou(10.0), viscosity + yield / 10.0, 1e-12);
  EXPECT_DOUBLE_EQ(BiViscous::viscosity(concrete, 1e-6), viscosity + yield / 0.01);
  EXPECT_DOUBLE_EQ(BiViscous::viscosity(concrete, 2.0), viscosity + yield / 2.0);
  for (const Law law : {Law::papanastasiou, Law::bi_viscous, Law::herschel_bulkley, Law::newtonian}) {
    const FlowCurve curve{law, concrete};
    EXPECT_NEAR(curve.stress(1e-9) / 1e-9, curve.largest_viscosity(), 1e-3) << name_of(law);
    EXPECT_LE(curve.stress(0.5) / 0.5, curve.largest_viscosity() * (1.0 + 1e-15)) << name_of(law);
  }
}

/// What a fluid's implicit update is: the trial less the elastic relaxation is the law's stress at the rate.
TEST(Laws, AFluidsReturnBalances) {
  for (const Law law : {Law::papanastasiou, Law::bi_viscous, Law::herschel_bulkley, Law::newtonian})
    for (const double trial : {1e-6, 1.0, 49.0, 50.0, 51.0, 400.0, 1e6})
      for (const double shear : {0.1, 10.0, 1e3}) {
        const auto relaxed = visit(law, [&](auto own) {
          return own.relax(concrete, Trial<double>{trial, shear}, 0.3);
        });
        EXPECT_NEAR(relaxed.stress, (FlowCurve{law, concrete}.stress(relaxed.rate)), 1e-12 * trial)
            << name_of(law) << " " << trial;
        EXPECT_NEAR(relaxed.stress, trial - shear * relaxed.rate, 1e-14 * trial);
      }
}

constexpr double indices[] = {0.3, 0.5, 0.9, 1.0, 1.2, 1.5};
Parameters<double> power_law(double index) { return {yield, viscosity, 100.0, 0.01, index}; }

TEST(HerschelBulkley, IsPapanastasiousLawWhereThePowerIsOne) {
  for (double rate = 1e-12; rate < 1e4; rate *= 3.0) {
    EXPECT_DOUBLE_EQ(HerschelBulkley::stress(concrete, rate), Papanastasiou::stress(concrete, rate));
    EXPECT_DOUBLE_EQ(HerschelBulkley::tangent(concrete, rate), Papanastasiou::tangent(concrete, rate));
    EXPECT_DOUBLE_EQ(HerschelBulkley::viscosity(concrete, rate), Papanastasiou::viscosity(concrete, rate));
  }
  EXPECT_DOUBLE_EQ(HerschelBulkley::largest_viscosity(concrete), Papanastasiou::largest_viscosity(concrete));
  for (const double trial : {0.0, 1e-6, 49.0, 51.0, 1e4}) {
    const auto one = HerschelBulkley::relax(concrete, Trial<double>{trial, 40.0}, 0.3);
    const auto other = Papanastasiou::relax(concrete, Trial<double>{trial, 40.0}, 0.3);
    EXPECT_NEAR(one.stress, other.stress, 1e-13 * trial);
    EXPECT_NEAR(one.rate, other.rate, 1e-13 * trial);
  }
}

TEST(HerschelBulkley, InFlowItIsThePowerLawPastYield) {
  for (const double n : indices)
    for (const double rate : {1.0, 10.0, 100.0})
      EXPECT_NEAR(HerschelBulkley::stress(power_law(n), rate) / (yield + viscosity * std::pow(rate, n)), 1.0,
                  1e-4)
          << n << " at " << rate;
}

/// Nothing divides by the rate, and no viscosity passes the bound that limits steps.
TEST(HerschelBulkley, HasAFiniteViscosityAtEveryRate) {
  for (const double n : indices) {
    const auto p = power_law(n);
    const double at_rest = viscosity * std::pow(100.0, 1.0 - n) + 100.0 * yield;
    EXPECT_EQ(HerschelBulkley::stress(p, 0.0), 0.0);
    EXPECT_NEAR(HerschelBulkley::viscosity(p, 0.0), at_rest, 1e-12 * at_rest);
    EXPECT_NEAR(HerschelBulkley::tangent(p, 0.0), at_rest, 1e-12 * at_rest);
    double stress_before = 0.0;
    for (double rate = 1e-300; rate < 1e3; rate *= 1.7) {
      const double stress = HerschelBulkley::stress(p, rate);
      ASSERT_GT(stress, stress_before) << n << " at " << rate;
      ASSERT_NEAR(HerschelBulkley::viscosity(p, rate) * rate, stress, 1e-13 * stress) << n << " at " << rate;
      ASSERT_LE(HerschelBulkley::viscosity(p, rate), HerschelBulkley::largest_viscosity(p) * (1.0 + 1e-14));
      ASSERT_GT(HerschelBulkley::tangent(p, rate), 0.0);
      stress_before = stress;
    }
  }
}

TEST(HerschelBulkley, RateAndTangentBelongToTheStressForEveryPower) {
  for (const double n : indices)
    for (double rate = 1e-8; rate < 1e3; rate *= 3.0) {
      const FlowCurve curve{Law::herschel_bulkley, power_law(n)};
      EXPECT_NEAR(curve.rate(curve.stress(rate)) / rate, 1.0, 1e-10) << n << " at " << rate;
      const Parameters<Dual> p{yield, viscosity, 100.0, 0.01, n};
      const Dual stress = HerschelBulkley::stress(p, Dual{rate, 1.0});
      EXPECT_NEAR(stress.d, curve.tangent(rate), 1e-12 * stress.d) << n << " at " << rate;
    }
}

TEST(HerschelBulkley, TheReturnBalancesFromAnyStart) {
  for (const double n : indices)
    for (const double trial : {0.0, 1e-9, 1.0, 49.0, 50.0, 51.0, 400.0, 1e6})
      for (const double shear : {0.1, 10.0, 1e3})
        for (const double before : {0.0, 1e-9, 0.3, 1e4}) {
          const auto p = power_law(n);
          const auto relaxed = HerschelBulkley::relax(p, Trial<double>{trial, shear}, before);
          EXPECT_NEAR(relaxed.stress, HerschelBulkley::stress(p, relaxed.rate), 1e-12 * trial)
              << n << ", " << trial << ", " << shear << " from " << before;
        }
}

/// Constant shear from rest: tau = G rate t up to yield, then tau0 + eta rate (1 - exp(-G (t - t_y) / eta)).
TEST(Laws, TheSolidsElasticStartYieldsAndReachesTheBinghamStress) {
  const double rate = 0.5, dt = 1e-6, yields_at = yield / (modulus * rate);
  double stress = 0.0, time = 0.0;
  while (time < 5.0 * viscosity / modulus + yields_at) {
    const Trial<double> trial{stress + modulus * dt * rate, modulus * dt};
    stress = ElastoViscoplastic::relax(concrete, trial, 0.0).stress;
    time += dt;
    const double exact =
        time < yields_at
            ? modulus * rate * time
            : yield + viscosity * rate * (1.0 - std::exp(-modulus * (time - yields_at) / viscosity));
    ASSERT_NEAR(stress, exact, 0.02) << time;
  }
}

TEST(ElastoViscoplastic, OfAPowerReturnsToYieldAndThePowerPastIt) {
  for (const double n : indices)
    for (const double past : {1e-9, 1e-3, 1.0, 400.0, 1e6})
      for (const double shear : {0.1, 10.0, 1e3}) {
        const auto p = power_law(n);
        const double trial = yield + past;
        const auto relaxed = ElastoViscoplastic::relax(p, Trial<double>{trial, shear}, 0.3);
        ASSERT_GE(relaxed.rate, 0.0);
        EXPECT_NEAR(relaxed.stress, yield + viscosity * std::pow(relaxed.rate, n), 1e-12 * trial)
            << n << " past yield by " << past << ", " << shear;
        const double nearly = n == 1.0 ? 1.0 + 1e-13 : n;  // the search where there is a closed form
        const auto searched = ElastoViscoplastic::relax(power_law(nearly), Trial<double>{trial, shear}, 0.3);
        EXPECT_NEAR(searched.stress, relaxed.stress, 1e-11 * trial) << n << " past yield by " << past;
      }
  for (const double n : indices) {
    const auto at_rest = ElastoViscoplastic::relax(power_law(n), Trial<double>{49.9, 40.0}, 0.3);
    EXPECT_EQ(at_rest.rate, 0.0);
    EXPECT_EQ(at_rest.stress, 49.9);
  }
}

/// Left alone, stress above yield relaxes to it and no further: the material is at rest under load.
TEST(Laws, AtRestTheYieldStressStays) {
  double stress = 80.0;
  for (int i = 0; i < 100000; ++i)
    stress = ElastoViscoplastic::relax(concrete, {stress, modulus * 1e-3}, 0.0).stress;
  EXPECT_NEAR(stress, yield, 1e-12);
  EXPECT_EQ(ElastoViscoplastic::relax(concrete, {49.9, modulus * 1e-3}, 0.0).rate, 0.0);
}

/// The closed form against what it solves (Yu et al. 2026, Eqs. 38, 39 and 45): at the returned rate the
/// stress of the law, with the flocculation of that rate, is the trial's less the elastic relaxation; for
/// alphas that cancel as printed.
TEST(Thixotropy, TheSolidsReturnMapBalancesForEveryBreakdown) {
  for (const double alpha : {0.0, 1e-12, 1e-6, 0.15, 1.0, 1e3})
    for (const double trial : {60.0, 150.0, 1e3, 1e6})
      for (const double lambda : {0.0, 0.5, 1.8}) {
        const Structure<double> structure{0.39 / yield, alpha};
        const double dt = 1e-3;
        const auto relaxed = Thixotropic<ElastoViscoplastic>::relax(
            concrete, structure, Trial<double>{trial, modulus * dt}, dt, lambda, 0.0);
        if (relaxed.rate == 0.0) {
          EXPECT_LE(trial, (1.0 + lambda + structure.growth * dt) * yield);
          continue;
        }
        const double expected =
            (1.0 + relaxed.flocculation) * yield + (viscosity + modulus * dt) * relaxed.rate;
        EXPECT_NEAR(trial, expected, 1e-9 * trial) << alpha << " " << trial << " " << lambda;
        EXPECT_NEAR(relaxed.flocculation, structure.stepped(lambda, relaxed.rate, dt), 1e-12 * (1 + lambda));
      }
}

TEST(Thixotropy, TheSolidsReturnOfAPowerBalancesForEveryBreakdown) {
  for (const double n : indices)
    for (const double alpha : {0.0, 1e-6, 0.15, 1.0, 1e3})
      for (const double trial : {60.0, 150.0, 1e3, 1e6})
        for (const double lambda : {0.0, 0.5, 1.8}) {
          const Structure<double> structure{0.39 / yield, alpha};
          const double dt = 1e-3;
          const auto relaxed = Thixotropic<ElastoViscoplastic>::relax(
              power_law(n), structure, Trial<double>{trial, modulus * dt}, dt, lambda, 0.0);
          if (relaxed.rate == 0.0) {
            EXPECT_LE(trial, (1.0 + lambda + structure.growth * dt) * yield);
            continue;
          }
          const double expected = (1.0 + relaxed.flocculation) * yield +
                                  viscosity * std::pow(relaxed.rate, n) + modulus * dt * relaxed.rate;
          EXPECT_NEAR(trial, expected, 1e-9 * trial) << n << " " << alpha << " " << trial << " " << lambda;
          EXPECT_NEAR(relaxed.flocculation, structure.stepped(lambda, relaxed.rate, dt),
                      1e-12 * (1 + lambda));
        }
}

TEST(Thixotropy, AnyLawWithoutStructureIsTheLawItself) {
  for (const Law law : every_law)
    for (const double trial : {20.0, 60.0, 1e4})
      visit(law, [&](auto own) {
        using Own = decltype(own);
        const auto plain = Own::relax(concrete, Trial<double>{trial, 40.0}, 0.1);
        const auto decorated = Thixotropic<Own>::relax(concrete, Structure<double>{},
                                                       Trial<double>{trial, 40.0}, 1e-3, 0.0, 0.1);
        EXPECT_DOUBLE_EQ(plain.stress, decorated.stress) << name_of(law);
        EXPECT_DOUBLE_EQ(plain.rate, decorated.rate) << name_of(law);
        return 0;
      });
}

TEST(Thixotropy, StepsApproachTheClosedFormAtRestAndInSteadyShear) {
  const Structure<double> structure{0.4, 0.2};
  EXPECT_DOUBLE_EQ(structure.after(0.5, 0.0, 10.0), 4.5) << "at rest it only grows";
  for (const double rate : {0.0, 0.1, 5.0}) {
    double coarse = 3.0, fine = 3.0;
    for (int i = 0; i < 200; ++i) coarse = structure.stepped(coarse, rate, 1e-2);
    for (int i = 0; i < 400; ++i) fine = structure.stepped(fine, rate, 5e-3);
    const double exact = structure.after(3.0, rate, 2.0);
    EXPECT_NEAR(fine, exact, 0.51 * std::abs(coarse - exact) + 1e-12) << "first order in the step";
    EXPECT_NEAR(fine, exact, 5e-3);
  }
}

/// At rest nothing breaks: the yield stress is tau0, what flocs have gained and what age has.
TEST(Ageing, IsPerrotsAndLinearWithoutItsTime) {
  const Ageing<double> perrot{0.02, 1.0 / 3000.0, 600.0}, linear{0.02, 0.0, 600.0};
  EXPECT_NEAR(perrot.grown(1200.0), 0.02 * 3000.0 * (std::exp(1800.0 / 3000.0) - 1.0), 1e-12);
  EXPECT_DOUBLE_EQ(linear.grown(1200.0), 0.02 * 1800.0);
  EXPECT_NEAR((Ageing<double>{0.02, 1e-12, 600.0}.grown(1200.0)), linear.grown(1200.0), 1e-7);
  EXPECT_EQ(Ageing<double>{}.grown(1e6), 0.0);
  EXPECT_EQ((Ageing<double>{0.0, 1.0, 1e6}.grown(1.0)), 0.0) << "where the power overflows";
  const Ageing<Dual> seeded{0.02, 1.0 / 3000.0, 600.0};
  EXPECT_NEAR(seeded.grown(Dual{1200.0, 1.0}).d, 0.02 * std::exp(0.6), 1e-15) << "A exp(t / t_c)";
}

/// Loaded up to what it holds at its age and not past it, whatever the law of the flow.
TEST(Ageing, AtRestTheYieldStressIsTheSumOfFlocsAndAge) {
  const Structure<double> structure{0.39 / yield, 0.15};
  const Ageing<double> ageing{0.5, 1.0 / 400.0, 30.0};
  const double dt = 0.1;
  double lambda = 0.2;
  for (int i = 1; i <= 1000; ++i) {
    const double grown = ageing.grown(i * dt);
    const double holds =
        yield + 0.2 * yield + 0.39 * i * dt + 0.5 * 400.0 * std::expm1((30.0 + i * dt) / 400.0);
    for (const double past : {-1e-9, 1e-9}) {
      const auto at = Thixotropic<ElastoViscoplastic>::relax(
          concrete, structure, {holds + past, modulus * dt}, dt, lambda, 0.0, grown);
      ASSERT_EQ(at.rate > 0.0, past > 0.0) << i;
    }
    lambda = Thixotropic<ElastoViscoplastic>::relax(concrete, structure, {10.0, modulus * dt}, dt, lambda,
                                                    0.0, grown)
                 .flocculation;
  }
  EXPECT_NEAR(lambda, 0.2 + 0.39 / yield * 100.0, 1e-12);
}

/// Flow takes nothing of it: every law has in flow the stress of the yield stress that age gives it.
TEST(Ageing, IsNotTakenBackByFlow) {
  const double grown = 35.0, dt = 1e-3;
  for (const Law law : every_law)
    for (const double trial : {20.0, 120.0, 1e4})
      visit(law, [&](auto own) {
        using Own = decltype(own);
        if (!has_yield_stress(law)) return 0;
        Parameters<double> aged = concrete;
        aged.yield_stress += grown;
        const auto expected = Own::relax(aged, Trial<double>{trial, 40.0}, 0.1);
        const auto relaxed = Thixotropic<Own>::relax(concrete, Structure<double>{0.0, 0.3},
                                                     Trial<double>{trial, 40.0}, dt, 0.0, 0.1, grown);
        EXPECT_NEAR(relaxed.stress, expected.stress, 1e-12 * trial) << name_of(law);
        EXPECT_NEAR(relaxed.rate, expected.rate, 1e-12 * (1.0 + expected.rate)) << name_of(law);
        return 0;
      });
}

constexpr double exponents[] = {0.3, 0.5, 0.9, 1.0, 1.2, 1.5, 2.0};

/// The balance that is solved, with any powers of breakdown and flow, and age.
TEST(Thixotropy, TheSolidsReturnBalancesForEveryPowerOfBreakdown) {
  for (const double m : exponents)
    for (const double n : {0.5, 1.0, 1.2})
      for (const double alpha : {0.0, 1e-6, 0.15, 1.0})
        for (const double trial : {60.0, 150.0, 1e3, 1e6})
          for (const double grown : {0.0, 12.0})
            for (const double lambda : {0.0, 0.5, 1.8}) {
              const Structure<double> structure{0.39 / yield, alpha, m};
              const double dt = 1e-3;
              const auto relaxed = Thixotropic<ElastoViscoplastic>::relax(
                  power_law(n), structure, Trial<double>{trial, modulus * dt}, dt, lambda, 0.0, grown);
              const double holds = (1.0 + relaxed.flocculation) * yield + grown;
              ASSERT_EQ(relaxed.rate == 0.0, trial <= (1.0 + lambda + structure.growth * dt) * yield + grown);
              EXPECT_NEAR(relaxed.flocculation,
                          (lambda + structure.growth * dt) / (1.0 + dt * alpha * std::pow(relaxed.rate, m)),
                          1e-12 * (1.0 + lambda));
              if (relaxed.rate == 0.0) continue;
              EXPECT_NEAR(trial, holds + viscosity * std::pow(relaxed.rate, n) + modulus * dt * relaxed.rate,
                          1e-12 * trial)
                  << m << " " << n << " " << alpha << " " << trial << " " << lambda << " " << grown;
              EXPECT_NEAR(relaxed.stress, trial - modulus * dt * relaxed.rate, 1e-14 * trial);
            }
}

/// The search where there is a closed form.
TEST(Thixotropy, APowerNextToOneReturnsAsTheClosedForm) {
  for (const double alpha : {1e-6, 0.15, 1.0})
    for (const double trial : {150.0, 1e3, 1e5}) {
      const Structure<double> linear{0.39 / yield, alpha}, nearly{0.39 / yield, alpha, 1.0 + 1e-13};
      const auto closed =
          Thixotropic<ElastoViscoplastic>::relax(concrete, linear, {trial, 40.0}, 1e-3, 0.5, 0.0);
      const auto found =
          Thixotropic<ElastoViscoplastic>::relax(concrete, nearly, {trial, 40.0}, 1e-3, 0.5, 0.0);
      EXPECT_NEAR(found.stress, closed.stress, 1e-11 * trial);
      EXPECT_NEAR(found.flocculation, closed.flocculation, 1e-11);
    }
}

/// At a constant rate lambda goes to growth / (alpha rate^m), exponentially with alpha rate^m: in closed form,
/// and by steps that approach it in first order.
TEST(Thixotropy, AConstantRateBreaksDownByItsPower) {
  for (const double m : exponents)
    for (const double rate : {0.2, 1.0, 4.0}) {
      const Structure<double> structure{0.4, 0.2, m};
      const double decay = 0.2 * std::pow(rate, m), balance = 0.4 / decay;
      const double exact = balance + (3.0 - balance) * std::exp(-2.0 * decay);
      EXPECT_NEAR(structure.after(3.0, rate, 2.0), exact, 1e-13);
      EXPECT_NEAR(structure.after(3.0, rate, 1e4 / decay), balance, 1e-12 * balance);
      double coarse = 3.0, fine = 3.0;
      for (int i = 0; i < 2000; ++i) coarse = structure.stepped(coarse, rate, 1e-3);
      for (int i = 0; i < 4000; ++i) fine = structure.stepped(fine, rate, 5e-4);
      EXPECT_NEAR(2.0 * fine - coarse, exact, 1e-5) << "first order in the step";
      EXPECT_NEAR(structure.stepped(balance, rate, 0.7), balance, 1e-13 * balance) << "it stays in balance";
    }
}

/// Derivatives of a return by any of its data, against central differences.
TEST(Laws, DerivativesGoThroughEveryReturn) {
  // tau0, eta, m, critical rate, growth, breakdown, trial, shear, lambda, n, power of breakdown, grown
  using Data = std::vector<double>;
  const auto relaxed = [](Law law, bool thixotropic, const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    const Parameters<T> p{x[0], x[1], x[2], x[3], x[9]};
    const Structure<T> structure{x[4], x[5], x[10]};
    const Trial<T> trial{x[6], x[7]};
    return visit(law, [&](auto own) {
      using Own = decltype(own);
      return thixotropic ? Thixotropic<Own>::relax(p, structure, trial, T(1e-2), x[8], T(0.4), x[11])
                         : Own::relax(p, trial, T(0.4));
    });
  };
  for (const Law law : every_law)
    for (const bool thixotropic : {false, true})
      for (const auto& [trial, power] : {std::pair{30.0, 1.0}, {300.0, 1.0}, {300.0, 0.8}}) {
        const double index = needs(law, Parameter::flow_index) ? 0.7 : 1.0;
        const Data at{yield, viscosity, 20.0, 0.05, 0.1, 0.3, trial, 40.0, 0.6, index, power, 3.0};
        for (std::size_t i = 0; i < at.size(); ++i) {
          if (i == 10 && power == 1.0) continue;  // the closed form, which has no other
          std::vector<Dual> seeded(at.begin(), at.end());
          seeded[i].d = 1.0;
          Data low = at, high = at;
          const double nudge = 1e-6 * at[i];
          low[i] -= nudge;
          high[i] += nudge;
          const auto exact = relaxed(law, thixotropic, seeded);
          const auto below = relaxed(law, thixotropic, low), above = relaxed(law, thixotropic, high);
          EXPECT_NEAR(exact.stress.d, (above.stress - below.stress) / (2.0 * nudge), 1e-7 * (trial / at[i]))
              << name_of(law) << " by " << i;
          EXPECT_NEAR(exact.rate.d, (above.rate - below.rate) / (2.0 * nudge),
                      1e-7 * (exact.rate.v + 1.0) / at[i])
              << name_of(law) << " by " << i;
        }
      }
}

TEST(EquationOfState, PressureIsTheEnergysSlope) {
  const EquationOfState<Dual> state{1e5, 4e4, 7.0};
  for (const double ratio : {0.97, 1.0, 1.01})
    EXPECT_NEAR(-state.energy(Dual{ratio, 1.0}).d, state.pressure(ratio).v, 1e-9);
  EXPECT_EQ(state.pressure(1.0).v, 0.0);
}

}  // namespace
}  // namespace flowrest::laws
