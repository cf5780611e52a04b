#pragma once

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "scenes/scene.h"

/// When material that can rest is at rest: one definition for every solver.
namespace flowrest::runs {

/// The rate at which material without structure would be overstressed as this is, 1/s: with the power n of its
/// rate, rate / (1 + structure)^(1 / n). `structure`: the part by which the local yield stress passes tau0.
inline double overstressing_rate(double shear_rate, double structure, double flow_index) {
  return flow_index == 1.0 ? shear_rate / (1.0 + structure)
                           : shear_rate / std::pow(1.0 + structure, 1.0 / flow_index);
}

/// Follows the overstress of the material: by what part its stress passes the yield stress where it shears,
/// K rate^n over the local yield stress, (1 + lambda) tau0 and what has grown with age. What governs is its 99th
/// percentile by mass: the fastest of a hundred parts of the material, so that a single particle or cell in a
/// film that dries up keeps nothing from resting.
///
/// A slump reads of it how much it can still grow: its spread goes with tau0^(-1/5), so a slump whose stress
/// nowhere passes the yield stress by more than the part e can grow by the part e / 5 at most.
///
/// At the start, and where the driving force changes, nothing shears yet, and that is no rest. So rest counts
/// once it has lasted for twice the time in which what drives moves the material over its own height.
class Rest {
 public:
  explicit Rest(const scenes::Scene&);

  /// Whether its law can rest and it has a yield stress: a fluid is never at rest, and nothing bounds the
  /// growth of what has no yield stress.
  bool can_rest() const { return viscosity_over_yield_ > 0.0; }
  /// Of a place that shears at this rate in 1/s; 0 of material that cannot rest. `structure`: the part by which
  /// its yield stress passes tau0, lambda and what has grown with age.
  double overstress(double shear_rate, double structure = 0.0) const {
    const double power = flow_index_ == 1.0 ? shear_rate : std::pow(shear_rate, flow_index_);
    return viscosity_over_yield_ * power / (1.0 + structure);
  }

  /// `overstress` is the one that governs; `nothing` where there is none to read, which is no rest. s
  void add(double time, double overstress);
  /// Goes on with a run that has been calm since this time, s; nothing where it is not.
  void restore(double time, std::optional<double> calm_since);

  /// Part by which the spread can still grow at most; nothing of a fluid, which always has some to come, and
  /// where nothing is read.
  std::optional<double> growth_to_come() const { return growth_; }
  std::optional<double> calm_since() const { return calm_since_; }  ///< s
  /// Since when it rests, where it has lasted long enough to be believed. s
  std::optional<double> rest_time() const;
  /// Whether the run is to end now: a scene may ask to go on.
  bool at_rest() const { return stops_ && rest_time().has_value(); }
  /// How long calm must last at a time to be believed, s.
  double patience(double time) const;

 private:
  double last_change_of_force(double time) const;

  double viscosity_over_yield_ = 0.0;  ///< s^n; 0: cannot rest
  double flow_index_ = 1.0;            ///< n
  bool stops_;
  double bound_;  ///< on the growth to come
  double height_, gravity_, density_;
  std::vector<std::pair<double, double>> body_force_;  ///< from s, N/m3
  double time_ = 0.0;
  std::optional<double> growth_, calm_since_;
};

}  // namespace flowrest::runs
