#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

/// What a scene file or the command line gives, before it is known to be right.
namespace flowrest::scenes {

/// Where something was given: a place in a file, or an option of the command line (line 0).
struct Location {
  std::string source;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  /// "file:line:column", or the option as it was given.
  std::string text() const;
};

struct Value;

/// A TOML value that few keys of a scene take ("a table") or none ("a date").
struct Foreign {
  std::string what;
  std::vector<std::string> names{};  ///< of a table's entries, in their order
  std::vector<Value> values;
};

/// A value as given, with its place.
struct Value {
  Location where;
  std::variant<Foreign, bool, std::int64_t, double, std::string, std::vector<Value>> content;
  /// "a number", "a string", ... for messages.
  std::string what() const;
};

/// What is wrong with a value, and where; nothing is wrong while `what` is empty.
struct Complaint {
  std::string what;
  Location where;
};

/// Everything given for a scene, by dotted path; later layers replace earlier ones key by key.
struct Given {
  std::map<std::string, Value> values;
  std::map<std::string, Location> sections;  ///< tables that were opened, even if empty
  Location start;                            ///< of the scene itself
  bool unreadable = false;                   ///< a text was no TOML, or what it extends cannot be had

  bool gives(const std::string& path) const { return values.contains(path); }
  /// The place to speak of when a key is at fault: its value, else its section, else the scene.
  Location place_of(const std::string& path) const;
};

/// Faults, gathered so that all are reported together.
class Faults {
 public:
  void add(const Location&, const std::string& what);
  bool any() const { return !faults_.empty(); }
  /// @throws SceneError with one line per fault, in the order of the text, if there is any.
  void raise() const;

 private:
  std::vector<Complaint> faults_;
};

}  // namespace flowrest::scenes
