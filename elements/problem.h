#pragma once

#include "laws/law.h"
#include "scenes/scene.h"

/// Finite elements as a referee between the solvers: an incompressible slump with a free surface, by a method
/// that shares no code with either.
namespace flowrest::elements {

enum class Symmetry { about_axis, plane };
enum class Floor { no_slip, slip };

/// What is computed, read off the scene in one place.
struct Problem {
  Symmetry symmetry = Symmetry::about_axis;
  Floor floor = Floor::no_slip;
  double height = 0.0;         ///< m, of the cone
  double radius_top = 0.0;     ///< m; of a plane section half its width there
  double radius_bottom = 0.0;  ///< m
  double domain_radius = 0.0;  ///< m; material that reaches it ends the run
  double density = 0.0;        ///< kg/m3
  double gravity = 0.0;        ///< m/s2
  laws::FlowCurve flow;        ///< with the yield stress that a constant structure gives
  double end = 0.0;            ///< s
  double spread_depth = 0.0;   ///< m
  double history_interval = 0.0, profile_interval = 0.0, field_interval = 0.0;  ///< s

  bool has_yield_stress() const {
    return laws::has_yield_stress(flow.law) && flow.parameters.yield_stress > 0.0;
  }
  /// Whether the law must be rounded at zero rate to have a viscosity there.
  bool is_rounded() const { return laws::can_rest(flow.law) && has_yield_stress(); }
};

/// @throws runs::RunError where the elements do not serve the scene: what stands in the way and what is
/// allowed.
Problem problem_of(const scenes::Scene&);

}  // namespace flowrest::elements
