#pragma once

#include <nlohmann/json.hpp>

#include "compare/report/page.h"
#include "studies/results.h"

namespace flowrest::studies {

/// The page of a study; `study_json` is its study.json, offered beside it.
report::Page study_page(const Results&, const nlohmann::ordered_json& study_json);

}  // namespace flowrest::studies
