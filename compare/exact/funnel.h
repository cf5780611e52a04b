#pragma once

#include <functional>
#include <vector>

/// A funnel that runs out as a plug that slides: what is known of it in closed form but for two integrals.
namespace flowrest::compare::exact {

/// Upright walls on all four sides, heights from the outlet.
struct Funnel {
  double height = 0.0;                  ///< m, of the material at the start
  double neck = 0.0;                    ///< m, of the straight part over the outlet
  double depth = 0.0;                   ///< m, between the plates
  std::function<double(double)> width;  ///< m, between the slopes at a height
  double area(double at) const { return depth * width(at); }
  double volume_below(double at) const;  ///< m3
};

/// Whether concrete in the neck leaves its walls, or is drawn down it as in a pipe that seals.
enum class Neck { lets_go, seals };

/// Unsteady Bernoulli flow with Coulomb friction on the walls. Across a section the speed is one, u = Q / A;
/// along the way rho (Q'/A + u du/ds) = rho g - dp/ds - mu max(p, 0) P / A with the perimeter P; the pressure
/// is zero at the surface and at the exit. The exit is the neck's top where the neck lets go, from where
/// material falls freely; where it seals it is the outlet, and the neck is under suction, which no wall answers
/// with friction. Neither yield stress nor viscosity enter: it slides.
class FunnelFlow {
 public:
  struct State {
    double time = 0.0;        ///< s
    double surface = 0.0;     ///< m, height of the surface
    double discharged = 0.0;  ///< share of the volume that is below the outlet
    double suction = 0.0;     ///< Pa, the largest tension in the neck; 0 where there is none
  };

  /// `friction` is mu. @throws std::invalid_argument where sizes, gravity or density are not above 0
  FunnelFlow(const Funnel&, double density, double gravity, double friction, Neck);

  /// From rest until all has left, a state each `interval` seconds, or to `end`.
  std::vector<State> run(double end, double interval) const;

 private:
  struct Profile {
    double exit_pressure = 0.0, lowest_pressure = 0.0;
  };
  Profile pressure(double surface, double flow, double acceleration) const;
  double acceleration(double surface, double flow) const;

  Funnel funnel_;
  double density_, gravity_, friction_, exit_;
  Neck neck_;
};

}  // namespace flowrest::compare::exact
