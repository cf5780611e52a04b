#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scenes/scene.h"

/// The rheology plug-in: flowrest's own laws for OpenFOAM, a library built beside the programs.
namespace flowrest::foam {

/// The library: FLOWREST_RHEOLOGY where set, else the one that flowrest brings; nothing where it was not
/// built.
std::optional<std::filesystem::path> find_plug_in();

/// The version of OpenFOAM that the library was compiled against, such as "1912.200626-1"; empty where it was
/// not built.
std::string openfoam_of_plug_in();

/// The library a scene's run loads, or nothing where it takes OpenFOAM's own laws: as foam.laws and the model
/// say.
/// @throws runs::MissingProgram where the run needs the plug-in and there is none, scenes::SceneError where
/// it is told to do without.
std::optional<std::filesystem::path> plug_in_for(const scenes::Scene&);

/// The scene with what depends on the plug-in settled: rows at a slump's base and whether trapped air rises,
/// where it does not say.
scenes::Scene settled(scenes::Scene, bool plug_in);

/// Whether concrete carries flocculation, which a Newtonian fluid has no use for.
bool carries_flocculation(const scenes::Scene&);

/// Whether a scene's law or walls are such as only the plug-in has.
bool needs_plug_in(const scenes::Scene&);

}  // namespace flowrest::foam
