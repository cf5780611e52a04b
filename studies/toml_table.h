#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scenes/text.h"
#include "scenes/value.h"

/// TOML tables of studies and cards, read with every fault named by file, line and column.
namespace flowrest::studies {

/// A file's text. @throws scenes::SceneError where it cannot be read
std::string text_of(const std::filesystem::path&);

/// A document; `what` it is is for messages: "a study". @throws scenes::SceneError where it is no TOML
toml::table parsed_toml(const std::string& text, const std::string& source, const std::string& what);

/// What a node is, for messages: "an array".
std::string kind_of(const toml::node&);

/// A table being read: every key is asked for once, what is left over is unknown.
class Table {
 public:
  Table(const toml::table& table, std::string name, const std::string& source, scenes::Faults& faults)
      : table_(table), name_(std::move(name)), source_(source), faults_(faults) {}

  scenes::Location where() const { return place(table_.source().begin); }
  scenes::Location where(const std::string& key) const {
    const toml::node* node = table_.get(key);
    return node ? place(node->source().begin) : where();
  }
  const toml::node* get(const std::string& key) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
    return table_.get(key);
  }
  void fault(const std::string& key, const std::string& what) {
    faults_.add(where(key), fmt::format("{}{}{} {}", name_, name_.empty() ? "" : ".", key, what));
  }

  std::string text(const std::string& key, const std::string& otherwise = "") {
    const toml::node* node = get(key);
    if (!node) return otherwise;
    if (const auto* string = node->as_string(); string && string->get().size() <= longest_text)
      return string->get();
    fault(key, "must be a string, not " + kind_of(*node));
    return otherwise;
  }

  double number(const std::string& key, double otherwise, double low, double high) {
    const toml::node* node = get(key);
    if (!node) return otherwise;
    const auto value = node->value<double>();
    if (node->is_number() && value && std::isfinite(*value) && *value >= low && *value <= high) return *value;
    fault(key, fmt::format("must be a number from {:g} to {:g}", low, high));
    return otherwise;
  }

  /// Strings; one alone is a list of one.
  std::vector<std::string> texts(const std::string& key) {
    const toml::node* node = get(key);
    std::vector<std::string> list;
    if (!node) return list;
    const auto take = [&](const toml::node& item) {
      if (const auto* string = item.as_string())
        list.push_back(string->get());
      else
        faults_.add(place(item.source().begin),
                    fmt::format("{}.{} must hold strings, not {}", name_, key, kind_of(item)));
    };
    if (const auto* array = node->as_array()) {
      for (const toml::node& item : *array) take(item);
      if (array->empty()) fault(key, "is empty; allowed: one string or more");
    } else {
      take(*node);
    }
    return list;
  }

  std::vector<double> numbers(const std::string& key) {
    const toml::node* node = get(key);
    std::vector<double> list;
    if (!node) return list;
    const auto* array = node->as_array();
    if (!array) {
      fault(key, "must be an array of numbers, not " + kind_of(*node));
      return list;
    }
    for (const toml::node& item : *array) {
      const auto value = item.value<double>();
      if (item.is_number() && value && std::isfinite(*value))
        list.push_back(*value);
      else
        faults_.add(place(item.source().begin), fmt::format("{}.{} must hold finite numbers", name_, key));
    }
    return list;
  }

  /// The table of this key, if it is one.
  const toml::table* table(const std::string& key) {
    const toml::node* node = get(key);
    if (!node) return nullptr;
    if (!node->is_table()) fault(key, "must be a table, not " + kind_of(*node));
    return node->as_table();
  }

  /// Refuses every key that was not asked for.
  void refuse_others() {
    for (auto&& [name, node] : table_) {
      const std::string key(name.str());
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      const std::string near = scenes::nearest(key, known_);
      faults_.add(place(name.source().begin),
                  fmt::format("unknown key {}{}; allowed: {}",
                              scenes::quoted(name_.empty() ? key : name_ + "." + key),
                              near.empty() ? "" : ", nearest is " + near, scenes::joined(known_)));
    }
  }

  scenes::Location place(const toml::source_position& position) const {
    return {source_, position.line, position.column};
  }
  const std::string& source() const { return source_; }
  scenes::Faults& faults() { return faults_; }

 private:
  static constexpr std::size_t longest_text = 4096;
  const toml::table& table_;
  std::string name_;
  const std::string& source_;
  scenes::Faults& faults_;
  std::vector<std::string> known_;
};

}  // namespace flowrest::studies
