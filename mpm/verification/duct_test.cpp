// Plane Poiseuille flow (Yu et al. 2026, section 3.3) against what is known exactly. Every bound is stated
// beside what was measured, on AVX-512 in double precision.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "mpm/output/checkpoint.h"
#include "mpm/output/test_runs.h"
#include "mpm/solver/settings.h"
#include "mpm/solver/test_bodies.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;

namespace {

constexpr double height = 0.5, density = 2000.0, viscosity = 30.0, force = 2000.0;

/// Steady velocity of a Bingham fluid, Yu et al. 2026, Eqs. 48 to 50. m/s
double exact_velocity(double y, double yield, double plastic_viscosity = viscosity) {
  const double plug = yield / force, from_middle = std::max(std::abs(y - 0.5 * height), plug);
  return (force * (0.25 * height * height - from_middle * from_middle) -
          2.0 * yield * (0.5 * height - from_middle)) /
         (2.0 * plastic_viscosity);
}

/// Relative L2 error of a profile.
template <class Exact>
double l2(const runs::Profile& profile, Exact exact) {
  double error = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < profile.value.size(); ++i) {
    const double u = exact(profile.coordinate[i]);
    error += (profile.value[i] - u) * (profile.value[i] - u);
    scale += u * u;
  }
  return std::sqrt(error / scale);
}

/// The same of a run's last profile, for the steady flow of a Bingham fluid.
double bingham_error(const runs::Run& run, double yield) {
  return l2(run.profiles.back(), [&](double y) { return exact_velocity(y, yield); });
}

scenes::Scene duct(const std::vector<std::string>& more) {
  return scenes::load_scene("poiseuille-step-down",
                            {with({"mpm.threads=1", "output.snapshot_interval=1000"}, more), {}});
}

std::string setting(const std::string& key, double value) { return key + "=" + std::to_string(value); }

/// Shear rate at a stress of tau = eta g + tau0 (1 - exp(-m g)), by bisection. 1/s
double papanastasiou_rate(double stress, double yield, double m) {
  double low = 0.0, high = stress / viscosity;
  for (int i = 0; i < 200; ++i) {
    const double g = 0.5 * (low + high);
    (viscosity * g - yield * std::expm1(-m * g) < stress ? low : high) = g;
  }
  return 0.5 * (low + high);
}

/// Steady velocity of the middle under a force: from dv/dy = g(tau), tau = F y' (y' from the middle), so that
/// v = (1/F) int_0^{F H/2} g dtau; Simpson's rule. m/s
double papanastasiou_creep(double driving, double yield, double m) {
  const int intervals = 2000;
  const double wall = 0.5 * driving * height, h = wall / intervals;
  double sum = 0.0;
  for (int i = 0; i <= intervals; ++i)
    sum += (i == 0 || i == intervals ? 1.0
            : i % 2 == 1             ? 4.0
                                     : 2.0) *
           papanastasiou_rate(i * h, yield, m) * h / 3.0;
  return sum / driving;
}

/// When a Bingham fluid between the plates stops, its force stepped down at zero from 2000 N/m3: the time at
/// which its plug's velocity falls below `slow`, by finite differences over half the height, velocities and
/// stresses staggered. The plug is held together by a stiff elasticity (twenty times the scene's), each
/// step's stress relaxed to the flow law.
double stopping_time(double driving, double yield, double slow) {
  const int cells = 250;
  const double dy = 0.5 * height / cells, modulus = 20.0 * 34138.0;
  const double dt = 0.5 * dy / std::sqrt(modulus / density);
  std::vector<double> velocity(cells),
      stress(cells + 1);  // y from the wall: velocity at centres, stress at faces
  for (int i = 0; i < cells; ++i)
    velocity[static_cast<std::size_t>(i)] = exact_velocity((i + 0.5) * dy, yield);
  for (int i = 0; i <= cells; ++i) stress[static_cast<std::size_t>(i)] = force * (0.5 * height - i * dy);
  double time = 0.0;
  while (velocity.back() > slow && time < 20.0) {
    for (std::size_t i = 0; i < velocity.size(); ++i)
      velocity[i] += dt / density * (driving + (stress[i + 1] - stress[i]) / dy);
    for (std::size_t i = 0; i + 1 < stress.size(); ++i) {
      const double gradient = i == 0 ? velocity[0] / (0.5 * dy) : (velocity[i] - velocity[i - 1]) / dy;
      const double trial = stress[i] + modulus * dt * gradient;
      const double rate = std::max(std::abs(trial) - yield, 0.0) / (viscosity + modulus * dt);
      stress[i] = trial - std::copysign(modulus * dt * rate, trial);
    }
    time += dt;
  }
  return time;
}

