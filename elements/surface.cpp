#include "elements/surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runs/depth.h"

namespace flowrest::elements {

Surface::Surface(std::vector<Point> markers) : marker_(std::move(markers)), length_{0.0} {
  length_.reserve(marker_.size());
  for (std::size_t i = 1; i < marker_.size(); ++i)
    length_.push_back(length_.back() + (marker_[i] - marker_[i - 1]).norm());
}

Surface Surface::of_cone(const Problem& problem, int markers) {
  const Point middle(0.0, problem.height), edge(problem.radius_top, problem.height),
      foot(problem.radius_bottom, 0.0);
  const double top = (edge - middle).norm(), side = (foot - edge).norm();
  const int on_top = std::max(1, static_cast<int>(std::lround(markers * top / (top + side))));
  std::vector<Point> line;
  if (problem.radius_top > 0.0)
    for (int i = 0; i < on_top; ++i) line.push_back(middle + (edge - middle) * i / on_top);
  const int on_side = markers - on_top;
  for (int i = 0; i <= on_side; ++i) line.push_back(edge + (foot - edge) * i / on_side);
  return Surface(std::move(line));
}

Point Surface::at(double length) const {
  const auto after = std::upper_bound(length_.begin() + 1, length_.end() - 1, length);
  const auto i = static_cast<std::size_t>(after - length_.begin());
  const double part = (length - length_[i - 1]) / (length_[i] - length_[i - 1]);
  return marker_[i - 1] + std::clamp(part, 0.0, 1.0) * (marker_[i] - marker_[i - 1]);
}

double Surface::radius() const {
  double largest = 0.0;
  for (const Point& m : marker_) largest = std::max(largest, m.x());
  return largest;
}

double Surface::volume(Symmetry symmetry) const {
  // The integral of r dz over the line, or of r^2 / 2 dz: that along the axis and the floor is nothing.
  double sum = 0.0;
  for (std::size_t i = 1; i < marker_.size(); ++i) {
    const Point &a = marker_[i - 1], &b = marker_[i];
    const double fall = a.y() - b.y();
    sum += symmetry == Symmetry::plane
               ? fall * (a.x() + b.x())
               : fall * std::numbers::pi / 3.0 * (a.x() * a.x() + a.x() * b.x() + b.x() * b.x());
  }
  return sum;
}

double Surface::depth(double radius) const {
  // Every crossing outwards bounds the material from above, every one inwards from below; the floor bounds
  // the rest.
  double sum = 0.0;
  for (std::size_t i = 1; i < marker_.size(); ++i) {
    const Point &a = marker_[i - 1], &b = marker_[i];
    const bool outwards = a.x() <= radius && radius < b.x(), inwards = b.x() <= radius && radius < a.x();
    if (!outwards && !inwards) continue;
    const double height = a.y() + (b.y() - a.y()) * (radius - a.x()) / (b.x() - a.x());
    sum += outwards ? height : -height;
  }
  return std::max(0.0, sum);
}

double Surface::spread(double threshold) const {
  // Between the radii of markers the depth is linear; it may jump at a radius where the line is vertical.
  std::vector<double> radii;
  for (const Point& m : marker_) radii.push_back(m.x());
  std::sort(radii.begin(), radii.end());
  radii.erase(std::unique(radii.begin(), radii.end()), radii.end());
  for (std::size_t i = radii.size(); i-- > 1;) {
    const double inner = radii[i - 1], width = radii[i] - inner;
    const double near = depth(inner + 1e-9 * width), far = depth(radii[i] - 1e-9 * width);
    if (far >= threshold) return 2.0 * radii[i];
    if (near > threshold) return 2.0 * (inner + width * (near - threshold) / (near - far));
  }
  return runs::nothing;
}

Surface landed(const std::vector<Point>& markers, double tolerance, double wedge) {
  const double toe = markers.back().x();
  std::vector<Point> line = {markers.front()};
  for (std::size_t i = 1; i < markers.size(); ++i) {
    const Point &before = line.back(), &here = markers[i];
    if (here.y() > tolerance + wedge * std::max(0.0, here.x() - toe)) {
      line.push_back(here);
      continue;
    }
    const double part = here.y() >= 0.0 ? 1.0 : before.y() / (before.y() - here.y());
    line.push_back({before.x() + part * (here.x() - before.x()), 0.0});
    break;
  }
  line.back().y() = 0.0;
  return Surface(std::move(line));
}

Surface with_volume(const Surface& surface, Symmetry symmetry, double volume) {
  const double factor = volume / surface.volume(symmetry);
  std::vector<Point> line = surface.markers();
  for (Point& m : line) m.y() *= factor;
  return Surface(std::move(line));
}

}  // namespace flowrest::elements
