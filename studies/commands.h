#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::studies {

/// Adds `flowrest study`, the job that its workflow calls, and `flowrest verify`.
void add_commands(CLI::App&);

}  // namespace flowrest::studies
