#pragma once

#include <optional>
#include <vector>

#include "scenes/apparatus/load.h"
#include "scenes/choices.h"

/// What the header of every apparatus needs: what it is told, and what it gives (apparatus.h).
namespace flowrest::scenes {

struct Case;
struct Key;
struct Pieces;
struct Scene;

}  // namespace flowrest::scenes
