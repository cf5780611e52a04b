#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::compare {

/// Adds `flowrest exact` and `flowrest compare`.
void add_commands(CLI::App&);

}  // namespace flowrest::compare