/// u = n / (n + 1) (F / K)^(1/n) ((H/2 - y0)^(1 + 1/n) - (y - y0)^(1 + 1/n)) outside the plug, y from the middle.
double herschel_bulkley_velocity(double y, double yield, double consistency, double n) {
  const double plug = yield / force, from_middle = std::max(std::abs(y - 0.5 * height), plug);
  const double power = 1.0 + 1.0 / n;
  return std::pow(force / consistency, 1.0 / n) / power *
         (std::pow(0.5 * height - plug, power) - std::pow(from_middle - plug, power));
}

/// Consistencies that make the plug about as fast as the benchmark's.
constexpr std::pair<double, double> powers[] = {{0.5, 200.0}, {1.3, 50.0}};

std::vector<std::string> power_duct(const std::string& model, double n, double consistency) {
  return {"material.model=" + model,
          "runs.mpm=" + model,
          "runs.foam=" + model,
          setting("material.flow_index", n),
          setting("material.plastic_viscosity", consistency),
          "material.regularisation_time=1000",
          "forces.body_force=[[0.0, 2000.0]]",
          "time.end=3"};
}

}  // namespace

class Duct : public RunTest {};

TEST_F(Duct, APowerOfTheRateFlowsInItsExactProfile) {
  for (const std::string model : {"herschel-bulkley", "elasto-viscoplastic"})
    for (const auto& [n, consistency] : powers) {
      const std::string name = model + ", n = " + std::to_string(n);
      const auto run = run_and_read(duct(power_duct(model, n, consistency)), name);
      const auto exact = [&, index = n, k = consistency](double y) {
        return herschel_bulkley_velocity(y, 100.0, k, index);
      };
      const double error = l2(run.profiles.back(), exact), plug = run.history.at("plug_velocity_m_s").back();
      std::printf("    %s: L2 %.3g, plug %.5g m/s of %.5g\n", name.c_str(), error, plug, exact(0.5 * height));
      EXPECT_LE(error, 0.02) << name;
      EXPECT_NEAR(plug, exact(0.5 * height), 0.02 * exact(0.5 * height)) << name;
    }
}

TEST_F(Duct, QuadraticApicMatchesTheExactProfileAndItsPlugDoesNotShear) {
  // Measured 5.7e-4, 4.8e-4, 3.4e-4 and 7.7e-4. Before the correction of the walls' transfer it was 2.0e-3 to
  // 2.7e-3 at CFL 0.75, and 4.2e-3 at 0.3.
  for (const double yield : {10.0, 50.0, 100.0, 200.0}) {
    const auto scene =
        duct({setting("material.yield_stress", yield), "time.end=12", "output.checkpoint_interval=12"});
    const std::string name = "yield " + std::to_string(yield);
    const auto run = run_and_read(scene, name);
    const double error = bingham_error(run, yield);
    std::printf("    yield %g Pa: L2 %.3g\n", yield, error);
    EXPECT_LE(error, 1e-3) << name;
    // The plug reaches yield / F from the middle; a cell either side of its edge shares its grid's nodes.
    Open open(all_of(read_checkpoint(folder / name)->solver), settings_of(scene));
    double fastest = 0.0;
    int in_plug = 0;
    for (std::size_t p = 0; p < open.size(); ++p) {
      if (std::abs(open.position(1, p) - 0.5 * height) > yield / force - 2.0 * 0.01) continue;
      fastest = std::max(fastest, open.rate()[p]);
      ++in_plug;
    }
    if (yield < 100.0) continue;  // 5 mm either side of the middle: narrower than a cell
    EXPECT_GT(in_plug, 300);
    EXPECT_EQ(fastest, 0.0) << "plastic shear rate in the plug, 1/s; at the wall it is "
                            << (force * 0.25 - yield) / viscosity;
  }
}

TEST_F(Duct, QuadraticApicDoesNotDependOnTheStep) {
  const auto profile = [&](const std::string& cfl) {
    return run_and_read(duct({"material.yield_stress=10", "time.end=12", "mpm.cell=0.02", "mpm.cfl=" + cfl}),
                        cfl)
        .profiles.back();
  };
  const runs::Profile usual = profile("0.75"), fine = profile("0.2");
  double difference = 0.0, scale = 0.0;
  ASSERT_EQ(usual.value.size(), fine.value.size());
  for (std::size_t i = 0; i < usual.value.size(); ++i) {
    difference += (usual.value[i] - fine.value[i]) * (usual.value[i] - fine.value[i]);
    scale += fine.value[i] * fine.value[i];
  }
  std::printf("    CFL 0.75 and 0.2 differ by %.3g\n", std::sqrt(difference / scale));
  EXPECT_LE(std::sqrt(difference / scale), 1e-3);
}

