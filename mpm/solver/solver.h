#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "laws/equation_of_state.h"
#include "laws/law.h"
#include "mpm/boundary/nozzle.h"
#include "mpm/boundary/walls.h"
#include "mpm/solver/choices.h"
#include "mpm/solver/layout.h"

namespace flowrest::mpm {

/// What the solver needs to know of a scene, in its own terms.
struct SolverSettings {
  int dimension = 2;
  bool axisymmetric = false;
  Transfer transfer = Transfer::quadratic_apic;
  std::optional<Dilatation> dilatation;  ///< default: smooth if quadratic, the cell average if linear
  StressRate stress_rate = StressRate::hughes_winget;
  laws::Law law = laws::Law::elasto_viscoplastic;
  bool explicit_fluid = false;
  bool single_precision = false;
  double cell = 0.0;                  ///< m
  double density = 0.0;               ///< kg/m3
  double flip_relaxation_time = 0.0;  ///< s; infinite for pure FLIP
  double density_correction =
      0.0;  ///< share of an overlap of particles, or of a gap at a wall, taken back per unit strain
  bool free_surface = true;  ///< where there is none, as in a duct, every cell is full and stays so
  laws::Parameters<double> flow;
  bool thixotropic = false;
  laws::Structure<double> structure;  ///< of what is thixotropic
  laws::Ageing<double> ageing;        ///< likewise; all of it is as old, fed or there from the start
  laws::EquationOfState<double> state;
  std::array<AxisBounds, 3> bounds{};
  std::vector<Wall> walls;      ///< of any shape, beside the planes of `bounds`
  std::vector<Nozzle> nozzles;  ///< in three dimensions, with quadratic functions
  int threads = 0;              ///< 0: as many as the particles can feed, of the cores that are ours
  std::string instruction_set;  ///< empty: the best this machine runs

  Dilatation b_bar() const {
    return dilatation.value_or(transfer == Transfer::quadratic_apic ? Dilatation::smooth
                                                                    : Dilatation::cell_average);
  }
};

/// One particle to begin with.
struct Seed {
  CellIndex cell{};
  std::array<double, 3> position{};  ///< within the cell, in [0, 1)
  double volume = 0.0;               ///< m3
  std::array<double, 3> velocity{};  ///< m/s
  double flocculation = 0.0;
  double volume_ratio = 1.0;         ///< J; `volume` is that at rest
  std::array<double, 5> deviator{};  ///< Pa, of the stress, as many components as particles have
  double rate = 0.0;                 ///< 1/s
};

/// Particles to begin with that are nowhere all at once: tells them one by one, the same ones in the same
/// order whenever it is asked.
using SeedSource = std::function<void(const std::function<void(const Seed&)>& use)>;

/// Extremes and sums of one step.
struct StepResult {
  double largest_speed = 0.0;     ///< m/s
  double largest_pressure = 0.0;  ///< Pa
  double dissipated = 0.0;        ///< J in this step
  double wall_work = 0.0;         ///< J done in this step by walls that are not along the grid, and nozzles
  double momentum = 0.0;          ///< kg m/s along the first axis, of the velocities that moved the particles
};

/// The particles of one block in double precision, in an order that depends on nothing but the motion.
struct ParticleBatch {
  std::size_t count = 0;
  std::array<std::vector<double>, 3> position;  ///< m
  std::array<std::vector<double>, 3> velocity;  ///< m/s
  std::vector<double> mass;                     ///< kg
  std::vector<double> volume;                   ///< m3
  std::vector<double> rate;                     ///< 1/s, plastic (EVP) or total (fluid) shear rate
  std::vector<double> shear_stress;             ///< Pa, the invariant
  std::array<std::vector<double>, 5> deviator;  ///< Pa, of the stress: xx, yy, xy and, in space, xz, yz
  std::vector<double> raw_pressure;             ///< Pa, of the particle's own volume
  std::vector<double> acting_pressure;  ///< Pa, averaged through the nodes; empty unless that is the B-bar
  std::vector<double> flocculation;     ///< empty without thixotropy
  std::vector<double> elastic_energy;   ///< J, of shape and volume

