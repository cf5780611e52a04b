#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::scenes {

/// Adds `flowrest scenes` and `flowrest check`.
void add_commands(CLI::App&);

}  // namespace flowrest::scenes
