#include "elements/flow.h"

#include <algorithm>
#include <cmath>

namespace flowrest::elements {

namespace {

/// The penalty of the augmented Lagrangian over the largest and over the plastic viscosity: an iteration
/// leaves about the inverse of the divergence that it finds.
constexpr double penalty_over_largest = 1e3, penalty_over_plastic = 1e6;
constexpr int most_iterations = 80;
/// An iteration that would gain less than this share of the power at work is the last.
constexpr double power_tolerance = 1e-10;

using Strain = Eigen::Matrix<double, strain_rows * element_points, 1>;

}  // namespace

Flow::Flow(const Topology& topology, const Problem& problem, const Fluid& fluid)
    : topology_(topology),
      symmetry_(problem.symmetry),
      density_(problem.density),
      gravity_(problem.gravity),
      fluid_(fluid),
      penalty_(std::max(penalty_over_largest * fluid.largest_viscosity(),
                        penalty_over_plastic * problem.flow.parameters.plastic_viscosity)),
      element_(static_cast<std::size_t>(topology.elements())),
      pressure_(element_.size(), Eigen::Vector3d::Zero()),
      system_(topology) {}

bool Flow::set_positions(const Mesh& mesh, const Field& position) {
  const Mesh here{mesh.topology, position, {}};
  for (int c = 0; c < topology_.columns; ++c)
    for (int r = 0; r < topology_.rows; ++r)
      if (!element_[index(c, r)].compute(here.element(c, r), symmetry_)) return false;
  return true;
}

Flow::ElementVelocity Flow::of_element(const Eigen::VectorXd& all, int column, int row) const {
  ElementVelocity own;
  for (int a = 0; a < element_nodes; ++a)
    own.segment<2>(2 * a) = all.segment<2>(2 * topology_.element_node(column, row, a));
  return own;
}

template <class Use>
void Flow::each_element(Use&& use) const {
  for (int c = 0; c < topology_.columns; ++c)
    for (int r = 0; r < topology_.rows; ++r) use(c, r, element_[index(c, r)]);
}

/// Adds an element's second derivatives to its column's matrix, and the negative of its first ones to
/// `downhill`.
void Flow::assemble_element(const FlowTask& task, const Eigen::VectorXd& velocity, int column, int row,
                            Eigen::MatrixXd& matrix, Eigen::VectorXd& downhill) const {
  const ElementMatrices& e = element_[index(column, row)];
  const ElementVelocity v = of_element(velocity, column, row);
  const Strain rates = e.strain * v;
  Eigen::Matrix<double, strain_rows * element_points + element_pressures, element_dofs> root;
  Strain stress;
  for (int q = 0; q < element_points; ++q) {
    const Eigen::Vector4d d = rates.segment<strain_rows>(strain_rows * q);
    const double rate = d.norm();
    const Response response = fluid_.at(rate);
    stress.segment<strain_rows>(strain_rows * q) = e.weight[q] * response.viscosity * d;
    // The square root of the second derivative viscosity (I - n n) + tangent n n, n = d / rate.
    auto rows = root.middleRows<strain_rows>(strain_rows * q);
    rows = e.strain.middleRows<strain_rows>(strain_rows * q);
    if (rate > 0.0) {
      const double along = std::sqrt(std::max(0.0, response.tangent / response.viscosity)) - 1.0;
      const Eigen::Matrix<double, 1, element_dofs> projected = d.transpose() * rows / (rate * rate);
      rows += along * d * projected;
    }
    rows *= std::sqrt(e.weight[q] * response.viscosity);
  }
  root.bottomRows<element_pressures>() = std::sqrt(penalty_) * e.divergence;
  Eigen::Matrix<double, element_dofs, element_dofs> second = root.transpose() * root;
  const Eigen::Vector3d multiplier = pressure_[index(column, row)] - penalty_ * (e.divergence * v);
  ElementVelocity first = e.divergence.transpose() * multiplier - e.strain.transpose() * stress;
  const double inertia = density_ * task.rate;
  const ElementVelocity moved =
      v -
      of_element(Eigen::Map<const Eigen::VectorXd>(task.history.data(), task.history.size()), column, row);
  for (int a = 0; a < element_nodes; ++a) {
    for (int b = 0; b < element_nodes; ++b)
      for (int i = 0; i < 2; ++i) {
        second(2 * a + i, 2 * b + i) += inertia * e.mass(a, b);
        first[2 * a + i] -= inertia * e.mass(a, b) * moved[2 * b + i];
      }
    first[2 * a + 1] -= density_ * gravity_ * e.volume[a];
  }
  int place[element_dofs], global[element_dofs];
  for (int i = 0; i < element_dofs; ++i) {
    global[i] = 2 * topology_.element_node(column, row, i / 2) + i % 2;
    place[i] = system_.place(column, row, i);
  }
  for (int i = 0; i < element_dofs; ++i) {
    if (task.held[static_cast<std::size_t>(global[i])]) {
      matrix(place[i], place[i]) += second(i, i);
      continue;
    }
    downhill[global[i]] += first[i];
    for (int j = 0; j < element_dofs; ++j)
      if (!task.held[static_cast<std::size_t>(global[j])] && place[j] <= place[i])
        matrix(place[i], place[j]) += second(i, j);
  }
}

/// Newton's direction from a velocity, and the slope of the functional along it.
bool Flow::find_direction(const FlowTask& task, const Eigen::VectorXd& velocity, Eigen::VectorXd& direction,
                          double& slope) {
  Eigen::VectorXd downhill = Eigen::VectorXd::Zero(velocity.size());
  Eigen::MatrixXd matrix;
  const bool definite = system_.factor([&](int column) -> const Eigen::MatrixXd& {
    matrix.setZero(system_.order(column), system_.order(column));
    for (int r = 0; r < topology_.rows; ++r) assemble_element(task, velocity, column, r, matrix, downhill);
    return matrix;
  });
  if (!definite) return false;
  direction = downhill;
  system_.solve(direction);
  slope = -downhill.dot(direction);
  return direction.allFinite();
}

/// How far along a direction the augmented functional is least: the root of its derivative, which rises.
double Flow::search(const FlowTask& task, const Eigen::VectorXd& velocity,
                    const Eigen::VectorXd& direction) const {
  struct Along {
    double square, mixed, change, weight;  // rate^2 = square + 2 mixed x + change x^2
  };
  std::vector<Along> points;
  points.reserve(element_.size() * element_points);
  double constant = 0.0, linear = 0.0;
  const Eigen::Map<const Eigen::VectorXd> history(task.history.data(), task.history.size());
  each_element([&](int c, int r, const ElementMatrices& e) {
    const ElementVelocity v = of_element(velocity, c, r), s = of_element(direction, c, r),
                          moved = v - of_element(history, c, r);
    const Strain rates = e.strain * v, changes = e.strain * s;
    for (int q = 0; q < element_points; ++q) {
      const Eigen::Vector4d d = rates.segment<strain_rows>(strain_rows * q),
                            change = changes.segment<strain_rows>(strain_rows * q);
      points.push_back({d.squaredNorm(), d.dot(change), change.squaredNorm(), e.weight[q]});
    }
    const Eigen::Vector3d divergence = e.divergence * v, grows = e.divergence * s;
    constant += (penalty_ * divergence - pressure_[index(c, r)]).dot(grows);
    linear += penalty_ * grows.squaredNorm();
    for (int i = 0; i < 2; ++i) {
      const auto step = Eigen::Map<const NodeValues, 0, Eigen::InnerStride<2>>(s.data() + i);
      const NodeValues pushed = density_ * task.rate * (e.mass * step);
      constant += pushed.dot(Eigen::Map<const NodeValues, 0, Eigen::InnerStride<2>>(moved.data() + i));
      linear += pushed.dot(step);
      if (i == 1) constant += density_ * gravity_ * e.volume.dot(step);
    }
  });
  const auto slope = [&](double x) {
    double sum = constant + linear * x;
    for (const Along& p : points) {
      const double square = std::max(0.0, p.square + x * (2.0 * p.mixed + x * p.change));
      sum += p.weight * fluid_.at(std::sqrt(square)).viscosity * (p.mixed + p.change * x);
    }
    return sum;
  };
  constexpr double enough = 1e-2;  // of the slope at the start
  constexpr int most_halvings = 40;
  double low = 0.0, low_slope = slope(0.0), high = 1.0, high_slope = slope(1.0);
  const double start = std::abs(low_slope);
  while (high_slope < -enough * start && high < 8.0) {
    low = high;
    low_slope = high_slope;
    high *= 2.0;
    high_slope = slope(high);
  }
  if (high_slope <= enough * start) return high;
  for (int i = 0; i < most_halvings; ++i) {
    // False position, pulled to the middle half of the interval so that it always shrinks.
    const double middle = low + (high - low) * std::clamp(low_slope / (low_slope - high_slope), 0.1, 0.9);
    const double at_middle = slope(middle);
    if (std::abs(at_middle) <= enough * start) return middle;
    (at_middle < 0.0 ? low : high) = middle;
    (at_middle < 0.0 ? low_slope : high_slope) = at_middle;
  }
  return low;
}

void Flow::relax_pressure(const Eigen::VectorXd& velocity) {
  each_element([&](int c, int r, const ElementMatrices& e) {
    pressure_[index(c, r)] -= penalty_ * (e.divergence * of_element(velocity, c, r));
  });
}

void Flow::balance(const FlowTask& task, const Eigen::VectorXd& velocity, FlowOutcome& outcome) const {
  outcome.divergence = outcome.dissipated = outcome.inertia = outcome.gravity = 0.0;
  const Eigen::Map<const Eigen::VectorXd> history(task.history.data(), task.history.size());
  each_element([&](int c, int r, const ElementMatrices& e) {
    const ElementVelocity v = of_element(velocity, c, r), moved = v - of_element(history, c, r);
    const Strain rates = e.strain * v;
    for (int q = 0; q < element_points; ++q) {
      const double rate = rates.segment<strain_rows>(strain_rows * q).norm();
      outcome.dissipated += e.weight[q] * fluid_.at(rate).viscosity * rate * rate;
    }
    outcome.divergence = std::max(outcome.divergence, (e.divergence * v).norm() / std::sqrt(e.weight.sum()));
    for (int i = 0; i < 2; ++i) {
      const auto own = Eigen::Map<const NodeValues, 0, Eigen::InnerStride<2>>(v.data() + i);
      const auto change = Eigen::Map<const NodeValues, 0, Eigen::InnerStride<2>>(moved.data() + i);
      outcome.inertia += density_ * task.rate * own.dot(e.mass * change);
      if (i == 1) outcome.gravity -= density_ * gravity_ * e.volume.dot(own);
    }
  });
}

FlowOutcome Flow::minimise(const FlowTask& task, Field& velocity) {
  FlowOutcome outcome;
  Eigen::VectorXd v = Eigen::Map<Eigen::VectorXd>(velocity.data(), velocity.size()), direction;
  while (outcome.iterations < most_iterations && !outcome.converged) {
    double slope = 0.0;
    if (!find_direction(task, v, direction, slope)) return outcome;
    ++outcome.iterations;
    const double step = search(task, v, direction);
    v += step * direction;
    balance(task, v, outcome);
    const double power = outcome.dissipated + std::abs(outcome.inertia) + std::abs(outcome.gravity);
    outcome.converged = std::abs(slope) <= power_tolerance * power;
    relax_pressure(v);
  }
  velocity = Eigen::Map<Field>(v.data(), 2, velocity.cols());
  return outcome;
}

double Flow::pressure(int column, int row, const Point& point) const {
  const std::size_t e = index(column, row);
  return pressure_[e].dot(element_[e].modes.at(point));
}

template <class Value>
Eigen::VectorXd Flow::node_means(const Value& value) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(topology_.nodes()), count = sum;
  for (int c = 0; c < topology_.columns; ++c)
    for (int r = 0; r < topology_.rows; ++r)
      for (int a = 0; a < element_nodes; ++a) {
        const int node = topology_.element_node(c, r, a);
        sum[node] += value(c, r, a);
        count[node] += 1.0;
      }
  return sum.cwiseQuotient(count);
}

