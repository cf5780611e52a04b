#include "compare/exact/film.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "runs/depth.h"

namespace flowrest::compare::exact {

namespace {

constexpr double tolerance = 1e-12;  // m, of a step's residual
constexpr double nudge = 1e-9;       // m, for derivatives of the flux
constexpr int most_iterations = 25;
constexpr double growth = 1.2;           // of the step, where Newton's method finds it easy
constexpr double step_over_time = 2e-3;  // a smaller one changes the spread by less than 0.1 mm

/// Solves the tridiagonal system in place; the solution is left in `right`.
void solve_tridiagonal(std::vector<double>& lower, std::vector<double>& middle,
                       const std::vector<double>& upper, std::vector<double>& right) {
  const std::size_t n = right.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = lower[i] / middle[i - 1];
    middle[i] -= factor * upper[i - 1];
    right[i] -= factor * right[i - 1];
  }
  right[n - 1] /= middle[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) right[i] = (right[i] - upper[i] * right[i + 1]) / middle[i];
}

/// int tau g dtau along the flow curve up to a shear rate, in pieces between which the law changes its
/// nature, each by Gauss' rule with four points. Pa2/s
double stress_rate_integral(const RegularisedFluid& fluid, double last_rate) {
  static constexpr double point[] = {0.8611363115940526, 0.3399810435848563};
  static constexpr double weight[] = {0.3478548451374538, 0.6521451548625461};
  static constexpr double ends[] = {0.3, 1.0, 2.0, 4.0, 8.0, 16.0, 40.0};  // of the rate at which it bends
  double sum = 0.0, begin = 0.0;
  const auto add_piece = [&](double end) {
    for (int k = 0; k < 4; ++k) {
      const double rate = 0.5 * (begin + end) + (k % 2 ? 0.5 : -0.5) * (end - begin) * point[k / 2];
      sum += 0.5 * (end - begin) * weight[k / 2] * fluid.stress(rate) * rate * fluid.tangent(rate);
    }
    begin = end;
  };
  for (const double end : ends) {
    const double rate = end * fluid.yielding_rate();
    if (rate >= last_rate) break;
    add_piece(rate);
  }
  add_piece(last_rate);
  return sum;
}

}  // namespace

double film_flux(const Bingham& material, double gravity, double depth, double slope) {
  if (!(depth > 0.0) || slope == 0.0) return 0.0;
  const double weight = material.density * gravity * std::abs(slope);  // Pa/m
  const double yielded = depth - material.yield_stress / weight;
  if (!(yielded > 0.0)) return 0.0;
  const double flux =
      weight * yielded * yielded * (3.0 * depth - yielded) / (6.0 * material.plastic_viscosity);
  return std::copysign(flux, slope);
}

double slope_under_plug(const Bingham& material, double gravity, double depth, double slope) {
  const double pull = plug_pull * material.yield_stress / (material.density * gravity);  // m
  return depth > pull ? slope * (1.0 - pull / depth) : 0.0;
}

double film_flux(const RegularisedFluid& fluid, double density, double gravity, double depth, double slope) {
  if (!(depth > 0.0) || slope == 0.0) return 0.0;
  const double base_stress = density * gravity * depth * std::abs(slope);
  // So little that the fluid is Newtonian there, and that its square would underflow.
  if (base_stress < 1e-6 * fluid.parameters.yield_stress)
    return std::copysign(base_stress * depth * depth / (3.0 * fluid.largest_viscosity()), slope);
  const double integral = stress_rate_integral(fluid, fluid.rate(base_stress));
  return std::copysign(depth * depth / (base_stress * base_stress) * integral, slope);
}

std::vector<double> FilmState::centres() const {
  std::vector<double> radius;
  for (std::size_t i = 0; i < depth.size(); ++i) radius.push_back((static_cast<double>(i) + 0.5) * spacing);
  return radius;
}

double FilmState::volume() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < depth.size(); ++i)
    sum += depth[i] * std::numbers::pi * spacing * spacing * (2.0 * static_cast<double>(i) + 1.0);
  return sum;
}

