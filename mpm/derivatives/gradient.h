#pragma once

#include <functional>
#include <vector>

#include "mpm/derivatives/quantities.h"
#include "mpm/derivatives/recording.h"
#include "mpm/derivatives/variation.h"

/// Derivatives of a recorded run.
namespace flowrest::mpm::derivatives {

/// Readings at a time, and how they change with the keys.
struct Readings {
  double time = 0.0;                       ///< s
  std::vector<double> value;               ///< by quantity, in its unit
  std::vector<std::vector<double>> slope;  ///< by quantity and key: the quantity's unit per the key's
};

/// Tells how far it has come, from 0 to 1.
using Watch = std::function<void(double)>;

/// Forward: the recorded run over dual numbers, by up to eight keys at once. Costs a run by the plain step times 3 to
/// 10 for every eight keys. @return at every row of the recording
/// @throws runs::NumericsError where a step fails.
std::vector<Readings> forward(const Variations&, const Recording&, const std::vector<Quantity>&,
                              const Watch& = {});

/// The readings of another variation of the recorded run, with the same steps.
/// @return by row of the recording, and quantity
std::vector<std::vector<double>> replayed(const Variation&, const Variation& recorded, const Recording&,
                                          const std::vector<Quantity>&, const Watch& = {});

/// What going backwards took.
struct ReverseCost {
  std::size_t snapshots = 0;         ///< states kept at most
  std::size_t recomputed_steps = 0;  ///< made again, beside those that each adjoint makes
  double memory = 0.0;               ///< bytes of the states kept
};

/// In words what reverse() does not serve of a scene; empty where it serves all.
std::string not_served_in_reverse(const SolverSettings&);

/// Reverse: the derivatives of readings at the recording's end by any number of keys, by one pass backwards for each
/// quantity (reverse_step.h). States are kept in at most `memory` bytes, and made again where they were not, with the
/// same bits.
/// @throws runs::NumericsError where a step fails or a state made again has other bits; std::invalid_argument where
/// the scene is not served.
Readings reverse(const Variations&, const Recording&, const std::vector<Quantity>&, double memory,
                 ReverseCost&, const Watch& = {});

}  // namespace flowrest::mpm::derivatives
