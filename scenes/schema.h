#pragma once

#include <algorithm>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "scenes/value.h"

/// Every key a scene can have, described once: reading, refusing, resolved settings and the key reference
/// follow it.
namespace flowrest::scenes {

/// A scene on its way from what was given to what is resolved.
struct Draft {
  Scene scene;
  std::optional<double> bulk_modulus;   ///< Pa, in place of Young's modulus
  std::vector<int> particles_per_cell;  ///< as given: one number for all axes, or one for each
  bool particles_for_each_axis = false;
  std::string extends;             ///< followed by the reader before any other key is stored
  std::set<std::string> unusable;  ///< keys that are missing or at fault: nothing may be concluded from them

  /// Gives the scene an apparatus, and what is usual with it: its dimension, gravity, whether it rests.
  void take(const Apparatus&);
};

/// One key of a scene.
struct Key {
  std::string section{};  ///< empty for the keys above all sections
  std::string name{};
  std::string unit{};
  std::string meaning{};
  std::string takes{};              ///< type and range in words
  std::vector<std::size_t> only{};  ///< places in the list of the apparatus that have this key; empty: all
  bool required = false;   ///< by every scene with its apparatus (of [thixotropy]: where the table is given)
  std::string fallback{};  ///< what holds where it is not given, where that is not the constant default
  std::string rival{};     ///< the key whose place this one takes
  /// Stores the value, or says what is wrong with it.
  std::function<Complaint(const Value&, Draft&)> read{};
  /// The resolved setting; null where it has none.
  std::function<nlohmann::ordered_json(Draft&)> write{};

  std::string path() const { return section.empty() ? name : section + "." + name; }

  Key&& needed() && { return required = true, std::move(*this); }
  Key&& only_with(std::vector<std::size_t> places) && { return only = std::move(places), std::move(*this); }
  bool suits(const Apparatus& apparatus) const {
    return only.empty() || std::find(only.begin(), only.end(), apparatus.index()) != only.end();
  }
  Key&& otherwise(std::string text) && { return fallback = std::move(text), std::move(*this); }
  Key&& replaces(std::string path_of_rival) && { return rival = std::move(path_of_rival), std::move(*this); }
};

/// A table of a scene.
struct Section {
  std::string name;
  std::string meaning;
};

const std::vector<Section>& sections();
const std::vector<Key>& keys();

/// The key of this dotted path, or null.
const Key* find_key(const std::string& path);

/// Names of the keys of a section that scenes with this apparatus may give (with any where it is null).
std::vector<std::string> key_names(const std::string& section, const Apparatus* = nullptr);

}  // namespace flowrest::scenes
