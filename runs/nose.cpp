#include "runs/nose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "runs/depth.h"

namespace flowrest::runs {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Rings or strips side by side. Areas and volumes are those per radian, or per width.
class Rings {
 public:
  explicit Rings(const DepthView& view)
      : about_(view.about),
        depth_(view.depth.begin(), view.depth.end()),
        edge_(depth_.size() + 1),
        beyond_(depth_.size() + 1) {
    const auto& centre = view.centre;
    const std::size_t n = depth_.size();
    for (std::size_t i = 1; i < n; ++i) edge_[i] = 0.5 * (centre[i - 1] + centre[i]);
    edge_[0] = n > 1 ? std::max(0.0, 2.0 * centre[0] - edge_[1]) : 0.0;
    edge_[n] = 2.0 * centre[n - 1] - edge_[n - 1];
    for (std::size_t i = n; i-- > 0;)
      beyond_[i] = beyond_[i + 1] + std::max(0.0, depth_[i]) * area(edge_[i], edge_[i + 1]);
  }

  About about() const { return about_; }
  std::size_t count() const { return depth_.size(); }
  double depth(std::size_t i) const { return depth_[i]; }
  double edge(std::size_t i) const { return edge_[i]; }      ///< inner edge of ring i
  double beyond(std::size_t i) const { return beyond_[i]; }  ///< volume from that edge outwards
  double area(double from, double to) const {
    return about_ == About::plane ? to - from : 0.5 * (to - from) * (to + from);
  }

 private:
  About about_;
  std::vector<double> depth_, edge_, beyond_;
};

/// h = coefficient (end - r)^power
struct Nose {
  double end, coefficient, power;
};

/// Volume from a place to the end of a nose whose coefficient is 1, `length` away from it.
double volume_of_nose(About about, double from, double length, double power) {
  const double strip = std::pow(length, power + 1.0) / (power + 1.0);
  if (about == About::plane) return strip;
  return strip * (from + length) - std::pow(length, power + 2.0) / (power + 2.0);
}

/// Length from `outer` to the end of the nose that holds `ratio` times as much from `inner` on as from `outer`
/// on.
double length_of_nose(About about, double inner, double outer, double ratio, double power) {
  const double width = outer - inner;
  double length = width / (std::pow(ratio, 1.0 / (power + 1.0)) - 1.0);
  if (about == About::plane) return length;
  // About an axis the rings' radii count as well: Newton's method for the logarithm of the ratio, with the slope
  // of the plane nose.
  double low = 0.0, high = infinite;
  constexpr int most_steps = 60;
  for (int step = 0; step < most_steps; ++step) {
    const double excess = std::log(volume_of_nose(about, inner, length + width, power) /
                                   volume_of_nose(about, outer, length, power) / ratio);
    (excess > 0.0 ? low : high) = length;
    const double slope = (power + 1.0) * (1.0 / (length + width) - 1.0 / length);
    double next = length - excess / slope;
    if (!(next > low && next < high)) next = high < infinite ? 0.5 * (low + high) : 2.0 * length;
    const double change = std::abs(next - length);
    length = next;
    if (change < 1e-9 * width) break;
  }
  return length;
}

/// The nose of a given power through the volumes beyond the inner edges of rings k - 1 and k.
Nose nose_of_power(const Rings& rings, std::size_t k, double power) {
  const double outer = rings.edge(k);
  const double length =
      length_of_nose(rings.about(), rings.edge(k - 1), outer, rings.beyond(k - 1) / rings.beyond(k), power);
  return {outer + length, rings.beyond(k) / volume_of_nose(rings.about(), outer, length, power), power};
}

/// Whether a nose that is nowhere deeper than `deepest` holds too little in ring k - 2.
bool too_flat(const Rings& rings, std::size_t k, const Nose& nose, double deepest) {
  const double from = rings.edge(k - 2), to = rings.edge(k - 1);
  // Up to here it is as deep as it can be.
  double flank = from;
  if (deepest < infinite && nose.power > 0.0)
    flank = std::clamp(nose.end - std::pow(deepest / nose.coefficient, 1.0 / nose.power), from, to);
  const double level = flank > from ? deepest * rings.area(from, flank) : 0.0;
  const double sloping =
      flank < to ? nose.coefficient * volume_of_nose(rings.about(), flank, nose.end - flank, nose.power) -
                       rings.beyond(k - 1)
                 : 0.0;
  const double needed = rings.beyond(k - 2) - rings.beyond(k - 1);
  return level + sloping < needed - 1e-9 * rings.beyond(k - 2);
}

/// The end of the volume from the inner edge of ring k on, if it stands as a wall.
double end_of_wall(const Rings& rings, std::size_t k, double height) {
  const double from = rings.edge(k), area = rings.beyond(k) / height;
  return rings.about() == About::plane ? from + area : std::sqrt(from * from + 2.0 * area);
}

/// Where the nose that ring k and the two inside it show falls through the threshold.
double edge_by(const Rings& rings, std::size_t k, double threshold) {
  if (k == 0) return end_of_wall(rings, k, std::max(rings.depth(0), threshold));
  // A bump: a nose falls, and this rises outwards.
  if (!(rings.depth(k - 1) > rings.depth(k))) return end_of_wall(rings, k, rings.depth(k));

  double low = 0.0, high = 1.0;
  if (k == 1) {
    low = high = 0.5;  // two rings do not tell one nose from another: concrete's
  } else {
    const double deepest = k > 2 ? std::max(rings.depth(k - 3), rings.depth(k - 2)) : infinite;
    const auto flat = [&](double power) {
      return too_flat(rings, k, nose_of_power(rings, k, power), deepest);
    };
    if (!flat(low))
      high = low;
    else if (flat(high))
      low = high;
    while (high - low > 1e-6) {
      const double middle = 0.5 * (low + high);
      (flat(middle) ? low : high) = middle;
    }
  }
  const Nose nose = nose_of_power(rings, k, high);
  if (nose.power == 0.0) return nose.coefficient > threshold ? nose.end : rings.edge(k);
  return std::max(rings.edge(k - 1), nose.end - std::pow(threshold / nose.coefficient, 1.0 / nose.power));
}

}  // namespace

double edge_of_depth(const DepthView& view, double threshold) {
  const std::size_t count = std::min(view.centre.size(), view.depth.size());
  std::size_t k = count;
  while (k > 0 && !(view.depth[k - 1] > threshold)) --k;
  if (k == 0) return nothing;
  const Rings rings({view.centre.first(count), view.depth.first(count), view.about});
  if (k == count) return rings.edge(count);
  --k;
  const double edge = edge_by(rings, k, threshold);
  const double passed = std::max(0.0, rings.depth(k + 1) / threshold);
  return passed > 0.0 ? std::lerp(edge, edge_by(rings, k + 1, threshold), std::min(1.0, passed)) : edge;
}

}  // namespace flowrest::runs
