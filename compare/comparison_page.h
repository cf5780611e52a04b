#pragma once

#include "compare/comparison.h"
#include "compare/report/page.h"

namespace flowrest::compare {

/// The comparison as a page. `json`: what to_json says of it.
report::Page page_of(const Comparison&, const nlohmann::ordered_json& json);

}  // namespace flowrest::compare
