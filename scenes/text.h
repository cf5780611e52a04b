#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Words for messages: lists, quotations and the nearest name.
namespace flowrest::scenes {

/// "a, b, c".
std::string joined(const std::vector<std::string>&);

/// Text with control characters escaped, cut when very long: fit for one line of a message.
std::string escaped(const std::string&);

/// Text from a user made fit for one line of a message: escaped and in quotes.
std::string quoted(const std::string&);

/// The candidate with the fewest slips of the pen from `word`; empty where none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

/// Why a file's text is none that can be read as UTF-8, and what is allowed; empty where it may be.
std::string encoding_fault(std::string_view text);

/// The mark that some programs put before UTF-8.
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Says notes to the user: a line "Note: ..." each, on stderr, so that what a command prints for programs
/// stays whole.
void print_notes(const std::vector<std::string>&);

/// A TOML basic string.
std::string toml_string(const std::string&);

/// The shortest text that reads back as exactly this number, always recognisable as a floating-point one.
std::string exact_text(double);

}  // namespace flowrest::scenes
