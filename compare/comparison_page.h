#pragma once

#include "compare/comparison.h"
#include "compare/report/page.h"

namespace flowrest::compare {

/// Carries the curve of a run that has come to rest on to `end` (s), as a tail: level but for what grows by
/// `rate` a second even at rest.
void carry_on(report::Curve&, double rate, double end);

/// The comparison as a page. `json`: what to_json says of it.
report::Page page_of(const Comparison&, const nlohmann::ordered_json& json);

/// How runs of a solver and a law are drawn on every page: colour tells the law and dashes tell the solver,
/// so that a figure shows by itself which difference is which. Exact solutions are drawn in ink.
report::Entry entry_of(const std::string& name, const std::string& solver, const std::string& model);

}  // namespace flowrest::compare
