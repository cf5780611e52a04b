#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "mpm/boundary/nozzle.h"
#include "mpm/solver/solver.h"

namespace flowrest::mpm {

/// Over which a feed's first discs take their speed, s.
constexpr double first_feed_step = 1e-4;

/// Keeps a nozzle's bore filled from its mouth to two cells above it, with discs of particles that stand where
/// the column is at the moment they come. Material s metres up the column passes the mouth when s metres have
/// been extruded; discs are equally thick, and the last one is cut where the column ends, so that all of
/// them together have the volume pi R^2 s, and so have those that have passed, to within a disc.
class Feed {
 public:
  /// `per_axis` particles along each axis of a cell (m); `half`: only y > 0 is computed.
  Feed(const Nozzle&, double cell, int per_axis, bool half, double flocculation);

  /// The discs that are due at `time`, moving as the column does on average over the `step` s after it.
  std::vector<Seed> due(double time, double step);
  /// How many are due at `time` and have not come.
  std::size_t count_due(double time) const;
  /// The next `count` discs, whether they are due or not: what `due` gives of a feed that is a little faster or
  /// slower, disc by disc.
  std::vector<Seed> next(std::size_t count, double time, double step);
  /// Takes the next `count` for come.
  void pass_over(std::size_t count) { discs_ += count; }
  /// Takes those that are due at `time` for come, as where a run is gone on with.
  void skip_to(double time);
  std::size_t discs() const { return discs_; }
  /// m3 of the computed part, of them all.
  double volume() const;

 private:
  struct Site {
    double x, y;  ///< m from the axis
  };
  bool is_due(std::size_t disc, double time) const;
  double begin_of(std::size_t disc) const { return thickness_ * static_cast<double>(disc); }
  double end_of(std::size_t disc) const { return std::min(begin_of(disc + 1), nozzle_.column); }

  Nozzle nozzle_;
  double cell_, thickness_, area_;
  double flocculation_;
  std::vector<Site> sites_;
  std::size_t discs_ = 0;
};

/// The feeds of a scene, one after the other.
class Feeds {
 public:
  Feeds(const SolverSettings&, int per_axis, bool half, double flocculation);
  bool any() const { return !feeds_.empty(); }
  /// As those of Feed.
  std::vector<Seed> due(double time, double step);
  void skip_to(double time);
  double volume() const;
  /// Of each feed, as those of Feed.
  void pass_over(const std::vector<std::size_t>& counts);
  std::vector<std::size_t> count_due(double time) const;
  std::vector<Seed> next(const std::vector<std::size_t>& counts, double time, double step);

 private:
  std::vector<Feed> feeds_;
};

}  // namespace flowrest::mpm
