#pragma once

#include "foamCases/apparatus/apparatus.h"

namespace flowrest::foam {

/// There is no case that prints yet.
/// @throws scenes::SceneError saying so.
std::unique_ptr<ApparatusCase> case_of(const scenes::Printing&, const scenes::Scene&);

}  // namespace flowrest::foam
