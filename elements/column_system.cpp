#include "elements/column_system.h"

namespace flowrest::elements {

namespace {

/// Replaces the lower triangle of a matrix by its Cholesky factor.
bool factor_in_place(Eigen::MatrixXd& matrix) {
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
  return factor.info() == Eigen::Success;
}

/// rows L^-T, in place.
void under(const Eigen::MatrixXd& factor, Eigen::MatrixXd& rows) {
  factor.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(rows);
}

/// Lower triangle of matrix - rows rows^T.
void take(Eigen::MatrixXd& matrix, const Eigen::MatrixXd& rows) {
  matrix.selfadjointView<Eigen::Lower>().rankUpdate(rows, -1.0);
}

}  // namespace

ColumnSystem::ColumnSystem(const Topology& topology)
    : topology_(topology), column_(static_cast<std::size_t>(topology.columns)) {}

int ColumnSystem::place(int column, int row, int local_dof) const {
  const int a = local_dof / 2, side_of = a / 3, component = local_dof % 2;
  const int begin = side_of == 1 ? 0 : side_of == 0 ? middle() : 2 * middle();
  if (side_of == 2 && column + 1 == topology_.columns) return begin + component;
  return begin + 2 * (2 * row + a % 3) + component;
}

void ColumnSystem::begin() { next_ = Eigen::MatrixXd::Zero(middle(), middle()); }

bool ColumnSystem::add_column(int column, const Eigen::MatrixXd& matrix) {
  Column& c = column_[static_cast<std::size_t>(column)];
  const int m = middle(), right = side(2 * column + 2);
  c.middle = matrix.topLeftCorner(m, m);
  if (!factor_in_place(c.middle)) return false;
  c.to_left = matrix.block(m, 0, m, m);
  c.to_right = matrix.block(2 * m, 0, right, m);
  under(c.middle, c.to_left);
  under(c.middle, c.to_right);
  c.left = next_ + matrix.block(m, m, m, m);
  take(c.left, c.to_left);
  if (!factor_in_place(c.left)) return false;
  c.onwards = matrix.block(2 * m, m, right, m);
  c.onwards.noalias() -= c.to_right * c.to_left.transpose();
  under(c.left, c.onwards);
  next_ = matrix.block(2 * m, 2 * m, right, right);
  take(next_, c.to_right);
  take(next_, c.onwards);
  return true;
}

bool ColumnSystem::finish() { return factor_in_place(next_); }

void ColumnSystem::solve(Eigen::VectorXd& x) const {
  const int m = middle();
  const auto part = [&](int node_column) { return x.segment(node_column * m, side(node_column)); };
  for (int i = 0; i < topology_.columns; ++i) {
    const Column& c = column_[static_cast<std::size_t>(i)];
    auto middle_part = part(2 * i + 1), left = part(2 * i), right = part(2 * i + 2);
    c.middle.triangularView<Eigen::Lower>().solveInPlace(middle_part);
    left.noalias() -= c.to_left * middle_part;
    right.noalias() -= c.to_right * middle_part;
    c.left.triangularView<Eigen::Lower>().solveInPlace(left);
    right.noalias() -= c.onwards * left;
  }
  auto toe = part(2 * topology_.columns);
  next_.triangularView<Eigen::Lower>().solveInPlace(toe);
  next_.triangularView<Eigen::Lower>().transpose().solveInPlace(toe);
  for (int i = topology_.columns; i-- > 0;) {
    const Column& c = column_[static_cast<std::size_t>(i)];
    auto middle_part = part(2 * i + 1), left = part(2 * i), right = part(2 * i + 2);
    left.noalias() -= c.onwards.transpose() * right;
    c.left.triangularView<Eigen::Lower>().transpose().solveInPlace(left);
    middle_part.noalias() -= c.to_left.transpose() * left + c.to_right.transpose() * right;
    c.middle.triangularView<Eigen::Lower>().transpose().solveInPlace(middle_part);
  }
}

}  // namespace flowrest::elements
