#include "scenes/document.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <string_view>

#include "scenes/schema.h"
#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

Location location(const toml::source_position& position, const std::string& source) {
  return {source, position.line, position.column};
}

std::string foreign_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::date:
      return "a date";
    case toml::node_type::time:
      return "a time";
    case toml::node_type::date_time:
      return "a date and time";
    default:
      return "an array nested too deeply";
  }
}

/// No key takes arrays deeper than pairs in a list.
constexpr int deepest_array = 2;

Value to_value(const toml::node& node, const std::string& source, int depth = 0) {
  Value value{location(node.source().begin, source), Foreign{}};
  if (const auto* boolean = node.as_boolean()) {
    value.content = boolean->get();
  } else if (const auto* integer = node.as_integer()) {
    value.content = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    value.content = number->get();
  } else if (const auto* text = node.as_string()) {
    value.content = text->get();
  } else if (const auto* array = node.as_array(); array && depth < deepest_array) {
    std::vector<Value> items;
    for (const toml::node& item : *array) items.push_back(to_value(item, source, depth + 1));
    value.content = std::move(items);
  } else if (const auto* table = node.as_table(); table && depth == 0) {
    Foreign entries{foreign_name(node), {}, {}};
    for (auto&& [name, item] : *table) {
      entries.names.emplace_back(name.str());
      entries.values.push_back(to_value(item, source, depth + 1));
    }
    value.content = std::move(entries);
  } else {
    value.content = Foreign{foreign_name(node), {}, {}};
  }
  return value;
}

std::vector<std::string> section_names() {
  std::vector<std::string> names;
  for (const Section& section : sections()) {
    if (!section.name.empty()) names.push_back(section.name);
  }
  return names;
}

bool is_section(const std::string& name) {
  const std::vector<std::string> names = section_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string unknown_section(const std::string& name) {
  const std::string near = nearest(name, section_names());
  return fmt::format("unknown section {}{}; allowed: {}", quoted(name),
                     near.empty() ? "" : ", nearest is " + near, joined(section_names()));
}

/// The section a key really belongs to, or the nearest name.
std::string hint(const std::string& section, const std::string& name) {
  for (const Key& key : keys()) {
    if (key.name != name) continue;
    return fmt::format(", {} belongs to {}", name,
                       key.section.empty() ? "the top" : fmt::format("[{}]", key.section));
  }
  std::vector<std::string> candidates = key_names(section);
  if (section.empty()) {
    for (const std::string& other : section_names()) candidates.push_back(other);
  }
  const std::string near = nearest(name, candidates);
  return near.empty() ? "" : ", nearest is " + near;
}

/// Why a key is refused, and what is allowed in its place.
std::string unknown_key(const std::string& section, const std::string& name) {
  std::vector<std::string> allowed = key_names(section);
  if (section.empty()) {
    for (const std::string& other : section_names()) allowed.push_back(fmt::format("[{}]", other));
  }
  const std::string path = section.empty() ? name : fmt::format("{}.{}", section, name);
  return fmt::format("unknown key {}{}; allowed: {}", quoted(path), hint(section, name), joined(allowed));
}

void read_section(const std::string& section, const toml::table& table, const std::string& source,
                  Given& given, Faults& faults) {
  for (auto&& [name, node] : table) {
    const std::string key(name.str());
    if (const Key* known = find_key(section + "." + key)) {
      given.values[known->path()] = to_value(node, source);
    } else {
      faults.add(location(name.source().begin, source), unknown_key(section, key));
    }
  }
}

/// toml++ puts no bound on the depth of dotted keys, and taking a very deep table down again overflows the
/// stack. Every level of a dotted key costs a dot, so a bound on dots bounds the depth, whatever the quoting.
constexpr std::ptrdiff_t most_dots = 10000;

bool is_readable(const std::string& text, const Location& start, Faults& faults) {
  if (text.size() > largest_text) {
    faults.add(start, fmt::format("is {} bytes long; allowed: {}", text.size(), largest_text));
    return false;
  }
  if (std::count(text.begin(), text.end(), '.') > most_dots) {
    faults.add(start, fmt::format("has more than {} dots: no scene needs so many numbers or nested keys",
                                  most_dots));
    return false;
  }
  return true;
}

std::optional<toml::table> parsed(const std::string& text, const std::string& source, Faults& faults) {
  try {
    return toml::parse(std::string_view(text));
  } catch (const toml::parse_error& error) {
    faults.add(location(error.source().begin, source),
               "is not valid TOML: " + escaped(std::string(error.description())));
    return std::nullopt;
  }
}

}  // namespace

