#pragma once

#include <string>

#include "scenes/scene.h"

/// The laws of concrete as the cases' dictionaries take them from sceneParameters.
namespace flowrest::foam {

/// The entries that depend on the law: rheologyLibraries, the fields that are state, concreteViscosity for
/// transportProperties and concreteStress for turbulenceProperties. `plug_in`: flowrest's laws, else
/// OpenFOAM's.
std::string concrete_laws(const scenes::Scene&, bool plug_in);

}  // namespace flowrest::foam
