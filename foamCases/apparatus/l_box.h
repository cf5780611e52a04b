#pragma once

#include "foamCases/apparatus/apparatus.h"

namespace flowrest::foam {

std::unique_ptr<ApparatusCase> case_of(const scenes::LBox&, const scenes::Scene&);

}  // namespace flowrest::foam
