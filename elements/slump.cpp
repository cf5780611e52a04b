#include "elements/slump.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runs/errors.h"

namespace flowrest::elements {

namespace {

constexpr int markers = 1400;
/// Of the cone's height: what is nearer to the floor lies on it.
constexpr double contact_tolerance = 1e-5;
/// A wedge of air of less than 4 degrees under the front is closed. A front that rolls meets the floor in a
/// cusp; what is closed of it is a ten thousandth of what advances. Where no step succeeds wider ones are, up
/// to a third of a turn.
constexpr double slim_wedge = 0.07, widest_wedge = 1.2;
constexpr double step_growth = 1.2;
constexpr int most_halvings = 8;
constexpr int most_passes = 8;

}  // namespace

Resolution Resolution::coarser(double factor) const {
  Resolution other = *this;
  other.columns = std::max(4, static_cast<int>(std::lround(columns / factor)));
  other.rows = std::max(2, static_cast<int>(std::lround(rows / factor)));
  other.step_over_time *= factor;
  return other;
}

struct Slump::Tried {
  Field velocity;
  FlowOutcome outcome;
  int iterations = 0;
};

Slump::Slump(const Problem& problem, const Resolution& resolution)
    : problem_(problem),
      resolution_(resolution),
      topology_{resolution.columns, resolution.rows},
      surface_(Surface::of_cone(problem, markers)),
      volume_(surface_.volume(problem.symmetry)),
      mesh_(make_mesh(topology_, surface_)),
      flow_(topology_, problem, Fluid(problem.flow, resolution.rounding)),
      velocity_(2, Field::Zero(2, topology_.nodes())),
      middle_(2, 0.0) {}

double Slump::longest_step() const {
  const double fall = std::sqrt(problem_.height / problem_.gravity);
  const double wanted = resolution_.step_over_time * (time_ + 0.5 * fall);
  return record_.steps == 0 ? wanted : std::min(wanted, step_growth * step_);
}

/// The axis lets nothing across, the floor nothing through; one without slip holds what lies on it.
std::vector<char> Slump::held_at_walls() const {
  std::vector<char> held(static_cast<std::size_t>(2 * topology_.nodes()), 0);
  const auto hold = [&](int node, int component) {
    held[static_cast<std::size_t>(2 * node + component)] = 1;
  };
  for (int j = 0; j < topology_.column_nodes(); ++j) hold(topology_.node(0, j), 0);
  for (int i = 0; i <= 2 * topology_.columns; ++i) {
    hold(topology_.node(i, 0), 1);
    if (problem_.floor == Floor::no_slip) hold(topology_.node(i, 0), 0);
  }
  return held;
}

/// The time derivative in the middle of the step, through the middles of those before it: of second order, of
/// first order from rest.
FlowTask Slump::task_of(double step) const {
  const double since = time_ + 0.5 * step - middle_[0], before = middle_[0] - middle_[1];
  FlowTask task;
  task.held = held_at_walls();
  if (!(before > 0.0)) {
    task.rate = 1.0 / since;
    task.history = velocity_[0];
    return task;
  }
  task.rate = 1.0 / since + 1.0 / (since + before);
  const double last = (since + before) / (since * before), first = since / (before * (since + before));
  task.history = (last * velocity_[0] - first * velocity_[1]) / task.rate;
  return task;
}

/// Holds every node of the surface that the step would carry through the floor to the speed that brings it
/// onto it.
/// @return whether there were any that were not held already
bool Slump::land(double step, Tried& tried, FlowTask& task) const {
  bool any = false;
  for (int i = 1; i < 2 * topology_.columns; ++i) {
    const int node = topology_.surface_node(i);
    const double height = mesh_.position(1, node);
    char& held = task.held[static_cast<std::size_t>(2 * node + 1)];
    if (held || height + step * tried.velocity(1, node) >= 0.0) continue;
    held = 1;
    tried.velocity(1, node) = -height / step;
    any = true;
  }
  return any;
}

bool Slump::try_step(double step, Tried& tried) {
  FlowTask task = task_of(step);
  tried.velocity = velocity_[0];
  for (int i = 0; i < 2 * topology_.nodes(); ++i)
    if (task.held[static_cast<std::size_t>(i)]) tried.velocity.data()[i] = 0.0;
  // The shape in the middle of the step is known once its velocity is.
  bool settled = false;
  for (int pass = 0; pass < most_passes && !settled; ++pass) {
    if (!flow_.set_positions(mesh_, mesh_.position + 0.5 * step * tried.velocity)) return false;
    tried.outcome = flow_.minimise(task, tried.velocity);
    tried.iterations += tried.outcome.iterations;
    if (!tried.outcome.converged) return false;
    settled = !land(step, tried, task) && pass > 0;
  }
  return settled;
}

/// The markers after the step; each moves with the edge of the element under it.
std::vector<Point> Slump::moved_markers(double step, const Field& velocity) const {
  std::vector<Point> moved = surface_.markers();
  std::size_t column = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double length = surface_.lengths()[i];
    while (column + 1 < static_cast<std::size_t>(topology_.columns) && length > mesh_.surface[2 * column + 2])
      ++column;
    const double begin = mesh_.surface[2 * column], end = mesh_.surface[2 * column + 2];
    const double xi = std::clamp(2.0 * (length - begin) / (end - begin) - 1.0, -1.0, 1.0);
    const NodeValues share = shape_at(xi, 1.0).value;
    for (int k = 0; k < 3; ++k)
      moved[i] +=
          step * share[3 * k + 2] * velocity.col(topology_.surface_node(2 * static_cast<int>(column) + k));
  }
  moved.front().x() = 0.0;
  return moved;
}

