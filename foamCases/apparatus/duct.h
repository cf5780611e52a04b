#pragma once

#include "foamCases/apparatus/apparatus.h"

namespace flowrest::foam {

std::unique_ptr<ApparatusCase> case_of(const scenes::Duct&, const scenes::Scene&);

}  // namespace flowrest::foam
