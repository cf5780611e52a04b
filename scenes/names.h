#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenes/scene.h"

/// The names of every choice a scene can make, in one place.
namespace flowrest::scenes {

template <class Choice>
using NameTable = std::vector<std::pair<Choice, std::string>>;

const NameTable<Dimension>& names_of(Dimension);
const NameTable<PrintDirection>& names_of(PrintDirection);
const NameTable<Model>& names_of(Model);
const NameTable<Scheme>& names_of(Scheme);
const NameTable<Precision>& names_of(Precision);
const NameTable<Seeding>& names_of(Seeding);
const NameTable<FluidUpdate>& names_of(FluidUpdate);
const NameTable<BBar>& names_of(BBar);
const NameTable<Wall>& names_of(Wall);
const NameTable<FoamLaws>& names_of(FoamLaws);
const NameTable<FoamMixing>& names_of(FoamMixing);
const NameTable<FoamStrainRate>& names_of(FoamStrainRate);
const NameTable<FoamWetting>& names_of(FoamWetting);
const NameTable<FoamFaces>& names_of(FoamFaces);

/// Every name of a choice.
template <class Choice>
std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const auto& [choice, name] : names_of(Choice{})) names.push_back(name);
  return names;
}

/// The choice that `name` names, if any.
template <class Choice>
std::optional<Choice> choice_named(const std::string& name) {
  for (const auto& [choice, known] : names_of(Choice{})) {
    if (known == name) return choice;
  }
  return std::nullopt;
}

}  // namespace flowrest::scenes
