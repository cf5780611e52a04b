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
std::vector<Readings> forward(const Variations&, const Recording&, const std::vector<const Quantity*>&,
                              const Watch& = {});

/// The readings of another variation of the recorded run, with the same steps.
/// @return by row of the recording, and quantity
std::vector<std::vector<double>> replayed(const Variation&, const Variation& recorded, const Recording&,
                                          const std::vector<const Quantity*>&, const Watch& = {});

}  // namespace flowrest::mpm::derivatives
