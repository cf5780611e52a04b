#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runs/run_directory.h"

/// What a study measures of a run, by name: a column of its history at the end ("spread_mm") or at a time
/// ("spread_mm@1.5"), a moment ("rest_time_s", "arrival_s", "light_s"), or how its profile differs from the
/// reference's ("profile_l1", "profile_l2", with or without a time).
/// Or how one of these changes with a key: "derivative(spread_mm, material.yield_stress)" in the quantity's unit per the
/// key's, "elasticity(...)" in % per %. Runs of material points are then made by `flowrest gradient`.
namespace flowrest::studies {

/// A derivative by its name.
struct DerivativeName {
  bool elasticity = false;
  std::string of, by;
};
/// The derivative that a quantity is; nothing where it is none.
std::optional<DerivativeName> derivative_named(const std::string& quantity);

/// What is wrong with the name of a quantity; empty where nothing is.
std::string complaint_about(const std::string& quantity);

/// Some names, for messages.
std::vector<std::string> quantity_examples();

/// Whether the quantity is itself a difference from the reference, so that its own value is the error.
bool is_difference(const std::string& quantity);

/// The unit of a quantity, from its name: "mm", "s", "m/s"; "1" for a ratio.
std::string unit_of(const std::string& quantity);

/// The quantity of a run; none where the run does not have it (a fluid has no rest time, a failed run no
/// end). `reference` is needed by differences alone.
std::optional<double> measure(const runs::Run&, const std::string& quantity,
                              const runs::Run* reference = nullptr);

}  // namespace flowrest::studies
