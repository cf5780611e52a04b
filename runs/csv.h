#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// CSV as flowrest writes it and as spreadsheets do.
namespace flowrest::runs {

/// The cells of a CSV file as text. A mark before UTF-8, line ends of every system, cells in quotes, empty
/// columns at the end, blank lines and lines that begin with # are read over. Commas, semicolons or tabs part
/// the cells, as the header has it or a first line "sep=;" says.
struct CsvText {
  struct Row {
    std::size_t line = 0;  ///< of the file, from 1
    std::vector<std::string> cells;
  };
  std::filesystem::path path;
  char separator = ',';
  char decimal_mark = '.';
  Row header;             ///< names the columns, each with a name of its own
  std::vector<Row> rows;  ///< no row has more cells than the header

  std::string place(const Row&) const;  ///< "file:line"
  /// The number in a cell: with the file's decimal mark, and with thousands parted where that is beyond
  /// doubt; nothing where it is none.
  std::optional<double> number(const std::string& cell) const;
};

/// A last line without its end was cut off by an interruption and is left out, unless `complete` says that
/// whoever wrote the file came to the end of it. A file without a line has no columns.
/// @throws RunError with file:line, the cause and what is allowed: where it is no text, where two separators
/// or two decimal marks could be meant, where there is no header.
CsvText read_csv_text(const std::filesystem::path&, bool complete = true);

/// A table read from CSV: named columns of equal length.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<std::size_t> lines;  ///< of the file, for each row
  bool has(const std::string& name) const;
  /// @throws RunError naming the columns there are.
  const std::vector<double>& at(const std::string& name) const;
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// As read_csv_text, of numbers alone; an empty cell reads nothing (`runs::nothing`).
/// @throws RunError with file:line of the first malformed row.
Table read_csv(const std::filesystem::path&, bool complete = false);

/// The first line of a CSV file that flowrest wrote; "" where there is none, or none to its end.
std::string header_of_csv(const std::filesystem::path&);

/// Cuts a CSV file that flowrest wrote back to whole rows whose first number is at most `time`; one without a
/// header goes.
/// @return the last row's first number, where there is one
std::optional<double> cut_csv_back(const std::filesystem::path&, double time);

/// A text as a cell of a CSV file, in quotes where it needs them.
std::string csv_field(const std::string& text);

/// Names parted by commas, as a header has them.
std::string csv_header(const std::vector<std::string>& names);

}  // namespace flowrest::runs