Given read_document(const std::string& text, const std::string& source, Faults& faults) {
  Given given;
  given.start = {source, 1, 1};
  given.unreadable = true;
  if (const std::string fault = encoding_fault(text); !fault.empty()) {
    faults.add(given.start, fault);
    return given;
  }
  if (!is_readable(text, given.start, faults)) return given;
  const std::optional<toml::table> document = parsed(text, source, faults);
  if (!document) return given;
  given.unreadable = false;
  for (auto&& [name, node] : *document) {
    const std::string key(name.str());
    const Location where = location(name.source().begin, source);
    if (is_section(key)) {
      given.sections[key] = where;
      if (const toml::table* table = node.as_table()) {
        read_section(key, *table, source, given, faults);
      } else {
        faults.add(location(node.source().begin, source),
                   fmt::format("{} must be a table, not {}; allowed keys: {}", key,
                               to_value(node, source).what(), joined(key_names(key))));
      }
    } else if (const Key* known = find_key(key)) {
      given.values[known->path()] = to_value(node, source);
    } else {
      faults.add(where, node.is_table() ? unknown_section(key) : unknown_key("", key));
    }
  }
  return given;
}

namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

void relocate(Value& value, const Location& where) {
  value.where = where;
  if (auto* items = std::get_if<std::vector<Value>>(&value.content)) {
    for (Value& item : *items) relocate(item, where);
  }
  if (auto* entries = std::get_if<Foreign>(&value.content)) {
    for (Value& item : entries->values) relocate(item, where);
  }
}

/// The value of a setting: TOML, or else text that stands without quotes.
std::optional<Value> setting_value(const std::string& text, const Location& where, Faults& faults) {
  if (!is_readable(text, where, faults)) return std::nullopt;
  Faults not_toml;
  std::optional<toml::table> table = parsed("value = " + text, where.source, not_toml);
  if (!table || table->size() != 1) table = parsed("value = " + toml_string(text), where.source, not_toml);
  if (!table) {
    faults.add(where, "is not valid UTF-8");
    return std::nullopt;
  }
  Value value = to_value(*table->get("value"), where.source);
  relocate(value, where);
  return value;
}

}  // namespace

Given read_setting(const std::string& setting, Faults& faults) {
  Given given;
  given.start = {"--set " + escaped(setting), 0, 0};
  const auto equals = setting.find('=');
  if (equals == std::string::npos) {
    faults.add(given.start, "has no value; allowed: KEY=VALUE, for example material.yield_stress=100");
    return given;
  }
  const std::string path = trimmed(setting.substr(0, equals));
  const auto dot = path.find('.');
  const std::string section = dot == std::string::npos ? "" : path.substr(0, dot);
  const std::string name = dot == std::string::npos ? path : path.substr(dot + 1);
  if (is_section(path)) {
    faults.add(given.start, "sets a whole table; allowed: one key at a time, " + path +
                                ".KEY with KEY one of " + joined(key_names(path)));
  } else if (path == "extends") {
    faults.add(given.start, "cannot change what a scene extends; allowed: every other key");
  } else if (find_key(path)) {
    std::optional<Value> value = setting_value(trimmed(setting.substr(equals + 1)), given.start, faults);
    if (value) given.values[path] = *std::move(value);
    if (!section.empty()) given.sections[section] = given.start;
  } else if (!section.empty() && !is_section(section)) {
    faults.add(given.start, unknown_section(section));
  } else {
    faults.add(given.start, unknown_key(section, name));
  }
  return given;
}

void overlay(Given& base, Given layer) {
  for (auto& [path, value] : layer.values) {
    const Key* key = find_key(path);
    if (key && !key->rival.empty() && !layer.values.contains(key->rival)) base.values.erase(key->rival);
    base.values.insert_or_assign(path, std::move(value));
  }
  base.unreadable = base.unreadable || layer.unreadable;
  for (auto& [name, where] : layer.sections) base.sections.insert_or_assign(name, where);
}

}  // namespace flowrest::scenes
