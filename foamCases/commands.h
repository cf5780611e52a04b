#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::foam {

/// Adds `flowrest foam`.
void add_commands(CLI::App&);

}  // namespace flowrest::foam
