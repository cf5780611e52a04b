#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace flowrest::elements {

/// What `flowrest exact --elements` is asked for besides its scene and its folder.
struct Options {
  bool chosen = false;
  int columns = 60;
  bool quiet = false;
};

/// Adds the options of the finite elements to `flowrest exact`; `others` are those of it that have no meaning
/// beside them.
std::shared_ptr<Options> add_options(CLI::App& exact, const std::vector<std::string>& others);

/// Makes the run. `output` may be empty: out/SCENE/exact/elements.
void run_command(const scenes::Scene&, const Options&, const std::string& output, bool force, bool json);

}  // namespace flowrest::elements
