#pragma once

#include <vector>

#include "foamCases/apparatus/apparatus.h"
#include "foamCases/quarter_grid.h"

namespace flowrest::foam {

std::unique_ptr<ApparatusCase> case_of(const scenes::Slump&, const scenes::Scene&);

/// The fraction of every cell that the cone fills. Areas are exact at each height and the cone's section is a
/// polynomial of second degree in it, so the sum over a row is its volume to round-off.
std::vector<double> cone_fraction(const scenes::Slump&, const QuarterGrid&);

}  // namespace flowrest::foam
