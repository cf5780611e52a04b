#include "foamCases/field_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace flowrest::foam {

namespace {

/// Walks through the text of a field file.
class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw FieldError(fmt::format("{}: {}", name_, what));
  }

  void skip_past(std::string_view word) {
    const auto found = text_.find(word, at_);
    if (found == std::string_view::npos) fail(fmt::format("there is no '{}'", word));
    at_ = found + word.size();
  }

  std::string_view word() {
    skip_blanks();
    const auto begin = at_;
    while (at_ < text_.size() && std::strchr(" \t\r\n();", text_[at_]) == nullptr) ++at_;
    if (begin == at_) fail("it ends too early");
    return text_.substr(begin, at_ - begin);
  }

  double number() {
    const auto digits = word();
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end != digits.data() + digits.size() || error == std::errc::invalid_argument)
      fail(fmt::format("'{}' is not a number", digits));
    return value;
  }

  void expect(char c) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != c) fail(fmt::format("a '{}' is missing", c));
    ++at_;
  }

  /// The numbers that follow directly, as the machine holds them.
  template <class Number>
  std::vector<Number> raw(std::size_t count) {
    if ((text_.size() - at_) / sizeof(Number) < count) fail("it ends too early");
    std::vector<Number> values(count);
    std::memcpy(values.data(), text_.data() + at_, count * sizeof(Number));
    at_ += count * sizeof(Number);
    return values;
  }

  bool at(char c) {
    skip_blanks();
    return at_ < text_.size() && text_[at_] == c;
  }

  void skip_comments() {
    while (at('/')) {
      const auto end = text_.find('\n', at_);
      if (end == std::string_view::npos) fail("it ends too early");
      at_ = end + 1;
    }
  }

  /// One value: bare where it is a scalar, in brackets where it is a vector.
  void value(int components, std::vector<double>& values) {
    if (components > 1) expect('(');
    for (int c = 0; c < components; ++c) values.push_back(number());
    if (components > 1) expect(')');
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && std::strchr(" \t\r\n", text_[at_]) != nullptr) ++at_;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
};

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FieldError(fmt::format("{}: cannot be read", path.string()));
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool says_binary(std::string_view text) {
  const auto format = text.find("format");
  if (format == std::string_view::npos) return false;
  const auto end = text.find(';', format);
  return end != std::string_view::npos &&
         text.substr(format, end - format).find("binary") != std::string_view::npos;
}

}  // namespace

std::vector<double> parse_internal_field(const std::string& bytes, const std::string& name, std::size_t cells,
                                         int components) {
  const std::size_t count = cells * static_cast<std::size_t>(components);
  Reader reader(bytes, name);
  reader.skip_past("internalField");
  std::vector<double> values;
  const auto layout = reader.word();
  if (layout == "uniform") {
    std::vector<double> one;
    reader.value(components, one);
    reader.expect(';');
    for (std::size_t i = 0; i < count; ++i) values.push_back(one[i % one.size()]);
    return values;
  }
  if (layout != "nonuniform") reader.fail("the internal field is neither uniform nor nonuniform");
  reader.word();  // List<scalar> or List<vector>
  if (const double written = reader.number(); written != static_cast<double>(cells))
    reader.fail(fmt::format("it holds {} cells, the mesh has {}", written, cells));
  reader.expect('(');
  if (says_binary(bytes)) {
    values = reader.raw<double>(count);
  } else {
    values.reserve(count);
    for (std::size_t cell = 0; cell < cells; ++cell) reader.value(components, values);
  }
  reader.expect(')');
  return values;
}

std::vector<int> read_labels(const std::filesystem::path& path) {
  const std::string bytes = bytes_of(path);
  const std::string name = path.string();
  Reader reader(bytes, name);
  reader.skip_past("FoamFile");
  reader.skip_past("}");
  reader.skip_comments();
  const double count = reader.number();
  if (!(count >= 0.0 && count <= 1e9)) reader.fail(fmt::format("it cannot hold {} labels", count));
  std::vector<int> labels;
  reader.expect('(');
  if (says_binary(bytes)) {
    for (const auto label : reader.raw<std::int32_t>(static_cast<std::size_t>(count)))
      labels.push_back(label);
  } else {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      labels.push_back(static_cast<int>(reader.number()));
  }
  reader.expect(')');
  return labels;
}

std::vector<double> read_internal_field(const std::filesystem::path& path, std::size_t cells,
                                        int components) {
  return parse_internal_field(bytes_of(path), path.string(), cells, components);
}

}  // namespace flowrest::foam
