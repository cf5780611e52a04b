#pragma once

#include "elements/slump.h"

namespace flowrest::elements {

/// What is read off a slump's shape at one time.
struct Reading {
  double time = 0.0;  ///< s
  double spread = 0.0, spread_half = 0.0,
         spread_double = 0.0;  ///< m, at the spread's depth, half and twice of it
  double height = 0.0;         ///< m, at the centre
  double volume = 0.0;         ///< m3
};
Reading reading_of(const Slump&);

/// Depths at radii, m.
struct DepthProfile {
  std::vector<double> radius, depth;
};

/// A slump followed from row to row of a record. Between its steps readings are interpolated linearly in
/// time: a step is so short a part of the time gone by that this costs less than the step itself. Depths are
/// interpolated at equal shares of the radius, so that a front stays as steep as it is.
class Follower {
 public:
  Follower(const Problem&, const Resolution&);

  /// Goes on until its last step ends at or after `time`; no step goes past `stop`.
  void reach(double time, double stop);
  Reading at(double time) const;
  DepthProfile profile(double time) const;
  const Slump& slump() const { return slump_; }

 private:
  double share_of_step(double time) const;

  Slump slump_;
  Reading before_, now_;
  Surface surface_before_;
};

}  // namespace flowrest::elements
