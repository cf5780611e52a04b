#pragma once

#include <CLI/CLI.hpp>

namespace flowrest::cli {

/// Adds `flowrest validate`: scenes against published values, at two resolutions, as one table.
void add_validate_command(CLI::App&);

}  // namespace flowrest::cli
