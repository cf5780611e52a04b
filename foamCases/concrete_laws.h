#pragma once

#include <string>

#include "foamCases/apparatus/apparatus.h"

/// The laws of concrete as the cases' dictionaries take them from sceneParameters.
namespace flowrest::foam {

/// The entries that depend on the law: rheologyLibraries, the fields that are state, concreteViscosity for
/// transportProperties and concreteStress for turbulenceProperties. `plug_in`: flowrest's laws, else
/// OpenFOAM's.
std::string concrete_laws(const ApparatusCase&, bool plug_in);

/// Whether a case takes the shear rate from the plug-in: elsewhere it follows from the velocities, as
/// vessels' cells and walls with friction do not let it.
bool writes_shear_rate(const ApparatusCase&);

}  // namespace flowrest::foam
