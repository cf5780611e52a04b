#include "scenes/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>

namespace flowrest::scenes {

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string escaped(const std::string& text) {
  constexpr std::size_t longest = 120;
  std::size_t end = std::min(text.size(), longest);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80)
    --end;  // whole characters
  std::string line;
  for (std::size_t i = 0; i < end; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x20 || byte == 0x7f) {
      line += fmt::format("\\x{:02x}", byte);
    } else {
      line += text[i];
    }
  }
  return end < text.size() ? line + "..." : line;
}

std::string quoted(const std::string& text) { return fmt::format("\"{}\"", escaped(text)); }

std::string encoding_fault(std::string_view text) {
  constexpr std::string_view utf_16_marks[] = {"\xFF\xFE", "\xFE\xFF"}, archive = "PK\x03\x04";
  const char* const allowed = "allowed: text in UTF-8 (a spreadsheet calls it CSV UTF-8)";
  for (const auto mark : utf_16_marks)
    if (text.starts_with(mark)) return fmt::format("is text in UTF-16; {}", allowed);
  if (text.starts_with(archive))
    return fmt::format("is an archive, such as a spreadsheet's own file (.xlsx, .ods); {}", allowed);
  const auto nul = text.find('\0');
  if (nul == std::string_view::npos) return {};
  // In UTF-16 without a mark every other byte of plain letters is 0.
  const bool utf_16 = nul < 2 && std::count(text.begin(), text.end(), '\0') > std::ssize(text) / 4;
  return fmt::format("{}; {}", utf_16 ? "is text in UTF-16" : "holds bytes that are 0, so it is no text",
                     allowed);
}

void print_notes(const std::vector<std::string>& notes) {
  // A closed stream is no reason to stop.
  for (const std::string& note : notes) std::fputs(fmt::format("Note: {}\n", note).c_str(), stderr);
}

std::string toml_string(const std::string& text) {
  std::string string = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      string += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      string += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    } else {
      string += c;
    }
  }
  string += '"';
  return string;
}

namespace {

/// Insertions, deletions, replacements and swaps of neighbours (optimal string alignment) from one word to
/// the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
  constexpr std::size_t longest = 64;  // no key is half as long; a huge word is near nothing
  if (word.size() > longest) return {};
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least && distance < candidate.size()) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string exact_text(double number) {
  std::string text = fmt::format("{}", number);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

}  // namespace flowrest::scenes