TEST_F(Duct, JitteredParticlesMatchTheExactProfile) {
  // Measured 3.2e-4, 6.8e-4, 3.1e-3 and 2.5e-3; seeds 2 to 4 at 100 and 200 Pa 1.9e-3 to 2.7e-3. With the
  // particles' own volumes for their shear stress (mpm/transfer/full_cells.h) up to 5.5e-3 and 7.9e-3.
  for (const double yield : {10.0, 50.0, 100.0, 200.0}) {
    const auto run = run_and_read(
        duct({setting("material.yield_stress", yield), "time.end=12", "mpm.seeding=jittered", "mpm.seed=1"}),
        "yield " + std::to_string(yield));
    const double error = bingham_error(run, yield);
    std::printf("    yield %g Pa: L2 %.3g\n", yield, error);
    EXPECT_LE(error, 5e-3) << yield << " Pa";
  }
}

TEST_F(Duct, ItsLatticeStaysOneInSinglePrecisionToo) {
  // Round-off disturbs the lattice, and disorder used to grow from it by e^1.7 a second: the plug ran 1 % too
  // fast from 12 s on (float) or 30 s (double). Measured at 30 s 1.1e-3, in float at 15 s 1.5e-3.
  const double yield = 100.0;
  for (const auto& [precision, end] : {std::pair{"double", 30}, std::pair{"float", 15}}) {
    const auto run =
        run_and_read(duct({setting("material.yield_stress", yield), "mpm.cell=0.0125",
                           fmt::format("mpm.precision={}", precision), fmt::format("time.end={}", end),
                           "forces.body_force=[[0.0, 2000.0]]"}),
                     precision);
    const double error = bingham_error(run, yield);
    std::printf("    %s, %d s: L2 %.2g\n", precision, end, error);
    EXPECT_LT(error, 2e-3) << precision;
  }
}

TEST_F(Duct, LinearFlipOnALatticeMatchesTheExactProfile) {
  // Measured 4.7e-4 at 10 Pa and 7.1e-4 at 200 Pa. How large a step the lattice bears before it breaks up
  // (2e-2 and more) depends on the plug: at 10 Pa it holds at CFL 0.3 and 0.1, at 200 Pa at 0.1 only, at 50
  // and 100 Pa at neither.
  for (const auto& [yield, cfl] : {std::pair{10.0, "0.3"}, std::pair{200.0, "0.1"}}) {
    const auto scene = duct({fmt::format("material.yield_stress={}", yield), "time.end=12",
                             "mpm.scheme=linear-flip", fmt::format("mpm.cfl={}", cfl),
                             "mpm.flip_relaxation_time=1e6", "mpm.particles_per_cell=[1,4]"});
    const double error = bingham_error(run_and_read(scene), yield);
    std::printf("    yield %g Pa: L2 %.3g\n", yield, error);
    EXPECT_LE(error, 1e-3) << yield << " Pa";
  }
}

TEST_F(Duct, NewtonianFlowConvergesAtLeastWithTheSquareOfTheCell) {
  // At 300 Pa s the flow is steady within a second. The force is a tenth of the others' tests: an elastic
  // fluid whose stress turns with the material is thinner by (rate * viscosity / shear modulus)^2 (Johnson
  // and Segalman 1977), 2e-4 at the wall under the whole force.
  const auto error = [&](const std::string& cell) {
    const auto scene = duct({"material.model=newtonian", "material.plastic_viscosity=300", "time.end=3",
                             "forces.body_force=[[0.0, 200.0]]", "mpm.cell=" + cell});
    return l2(run_and_read(scene, cell).profiles.back(),
              [](double y) { return 0.1 * exact_velocity(y, 0.0, 300.0); });
  };
  const double coarse = error("0.05"), fine = error("0.025"), finest = error("0.0125");
  std::printf("    L2 %.3g, %.3g, %.3g at 50, 25, 12.5 mm: order %.2f, %.2f\n", coarse, fine, finest,
              std::log2(coarse / fine), std::log2(fine / finest));
  EXPECT_GE(std::log2(coarse / fine), 1.8) << coarse << " and " << fine;
  EXPECT_GE(std::log2(fine / finest), 1.8) << fine << " and " << finest;
}

