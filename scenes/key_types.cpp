#include "scenes/key_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flowrest::scenes {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::int64_t most_names = 16;  // models in a list of runs
constexpr std::size_t most_force_steps = 10000;

std::string must_be(const std::string& what, const Value& value) {
  return fmt::format("must be {}, not {}", what, value.what());
}

// ---- reading one value: each returns what is wrong, or nothing

std::string read_number(const Value& value, const Range& range, double& number) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.content)) {
    number = static_cast<double>(*integer);
  } else if (const auto* given = std::get_if<double>(&value.content)) {
    number = *given;
  } else {
    return must_be("a number", value);
  }
  if (!std::isfinite(number)) return fmt::format("is {}; allowed: finite numbers, {}", number, range.text());
  if (!range.holds(number)) return fmt::format("is {:g}; allowed: {}", number, range.text());
  return {};
}

std::string read_integer(const Value& value, std::int64_t low, std::int64_t high, std::int64_t& integer) {
  const auto* given = std::get_if<std::int64_t>(&value.content);
  if (!given) return must_be("an integer", value);
  if (*given < low || *given > high) return fmt::format("is {}; allowed: {} to {}", *given, low, high);
  integer = *given;
  return {};
}

std::string read_models(const Value& value, std::vector<Model>& models) {
  std::vector<Value> items;
  if (const auto* array = std::get_if<std::vector<Value>>(&value.content)) {
    items = *array;
  } else if (std::holds_alternative<std::string>(value.content)) {
    items = {value};
  } else {
    return must_be("an array of models", value) + "; allowed: " + joined(all_names<Model>());
  }
  if (std::ssize(items) > most_names) return "names a model more than once";
  models.clear();
  for (const Value& item : items) {
    Model model{};
    if (const std::string wrong = read_choice(item, model); !wrong.empty()) return "(an item) " + wrong;
    if (std::find(models.begin(), models.end(), model) != models.end()) {
      return fmt::format("names {} twice; allowed: each model once", to_string(model));
    }
    models.push_back(model);
  }
  return {};
}

std::string read_force_step(const Value& item, std::pair<double, double>& step) {
  const auto* pair = std::get_if<std::vector<Value>>(&item.content);
  if (!pair || pair->size() != 2) return "must hold [time, N/m3] pairs";
  std::string wrong = read_number((*pair)[0], from(0.0, largest_time), step.first);
  if (!wrong.empty()) return "(a time) " + wrong;
  wrong = read_number((*pair)[1], from(-largest_stress, largest_stress), step.second);
  if (!wrong.empty()) return "(a force) " + wrong;
  return {};
}

std::string read_body_force(const Value& value, std::vector<std::pair<double, double>>& force) {
  const auto* array = std::get_if<std::vector<Value>>(&value.content);
  if (!array) {
    double constant = 0.0;
    if (!std::holds_alternative<std::int64_t>(value.content) &&
        !std::holds_alternative<double>(value.content)) {
      return must_be("a number or an array of [time, N/m3] pairs", value);
    }
    const std::string wrong = read_number(value, from(-largest_stress, largest_stress), constant);
    force = {{0.0, constant}};
    return wrong;
  }
  if (array->empty() || array->size() > most_force_steps) {
    return fmt::format("has {} pairs; allowed: 1 to {}", array->size(), most_force_steps);
  }
  force.clear();
  for (const Value& item : *array) {
    std::pair<double, double> step;
    if (const std::string wrong = read_force_step(item, step); !wrong.empty()) return wrong;
    if (force.empty() && step.first != 0.0) {
      return fmt::format("starts at {:g} s; allowed: pairs that start at time 0", step.first);
    }
    if (!force.empty() && step.first <= force.back().first) {
      return fmt::format("goes from {:g} s to {:g} s; allowed: ascending times", force.back().first,
                         step.first);
    }
    force.push_back(step);
  }
  return {};
}

std::string read_particles(const Value& value, Draft& draft) {
  constexpr std::int64_t most_along_an_axis = 16;
  std::int64_t count = 0;
  if (const auto* array = std::get_if<std::vector<Value>>(&value.content)) {
    std::vector<int> axes;
    for (const Value& item : *array) {
      if (axes.size() == 3) break;
      const std::string wrong = read_integer(item, 1, most_along_an_axis, count);
      if (!wrong.empty()) return "(along an axis) " + wrong;
      axes.push_back(static_cast<int>(count));
    }
    if (array->size() != 2 && array->size() != 3) {
      return fmt::format("has {} entries; allowed: one number, or one entry for each axis (2 or 3)",
                         array->size());
    }
    draft.particles_per_cell = axes;
    draft.particles_for_each_axis = true;
    return {};
  }
  if (!std::holds_alternative<std::int64_t>(value.content)) {
    return must_be("an integer or an array of one integer for each axis", value);
  }
  std::string wrong =
      read_integer(value, 1, most_along_an_axis * most_along_an_axis * most_along_an_axis, count);
  draft.particles_per_cell = {static_cast<int>(count)};
  draft.particles_for_each_axis = false;
  return wrong;
}

