#include "compare/report/picture_size.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace flowrest::report {

namespace fs = std::filesystem;

namespace {

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int big_endian(std::string_view bytes) {
  unsigned value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return static_cast<int>(value);
}

int number_after(std::string_view text, const std::string& name) {
  const auto at = text.find(name + "=\"");
  return at == std::string_view::npos ? 0
                                      : std::atoi(std::string(text.substr(at + name.size() + 2, 12)).c_str());
}

}  // namespace

std::optional<PictureSize> png_size(const fs::path& path) {
  const std::string bytes = bytes_of(path);
  constexpr std::string_view signature = "\x89PNG\r\n\x1a\n", end = "IEND\xae\x42\x60\x82";
  constexpr std::size_t width_at = 16, header = 24;
  if (bytes.size() < header || !bytes.starts_with(signature) || !bytes.ends_with(end)) return std::nullopt;
  const std::string_view text = bytes;
  return PictureSize{big_endian(text.substr(width_at, 4)), big_endian(text.substr(width_at + 4, 4))};
}

std::optional<PictureSize> svg_size(const fs::path& path) {
  const std::string text = bytes_of(path);
  const auto begin = text.find("<svg");
  const auto last = text.find_last_not_of(" \r\n\t");
  if (begin == std::string::npos || last == std::string::npos ||
      !std::string_view(text).substr(0, last + 1).ends_with("</svg>"))
    return std::nullopt;
  const std::string_view head = std::string_view(text).substr(begin, text.find('>', begin) - begin);
  const PictureSize size{number_after(head, " width"), number_after(head, " height")};
  return size[0] > 0 && size[1] > 0 ? std::optional(size) : std::nullopt;
}

}  // namespace flowrest::report
