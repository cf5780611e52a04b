#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::cli {

/// Adds `flowrest run`: every run a scene names, then their comparison.
void add_run_command(CLI::App&);

}  // namespace flowrest::cli
