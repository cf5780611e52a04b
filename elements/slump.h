#pragma once

#include <string>

#include "elements/flow.h"

namespace flowrest::elements {

/// How finely a slump is computed.
struct Resolution {
  int columns = 60, rows = 6;  ///< of elements
  double step_over_time =
      0.03;  ///< a step, of the time since the release and half that of a fall from the cone's height
  double rounding = 1e-4;  ///< 1/s, at which a law that can rest is rounded
  /// The same with elements and steps `factor` times as large.
  Resolution coarser(double factor) const;
};

/// Counters of what a slump's steps have come to.
struct StepRecord {
  int steps = 0, iterations = 0, repeated = 0;
  int closed = 0;  ///< wedges of air under the front that were wider than usual and closed to go on
  double largest_divergence = 0.0;  ///< 1/s
  double volume_corrected =
      0.0;  ///< sum of what the steps' corrections of volume changed it by, of the volume
};

/// A slump as it spreads. Velocities live in the middle of steps, in the shape that the body has there; so
/// positions are second order in the step. Inertia is taken from the two velocities before (BDF2). Nodes of
/// the surface that would pass through the floor come to lie on it and are held there. After each step the
/// surface has moved with the material, and a new mesh is laid under it.
class Slump {
 public:
  Slump(const Problem&, const Resolution&);

  /// One step, at most to `target`.
  /// @throws runs::NumericsError where no step is short enough.
  void step(double target);

  double time() const { return time_; }
  const Surface& surface() const { return surface_; }
  const Mesh& mesh() const { return mesh_; }
  /// Of the last step, on the mesh; at rest at the start. m/s
  const Field& velocity() const { return velocity_[0]; }
  const Flow& flow() const { return flow_; }
  const FlowOutcome& outcome() const { return outcome_; }
  const StepRecord& record() const { return record_; }
  const Problem& problem() const { return problem_; }

 private:
  struct Tried;
  double longest_step() const;
  FlowTask task_of(double step) const;
  std::vector<char> held_at_walls() const;
  bool try_step(double step, Tried&);
  bool land(double step, Tried&, FlowTask&) const;
  std::vector<Point> moved_markers(double step, const Field& velocity) const;
  void accept(double step, const Tried&);
  void lay_mesh(const Surface&, const Mesh& carried, const std::vector<Field>& velocities);
  bool close_front();

  Problem problem_;
  Resolution resolution_;
  Topology topology_;
  Surface surface_;
  double volume_;  ///< m3
  Mesh mesh_;
  Flow flow_;
  double time_ = 0.0, step_ = 0.0;  ///< s
  std::vector<Field> velocity_;     ///< of the last step and of the one before, carried along by the material
  std::vector<double> middle_;      ///< s, when they were
  FlowOutcome outcome_;
  StepRecord record_;
};

}  // namespace flowrest::elements
