#include "mpm/plain/solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "mpm/plain/inputs.h"

namespace flowrest::mpm::plain {

namespace {

/// Calls use(number) for one number of a particle's state.
template <int Dim, class P, class Use>
void visit_number(P& p, bool thixotropic, int wanted, const Use& use) {
  int number = 0;
  visit_state<Dim>(p, thixotropic, [&](auto& value) {
    if (number++ == wanted) use(value);
  });
}

template <class T, int Dim>
std::vector<Particle<T, Dim>> particles_of(const SolverSettings& settings, const SeedSource& seeds) {
  std::vector<Particle<T, Dim>> particles;
  seeds([&](const Seed& seed) { particles.push_back(particle_of<T, Dim>(settings, seed)); });
  return particles;
}

template <class T, int Dim>
std::vector<Particle<T, Dim>> particles_of(const SolverSettings& settings, const StoredState& state) {
  std::vector<Particle<T, Dim>> particles(state.cells.size());
  for (std::size_t q = 0; q < particles.size(); ++q) particles[q].cell = cell_of<Dim>(state.cells[q]);
  for (int k = 0; k < state.array_count; ++k) {
    const std::vector<double> array = state.array(k);
    for (std::size_t q = 0; q < particles.size(); ++q)
      visit_number<Dim>(particles[q], settings.thixotropic, k,
                        [&](T& number) { number = static_cast<T>(array.at(q)); });
  }
  return particles;
}

template <class T, int Dim>
class PlainSolver final : public Solver {
 public:
  PlainSolver(const SolverSettings& settings, const std::vector<Particle<T, Dim>>& particles)
      : settings_(settings), body_(body_of<T, Dim>(settings, inputs_of<T>(settings), particles)) {}

  PlainSolver(const SolverSettings& settings, const StoredState& state)
      : PlainSolver(settings, particles_of<T, Dim>(settings, state)) {
    if (!body_.walls()) return;
    std::size_t i = 0;
    body_.walls()->visit_forces([&](Vec<T, Dim>& force) {
      for (std::size_t c = 0; c < Dim; ++c)
        if (i + c < state.wall_forces.size()) force[c] = static_cast<T>(state.wall_forces[i + c]);
      i += 3;
    });
  }

  StepResult step(double step, const std::array<double, 3>& acceleration) override {
    const double begin = now();
    Vec<T, Dim> driving;
    for (std::size_t a = 0; a < Dim; ++a) driving[a] = static_cast<T>(acceleration[a]);
    const auto kept = static_cast<T>(kept_share(apic_relaxation_time_, step));
    std::vector<NozzleMotion<T>> nozzles;
    for (const NozzleMotion<double>& nozzle : nozzles_at(settings_, time_, step))
      nozzles.emplace_back(nozzle);
    const Outcome<T> outcome = body_.step(time_, static_cast<T>(step), driving, kept, nozzles);
    time_ += step;
    step_ = step;
    times_.particles_to_grid += now() - begin;
    require_stable(outcome.faults, value(outcome.dissipated), step);
    return {.largest_speed = outcome.largest_speed,
            .largest_pressure = outcome.largest_pressure,
            .dissipated = value(outcome.dissipated),
            .wall_work = value(outcome.wall_work),
            .momentum = value(outcome.momentum)};
  }

  void set_apic_relaxation_time(double time) override { apic_relaxation_time_ = time; }
  void set_time(double time) override { time_ = time; }

  mpm::Vector wall_force(std::size_t wall) const override {
    mpm::Vector force{};
    if (!body_.walls()) return force;
    const Vec<T, Dim> own = body_.walls()->force(wall);
    for (std::size_t c = 0; c < Dim; ++c) force[c] = value(own[c]);
    return force;
  }

  mpm::Vector nozzle_force() const override {
    mpm::Vector force{};
    for (std::size_t c = 0; c < Dim; ++c) force[c] = value(body_.nozzle_impulse()[c]) / step_;
    return force;
  }

  void exchange(const std::function<bool(const mpm::Vector&)>& leaves,
                const std::function<void(const ParticleBatch&)>& use,
                const std::vector<Seed>& come) override {
    const ParticleBatch all = leaves ? everything() : ParticleBatch{};
    ParticleBatch leaving;
    std::vector<Particle<T, Dim>> particles;
    for (std::size_t q = 0; q < body_.particles().size(); ++q) {
      if (leaves && leaves({all.position[0][q], all.position[1][q], all.position[2][q]})) {
        leaving.add(all, q);
      } else {
        particles.push_back(body_.particles()[q]);
      }
    }
    if (leaving.count > 0) use(leaving);
    for (const Seed& seed : come) particles.push_back(particle_of<T, Dim>(settings_, seed));
    body_.take(particles);
  }

  void visit_motion(const std::function<void(const ParticleBatch&)>& use) override { use(motion()); }
  void visit(const std::function<void(const ParticleBatch&)>& use) override { use(everything()); }

  void visit_cells(const std::function<void(std::span<const CellIndex>)>& use) override {
    std::vector<CellIndex> cells;
    for (const Particle<T, Dim>& p : body_.particles())
      std::copy(p.cell.begin(), p.cell.end(), cells.emplace_back().begin());
    use(cells);
  }

