#pragma once

#include <vector>

#include "elements/surface.h"

namespace flowrest::elements {

using Field = Eigen::Matrix2Xd;  ///< a vector for each node

/// Elements in columns from floor to surface. The outer edge of the last column is one point, the toe. Nodes
/// stand in columns as well, two for each column of elements, counted from below and from the axis; the toe
/// is the last node.
struct Topology {
  int columns = 0, rows = 0;  ///< of elements

  int column_nodes() const { return 2 * rows + 1; }
  int nodes() const { return 2 * columns * column_nodes() + 1; }
  int toe() const { return nodes() - 1; }
  int elements() const { return columns * rows; }
  int node(int node_column, int node_row) const {
    return node_column == 2 * columns ? toe() : node_column * column_nodes() + node_row;
  }
  /// Node a of the element in a column and row.
  int element_node(int column, int row, int a) const { return node(2 * column + a / 3, 2 * row + a % 3); }
  /// The node at the surface of a column of nodes; the last is the toe.
  int surface_node(int node_column) const { return node(node_column, 2 * rows); }
};

struct Mesh {
  Topology topology;
  Field position;               ///< m
  std::vector<double> surface;  ///< length along the surface of each column of nodes, m

  ElementPositions element(int column, int row) const;
};

/// A mesh under a surface: columns are straight from the floor to the surface, narrower towards the toe,
/// where the material rolls over, and rows thinner towards the floor, where it shears.
Mesh make_mesh(const Topology&, const Surface&);

/// A point in the square of an element.
struct Place {
  int column = 0, row = 0;
  double xi = 0.0, eta = 0.0;
};
/// Where a point lies in a mesh, searched from a place near it. A point outside belongs to the element that
/// it is next to, at the nearest point of its square.
Place locate(const Mesh&, const Point&, Place start);

/// Fields on the nodes of one mesh, carried over to those of another over nearly the same body.
std::vector<Field> transfer(const Mesh& from, const std::vector<Field>&, const Mesh& to);

}  // namespace flowrest::elements
