#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "scenes/names.h"
#include "scenes/range.h"
#include "scenes/schema.h"
#include "scenes/text.h"

/// The types a key can have: each makes a Key that reads, checks and writes a setting of that type.
namespace flowrest::scenes {

/// Upper ends of ranges: far past anything physical, near enough that no product of a few of them overflows.
inline constexpr double largest_length = 1e6;   // m
inline constexpr double largest_stress = 1e15;  // Pa
inline constexpr double largest_time = 1e12;    // s

inline constexpr std::int64_t most_particles_along_an_axis = 16;

/// Where the setting of a key is kept.
template <class T>
using Access = T& (*)(Draft&);

Key number(std::string path, std::string unit, Range, Access<double>, std::string meaning);
/// A number that may have no value.
Key number(std::string path, std::string unit, Range, Access<std::optional<double>>, std::string meaning);
Key integer(std::string path, std::int64_t low, std::int64_t high, Access<int>, std::string meaning);
Key integer(std::string path, std::int64_t low, std::int64_t high, Access<std::uint64_t>,
            std::string meaning);
Key boolean(std::string path, Access<bool>, std::string meaning);
/// A string of a bounded length.
Key text(std::string path, Access<std::string>, std::string meaning);
/// A list of models, each named once; a single name is a list of one.
Key models(std::string path, Access<std::vector<Model>>, std::string meaning);
/// A force that is constant, or steps at ascending times from 0.
Key steps(std::string path, std::string unit, Access<std::vector<std::pair<double, double>>>,
          std::string meaning);
/// Particles in a cell: a number, or one for each axis.
Key particles(std::string path, std::string meaning);
/// How a wall holds the material.
Key wall(std::string path, Access<WallContact>, std::string meaning);
/// A wall that may be left to another's law.
Key wall(std::string path, Access<std::optional<WallContact>>, std::string meaning);

/// Reads a number in a range. @return what is wrong with it; empty where nothing is
std::string read_number(const Value&, const Range&, double& number);

/// A key without a type.
Key plain_key(std::string path, std::string unit, std::string meaning, std::string takes);

/// What is wrong with a value that should name one of `allowed`.
std::string unknown_choice(const Value&, const std::vector<std::string>& allowed);

template <class Choice>
std::string read_choice(const Value& value, Choice& choice) {
  const auto* name = std::get_if<std::string>(&value.content);
  const std::optional<Choice> named = name ? choice_named<Choice>(*name) : std::nullopt;
  if (!named) return unknown_choice(value, all_names<Choice>());
  choice = *named;
  return {};
}

/// One of a choice's names, or none.
template <class Choice>
Key choice(std::string path, Access<std::optional<Choice>> at, std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), "one of " + joined(all_names<Choice>()));
  key.read = [=](const Value& value, Draft& draft) {
    Choice given{};
    std::string wrong = read_choice(value, given);
    if (wrong.empty()) at(draft) = given;
    return Complaint{wrong, value.where};
  };
  key.write = [=](Draft& draft) {
    return at(draft) ? nlohmann::ordered_json(to_string(*at(draft))) : nlohmann::ordered_json();
  };
  return key;
}

/// One of a choice's names.
template <class Choice>
Key choice(std::string path, Access<Choice> at, std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), "one of " + joined(all_names<Choice>()));
  key.read = [=](const Value& value, Draft& draft) {
    return Complaint{read_choice(value, at(draft)), value.where};
  };
  key.write = [=](Draft& draft) { return nlohmann::ordered_json(to_string(at(draft))); };
  return key;
}

}  // namespace flowrest::scenes