/// Takes up a surface, its volume put right, and lays a new mesh under it.
void Slump::lay_mesh(const Surface& surface, const Mesh& carried, const std::vector<Field>& velocities) {
  const double volume = surface.volume(problem_.symmetry);
  record_.volume_corrected += std::abs(volume / volume_ - 1.0);
  surface_ = with_volume(surface, problem_.symmetry, volume_);
  mesh_ = make_mesh(topology_, surface_);
  velocity_ = transfer(carried, velocities, mesh_);
}

/// Lets the front down on the floor where it overhangs it so far that no mesh under it can move.
/// @return whether there was anything to let down
bool Slump::close_front() {
  for (double wedge = 2.0 * slim_wedge; wedge < widest_wedge; wedge *= 1.5) {
    const Surface closed = landed(surface_.markers(), contact_tolerance * problem_.height, wedge);
    if (!(closed.toe().x() > surface_.toe().x())) continue;
    const Mesh before = mesh_;
    lay_mesh(closed, before, velocity_);
    ++record_.closed;
    return true;
  }
  return false;
}

void Slump::accept(double step, const Tried& tried) {
  const Surface moved =
      landed(moved_markers(step, tried.velocity), contact_tolerance * problem_.height, slim_wedge);
  Mesh carried = mesh_;
  carried.position += step * tried.velocity;
  lay_mesh(moved, carried, {tried.velocity, velocity_[0]});
  middle_ = {time_ + 0.5 * step, middle_[0]};
  outcome_ = tried.outcome;
  ++record_.steps;
  record_.iterations += tried.iterations;
  record_.largest_divergence = std::max(record_.largest_divergence, tried.outcome.divergence);
  step_ = step;
}

void Slump::step(double target) {
  double step = longest_step();
  const double left = target - time_;
  // Two equal steps rather than a long and a very short one.
  if (step >= left) {
    step = left;
  } else if (step > 0.5 * left) {
    step = 0.5 * left;
  }
  Tried tried;
  for (int halvings = 0; !try_step(step, tried); tried = {}) {
    ++record_.repeated;
    step *= 0.5;
    if (++halvings <= most_halvings) continue;
    if (!close_front())
      throw runs::NumericsError(fmt::format(
          "at {:.6g} s no step is short enough for the elements: the mesh folds, or the minimisation does "
          "not converge",
          time_));
    halvings = 0;
    step = std::min(left, longest_step());
  }
  accept(step, tried);
  time_ = step < left ? time_ + step : target;
  if (surface_.radius() > problem_.domain_radius)
    throw runs::NumericsError(
        fmt::format("the material has reached geometry.domain_radius = {} m at {:.4g} s: enlarge the domain",
                    problem_.domain_radius, time_));
}

}  // namespace flowrest::elements