SpreadingFilm::SpreadingFilm(Flux flux, double radius, double volume, double domain_radius, int rings)
    : flux_(std::move(flux)) {
  state_.spacing = domain_radius / rings;
  // Whole rings: the cylinder's radius is the nearest face, its volume exact.
  const int filled = std::max(1, static_cast<int>(std::lround(radius / state_.spacing)));
  const double edge = filled * state_.spacing;
  state_.depth.assign(static_cast<std::size_t>(rings), 0.0);
  std::fill_n(state_.depth.begin(), filled, volume / (std::numbers::pi * edge * edge));
}

double SpreadingFilm::face_flux(double inner, double outer) const {
  return flux_(0.5 * (inner + outer), (inner - outer) / state_.spacing);
}

/// One step of implicit Euler by Newton's method; false where it does not converge.
bool SpreadingFilm::try_step(double step, std::vector<double>& depth) const {
  const std::size_t n = depth.size();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    std::vector<double> lower(n, 0.0), middle(n, 1.0), upper(n, 0.0), residual(n);
    for (std::size_t i = 0; i < n; ++i) residual[i] = depth[i] - state_.depth[i];
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double flux = face_flux(depth[i], depth[i + 1]);
      const double by_inner = (face_flux(depth[i] + nudge, depth[i + 1]) - flux) / nudge;
      const double by_outer = (face_flux(depth[i], depth[i + 1] + nudge) - flux) / nudge;
      // dt r_face / (r dr), in rings
      const double out =
          step / state_.spacing * (static_cast<double>(i) + 1.0) / (static_cast<double>(i) + 0.5);
      const double in =
          step / state_.spacing * (static_cast<double>(i) + 1.0) / (static_cast<double>(i) + 1.5);
      residual[i] += out * flux;
      residual[i + 1] -= in * flux;
      middle[i] += out * by_inner;
      upper[i] += out * by_outer;
      lower[i + 1] -= in * by_inner;
      middle[i + 1] -= in * by_outer;
    }
    const auto largest = std::max_element(residual.begin(), residual.end(),
                                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (!std::isfinite(*largest)) return false;
    if (std::abs(*largest) < tolerance) return true;
    solve_tridiagonal(lower, middle, upper, residual);
    for (std::size_t i = 0; i < n; ++i) depth[i] = std::max(0.0, depth[i] - residual[i]);
  }
  return false;
}

void SpreadingFilm::advance_to(double time) {
  constexpr double smallest_step = 1e-14;  // s
  while (state_.time < time) {
    const double step = std::min(step_, time - state_.time);
    auto depth = state_.depth;
    if (!try_step(step, depth)) {
      step_ = 0.5 * step;
      if (step_ < smallest_step) throw std::runtime_error("the thin film's step finds no solution");
      continue;
    }
    state_.depth = std::move(depth);
    state_.time = step < time - state_.time ? state_.time + step : time;
    if (step == step_) step_ = std::min(growth * step_, std::max(1e-5, step_over_time * state_.time));
  }
}

SpreadingFilm bingham_film(const Bingham& material, double gravity, double radius, double volume,
                           double domain_radius, int rings, bool plug_pulls) {
  return {[=](double depth, double slope) {
            if (plug_pulls) slope = slope_under_plug(material, gravity, depth, slope);
            return film_flux(material, gravity, depth, slope);
          },
          radius, volume, domain_radius, rings};
}

Approach approach_to_rest(const Bingham& material, double gravity, double radius, double volume,
                          double domain_radius, double time, double spread_depth) {
  constexpr int rings = 450;
  const auto speed = [&](bool plug_pulls) {
    SpreadingFilm film = bingham_film(material, gravity, radius, volume, domain_radius, rings, plug_pulls);
    const auto spread_at = [&](double t) {
      film.advance_to(t);
      const auto centres = film.state().centres();
      return runs::spread({centres, film.state().depth}, spread_depth);
    };
    const double before = spread_at(time / std::numbers::sqrt2),
                 after = spread_at(time * std::numbers::sqrt2);
    return (after - before) * std::numbers::sqrt2 / time;
  };
  return {speed(false), speed(true)};
}

}  // namespace flowrest::compare::exact
