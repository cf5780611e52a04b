#include "studies/toml_table.h"

#include <fstream>
#include <sstream>

#include "scenes/document.h"
#include "scenes/scene.h"

namespace flowrest::studies {

using scenes::SceneError;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw SceneError(scenes::escaped(path.string()) + ": cannot be read");
  return text.str();
}

toml::table parsed_toml(const std::string& text, const std::string& source, const std::string& what) {
  const scenes::Location start{source, 1, 1};
  constexpr std::ptrdiff_t most_dots = 10000;  // toml++ puts no bound on the depth of dotted keys
  if (text.size() > scenes::largest_text || std::count(text.begin(), text.end(), '.') > most_dots)
    throw SceneError(start.text() + ": is larger than " + what + " can be");
  if (const std::string fault = scenes::encoding_fault(text); !fault.empty())
    throw SceneError(start.text() + ": " + fault);
  try {
    return toml::parse(std::string_view(text));
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    throw SceneError(scenes::Location{source, at.line, at.column}.text() +
                     ": is not valid TOML: " + scenes::escaped(std::string(error.description())));
  }
}

std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or a time";
  }
}

}  // namespace flowrest::studies
