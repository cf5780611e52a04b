#include "scenes/key_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flowrest::scenes {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t most_steps = 10000;

std::string must_be(const std::string& what, const Value& value) {
  return fmt::format("must be {}, not {}", what, value.what());
}

// ---- reading one value: each returns what is wrong, or nothing

std::string read_integer(const Value& value, std::int64_t low, std::int64_t high, std::int64_t& integer) {
  const auto* given = std::get_if<std::int64_t>(&value.content);
  if (!given) return must_be("an integer", value);
  if (*given < low || *given > high) return fmt::format("is {}; allowed: {} to {}", *given, low, high);
  integer = *given;
  return {};
}

Complaint read_models(const Value& value, std::vector<Model>& models) {
  std::vector<Value> items = {value};  // a single name is a list of one
  if (const auto* array = std::get_if<std::vector<Value>>(&value.content)) items = *array;
  models.clear();
  for (const Value& item : items) {
    Model model{};
    if (const std::string wrong = read_choice(item, model); !wrong.empty()) return {wrong, item.where};
    if (std::find(models.begin(), models.end(), model) != models.end()) {
      return {fmt::format("names {} twice; allowed: each model once", to_string(model)), item.where};
    }
    models.push_back(model);
  }
  return {};
}

/// One [time, force] pair of steps, where `earlier` are those before it.
Complaint read_step(const Value& item, std::vector<std::pair<double, double>>& earlier) {
  const auto* pair = std::get_if<std::vector<Value>>(&item.content);
  if (!pair || pair->size() != 2) return {"must hold pairs of two numbers, [time, force]", item.where};
  const Value& time = (*pair)[0];
  const Value& force = (*pair)[1];
  std::pair<double, double> step;
  std::string wrong = read_number(time, from(0.0, largest_time), step.first);
  if (!wrong.empty()) return {"at a time " + wrong, time.where};
  wrong = read_number(force, from(-largest_stress, largest_stress), step.second);
  if (!wrong.empty()) return {"at a force " + wrong, force.where};
  if (earlier.empty() && step.first != 0.0) {
    return {fmt::format("starts at {:g} s; allowed: pairs that start at time 0", step.first), time.where};
  }
  if (!earlier.empty() && step.first <= earlier.back().first) {
    return {
        fmt::format("goes from {:g} s to {:g} s; allowed: ascending times", earlier.back().first, step.first),
        time.where};
  }
  earlier.push_back(step);
  return {};
}

Complaint read_steps(const Value& value, std::vector<std::pair<double, double>>& steps) {
  steps.clear();
  if (std::holds_alternative<std::int64_t>(value.content) || std::holds_alternative<double>(value.content)) {
    double constant = 0.0;
    const std::string wrong = read_number(value, from(-largest_stress, largest_stress), constant);
    steps.emplace_back(0.0, constant);
    return {wrong, value.where};
  }
  const auto* array = std::get_if<std::vector<Value>>(&value.content);
  if (!array) return {must_be("a number or an array of [time, force] pairs", value), value.where};
  if (array->empty() || array->size() > most_steps) {
    return {fmt::format("has {} pairs; allowed: 1 to {}", array->size(), most_steps), value.where};
  }
  for (const Value& item : *array) {
    if (Complaint wrong = read_step(item, steps); !wrong.what.empty()) return wrong;
  }
  return {};
}

Complaint read_particles_by_axis(const std::vector<Value>& axes, const Location& where, Draft& draft) {
  if (axes.size() != 2 && axes.size() != 3) {
    const std::string entries = axes.size() == 1 ? "entry" : "entries";
    return {fmt::format("has {} {}; allowed: one number, or one entry for each axis (2 or 3)", axes.size(),
                        entries),
            where};
  }
  draft.particles_for_each_axis = true;
  draft.particles_per_cell.clear();
  for (const Value& axis : axes) {
    std::int64_t count = 0;
    const std::string wrong = read_integer(axis, 1, most_particles_along_an_axis, count);
    if (!wrong.empty()) return {"along an axis " + wrong, axis.where};
    draft.particles_per_cell.push_back(static_cast<int>(count));
  }
  return {};
}

Complaint read_particles(const Value& value, Draft& draft) {
  if (const auto* axes = std::get_if<std::vector<Value>>(&value.content)) {
    return read_particles_by_axis(*axes, value.where, draft);
  }
  constexpr std::int64_t most =
      most_particles_along_an_axis * most_particles_along_an_axis * most_particles_along_an_axis;
  if (!std::holds_alternative<std::int64_t>(value.content)) {
    return {must_be("an integer or an array of one integer for each axis", value), value.where};
  }
  std::int64_t count = 0;
  const std::string wrong = read_integer(value, 1, most, count);
  draft.particles_per_cell = {static_cast<int>(count)};
  return {wrong, value.where};
}

