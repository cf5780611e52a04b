#pragma once

#include <string>

#include "runs/run_directory.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// Watches what a flow must keep: the volume of its concrete, and no more motion than its weight can give.
class Conservation {
 public:
  /// By what share the volume may change in a run that counts as sound. Sound runs stay below 2e-6 in slumps
  /// and 5e-5 in L-boxes; one whose air raced through the bars lost 1.4e-3.
  static constexpr double volume_allowed = 2e-4;

  /// `volume` that the concrete should have at the start, m3.
  Conservation(const scenes::Scene&, double volume);

  /// At `time` in s the mesh holds `volume` in m3, which moves with `kinetic_energy` in J.
  void add(double time, double volume, double kinetic_energy);
  /// Counts the rows that a run has behind it.
  void continue_from(const runs::Table& history);

  double first_volume() const { return first_volume_; }  ///< m3
  /// By how much the first volume differs from that of the scene, relative.
  double initial_error() const { return first_volume_ / scene_volume_ - 1.0; }
  /// By how much the volume has changed since the start, relative; 0 where concrete may leave.
  double error() const;
  double largest_error() const { return largest_error_; }  ///< without its sign

  /// Why the run can give no answer any more; empty where it can.
  std::string fault() const;
  /// Why its answer is in doubt; empty where it is not.
  std::string doubt() const;

 private:
  void note_error(double time, double error);

  bool may_leave_, has_begun_ = false;
  double scene_volume_;  ///< m3
  double energy_bound_;  ///< J
  double time_ = 0.0, volume_ = 0.0, kinetic_energy_ = 0.0;
  double first_volume_ = 0.0;
  double largest_error_ = 0.0;
  double doubted_since_ = 0.0;  ///< s
};

/// Volume of the concrete at the start, of the whole body, m3; of a plane m3 to a metre.
double initial_volume(const scenes::Scene&);

}  // namespace flowrest::foam