TEST_F(Duct, SteppedDownBelowYieldTheExactMaterialStopsWhenTheFiniteDifferencesSay) {
  const double slow = 2e-3;
  const auto run = run_and_read(duct({"time.end=18.5"}));
  const auto& time = run.history.at("time_s");
  const auto& plug = run.history.at("plug_velocity_m_s");
  double stopped = 0.0;
  for (std::size_t i = 1; i < time.size() && stopped == 0.0; ++i)
    if (time[i] > 12.0 && plug[i] < slow)
      stopped = time[i - 1] + (time[i] - time[i - 1]) * (plug[i - 1] - slow) / (plug[i - 1] - plug[i]) - 12.0;
  const double expected = stopping_time(360.0, 100.0, slow);
  std::printf("    stops after %.4g s, finite differences %.4g s\n", stopped, expected);
  EXPECT_LT(expected, 5.87) << "the bound for all Bingham flows";
  EXPECT_NEAR(stopped, expected, 0.03 * expected);
  // It stays where it is but for its elastic swing, which has no mean.
  double mean = 0.0;
  int rows = 0;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (time[i] > 17.5) {
      mean += plug[i];
      ++rows;
    }
  EXPECT_LT(std::abs(mean / rows), 2e-3) << "m/s, of 1.33 m/s before";
}

TEST_F(Duct, BelowYieldARegularisedFluidCreepsAsFastAsItsLawSays) {
  // Put on at once, the force would set the fluid swinging (it is a spring beside a viscosity of m tau0) a
  // thousand times faster than it creeps. It grows over two seconds, eight of the slowest swing's periods,
  // and what still swings is averaged out. Measured: 16.87, 1.840, 0.1859 and 0.01877 mm/s of 16.85, 1.839,
  // 0.1858 and 0.01860.
  std::string ramp = "forces.body_force=[";
  const int stairs = 100;
  for (int i = 0; i < stairs; ++i) {
    const double done = (i + 0.5) / stairs;
    ramp += fmt::format("{}[{}, {}]", i == 0 ? "" : ", ", i == 0 ? 0.0 : 2.0 * i / stairs,
                        360.0 * 0.5 * (1.0 - std::cos(std::numbers::pi * done)));
  }
  ramp += ", [2.0, 360.0]]";
  for (const double m : {10.0, 100.0, 1e3, 1e4}) {
    const auto scene = duct({"material.model=papanastasiou", setting("material.regularisation_time", m), ramp,
                             "mpm.cell=0.02", "time.end=8"});
    const auto run = run_and_read(scene, std::to_string(m));
    const double expected = papanastasiou_creep(360.0, 100.0, m);
    const auto& time = run.history.at("time_s");
    const auto& plug = run.history.at("plug_velocity_m_s");
    double creep = 0.0, least = 1.0, most = 0.0;
    int rows = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
      if (time[i] < 4.0) continue;
      creep += plug[i];
      least = std::min(least, plug[i]);
      most = std::max(most, plug[i]);
      ++rows;
    }
    creep /= rows;
    std::printf("    m = %g s: creeps at %.4g m/s (%.4g to %.4g), its law says %.4g\n", m, creep, least, most,
                expected);
    EXPECT_NEAR(creep, expected, 0.05 * expected) << "m = " << m;
  }
  EXPECT_NEAR(papanastasiou_creep(360.0, 100.0, 10.0), 1.69e-2, 1e-4);
  EXPECT_NEAR(papanastasiou_creep(360.0, 100.0, 100.0), 1.84e-3, 1e-5);
  EXPECT_NEAR(papanastasiou_creep(360.0, 100.0, 1e3), 1.86e-4, 1e-6);
  EXPECT_NEAR(papanastasiou_creep(360.0, 100.0, 1e4), 1.86e-5, 1e-7);
}

TEST_F(Duct, FlocculationAtRestGrowsExactlyWithTime) {
  const auto scene = duct({"forces.body_force=[[0.0, 100.0]]", "time.end=1", "mpm.cell=0.05",
                           "thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                           "thixotropy.initial_flocculation=1.8"});
  const auto run = run_and_read(scene);
  for (std::size_t i = 0; i < run.history.rows(); ++i)
    ASSERT_NEAR(run.history.at("flocculation_mean")[i], 1.8 + 0.39 / 100.0 * run.history.at("time_s")[i],
                1e-12);
}
