#pragma once

#include <nlohmann/json.hpp>

#include "compare/report/page.h"
#include "studies/results.h"

namespace flowrest::studies {

/// An id for a figure: letters, digits and hyphens.
std::string id_for(const std::string& text);

/// The page of a study; `study_json` is its study.json, offered beside it.
report::Page study_page(const Results&, const nlohmann::ordered_json& study_json);

}  // namespace flowrest::studies
