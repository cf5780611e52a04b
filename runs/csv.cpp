#include "runs/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "runs/depth.h"
#include "runs/run_directory.h"
#include "scenes/text.h"

namespace flowrest::runs {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::pair<char, const char*>, 3> separators = {
    {{',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}}};
const char* const allowed_separators = "allowed: cells parted by commas, semicolons or tabs";

/// Blanks that part thousands in print: UTF-8's no-break space and its narrow one.
constexpr std::string_view wide_blanks[] = {"\xC2\xA0", "\xE2\x80\xAF"};

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw RunError(fmt::format("{}: cannot be read to its end", path.string()));
  return text;
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool ends_line(char c) { return c == '\n' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<double> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  // Underflow and overflow are numbers all the same; from_chars leaves the value alone there.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  return error == std::errc{} ? std::optional(value) : std::nullopt;
}

/// Goes through a file's text line by line and cell by cell.
class Scanner {
 public:
  Scanner(std::string_view text, const fs::path& path) : text_(text), path_(path) {}

  bool at_end() const { return at_ == text_.size(); }
  std::size_t line() const { return line_; }

  /// The line here, up to its end; nothing is passed over.
  std::string_view peek() const {
    const auto end = std::find_if(text_.begin() + static_cast<std::ptrdiff_t>(at_), text_.end(), ends_line);
    return text_.substr(at_, static_cast<std::size_t>(end - text_.begin()) - at_);
  }

  void skip_line() {
    at_ += peek().size();
    pass_line_end();
  }

  /// The cells of the line here; one in quotes may go on over several lines.
  std::vector<std::string> take_cells(char separator) {
    std::vector<std::string> cells;
    do {
      cells.push_back(take_cell(separator));
    } while (!at_end() && text_[at_] == separator && ++at_);
    pass_line_end();
    return cells;
  }

 private:
  std::string take_cell(char separator) {
    while (!at_end() && is_blank(text_[at_]) && text_[at_] != separator && !ends_line(text_[at_])) ++at_;
    if (!at_end() && text_[at_] == '"') return take_quoted(separator);
    const std::size_t begin = at_;
    while (!at_end() && text_[at_] != separator && !ends_line(text_[at_])) ++at_;
    return std::string(trimmed(text_.substr(begin, at_ - begin)));
  }

  std::string take_quoted(char separator) {
    const std::size_t first_line = line_;
    std::string cell;
    for (++at_; !at_end(); ++at_) {
      if (text_[at_] == '"' && (++at_ == text_.size() || text_[at_] != '"')) {
        while (!at_end() && text_[at_] == ' ') ++at_;
        if (!at_end() && text_[at_] != separator && !ends_line(text_[at_]))
          throw RunError(
              fmt::format("{}:{}: a cell goes on after its closing quote; allowed: a quote in it as two",
                          path_.string(), line_));
        return std::string(trimmed(cell));
      }
      if (text_[at_] == '\n') ++line_;
      cell += text_[at_];
    }
    throw RunError(fmt::format("{}:{}: a quote is opened and never closed", path_.string(), first_line));
  }

  void pass_line_end() {
    if (at_end()) return;
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    ++line_;
  }

  std::string_view text_;
  fs::path path_;
  std::size_t at_ = 0, line_ = 1;
};

/// Whether a line says nothing of its own.
bool is_skipped(std::string_view line) {
  const auto content = trimmed(line);
  return content.empty() || content.front() == '#';
}

/// What a spreadsheet's hint, a first line such as "sep=;", names.
std::optional<char> hinted_separator(std::string_view line) {
  line = trimmed(line);
  if (line.size() >= 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
  if (line == "sep=") return '\t';  // the tab itself was trimmed
  return line.size() == 5 && line.starts_with("sep=") ? std::optional(line.back()) : std::nullopt;
}

/// What parts the cells of a header.
char separator_in(std::string_view header, const std::string& place) {
  std::array<bool, separators.size()> found{};
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    for (std::size_t i = 0; i < separators.size(); ++i)
      found[i] = found[i] || (!quoted && c == separators[i].first);
  }
  std::vector<std::string> names;
  char separator = ',';
  for (std::size_t i = 0; i < separators.size(); ++i)
    if (found[i]) {
      names.emplace_back(separators[i].second);
      separator = separators[i].first;
    }
  if (names.size() > 1)
    throw RunError(
        fmt::format("{}: the header holds {}: either could part its cells; {}, by one of them alone", place,
                    fmt::join(names, " and "), allowed_separators));
  const auto other = trimmed(header).find_first_of(" \t|");
  if (names.empty() && other != std::string_view::npos && header.find('"') == std::string_view::npos)
    throw RunError(fmt::format("{}: the header is parted by {}; {}", place,
                               header.find('|') != std::string_view::npos ? "bars" : "blanks",
                               allowed_separators));
  return separator;
}

/// A cell in which whatever may part thousands, blanks, an apostrophe or `mark`, is an underscore, which is
/// no part of a number.
std::string with_thousands_marked(std::string_view cell, char mark) {
  std::string marked;
  while (!cell.empty()) {
    std::size_t length = cell.front() == ' ' || cell.front() == '\'' || cell.front() == mark ? 1 : 0;
    for (const auto blank : wide_blanks)
      if (cell.starts_with(blank)) length = blank.size();
    marked += length > 0 ? '_' : cell.front();
    cell.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return marked;
}

/// How a number is written, as far as its decimal mark is concerned.
struct Written {
  std::optional<char> decimal;  ///< for certain
  std::optional<char> doubted;  ///< it may begin decimals or part thousands
};

/// Whether the digits of `text` stand in groups of three, parted by `mark`: 1.234.567
bool in_groups(std::string_view text, char mark) {
  const auto first = text.find(mark);
  if (first == 0 || first > 3 || text.front() == '0') return false;
  for (std::size_t i = first; i < text.size(); i += 4) {
    if (text[i] != mark || text.size() < i + 4) return false;
    if (!std::all_of(text.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     text.begin() + static_cast<std::ptrdiff_t>(i) + 4, is_digit))
      return false;
  }
  return true;
}

/// Digits before an exponent, without their sign.
std::string_view mantissa_of(std::string_view cell) {
  if (cell.starts_with('+') || cell.starts_with('-')) cell.remove_prefix(1);
  return cell.substr(0, cell.find_first_of("eE"));
}

Written written(std::string_view given) {
  std::string cell = with_thousands_marked(given, ' ');
  std::erase(cell, '_');
  const auto digits = mantissa_of(cell);
  Written w;
  const bool is_number =
      std::any_of(digits.begin(), digits.end(), is_digit) &&
      std::all_of(digits.begin(), digits.end(), [](char c) { return is_digit(c) || c == '.' || c == ','; });
  if (!is_number) return w;
  const auto last = digits.find_last_of(".,");
  if (last == std::string_view::npos) return w;
  const char mark = digits[last], other = mark == '.' ? ',' : '.';
  const auto times = std::count(digits.begin(), digits.end(), mark);
  if (times > 1) {
    if (in_groups(digits, mark)) w.decimal = other;
  } else if (digits.find(other) != std::string_view::npos) {
    if (in_groups(digits.substr(0, last), other)) w.decimal = mark;
  } else if (in_groups(digits, mark) && cell.ends_with(digits)) {
    w.doubted = mark;
  } else {
    w.decimal = mark;
  }
  return w;
}

/// Where a file first writes decimals with a mark.
struct Evidence {
  std::string place, cell;  ///< empty where nothing speaks for it
  void take(const CsvText& csv, const CsvText::Row& row, const std::string& what) {
    if (!place.empty()) return;
    place = csv.place(row);
    cell = what;
  }
};

/// The decimal mark that the cells speak for.
/// @throws RunError where they speak for both, or where a mark may as well part thousands.
char decimal_mark_of(const CsvText& csv) {
  Evidence comma, point, doubted_comma, doubted_point;
  for (const auto& row : csv.rows)
    for (const std::string& cell : row.cells) {
      const Written w = written(cell);
      if (w.decimal) (*w.decimal == ',' ? comma : point).take(csv, row, cell);
      if (w.doubted) (*w.doubted == ',' ? doubted_comma : doubted_point).take(csv, row, cell);
    }
  if (comma.place.empty() && doubted_comma.place.empty()) return '.';
  const auto refuse = [](const Evidence& here, const Evidence& there) {
    throw RunError(
        fmt::format("{}: '{}' does not go with '{}' ({}): one writes decimals with a comma, the other with "
                    "a point; allowed: one of them throughout, and thousands not parted",
                    here.place, here.cell, there.cell, there.place));
  };
  if (!comma.place.empty() && !point.place.empty()) refuse(comma, point);
  if (!comma.place.empty() && !doubted_point.place.empty()) refuse(doubted_point, comma);
  if (!doubted_comma.place.empty() && !point.place.empty()) refuse(doubted_comma, point);
  if (!comma.place.empty()) return ',';
  // Spreadsheets part cells by semicolons because the comma is their decimal mark.
  if (csv.separator == ';' && doubted_point.place.empty()) return ',';
  throw RunError(
      fmt::format("{}: '{}' may be a number with decimals or one of thousands; allowed: decimals with a "
                  "point, and thousands not parted",
                  doubted_comma.place, doubted_comma.cell));
}

/// The header's names without the empty ones at its end.
void check_header(CsvText& csv) {
  auto& names = csv.header.cells;
  while (names.size() > 1 && names.back().empty()) names.pop_back();
  if (!names.front().empty() && parsed(names.front()))
    throw RunError(
        fmt::format("{}: the first line holds numbers; a header that names the columns is expected",
                    csv.place(csv.header)));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty() || std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i),
                                      names[i]) != names.begin() + static_cast<std::ptrdiff_t>(i))
      throw RunError(fmt::format("{}: column {} is {}; every column needs a name of its own",
                                 csv.place(csv.header), i + 1,
                                 names[i].empty() ? "unnamed" : "a second '" + names[i] + "'"));
}

/// Without the empty cells beyond the header, if that is all there is.
void cut_to_header(CsvText::Row& row, std::size_t columns) {
  while (row.cells.size() > columns && row.cells.back().empty()) row.cells.pop_back();
}

/// A text without the last line where that has no end.
std::string_view whole_lines(std::string_view text) {
  const auto end = text.find_last_of("\n\r");
  return end == std::string_view::npos ? std::string_view() : text.substr(0, end + 1);
}

}  // namespace

std::string CsvText::place(const Row& row) const { return fmt::format("{}:{}", path.string(), row.line); }

std::optional<double> CsvText::number(const std::string& cell) const {
  const bool plain = cell.find_first_of(", '\xC2\xE2") == std::string::npos &&
                     (decimal_mark == '.' ? std::count(cell.begin(), cell.end(), '.') < 2
                                          : cell.find('.') == std::string::npos);
  if (plain) return parsed(cell);
  std::string digits = with_thousands_marked(cell, decimal_mark == '.' ? ',' : '.');
  if (digits.find('_') != std::string::npos) {
    const auto mantissa = mantissa_of(digits);
    if (!in_groups(mantissa.substr(0, mantissa.find(decimal_mark)), '_')) return std::nullopt;
    const auto fraction = mantissa.find(decimal_mark);
    if (fraction != std::string_view::npos && mantissa.find('_', fraction) != std::string_view::npos)
      return std::nullopt;
    std::erase(digits, '_');
  }
  if (decimal_mark == ',') std::replace(digits.begin(), digits.end(), ',', '.');
  return parsed(digits);
}

CsvText read_csv_text(const fs::path& path, bool complete) {
  const std::string bytes = read_text(path);
  if (const std::string fault = scenes::encoding_fault(bytes); !fault.empty())
    throw RunError(fmt::format("{}:1: {}", path.string(), fault));
  std::string_view text = bytes;
  if (text.starts_with(scenes::byte_order_mark)) text.remove_prefix(scenes::byte_order_mark.size());
  if (!complete) text = whole_lines(text);

  CsvText csv;
  csv.path = path;
  Scanner scanner(text, path);
  const auto hint = hinted_separator(scanner.peek());
  if (hint) scanner.skip_line();
  bool has_header = false, has_comma = false;
  while (!scanner.at_end()) {
    if (is_skipped(scanner.peek())) {
      scanner.skip_line();
      continue;
    }
    CsvText::Row row{scanner.line(), {}};
    if (!has_header) csv.separator = hint ? *hint : separator_in(scanner.peek(), csv.place(row));
    row.cells = scanner.take_cells(csv.separator);
    if (std::all_of(row.cells.begin(), row.cells.end(), [](const std::string& c) { return c.empty(); }))
      continue;
    if (!std::exchange(has_header, true)) {
      csv.header = std::move(row);
      check_header(csv);
      continue;
    }
    cut_to_header(row, csv.header.cells.size());
    for (const std::string& cell : row.cells) has_comma = has_comma || cell.find(',') != std::string::npos;
    csv.rows.push_back(std::move(row));
  }
  if (has_comma) csv.decimal_mark = decimal_mark_of(csv);
  return csv;
}

bool Table::has(const std::string& name) const {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const std::vector<double>& Table::at(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw RunError(fmt::format("no column '{}'; there are: {}", name, csv_header(names)));
  return columns[static_cast<std::size_t>(found - names.begin())];
}

Table read_csv(const fs::path& path, bool complete) {
  const CsvText csv = read_csv_text(path, complete);
  Table table;
  table.names = csv.header.cells;
  table.columns.resize(table.names.size());
  for (const auto& row : csv.rows) {
    if (row.cells.size() != table.names.size())
      throw RunError(fmt::format("{}: {} values where the header names {}", csv.place(row), row.cells.size(),
                                 table.names.size()));
    for (std::size_t column = 0; column < row.cells.size(); ++column) {
      const auto value = row.cells[column].empty() ? nothing : csv.number(row.cells[column]);
      if (!value)
        throw RunError(fmt::format("{}: '{}' in column {} is not a number", csv.place(row), row.cells[column],
                                   table.names[column]));
      table.columns[column].push_back(*value);
    }
    table.lines.push_back(row.line);
  }
  return table;
}

std::string header_of_csv(const fs::path& path) {
  if (!fs::exists(path)) return "";
  const std::string text = read_text(path);
  const std::string_view whole = whole_lines(text);
  return std::string(trimmed(whole.substr(0, whole.find('\n'))));
}

std::optional<double> cut_csv_back(const fs::path& path, double time) {
  if (!fs::exists(path)) return std::nullopt;
  const std::string text = read_text(path);
  std::string_view left = whole_lines(text);
  const auto take_line = [&left] {
    const auto end = left.find('\n');
    const auto line = left.substr(0, end);
    left.remove_prefix(end == std::string_view::npos ? left.size() : end + 1);
    return line;
  };
  if (left.empty()) {
    fs::remove(path);
    return std::nullopt;
  }
  std::string kept = fmt::format("{}\n", take_line());
  std::optional<double> last;
  while (!left.empty()) {
    const auto line = take_line();
    const auto row_time = parsed(trimmed(line.substr(0, line.find(','))));
    if (!row_time || *row_time > time) continue;
    kept += fmt::format("{}\n", line);
    last = row_time;
  }
  write_atomically(path, kept);
  return last;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_header(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ","));
}

}  // namespace flowrest::runs
