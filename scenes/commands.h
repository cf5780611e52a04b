#pragma once

#include <CLI/CLI.hpp>

#include "scenes/cost.h"

namespace flowrest::scenes {

/// Adds `flowrest scenes` and `flowrest check`, which says what the solvers that are there tell of a scene.
void add_commands(CLI::App&, const Estimates& = {});

}  // namespace flowrest::scenes
