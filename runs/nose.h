#pragma once

#include <span>

/// The edge of a body's depth, found within the ring or bin that it lies in.
namespace flowrest::runs {

/// What a depth is spread about: an axis, so that it counts by rings, or a plane, so that it counts by strips.
enum class About { axis, plane };

/// A depth to be read: rings or strips side by side.
struct DepthView {
  std::span<const double> centre;  ///< m, rising
  std::span<const double> depth;   ///< m, volume per plan area: the mean over the ring
  About about = About::axis;
};

/// The place at which a depth falls through `threshold` for the last time going outwards, m; nothing where it
/// is nowhere deeper.
///
/// A front is steep: between the centres of two rings the depth says little of where it
/// falls. Their volumes say more. The nose is taken for h = C (R - r)^p with p from 0 (a wall) to 1 (a cone's
/// flank); on the way lie the viscous current, p = 1/3 (Huppert 1982), and the arrested yield-stress material,
/// p = 1/2 (Liu and Mei 1989). R, C and p follow from the volumes that lie beyond the inner edges of the last
/// ring deeper than the threshold and of the two inside it; deeper than the ring inside those it is nowhere.
/// All four noses are read exactly, and the volume is kept. Where the next ring is wet too, but not so deep,
/// the reading passes over to it in proportion to its depth, so that an advancing front is read without a leap.
double edge_of_depth(const DepthView&, double threshold);

}  // namespace flowrest::runs
