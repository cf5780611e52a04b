#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::studies {

/// Adds `flowrest study` and the job that its workflow calls.
void add_commands(CLI::App&);

}  // namespace flowrest::studies
