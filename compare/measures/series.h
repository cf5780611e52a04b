#pragma once

#include <optional>
#include <span>
#include <vector>

/// Measures of quantities against time and of profiles against a coordinate, as plain functions.
namespace flowrest::compare {

/// A quantity against time; times ascend, and every value is finite.
struct Series {
  std::vector<double> time;  ///< s
  std::vector<double> value;
  bool empty() const { return time.empty(); }
  double end() const { return time.back(); }
  /// Linear between samples, constant beyond them.
  double at(double t) const;
};

/// Value at x of the polyline through (xs, ys), constant beyond its ends. xs ascend and are not empty.
double interpolate(std::span<const double> xs, std::span<const double> ys, double x);

/// A robust straight line through a stretch of a series.
struct Trend {
  double slope =
      0.0;  ///< per s: the median of the slopes of all pairs (Theil and Sen), which outliers do not move
  double scatter = 0.0;  ///< 1.4826 times the median distance from the line
};
/// Of the samples in [from, to]; none where there are fewer than three or they span no time.
std::optional<Trend> trend(const Series&, double from, double to);

/// Rate of change at each sample: the least-squares slope over a window of `window` seconds centred on it
/// (cut at the ends).
Series rate_of_change(const Series&, double window);

/// The first sampled time from which |value| stays at or below `threshold` up to the end; none where it never
/// does.
std::optional<double> settles_below(const Series&, double threshold);

/// How a profile differs from a reference, in the profile's unit; norms are weighted by plan area where the
/// coordinate is a radius.
struct ProfileError {
  double l1 = 0.0;    ///< mean of |difference| over the area either profile covers
  double l2 = 0.0;    ///< root of the mean square over the same area
  double linf = 0.0;  ///< largest difference
  double l1_relative =
      0.0;  ///< int |difference| / int |reference|: of depths, the share of volume that lies elsewhere
  double l2_relative = 0.0;  ///< ||difference||_2 / ||reference||_2
};
/// On a common, ascending grid, by the trapezoidal rule. Points where both are within `floor` of zero are not
/// covered.
ProfileError profile_error(std::span<const double> coordinate, std::span<const double> value,
                           std::span<const double> reference, bool radial, double floor);

/// A round number near `value`: 1, 2, 2.5 or 5 times a power of ten.
double round_step(double value);

}  // namespace flowrest::compare