constexpr double largest_friction = 10.0;

/// { friction = 0.3 }
Complaint read_friction(const Foreign& table, const Location& where, WallContact& contact) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    if (table.names[i] == "friction") continue;
    return {fmt::format("has an unknown entry {}; allowed: friction", quoted(table.names[i])),
            table.values[i].where};
  }
  if (table.values.empty()) return {"is an empty table; allowed: { friction = a number }", where};
  const std::string wrong = read_number(table.values[0], from(0.0, largest_friction), contact.friction);
  if (!wrong.empty()) return {"has a friction that " + wrong, table.values[0].where};
  contact.law = Wall::friction;
  return {};
}

Complaint read_wall(const Value& value, WallContact& contact) {
  const auto* table = std::get_if<Foreign>(&value.content);
  if (table && table->what == "a table") return read_friction(*table, value.where, contact);
  contact.friction = 0.0;
  const std::string wrong = read_choice(value, contact.law);
  return {wrong.empty() ? "" : wrong + ", { friction = a number }", value.where};
}

template <class Integer>
Key any_integer(std::string path, std::int64_t low, std::int64_t high, Access<Integer> at,
                std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), fmt::format("integer, {} to {}", low, high));
  key.read = [=](const Value& value, Draft& draft) {
    std::int64_t given = 0;
    std::string wrong = read_integer(value, low, high, given);
    if (wrong.empty()) at(draft) = static_cast<Integer>(given);
    return Complaint{wrong, value.where};
  };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

}  // namespace

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
  key.read = [=](const Value& value, Draft& draft) {
    return Complaint{read_number(value, range, at(draft)), value.where};
  };
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
    return Complaint{wrong, value.where};
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
  key.read = [=](const Value& value, Draft& draft) -> Complaint {
    const auto* given = std::get_if<bool>(&value.content);
    if (!given) return {must_be("true or false", value), value.where};
    at(draft) = *given;
    return {};
  };
  key.write = [=](Draft& draft) { return Json(at(draft)); };
  return key;
}

Key text(std::string path, Access<std::string> at, std::string meaning) {
  constexpr std::size_t longest = 200;
  Key key = plain_key(std::move(path), "", std::move(meaning), fmt::format("string, 1 to {} bytes", longest));
  key.read = [=](const Value& value, Draft& draft) -> Complaint {
    const auto* given = std::get_if<std::string>(&value.content);
    if (!given) return {must_be("a string", value), value.where};
    if (given->empty() || given->size() > longest) {
      return {fmt::format("has {} bytes; allowed: 1 to {}", given->size(), longest), value.where};
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
  key.read = [=](const Value& value, Draft& draft) { return read_steps(value, at(draft)); };
  key.write = [=](Draft& draft) { return at(draft).empty() ? Json() : Json(at(draft)); };
  return key;
}

Key particles(std::string path, std::string meaning) {
  Key key = plain_key(std::move(path), "", std::move(meaning), "integer, or array of integers");
  key.read = read_particles;
  key.write = [](Draft& draft) { return Json(draft.scene.mpm.particles_per_cell); };
  return key;
}

namespace {

Key any_wall(std::string path, std::string meaning) {
  return plain_key(std::move(path), "", std::move(meaning),
                   fmt::format("one of {}, or {{ friction = number, {} }}", joined(all_names<Wall>()),
                               from(0.0, largest_friction).text()));
}

Json written(const WallContact& contact) {
  if (contact.law == Wall::friction) return Json{{"friction", contact.friction}};
  return to_string(contact.law);
}

}  // namespace

Key wall(std::string path, Access<WallContact> at, std::string meaning) {
  Key key = any_wall(std::move(path), std::move(meaning));
  key.read = [=](const Value& value, Draft& draft) { return read_wall(value, at(draft)); };
  key.write = [=](Draft& draft) { return written(at(draft)); };
  return key;
}

Key wall(std::string path, Access<std::optional<WallContact>> at, std::string meaning) {
  Key key = any_wall(std::move(path), std::move(meaning));
  key.read = [=](const Value& value, Draft& draft) { return read_wall(value, at(draft).emplace()); };
  key.write = [=](Draft& draft) { return at(draft) ? written(*at(draft)) : Json(); };
  return key;
}

}  // namespace flowrest::scenes
