#include "mpm/output/noise.h"

#include <cmath>

#include "mpm/output/test_runs.h"
#include "mpm/solver/test_bodies.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;
using testing::HasSubstr;
using testing::Not;

namespace {

/// A block of 4 x 3 (x 3) cells of three particles an axis, that move as `velocity` says of their place
/// (cells).
std::unique_ptr<Solver> moving(const SolverSettings& s,
                               const std::function<std::array<double, 3>(std::array<double, 3>)>& velocity) {
  auto seeds = block(s, {0, 0, 0}, {4, 3, s.dimension == 3 ? 3 : 0}, 3);
  for (Seed& seed : seeds) {
    std::array<double, 3> place{};
    for (std::size_t a = 0; a < 3; ++a) place[a] = seed.cell[a] + seed.position[a];
    seed.velocity = velocity(place);
  }
  return make_solver(s, seeds);
}

std::vector<CellMotion> cells_at(const std::vector<double>& velocities) {
  std::vector<CellMotion> cells;
  for (const double v : velocities)
    cells.push_back({{static_cast<int>(cells.size()), 0, 0}, 2.0, {v, 0.0, 0.0}});
  return cells;
}

}  // namespace

TEST(Noise, WhatIsLinearInSpaceIsNone) {
  for (const Variant& v : every_variant()) {
    const SolverSettings s = concrete(v);
    const auto solver = moving(s, [&](const std::array<double, 3>& x) {
      return std::array<double, 3>{0.3 + 0.1 * x[0] - 0.2 * x[1], 0.4 * x[0] + 0.2 * x[2],
                                   s.dimension == 3 ? x[1] - x[2] : 0.0};
    });
    const VelocityNoise noise = noise_within_cells(*solver, s.dimension, s.cell);
    EXPECT_GT(noise.speed, 0.3) << name_of(v);
    EXPECT_LT(noise.within_cells, 2e-6 * noise.speed) << name_of(v);  // float
  }
}

TEST(Noise, AParabolaIsWhatItsThreePointsLeave) {
  // Three places a third of a cell apart: squares differ from their line by 1/3, -2/3 and 1/3 of a ninth.
  for (const Variant& v : every_variant()) {
    const SolverSettings s = concrete(v);
    const auto solver = moving(s, [](const std::array<double, 3>& x) {
      return std::array<double, 3>{x[1] * x[1], 0.0, 0.0};
    });
    const double particles = std::pow(3.0, s.dimension), free = particles - 1.0 - s.dimension;
    const double expected = std::sqrt(particles / 3.0 * (6.0 / 9.0) / 81.0 / free);
    EXPECT_NEAR(noise_within_cells(*solver, s.dimension, s.cell).within_cells, expected, 1e-5 * expected)
        << name_of(v);
  }
}

TEST(Noise, CellsOfTooFewParticlesSayNothing) {
  const SolverSettings s = concrete(every_variant().front());
  auto seeds = block(s, {0, 0, 0}, {2, 2, 0}, 1);
  for (Seed& seed : seeds) seed.velocity = {seed.cell[0] % 2 == 0 ? 1.0 : -1.0, 0.0, 0.0};
  const VelocityNoise noise = noise_within_cells(*make_solver(s, seeds), s.dimension, s.cell);
  EXPECT_NEAR(noise.speed, 1.0, 1e-7);
  EXPECT_EQ(noise.within_cells, 0.0);
}

TEST(Noise, AnAlternationIsItsAmplitudeAndAnAccelerationIsNone) {
  EXPECT_NEAR(alternation({cells_at({1.0, 5.0}), cells_at({0.0, 5.0}), cells_at({1.0, 5.0})}, 0.1, 0.1),
              0.5 / std::sqrt(2.0), 1e-15);
  // 2 m/s2 over unequal steps.
  EXPECT_NEAR(alternation({cells_at({1.0, 1.0}), cells_at({1.2, 1.2}), cells_at({1.6, 1.6})}, 0.1, 0.2), 0.0,
              1e-15);
  // A cell that was empty has no history.
  EXPECT_EQ(alternation({cells_at({1.0}), cells_at({1.0, 3.0}), cells_at({1.0, -3.0})}, 0.1, 0.1), 0.0);
  EXPECT_EQ(alternation({cells_at({}), cells_at({}), cells_at({})}, 0.1, 0.1), 0.0);
}

TEST(Noise, IsAFaultOnlyWhereItIsALargeShareOfAMotionThatMatters) {
  const auto record = [](double seconds, double speed, double within, double between) {
    NoiseRecord r;
    for (int i = 1; i <= 10; ++i) r.add(seconds * i / 10.0, {speed, within, between});
    return r.fault(0.3);
  };
  EXPECT_EQ(record(10.0, 1.0, 0.29, 0.09), "");   // small shares
  EXPECT_EQ(record(10.0, 2e-4, 1e-4, 1e-4), "");  // 1 mm in all; 3 mm matter
  EXPECT_EQ(record(10.0, 0.0, 0.0, 0.0), "");
  EXPECT_THAT(record(10.0, 1e-3, 5e-4, 0.0), HasSubstr("within cells"));
  EXPECT_THAT(record(10.0, 1e-3, 5e-4, 0.0), HasSubstr("50 % of the speed between 0.00 and 10.00 s"));
  EXPECT_THAT(record(10.0, 1e-3, 0.0, 4e-4), HasSubstr("alternate from step to step, 40 %"));
}

class NoisyRun : public RunTest {};

TEST_F(NoisyRun, WithoutItsRelaxationEitherTransferIsCalledNoisyAndWithItIsNot) {
  for (const auto& [scheme, relaxation] :
       {std::pair<std::string, std::string>{"linear-flip", "flip_relaxation_time"},
        {"quadratic-apic", "apic_relaxation_time"}}) {
    const std::vector<std::string> usual = {"mpm.scheme=" + scheme, "time.end=1"};
    const auto run = run_and_read(tiny_slump(usual), "usual");
    EXPECT_THAT(run.info["verdict"].get<std::string>(), Not(HasSubstr("differ within cells"))) << scheme;
    const auto noisy = run_and_read(tiny_slump(with(usual, {"mpm." + relaxation + "=1000"})), "noisy");
    EXPECT_THAT(noisy.info["verdict"].get<std::string>(), HasSubstr("noisy: velocities differ within cells"))
        << scheme;
    EXPECT_GT(noisy.info["noise"]["within_cells"]["path_m"], 0.003) << scheme;
  }
}

TEST_F(NoisyRun, TheChatterOfAFluidPastItsViscousLimitIsMeasured) {
  const std::vector<std::string> fluid = {"material.model=papanastasiou", "time.end=10",
                                          "output.snapshot_interval=100", "output.checkpoint_interval=100"};
  const auto alternates = [&](const std::vector<std::string>& more, const std::string& name) {
    const auto run = run_and_read(tiny_slump(with(fluid, more)), name);
    return run.info["noise"]["between_steps"]["path_m"].get<double>();
  };
  EXPECT_GT(alternates({"mpm.fluid_update=explicit", "mpm.time_step=0.001", "mpm.allow_unstable_step=true"},
                       "past"),
            0.0005);
  EXPECT_LT(alternates({}, "implicit"), 1e-4);
}
