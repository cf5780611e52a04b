#pragma once

#include <CLI/CLI.hpp>

#include "runs/material_state.h"

namespace flowrest::foam {

/// Adds `flowrest foam`. `read_state` reads what --from names, whichever solver left it.
void add_commands(CLI::App&, const runs::StateReader& read_state = {});

}  // namespace flowrest::foam
