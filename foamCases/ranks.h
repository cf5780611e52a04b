#pragma once

#include <cstddef>
#include <string>

#include "scenes/scene.h"

/// Into how many parts a case may be cut.
namespace flowrest::foam {

/// What a scene's mesh offers to ranks.
struct Divisible {
  std::size_t cells = 0;
  std::size_t slices = 0;  ///< of cells across the axis along which decomposePar cuts
};
Divisible divisible(const scenes::Scene&);

/// Ranks beyond which solving takes longer instead of shorter on this machine.
int sensible_ranks(const Divisible&, int cores);

/// @throws scenes::SceneError where a scene cannot be solved on so many ranks, saying how many are allowed
/// and how many are sensible.
void check_ranks(const scenes::Scene&, int ranks, int cores);

/// Why so many ranks are more than sensible, in words; empty where they are not.
std::string too_many_ranks(const scenes::Scene&, int ranks, int cores);

}  // namespace flowrest::foam
