// Two methods that share nothing: finite elements and the thin film under its plug's pull.
#include <gtest/gtest.h>

#include "compare/exact/film.h"
#include "elements/test_problems.h"
#include "runs/depth.h"

using namespace flowrest;

TEST(ElementsAndFilm, AgreeOnceTheSlumpIsThin) {
  const elements::Problem problem = elements::test::roussel();
  elements::Slump slump(problem, elements::test::coarse(30, 4));
  const auto& p = problem.flow.parameters;
  auto film = compare::exact::bingham_film({problem.density, p.yield_stress, p.plastic_viscosity},
                                           problem.gravity, problem.radius_bottom,
                                           slump.surface().volume(problem.symmetry), 0.45, 225, true);
  for (const double time : {5.0, 10.0, 20.0}) {
    elements::test::advance(slump, time);
    film.advance_to(time);
    const auto centres = film.state().centres();
    const double spread = 1e3 * runs::spread({centres, film.state().depth}, problem.spread_depth);
    EXPECT_NEAR(elements::test::spread_mm(slump) / spread, 1.0, 5e-3) << time;
  }
}
