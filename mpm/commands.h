#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::mpm {

/// Adds `flowrest mpm`.
void add_commands(CLI::App&);

}  // namespace flowrest::mpm