  void clear();
  /// Takes up a particle of another batch, of the same solver.
  void add(const ParticleBatch& other, std::size_t particle);
};

/// CPU per stage of the steps so far.
struct StageTimes {
  double particles_to_grid = 0.0, nodes = 0.0, grid_to_particles = 0.0, sorting = 0.0;  ///< s of wall time
  double volumes = 0.0;  ///< s of wall time, smooth B-bar only
};

/// Everything a solver holds, for checkpoints: particles in sorted order. Their arrays are many times as long
/// as anything else, and asked for one after the other.
struct StoredState {
  std::vector<CellIndex> cells;
  std::function<std::vector<double>(int)> array;  ///< in the order of Particles; exact for either precision
  int array_count = 0;
  int tile_capacity = 0;
  std::vector<double> wall_forces;  ///< N, at the walls' points: what the next step's contact starts from
};

/// The same, all of it at hand.
struct SolverState {
  std::vector<CellIndex> cells;
  std::vector<std::vector<double>> arrays;
  int tile_capacity = 0;
  std::vector<double> wall_forces;
};

/// A material point solver for one scene. One call of a virtual function per step; none inside.
class Solver {
 public:
  virtual ~Solver() = default;
  /// Advances by `step` seconds under a uniform acceleration (m/s2, per axis of the solver).
  /// @throws runs::NumericsError where a particle moved further than a cell or is not finite.
  virtual StepResult step(double step, const std::array<double, 3>& acceleration) = 0;
  /// Sets the time over which APIC's transfer smooths velocities once, s; zero, as a solver starts, for once
  /// a step. Linear transfers have their own, fixed one.
  virtual void set_apic_relaxation_time(double) = 0;
  /// Says what time it is, for walls that move: s at the next step's beginning.
  virtual void set_time(double) = 0;
  /// Force of a wall of the settings on the material in the last step, N.
  virtual Vector wall_force(std::size_t wall) const = 0;
  /// Force of the nozzles on the material in the last step, N.
  virtual Vector nozzle_force() const = 0;
  /// Between two steps: takes out the particles for whose place (m) `leaves` is true (nobody where it is empty), after `use` has seen them,
  /// and puts others in. The rest keep all that they have, and their order in each cell.
  virtual void exchange(const std::function<bool(const Vector&)>& leaves,
                        const std::function<void(const ParticleBatch&)>& use,
                        const std::vector<Seed>& come) = 0;
  /// Calls `use` for every block in turn.
  virtual void visit(const std::function<void(const ParticleBatch&)>& use) = 0;
  /// The same with positions, velocities and masses alone, which cost little.
  virtual void visit_motion(const std::function<void(const ParticleBatch&)>& use) = 0;
  /// A piece of the state of every block in turn, which add up to what StoredState has: its particles' cells,
  /// and one of their arrays.
  virtual void visit_cells(const std::function<void(std::span<const CellIndex>)>& use) = 0;
  virtual void visit_array(int array, const std::function<void(std::span<const double>)>& use) = 0;
  virtual int array_count() const = 0;
  virtual int tile_capacity() const = 0;
  virtual std::vector<double> wall_forces() const = 0;
  SolverState state();
  virtual std::size_t particle_count() const = 0;
  virtual std::size_t occupied_cells() const = 0;
  virtual std::size_t bytes() const = 0;  ///< of particles and grid
  virtual int threads() const = 0;
  virtual const std::string& instruction_set() const = 0;
  virtual const StageTimes& stage_times() const = 0;
};

/// What a solver says of a step after which `faults` particles have moved further than a cell or are no
/// longer finite. @throws runs::NumericsError where there are any, or the energy dissipated in it is not
/// finite.
void require_stable(std::uint32_t faults, double dissipated, double step);

/// A list of seeds as a source, and a state at hand as one that is stored; they look at what they are of.
SeedSource source_of(const std::vector<Seed>&);
StoredState stored(const SolverState&);

std::unique_ptr<Solver> make_solver(const SolverSettings&, const SeedSource&);
std::unique_ptr<Solver> make_solver(const SolverSettings&, const StoredState&);
std::unique_ptr<Solver> make_solver(const SolverSettings&, const std::vector<Seed>&);
std::unique_ptr<Solver> make_solver(const SolverSettings&, const SolverState&);

}  // namespace flowrest::mpm
