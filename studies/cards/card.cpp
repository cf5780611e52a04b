#include "studies/cards/card.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/installation.h"
#include "scenes/scene.h"
#include "scenes/text.h"
#include "studies/toml_table.h"

namespace flowrest::studies::cards {

namespace fs = std::filesystem;
using scenes::SceneError;

namespace {

constexpr double largest = 1e12;

/// A text that must be there.
std::string needed_text(Table& table, const std::string& key) {
  const std::string text = table.text(key);
  if (text.empty()) table.fault(key, "is missing; needed: a text");
  return text;
}

Target target_of(Table table) {
  Target target;
  target.quantity = needed_text(table, "quantity");
  if (table.get("at")) target.at = table.number("at", 0.0, 0.0, largest);
  if (!table.get("value"))
    table.fault("value", "is missing; needed: the number that an answer is held against");
  target.value = table.number("value", 0.0, -largest, largest);
  target.uncertainty = table.number("uncertainty", 0.0, 0.0, largest);
  if (!(target.uncertainty > 0.0))
    table.fault("uncertainty", "must be above 0: nothing is known exactly by a computation");
  target.note = table.text("note");
  table.refuse_others();
  return target;
}

Known known_of(Table table) {
  Known known{needed_text(table, "method"), needed_text(table, "answer"), needed_text(table, "measured")};
  table.refuse_others();
  return known;
}

/// Reads an array of tables.
template <class Item>
std::vector<Item> items(Table& card, const std::string& key, Item (*read)(Table)) {
  std::vector<Item> list;
  const toml::node* node = card.get(key);
  if (!node) return list;
  const toml::array* array = node->as_array();
  if (!array || !array->is_array_of_tables()) {
    card.fault(key, "must be an array of tables, [[" + key + "]]");
    return list;
  }
  for (const toml::node& item : *array)
    list.push_back(read(Table(*item.as_table(), key, card.source(), card.faults())));
  return list;
}

}  // namespace

Card parse_card(const std::string& text, const fs::path& path) {
  const std::string source = scenes::escaped(path.string());
  const toml::table document = parsed_toml(text, source, "a card");
  scenes::Faults faults;
  Table table(document, "", source, faults);
  Card card;
  card.name = path.stem().string();
  card.title = needed_text(table, "title");
  card.statement = needed_text(table, "statement");
  card.source = needed_text(table, "source");
  card.command = table.text("command");
  card.targets = items(table, "target", target_of);
  if (card.targets.empty()) table.fault("target", "is missing; needed: at least one [[target]]");
  card.known = items(table, "known", known_of);
  table.refuse_others();
  faults.raise();
  return card;
}

std::vector<std::string> card_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(scenes::shared_folder("cards"), error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Card load_card(const std::string& name_or_path) {
  std::error_code error;
  const fs::path ours = scenes::shared_folder("cards") / (name_or_path + ".toml");
  const fs::path path = fs::is_regular_file(ours, error) ? ours : fs::path(name_or_path);
  if (!fs::is_regular_file(path, error))
    throw SceneError(fmt::format("no card {}; allowed: a card's TOML file, or one of {}",
                                 scenes::quoted(name_or_path), scenes::joined(card_names())));
  return parse_card(text_of(path), path);
}

}  // namespace flowrest::studies::cards
