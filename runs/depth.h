#pragma once

#include <limits>
#include <span>
#include <vector>

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

/// Accumulates volumes (of the whole body) into rings. A volume at radius r is shared between the two nearest
/// ring centres (nearly a tent of one ring's width, corrected so that a uniform layer is uniform up to the
/// axis), so that the sum is the volume whatever the sampling. What lies beyond the last ring's centre counts
/// to the last ring.
class RadialDepthAccumulator {
 public:
  RadialDepthAccumulator(double spacing, double largest_radius);
  void add(double radius, double volume);
  RadialDepth depth() const;

 private:
  double spacing_;
  std::vector<double> volume_;
};

/// Twice the radius at which the depth falls through `threshold` for the last time going outwards,
/// interpolated linearly between ring centres; nothing where the depth is nowhere above it. m
double spread(std::span<const double> radius, std::span<const double> depth, double threshold);

/// Depth at the centre, m: the line fitted by least squares to the depths within a quarter of the radius of
/// the spread at `spread_depth`, two rings at least, each counting by its area, taken at r = 0; nothing
/// without rings. An arrested profile falls linearly from its centre; the innermost ring alone holds so few
/// particles that it says more of where they were put.
double centre_depth(std::span<const double> radius, std::span<const double> depth, double spread_depth);

/// Where the depth over equal bins along a channel falls through `front_depth` for the last time,
/// interpolated between their centres; the channel's length where the last bin is deeper; nothing where none
/// is. m
double front(std::span<const double> centre, std::span<const double> depth, double length,
             double front_depth);

/// Mean of the first or the last depths of a channel over about `length`, one bin at least; nothing without
/// bins. m
enum class ChannelEnd { first, last };
double depth_at_end(std::span<const double> depth, double bin_width, ChannelEnd, double length);

}  // namespace flowrest::runs
