#pragma once

#include <vector>

#include "elements/column_system.h"
#include "elements/fluid.h"

namespace flowrest::elements {

/// What a step asks of the flow: the velocity v that minimises, among all without divergence,
///   int rho rate / 2 |v - history|^2 + int phi(D(v)) - int rho g . v,
/// phi the potential of the flow law (its derivative by the shear rate is the stress). It is convex for every
/// law whose stress does not fall with the rate.
struct FlowTask {
  double rate = 0.0;       ///< 1/s: v's weight in the time derivative, rate (v - history)
  Field history;           ///< m/s
  std::vector<char> held;  ///< unknowns that keep the value they have, two a node
};

struct FlowOutcome {
  bool converged = false;
  int iterations = 0;
  double divergence = 0.0;  ///< the largest that is left in an element, root mean square, 1/s
  double dissipated = 0.0;  ///< W, of a radian, or of a metre's width in a plane
  double inertia = 0.0;     ///< W, taken up by what moves
  double gravity = 0.0;     ///< W, given by gravity
};

/// The minimiser: Newton's method with an exact search along each of its directions. The pressure is the
/// multiplier of the constraint, brought to it by an augmented Lagrangian within the same iterations (Fortin
/// and Glowinski 1983).
class Flow {
 public:
  Flow(const Topology&, const Problem&, const Fluid&);

  /// Takes up a configuration, in which all that follows is meant.
  /// @return false where an element is folded
  bool set_positions(const Mesh&, const Field& position);

  /// From a start that has the prescribed values.
  FlowOutcome minimise(const FlowTask&, Field& velocity);

  /// Of each node, the mean of its elements', Pa; positive in compression.
  Eigen::VectorXd node_pressures(const Field& position) const;
  /// Of each node, the mean of its elements', 1/s.
  Eigen::VectorXd node_rates(const Field& velocity) const;
  /// Pa, in an element
  double pressure(int column, int row, const Point&) const;

 private:
  using ElementVelocity = Eigen::Matrix<double, element_dofs, 1>;
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(column * topology_.rows + row);
  }
  ElementVelocity of_element(const Eigen::VectorXd&, int column, int row) const;
  template <class Use>
  void each_element(Use&&) const;
  template <class Value>
  Eigen::VectorXd node_means(const Value&) const;
  void assemble_element(const FlowTask&, const Eigen::VectorXd& velocity, int column, int row,
                        Eigen::MatrixXd& matrix, Eigen::VectorXd& downhill) const;
  bool find_direction(const FlowTask&, const Eigen::VectorXd& velocity, Eigen::VectorXd& direction,
                      double& slope);
  double search(const FlowTask&, const Eigen::VectorXd& velocity, const Eigen::VectorXd& direction) const;
  void relax_pressure(const Eigen::VectorXd& velocity);
  void balance(const FlowTask&, const Eigen::VectorXd& velocity, FlowOutcome&) const;

  Topology topology_;
  Symmetry symmetry_;
  double density_, gravity_;
  Fluid fluid_;
  double penalty_;  ///< Pa s
  std::vector<ElementMatrices> element_;
  std::vector<Eigen::Vector3d> pressure_;  ///< of each element's modes
  ColumnSystem system_;
};

}  // namespace flowrest::elements
