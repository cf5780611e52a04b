#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "compare/comparison.h"

namespace flowrest::compare {

/// The self-contained page of a comparison: template, style, script, Chart.js and data in one file that needs
/// no network.
/// @throws runs::MissingProgram where Chart.js is not installed.
std::string report_page(const Comparison&, const nlohmann::ordered_json& comparison_json);

}  // namespace flowrest::compare
