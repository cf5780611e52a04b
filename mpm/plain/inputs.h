#pragma once

#include <algorithm>
#include <limits>
#include <memory>

#include "mpm/plain/step.h"
#include "mpm/solver/solver.h"

/// From a solver's settings and seeds to what the plain step computes with, over any scalar.
namespace flowrest::mpm::plain {

/// The numbers of a solver's settings that a step computes with, and that it has derivatives by. All else of
/// the settings (cells, where walls stand) is alike for every scalar.
template <class T>
struct Inputs {
  Material<T> material;
  std::vector<T> friction;                           ///< a coefficient for each wall of any shape
  std::array<std::array<T, 2>, 3> plane_friction{};  ///< of each axis' lower and upper plane wall
};

/// Calls use(number) for each of them.
template <class I, class Use>
void visit_numbers(I& inputs, const Use& use) {
  auto& m = inputs.material;
  for (auto* number : {&m.density, &m.state.bulk_modulus, &m.state.shear_modulus, &m.state.exponent,
                       &m.parameters.yield_stress, &m.parameters.plastic_viscosity,
                       &m.parameters.regularisation_time, &m.parameters.critical_shear_rate,
                       &m.parameters.flow_index, &m.structure.growth, &m.structure.breakdown,
                       &m.structure.exponent, &m.ageing.rate, &m.ageing.per_time, &m.ageing.initial_age})
    use(*number);
  for (auto& coefficient : inputs.friction) use(coefficient);
  for (auto& axis : inputs.plane_friction)
    for (auto& coefficient : axis) use(coefficient);
}

/// All of them.
inline std::vector<double> numbers_of(const Inputs<double>& inputs) {
  std::vector<double> numbers;
  visit_numbers(inputs, [&](double number) { numbers.push_back(number); });
  return numbers;
}

template <class T>
Inputs<T> inputs_of(const SolverSettings& s) {
  Inputs<T> inputs;
  Material<T>& m = inputs.material;
  m.density = static_cast<T>(s.density);
  m.state = {static_cast<T>(s.state.bulk_modulus), static_cast<T>(s.state.shear_modulus),
             static_cast<T>(s.state.exponent)};
  m.law = s.law;
  m.parameters = {static_cast<T>(s.flow.yield_stress), static_cast<T>(s.flow.plastic_viscosity),
                  static_cast<T>(s.flow.regularisation_time), static_cast<T>(s.flow.critical_shear_rate),
                  static_cast<T>(s.flow.flow_index)};
  m.thixotropic = s.thixotropic;
  m.structure = {static_cast<T>(s.structure.growth), static_cast<T>(s.structure.breakdown),
                 static_cast<T>(s.structure.exponent)};
  m.ageing = {static_cast<T>(s.ageing.rate), static_cast<T>(s.ageing.per_time),
              static_cast<T>(s.ageing.initial_age)};
  for (const Wall& wall : s.walls)
    inputs.friction.push_back(static_cast<T>(wall.contact == mpm::Contact::friction ? wall.friction : 0.0));
  for (std::size_t a = 0; a < 3; ++a)
    inputs.plane_friction[a] = {static_cast<T>(s.bounds[a].lower_friction),
                                static_cast<T>(s.bounds[a].upper_friction)};
  return inputs;
}

inline Numerics numerics_of(const SolverSettings& s) {
  return {.axisymmetric = s.axisymmetric,
          .cell = s.cell,
          .bounds = s.bounds,
          .dilatation = s.b_bar(),
          .explicit_fluid = s.explicit_fluid,
          .free_surface = s.free_surface,
          .density_correction = s.density_correction};
}

template <class T, int Dim>
Body<T, Dim> body_of(const SolverSettings& s, const Inputs<T>& inputs,
                     const std::vector<Particle<T, Dim>>& particles) {
  std::unique_ptr<Contact<T, Dim>> walls;
  if (!s.walls.empty()) walls = std::make_unique<Contact<T, Dim>>(s.walls, inputs.friction, s.cell, s.bounds);
  return Body<T, Dim>(inputs.material, numerics_of(s), std::move(walls), particles, inputs.plane_friction);
}

/// Share of their own velocity that particles keep over a step, whose transfer smooths once in
/// `relaxation_time` s.
inline double kept_share(double relaxation_time, double step) {
  return std::max(0.0, 1.0 - step / std::max(relaxation_time, step));
}

/// The nozzles that are there at a time.
inline std::vector<NozzleMotion<double>> nozzles_at(const SolverSettings& s, double time, double step) {
  std::vector<NozzleMotion<double>> there;
  for (const Nozzle& nozzle : s.nozzles)
    if (nozzle.is_there(time)) there.push_back(motion_of(nozzle, time, step, s.cell));
  return there;
}

template <int Dim>
Cell<Dim> cell_of(const CellIndex& index) {
  Cell<Dim> cell;
  std::copy_n(index.begin(), Dim, cell.begin());
  return cell;
}

/// Calls use(component) for the components of a particle's deviator.
template <int Dim, class P, class Use>
void visit_deviator(P& p, const Use& use) {
  use(p.stress.xx);
  use(p.stress.yy);
  use(p.stress.xy);
  if constexpr (Dim == 3) {
    use(p.stress.xz);
    use(p.stress.yz);
  }
}

/// Calls use(number) for every number of a particle's state, in the order of SolverState's arrays.
template <int Dim, class P, class Use>
void visit_state(P& p, bool thixotropic, const Use& use) {
  for (auto& x : p.place) use(x);
  for (auto& v : p.velocity) use(v);
  for (auto& row : p.affine)
    for (auto& a : row) use(a);
  visit_deviator<Dim>(p, use);
  use(p.volume_ratio);
  use(p.pressure);
  use(p.mass);
  use(p.rate);
  if (thixotropic) use(p.flocculation);
}

template <class T, int Dim>
Particle<T, Dim> particle_of(const SolverSettings& settings, const Seed& seed) {
  Particle<T, Dim> p;
  p.cell = cell_of<Dim>(seed.cell);
  for (std::size_t a = 0; a < Dim; ++a) {
    const T last = T(1) - T(0.5) * std::numeric_limits<T>::epsilon();
    p.place[a] = std::clamp(static_cast<T>(seed.position[a]), T(0), last);
    p.velocity[a] = static_cast<T>(seed.velocity[a]);
  }
  p.mass = static_cast<T>(seed.volume * settings.density);
  p.volume_ratio = static_cast<T>(seed.volume_ratio);
  p.pressure = inputs_of<T>(settings).material.state.pressure(p.volume_ratio);
  if (settings.thixotropic) p.flocculation = static_cast<T>(seed.flocculation);
  std::size_t component = 0;
  visit_deviator<Dim>(p, [&](T& s) { s = static_cast<T>(seed.deviator[component++]); });
  p.rate = static_cast<T>(seed.rate);
  return p;
}

}  // namespace flowrest::mpm::plain