std::string read_wall(const Value& value, Wall& wall) {
  if (const auto* foreign = std::get_if<Foreign>(&value.content); foreign && foreign->what == "a table") {
    return "is a table: walls with friction are not built yet; allowed: " + joined(all_names<Wall>());
  }
  return read_choice(value, wall);
}

template <class Integer>
Key any_integer(std::string path, std::int64_t low, std::int64_t high, Access<Integer> at,
                std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), fmt::format("integer, {} to {}", low, high));
  key.read = [=](const Value& value, Draft& draft) {
    std::int64_t given = 0;
    std::string wrong = read_integer(value, low, high, given);
    if (wrong.empty()) at(draft) = static_cast<Integer>(given);
    return wrong;
  };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

}  // namespace

std::string unknown_choice(const Value& value, const std::vector<std::string>& allowed) {
  const auto* name = std::get_if<std::string>(&value.content);
  if (!name) return must_be("a string", value) + "; allowed: " + joined(allowed);
  const std::string near = nearest(*name, allowed);
  return fmt::format("is {}{}; allowed: {}", quoted(*name),
                     near.empty() ? "" : ", nearest is " + quoted(near), joined(allowed));
}

Key plain_key(std::string path, std::string unit, std::string meaning, std::string takes) {
  Key key;
  const auto dot = path.find('.');
  key.section = dot == std::string::npos ? "" : path.substr(0, dot);
  key.name = dot == std::string::npos ? path : path.substr(dot + 1);
  key.unit = std::move(unit);
  key.meaning = std::move(meaning);
  key.takes = std::move(takes);
  return key;
}

Key number(std::string path, std::string unit, Range range, Access<double> at, std::string meaning) {
  Key key = plain_key(std::move(path), std::move(unit), std::move(meaning), "number, " + range.text());
  key.read = [=](const Value& value, Draft& draft) { return read_number(value, range, at(draft)); };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

Key number(std::string path, std::string unit, Range range, Access<std::optional<double>> at,
           std::string meaning) {
  Key key = plain_key(std::move(path), std::move(unit), std::move(meaning), "number, " + range.text());
  key.read = [=](const Value& value, Draft& draft) {
    double given = 0.0;
    std::string wrong = read_number(value, range, given);
    if (wrong.empty()) at(draft) = given;
    return wrong;
  };
  key.write = [=](Draft& draft) { return at(draft) ? Json(*at(draft)) : Json(); };
  return key;
}

Key integer(std::string path, std::int64_t low, std::int64_t high, Access<int> at, std::string meaning) {
  return any_integer(std::move(path), low, high, at, std::move(meaning));
}

Key integer(std::string path, std::int64_t low, std::int64_t high, Access<std::uint64_t> at,
            std::string meaning) {
  return any_integer(std::move(path), low, high, at, std::move(meaning));
}

Key boolean(std::string path, Access<bool> at, std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), "true or false");
  key.read = [=](const Value& value, Draft& draft) -> std::string {
    const auto* given = std::get_if<bool>(&value.content);
    if (!given) return must_be("true or false", value);
    at(draft) = *given;
    return {};
  };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

Key text(std::string path, Access<std::string> at, std::string meaning) {
  constexpr std::size_t longest = 200;
  Key key = plain_key(std::move(path), "", std::move(meaning), fmt::format("string, 1 to {} bytes", longest));
  key.read = [=](const Value& value, Draft& draft) -> std::string {
    const auto* given = std::get_if<std::string>(&value.content);
    if (!given) return must_be("a string", value);
    if (given->empty() || given->size() > longest) {
      return fmt::format("has {} bytes; allowed: 1 to {}", given->size(), longest);
    }
    at(draft) = *given;
    return {};
  };
  key.write = [=](Draft& draft) { return at(draft).empty() ? Json() : Json(at(draft)); };
  return key;
}

Key models(std::string path, Access<std::vector<Model>> at, std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), "array of " + joined(all_names<Model>()));
  key.read = [=](const Value& value, Draft& draft) { return read_models(value, at(draft)); };
  key.write = [=](Draft& draft) {
    Json names = Json::array();
    for (const Model model : at(draft)) names.push_back(to_string(model));
    return names;
  };
  return key;
}

Key steps(std::string path, std::string unit, Access<std::vector<std::pair<double, double>>> at,
          std::string meaning) {
  Key key = plain_key(std::move(path), std::move(unit), std::move(meaning),
                      "number, or array of [time, force] with ascending times from 0");
  key.read = [=](const Value& value, Draft& draft) { return read_body_force(value, at(draft)); };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

Key particles(std::string path, std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), "integer, or array of integers");
  key.read = read_particles;
  key.write = [](Draft& draft) { return Json(draft.scene.mpm.particles_per_cell); };
  return key;
}

Key wall(std::string path, Access<Wall> at, std::string meaning) {
  Key key = choice(std::move(path), at, std::move(meaning));
  key.read = [=](const Value& value, Draft& draft) { return read_wall(value, at(draft)); };
  return key;
}

}  // namespace flowrest::scenes
