#include "elements/mesh.h"

#include <algorithm>
#include <cmath>

namespace flowrest::elements {

namespace {

constexpr double column_grading = 20.0;  ///< width of the first column over that of the last
constexpr double row_grading = 4.0;      ///< height of the highest row over that of the lowest

/// Places of nodes on [0, 1]: widths of elements grow by a constant factor to `ratio` in all, a node in the
/// middle of each.
std::vector<double> graded(int elements, double ratio) {
  const double k = std::log(ratio);
  std::vector<double> place(static_cast<std::size_t>(2 * elements + 1));
  for (std::size_t i = 0; i < place.size(); i += 2)
    place[i] = std::expm1(k * static_cast<double>(i) / (2.0 * elements)) / std::expm1(k);
  for (std::size_t i = 1; i < place.size(); i += 2) place[i] = 0.5 * (place[i - 1] + place[i + 1]);
  return place;
}

/// The line of a column of nodes from floor to surface: straight, or an arc about the toe, or something
/// between. The toe needs arcs: where the front rolls over, floor and surface meet in an angle of up to half
/// a turn.
class Spine {
 public:
  Spine(const Point& floor, const Point& top, const Point& toe, double roundness)
      : floor_(floor), top_(top), toe_(toe), roundness_(roundness) {}

  Point at(double share) const {
    const Point below = floor_ - toe_, above = top_ - toe_;
    const double angle = share * std::atan2(above.y(), -above.x());
    const double radius = (1.0 - share) * below.norm() + share * above.norm();
    const Point arc = toe_ + radius * Point(-std::cos(angle), std::sin(angle));
    return (1.0 - roundness_) * (floor_ + share * (top_ - floor_)) + roundness_ * arc;
  }

 private:
  Point floor_, top_, toe_;
  double roundness_;
};

}  // namespace

ElementPositions Mesh::element(int column, int row) const {
  ElementPositions nodes;
  for (int a = 0; a < element_nodes; ++a) nodes.col(a) = position.col(topology.element_node(column, row, a));
  return nodes;
}

Mesh make_mesh(const Topology& topology, const Surface& surface) {
  Mesh mesh{topology, Field(2, topology.nodes()), graded(topology.columns, 1.0 / column_grading)};
  const auto up = graded(topology.rows, row_grading);
  for (int i = 0; i < 2 * topology.columns; ++i) {
    double& length = mesh.surface[static_cast<std::size_t>(i)];
    const double share = length;
    const Point floor = share * surface.toe();
    length *= surface.length();
    const Spine spine(floor, surface.at(length), surface.toe(), share * share);
    for (int j = 0; j < topology.column_nodes(); ++j)
      mesh.position.col(topology.node(i, j)) = spine.at(up[static_cast<std::size_t>(j)]);
  }
  mesh.surface.back() = surface.length();
  mesh.position.col(topology.toe()) = surface.toe();
  return mesh;
}

namespace {

struct Inverse {
  Place place;
  double outside = 0.0;  ///< how far the point lies out of the square
};

/// Newton's method for the point of an element's square that lies at `point`, kept near the square.
Inverse invert(const Mesh& mesh, const Point& point, const Place& start) {
  constexpr int most_iterations = 12;
  constexpr double tolerance = 1e-10, margin = 1.5;
  const ElementPositions nodes = mesh.element(start.column, start.row);
  Inverse found{start, 0.0};
  auto& [column, row, xi, eta] = found.place;
  for (int i = 0; i < most_iterations; ++i) {
    const Shape shape = shape_at(xi, eta);
    const Eigen::Matrix2d jacobian = nodes * shape.gradient;
    // Where the square is drawn together to the toe every place is the same one.
    if (!(std::abs(jacobian.determinant()) > 1e-14 * jacobian.squaredNorm())) break;
    const Point step = jacobian.inverse() * (point - nodes * shape.value);
    xi = std::clamp(xi + step.x(), -margin, margin);
    eta = std::clamp(eta + step.y(), -margin, margin);
    if (step.norm() < tolerance) break;
  }
  found.outside = std::max({0.0, std::abs(xi) - 1.0, std::abs(eta) - 1.0});
  return found;
}

}  // namespace

Place locate(const Mesh& mesh, const Point& point, Place start) {
  constexpr int most_elements = 100;
  constexpr double inside = 1e-9;
  Inverse best{{}, 1e9};
  for (int walked = 0; walked < most_elements; ++walked) {
    const Inverse here = invert(mesh, point, start);
    if (here.outside < best.outside) best = here;
    if (here.outside <= inside) break;
    const auto aside = [](double x) { return x > 1.0 + inside ? 1 : x < -1.0 - inside ? -1 : 0; };
    const int column = std::clamp(start.column + aside(here.place.xi), 0, mesh.topology.columns - 1);
    const int row = std::clamp(start.row + aside(here.place.eta), 0, mesh.topology.rows - 1);
    if (column == start.column && row == start.row) break;
    start = {column, row, 0.0, 0.0};
  }
  best.place.xi = std::clamp(best.place.xi, -1.0, 1.0);
  best.place.eta = std::clamp(best.place.eta, -1.0, 1.0);
  return best.place;
}

std::vector<Field> transfer(const Mesh& from, const std::vector<Field>& fields, const Mesh& to) {
  const Topology& topology = to.topology;
  std::vector<Field> moved(fields.size(), Field(2, topology.nodes()));
  for (int i = 0; i <= 2 * topology.columns; ++i)
    for (int j = 0; j < topology.column_nodes(); ++j) {
      const int node = topology.node(i, j);
      Place start{std::min(i / 2, topology.columns - 1), std::min(j / 2, topology.rows - 1), 0.0, 0.0};
      // At the toe itself there is no way to begin: every place there is the same one.
      start.xi = std::min(i - 2 * start.column - 1.0, 0.9);
      start.eta = j - 2 * start.row - 1.0;
      const Place place = locate(from, to.position.col(node), start);
      const NodeValues share = shape_at(place.xi, place.eta).value;
      for (std::size_t f = 0; f < fields.size(); ++f) {
        moved[f].col(node).setZero();
        for (int a = 0; a < element_nodes; ++a)
          moved[f].col(node) += share[a] * fields[f].col(topology.element_node(place.column, place.row, a));
      }
      if (node == topology.toe()) break;
    }
  return moved;
}

}  // namespace flowrest::elements
