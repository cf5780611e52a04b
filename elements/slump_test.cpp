#include "elements/slump.h"

#include <gtest/gtest.h>

#include <cmath>

#include "elements/test_problems.h"
#include "runs/errors.h"

using namespace flowrest::elements;
using namespace flowrest::elements::test;

TEST(Slump, RousselsConeFallsAsComputedIndependently) {
  Slump slump(roussel(), coarse());
  EXPECT_NEAR(spread_mm(slump), 199.0, 1e-6);
  // An independent program's values, sharp at 3 mm, known to 1 mm; 0.3 % for the coarse grid.
  for (const auto& [time, spread] : {std::pair{0.1, 233.3}, {0.3, 364.4}, {0.5, 402.5}, {1.0, 442.1}}) {
    advance(slump, time);
    EXPECT_NEAR(spread_mm(slump) / spread, 1.0, 3e-3) << time;
  }
  EXPECT_NEAR(1e3 * slump.surface().markers().front().y(), 50.2, 0.5);
  EXPECT_LT(slump.record().largest_divergence, 1e-7);
}

TEST(Slump, KeepsItsVolume) {
  for (const Symmetry symmetry : {Symmetry::about_axis, Symmetry::plane}) {
    Problem problem = roussel();
    problem.symmetry = symmetry;
    problem.domain_radius = 2.0;
    Slump slump(problem, coarse());
    const double volume = slump.surface().volume(symmetry);
    advance(slump, 0.4);
    EXPECT_NEAR(slump.surface().volume(symmetry) / volume, 1.0, 1e-6);
    EXPECT_LT(slump.record().volume_corrected, 5e-3) << "all that steps had to be corrected by";
  }
}

TEST(Slump, ShorterStepsChangeLittle) {
  Slump long_steps(roussel(), coarse()), short_steps(roussel(), coarse(24, 4, 0.02));
  advance(long_steps, 0.5);
  advance(short_steps, 0.5);
  EXPECT_NEAR(spread_mm(long_steps) / spread_mm(short_steps), 1.0, 5e-4);
}

TEST(Slump, SpreadsFartherOnAFloorWithoutFriction) {
  Problem slippery = roussel();
  slippery.floor = Floor::slip;
  Slump held(roussel(), coarse()), free(slippery, coarse());
  advance(held, 0.3);
  advance(free, 0.3);
  EXPECT_GT(spread_mm(free), spread_mm(held) + 20.0);
  EXPECT_NEAR(free.surface().volume(Symmetry::about_axis) / held.surface().volume(Symmetry::about_axis), 1.0,
              1e-6);
}

TEST(Slump, AStiffConeStands) {
  Problem stiff = roussel();
  stiff.flow.parameters.yield_stress = 5000.0;
  Slump slump(stiff, coarse());
  advance(slump, 1.0);
  EXPECT_NEAR(spread_mm(slump), 199.0, 0.05);
  EXPECT_NEAR(slump.surface().markers().front().y(), 0.3, 1e-4);
}

TEST(Slump, EndsWhereTheDomainEnds) {
  Problem problem = roussel();
  problem.domain_radius = 0.12;
  Slump slump(problem, coarse());
  EXPECT_THROW(advance(slump, 0.5), flowrest::runs::NumericsError);
}
