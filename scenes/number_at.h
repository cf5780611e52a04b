#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"

namespace flowrest::scenes {

/// The place of a number in a scene: a key's dotted path, on into a table ("walls.base.friction"), and for pairs of
/// time and value the number of the pair from 0 on ("process.printing_velocity[2]").
struct NumberAt {
  std::string path;
  double value;
  std::string unit;  ///< of the key; "" where it has none
};

/// The number at a place of a scene as it is resolved.
/// @throws SceneError naming the place and what is allowed where there is no number.
NumberAt number_at(const Scene&, const std::string& path);

/// The scene with other numbers at such places.
/// @throws SceneError where the scene would not be one.
Scene with_numbers(const Scene&, const std::vector<NumberAt>&);

}  // namespace flowrest::scenes
