#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mpm/solver/solver.h"
#include "runs/noise.h"

namespace flowrest::mpm {

/// Root mean square speeds of a body's particles, m/s.
struct VelocityNoise {
  double speed = 0.0;          ///< of all motion
  double within_cells = 0.0;   ///< of what differs within a cell from a field linear in space
  double between_steps = 0.0;  ///< of what alternates from step to step in the cells' means
};

/// Mass and mean velocity of the particles of one cell.
struct CellMotion {
  CellIndex cell{};
  double mass = 0.0;                 ///< kg
  std::array<double, 3> velocity{};  ///< m/s
};

/// The mean motion of every cell's particles, in the order of cells.
std::vector<CellMotion> motion_of_cells(Solver&, int dimension, double cell);

/// How far velocities within cells differ from fields linear in space: rms over the mass of the cells that
/// hold enough particles to tell, each residual over its degrees of freedom. `between_steps` is left out.
VelocityNoise noise_within_cells(Solver&, int dimension, double cell);

/// The amplitude of what alternates from step to step, rms over the mass of the cells that three moments have
/// in common, m/s. A constant acceleration is none; `first` and `second` are the steps between the moments,
/// s.
double alternation(const std::array<std::vector<CellMotion>, 3>& moments, double first, double second);

/// Measures noise in the three steps after an output, at most once in 200 steps, so that it costs little.
class NoiseMeter {
 public:
  NoiseMeter(int dimension, double cell) : dimension_(dimension), cell_(cell) {}
  /// An output has been made: the next steps may be looked at.
  void begin();
  /// Looks at the particles after a step of `step` seconds. True where that completes a measurement.
  bool add(Solver&, double step);
  const VelocityNoise& noise() const { return noise_; }

  /// Where it stands between two measurements and in the midst of one, for checkpoints.
  std::vector<double> state() const;
  /// @throws std::out_of_range where that is no state.
  void restore(const std::vector<double>& state);

 private:
  int dimension_;
  double cell_;
  int since_begin_ = -1;  ///< steps; negative before the first output
  std::array<std::vector<CellMotion>, 3> moments_;
  std::array<double, 3> steps_{};
  VelocityNoise noise_;
};

/// What a run has shown of one kind of noise where it passed its bound.
struct NoiseSeen {
  double time = 0.0;    ///< s, for how long
  double path = 0.0;    ///< m, how far it could have moved the material: its speed over that time
  double motion = 0.0;  ///< m, how far the material moved meanwhile, noise included
  double first = -1.0;  ///< s, when; -1 for never
  double last = -1.0;   ///< s
};

/// Both kinds of noise over a run, for its verdict. Noise is no matter where it is a small share of the
/// motion, nor where there is so little motion that it could not have moved the material visibly.
struct NoiseRecord {
  /// In sound runs velocities differ within cells by 0.01 to 0.2 of the mean speed (by more only where a body
  /// has just stopped); pure FLIP's by 0.6 to 0.9.
  static constexpr double within_cells_bound = 0.3;
  /// In sound runs 0.001 to 0.04; past the viscous limit of an explicit fluid 0.1 to 0.5.
  static constexpr double between_steps_bound = 0.1;
  static constexpr double path_allowed = runs::noise_path_allowed;

  NoiseSeen within_cells, between_steps;
  double judged_until = 0.0;  ///< s

  /// Takes in what was measured at `time`, as holding since the last measurement.
  void add(double time, const VelocityNoise&);
  /// Empty where the noise is within bounds; otherwise what passes them, when and by how much.
  std::string fault(double body_height) const;
};

}  // namespace flowrest::mpm
