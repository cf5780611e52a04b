#pragma once

#include <vector>

#include "elements/mesh.h"

namespace flowrest::elements {

/// Symmetric positive definite equations for two unknowns at each node of a mesh in columns, by Cholesky's
/// method: the nodes within each column of elements are eliminated first, which leaves those between the
/// columns coupled each with its neighbours alone. All in dense blocks.
class ColumnSystem {
 public:
  explicit ColumnSystem(const Topology&);

  /// Order of an element column's matrix: unknowns of its middle nodes, of those to its left, of those to its
  /// right.
  int middle() const { return 2 * topology_.column_nodes(); }
  int side(int node_column) const { return node_column == 2 * topology_.columns ? 2 : middle(); }
  int order(int column) const { return 2 * middle() + side(2 * column + 2); }
  /// Place of an unknown of an element of the column in that matrix.
  int place(int column, int row, int local_dof) const;

  /// Factors the equations whose matrix is the sum over columns of `column_matrix(c)`, of which the lower
  /// triangle is read; each is asked for once, in order.
  /// @return false where the sum is not positive definite
  template <class ColumnMatrix>
  bool factor(ColumnMatrix&& column_matrix) {
    begin();
    for (int c = 0; c < topology_.columns; ++c)
      if (!add_column(c, column_matrix(c))) return false;
    return finish();
  }
  /// Solves in place, two unknowns a node in the order of the nodes.
  void solve(Eigen::VectorXd&) const;

 private:
  void begin();
  bool add_column(int column, const Eigen::MatrixXd&);
  bool finish();

  Topology topology_;
  struct Column {
    Eigen::MatrixXd middle;  ///< Cholesky factor of the middle nodes
    Eigen::MatrixXd to_left,
        to_right;             ///< rows of the factor of the nodes on either side, under the middle ones
    Eigen::MatrixXd left;     ///< Cholesky factor of the nodes to the left
    Eigen::MatrixXd onwards;  ///< rows of the factor of the nodes to the right, under the left ones
  };
  std::vector<Column> column_;
  Eigen::MatrixXd next_;  ///< what has been gathered of the nodes to the right; at the end the toe's factor
};

}  // namespace flowrest::elements
