#pragma once

#include <limits>
#include <span>
#include <vector>

#include "runs/nose.h"

/// Depth and the measures made of it, defined once for every solver: concrete volume per plan area.
namespace flowrest::runs {

/// What a gauge gives that has nothing to read: no number in memory, an empty cell in CSV, null in JSON. It
/// is never 0, which is a reading.
inline constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Depth of a slump over equal rings of width `spacing`: ring i covers [i, i + 1) * spacing, its centre at (i
/// + 1/2).
struct RadialDepth {
  double spacing = 0.0;       ///< m
  std::vector<double> depth;  ///< m
  std::vector<double> centres() const;
  /// Integral of depth over the plan area, m3.
  double volume() const;
};

/// Shares volumes (of the whole body) out over equal rings about an axis, or equal strips beside a plane. Each
/// volume lies evenly between its place - grain / 2 and its place + grain / 2: a particle's width as it was
/// placed. The sum is the volume whatever the sampling, and a uniform layer is uniform up to the axis. What
/// lies beyond the last ring counts to the last ring.
class DepthAccumulator {
 public:
  /// All in m; the grain is at most `spacing`. @throws std::invalid_argument otherwise
  DepthAccumulator(About about, double spacing, double extent, double grain);
  /// `place` is the distance from the axis or the plane, m. `volume` in m3, beside a plane per width in m2.
  void add(double place, double volume);
  std::vector<double> depth() const;  ///< m, of each ring
  std::vector<double> centres() const;

 private:
  double area(std::size_t ring) const;  ///< m2, beside a plane per width in m
  void add_to(long ring, double volume);

  About about_;
  double spacing_, grain_;
  std::vector<double> volume_;
};

/// Twice the distance from the middle at which the depth falls through `threshold` for the last time going
/// outwards (edge_of_depth); nothing where the depth is nowhere above it. m
double spread(const DepthView&, double threshold);

/// Depth at the centre, m: the line fitted by least squares to the depths within a quarter of the radius of
/// the spread at `spread_depth`, two rings at least, and four where they lie within 0.4 of it, each counting by
/// its area, taken at r = 0; nothing
/// without rings. An arrested profile falls linearly from its centre; the innermost ring alone holds so few
/// particles that it says more of where they were put.
double centre_depth(const DepthView&, double spread_depth);

/// Where the depth over equal bins along a channel falls through `front_depth` for the last time
/// (edge_of_depth); the channel's length where the last bin is deeper; nothing where none is. m
double front(std::span<const double> centre, std::span<const double> depth, double length,
             double front_depth);

/// Mean of the first or the last depths of a channel over about `length`, one bin at least; nothing without
/// bins. m
enum class ChannelEnd { first, last };
double depth_at_end(std::span<const double> depth, double bin_width, ChannelEnd, double length);

}  // namespace flowrest::runs
