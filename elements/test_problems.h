#pragma once

#include "elements/slump.h"

/// Problems that tests start from.
namespace flowrest::elements::test {

/// Roussel's slump (Roussel et al. 2016).
inline Problem roussel() {
  Problem problem;
  problem.height = 0.3;
  problem.radius_top = 0.05;
  problem.radius_bottom = 0.1;
  problem.domain_radius = 0.6;
  problem.density = 2300.0;
  problem.gravity = 9.81;
  problem.flow.law = laws::Law::elasto_viscoplastic;
  problem.flow.parameters = {50.0, 50.0, 100.0, 0.01};
  problem.end = 60.0;
  problem.spread_depth = 0.003;
  return problem;
}

inline Problem newtonian() {
  Problem problem = roussel();
  problem.flow.law = laws::Law::newtonian;
  return problem;
}

inline Resolution coarse(int columns = 24, int rows = 4, double step_over_time = 0.04) {
  return {columns, rows, step_over_time, 1e-4};
}

inline void advance(Slump& slump, double time) {
  while (slump.time() < time) slump.step(time);
}

inline double spread_mm(const Slump& slump) {
  return 1e3 * slump.surface().spread(slump.problem().spread_depth);
}

}  // namespace flowrest::elements::test