  void visit_array(int array, const std::function<void(std::span<const double>)>& use) override {
    std::vector<double> numbers;
    for (const Particle<T, Dim>& p : body_.particles())
      visit_number<Dim>(p, settings_.thixotropic, array, [&](const T& n) { numbers.push_back(value(n)); });
    use(numbers);
  }

  int array_count() const override {
    int count = 0;
    const Particle<T, Dim> any{};
    visit_state<Dim>(any, settings_.thixotropic, [&](const T&) { ++count; });
    return count;
  }

  int tile_capacity() const override { return 0; }

  std::vector<double> wall_forces() const override {
    std::vector<double> forces;
    if (body_.walls())
      body_.walls()->visit_forces([&](const Vec<T, Dim>& force) {
        for (std::size_t c = 0; c < 3; ++c) forces.push_back(c < Dim ? value(force[c]) : 0.0);
      });
    return forces;
  }

  std::size_t particle_count() const override { return body_.particles().size(); }
  std::size_t occupied_cells() const override { return body_.occupied_cells(); }
  std::size_t bytes() const override {
    return 2 * body_.particles().size() * sizeof(Particle<T, Dim>) +
           body_.grid().size() * (sizeof(Node<T, Dim>) + sizeof(Average<T>));
  }
  int threads() const override { return 1; }
  const std::string& instruction_set() const override { return instruction_set_; }
  const StageTimes& stage_times() const override { return times_; }

 private:
  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  ParticleBatch motion() const {
    ParticleBatch batch;
    batch.count = body_.particles().size();
    for (std::size_t a = 0; a < 3; ++a) {
      batch.position[a].assign(batch.count, 0.0);
      batch.velocity[a].assign(batch.count, 0.0);
    }
    for (std::size_t q = 0; q < batch.count; ++q) {
      const Particle<T, Dim>& p = body_.particles()[q];
      for (std::size_t a = 0; a < Dim; ++a) {
        batch.position[a][q] = (p.cell[a] + value(p.place[a])) * settings_.cell;
        batch.velocity[a][q] = value(p.velocity[a]);
      }
      batch.mass.push_back(value(p.mass));
    }
    return batch;
  }

  ParticleBatch everything() const {
    ParticleBatch batch = motion();
    const laws::EquationOfState<double>& state = settings_.state;
    if (settings_.b_bar() == Dilatation::smooth)
      for (const T& pressure : body_.acting_pressure()) batch.acting_pressure.push_back(value(pressure));
    for (const Particle<T, Dim>& p : body_.particles()) {
      const double ratio = value(p.volume_ratio), stress = value(p.stress.invariant());
      const double at_rest = value(p.mass) / settings_.density;  // m3
      const double shape =
          settings_.explicit_fluid ? 0.0 : stress * stress / (2.0 * state.shear(ratio)) * ratio;
      batch.volume.push_back(at_rest * ratio);
      batch.rate.push_back(value(p.rate));
      batch.shear_stress.push_back(stress);
      std::size_t component = 0;
      visit_deviator<Dim>(p, [&](const T& s) { batch.deviator[component++].push_back(value(s)); });
      batch.raw_pressure.push_back(value(p.pressure));
      batch.elastic_energy.push_back(at_rest * (shape + state.energy(ratio)));
      if (settings_.thixotropic) batch.flocculation.push_back(value(p.flocculation));
    }
    return batch;
  }

  SolverSettings settings_;
  Body<T, Dim> body_;
  double apic_relaxation_time_ = 0.0;
  double time_ = 0.0;  ///< s
  double step_ = 1.0;  ///< s, the last one
  StageTimes times_;
  std::string instruction_set_ = "generic";
};

template <class T, int Dim, class From>
std::unique_ptr<Solver> solver_from(const SolverSettings& settings, const From& from) {
  if constexpr (std::is_same_v<From, StoredState>) {
    return std::make_unique<PlainSolver<T, Dim>>(settings, from);
  } else {
    return std::make_unique<PlainSolver<T, Dim>>(settings, particles_of<T, Dim>(settings, from));
  }
}

template <class From>
std::unique_ptr<Solver> make(const SolverSettings& settings, const From& from) {
  if (const std::string what = not_served(settings); !what.empty())
    throw std::invalid_argument("the plain step does not serve " + what);
  if (settings.single_precision)
    return settings.dimension == 3 ? solver_from<float, 3>(settings, from)
                                   : solver_from<float, 2>(settings, from);
  return settings.dimension == 3 ? solver_from<double, 3>(settings, from)
                                 : solver_from<double, 2>(settings, from);
}

}  // namespace

std::string not_served(const SolverSettings& settings) {
  if (settings.transfer != Transfer::quadratic_apic)
    return "linear functions (mpm.scheme linear-flip and paper)";
  if (settings.b_bar() == Dilatation::centroid) return "the dilatation of the cells' centres";
  if (settings.stress_rate != StressRate::hughes_winget) return "the Jaumann rate";
  return "";
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const SeedSource& seeds) {
  return make(settings, seeds);
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const StoredState& state) {
  return make(settings, state);
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const std::vector<Seed>& seeds) {
  return make(settings, source_of(seeds));
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const SolverState& state) {
  return make(settings, stored(state));
}

}  // namespace flowrest::mpm::plain