Eigen::VectorXd Flow::node_pressures(const Field& position) const {
  return node_means(
      [&](int c, int r, int a) { return pressure(c, r, position.col(topology_.element_node(c, r, a))); });
}

/// The rates of an element at its Gauss points, carried to its nodes as a polynomial of the same order.
Eigen::VectorXd Flow::node_rates(const Field& velocity) const {
  static const auto to_nodes = [] {
    Eigen::Matrix<double, element_points, element_nodes> at_points;
    for (int q = 0; q < element_points; ++q) {
      const GaussPoint& g = gauss_points()[static_cast<std::size_t>(q)];
      at_points.row(q) = shape_at(g.xi, g.eta).value;
    }
    return Eigen::Matrix<double, element_nodes, element_points>(at_points.inverse());
  }();
  const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(velocity.data(), velocity.size());
  std::vector<NodeValues> rates(element_.size());
  each_element([&](int c, int r, const ElementMatrices& e) {
    const Strain strain = e.strain * of_element(v, c, r);
    NodeValues at_points;
    for (int q = 0; q < element_points; ++q)
      at_points[q] = strain.segment<strain_rows>(strain_rows * q).norm();
    rates[index(c, r)] = (to_nodes * at_points).cwiseMax(0.0);
  });
  return node_means([&](int c, int r, int a) { return rates[index(c, r)][a]; });
}

}  // namespace flowrest::elements
