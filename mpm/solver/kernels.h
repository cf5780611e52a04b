#pragma once

#include <string>
#include <vector>

#include "laws/law.h"
#include "mpm/boundary/contact_points.h"
#include "mpm/material/equation_of_state.h"
#include "mpm/material/flow_law.h"
#include "mpm/solver/choices.h"
#include "mpm/solver/layout.h"

/// The stages of a step as plain functions over one block, compiled once per instruction set and chosen at
/// run time.
namespace flowrest::mpm {

using laws::Law;

/// Everything that is the same for all particles of a step.
template <class T>
struct StepParameters {
  T step{};             ///< s
  T cell{};             ///< m
  T density{};          ///< kg/m3, initial
  T acceleration[3]{};  ///< m/s2, of gravity and body force
  T keep{};             ///< share of the particle's own velocity (and APIC's affine part) kept over the step
  T density_correction{};  ///< share of an overlap of particles, or of a gap at a wall, taken back per unit
                           ///< strain
  bool filling_matters = true;  ///< there are free surfaces, and B-bar is by average
  bool full_cells = false;      ///< there are none, and B-bar is by average
  FlowParameters<T> flow;
  EquationOfState<T> state;
  Law law = Law::elasto_viscoplastic;
  bool thixotropic = false;
  StressRate stress_rate = StressRate::hughes_winget;
  Dilatation dilatation = Dilatation::smooth;
  bool explicit_fluid = false;
  AxisBounds bounds[3];
  /// Moves a place (m) out of walls of any shape if it lies in one of `near`; returns whether it did. Null
  /// where there are no such walls.
  bool (*keep_out)(const void* walls, WallSet near, double (&place)[3]) = nullptr;
  const void* walls = nullptr;
  T smallest_mass{};  ///< kg: a node with less carries no velocity
};

/// Room for one thread's tile of particles in flight: every particle of a tile's cells, `capacity` at most.
template <class T>
struct Workspace {
  T* memory = nullptr;  ///< workspace_arrays * capacity values, aligned to 64 bytes
  int capacity = 0;     ///< a multiple of 16, at least the fullest cell's particles + tile_padding
};
constexpr int workspace_arrays = 112;
constexpr int tile_padding = 16;  ///< lanes of the last pack may write past a tile's end

template <class T>
using BlockStage = void (*)(const StepParameters<T>&, const ParticleView<T>&, const BlockView&,
                            const Grid<T>&, const Workspace<T>&);
template <class T>
using NodeStage = void (*)(const StepParameters<T>&, const NodeView&, const Grid<T>&);
/// Reads an average of a block's particles off the grid, into an array with a place for each.
template <class T>
using AverageReader = void (*)(const StepParameters<T>&, const ParticleView<T>&, const BlockView&,
                               const Grid<T>&, const Workspace<T>&, T* out);

/// One instruction set's stages for one dimension and transfer.
template <class T>
struct Kernels {
  int dimension = 0;
  /// Mass, momentum and the impulse of the step's forces into the arena.
  BlockStage<T> particles_to_grid = nullptr;
  NodeStage<T> update_nodes = nullptr;  ///< arenas summed into velocities
  /// Quadratic: velocities, strain, stress, positions. Linear: velocities, and their momentum re-mapped into the
  /// arena.
  BlockStage<T> grid_to_particles = nullptr;
  NodeStage<T> remap_nodes = nullptr;             ///< linear only (MUSL)
  BlockStage<T> remapped_to_particles = nullptr;  ///< linear only (MUSL): strain, stress, positions
  // Quadratic only, for the smooth B-bar:
  NodeStage<T> average_dilatation = nullptr;  ///< of what grid_to_particles left in the arenas
  BlockStage<T> update_volumes = nullptr;     ///< volumes and pressures, and both into the arena
  NodeStage<T> average_pressure = nullptr;
  AverageReader<T> acting_pressure = nullptr;  ///< for those who look at particles between steps
  ContactKernels<T> contact{};                 ///< with walls of any shape
};

/// The instruction sets this build has and this machine can run, best first: "avx512", "avx2", "x86-64" or
/// "generic".
std::vector<std::string> instruction_sets();

/// @throws std::invalid_argument where the machine cannot run `instruction_set`.
template <class T>
Kernels<T> kernels(const std::string& instruction_set, int dimension, bool axisymmetric, Transfer);

}  // namespace flowrest::mpm
