#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// The fields a case holds, in one piece or decomposed into the parts of its ranks.
namespace flowrest::foam {

/// One field of one time, `components` numbers to a cell.
using ReadField = std::function<std::vector<double>(const std::string& field, int components)>;

/// Times and fields of a case in cell order of the whole mesh, whoever solved it.
class CaseFields {
 public:
  /// `ranks` above 1: the fields are those of processor0 and so on, as decomposePar cut them.
  CaseFields(std::filesystem::path case_directory, int ranks);

  /// How many processor folders a case holds; 1 where it is in one piece.
  static int ranks_in(const std::filesystem::path& case_directory);

  /// Time directories that every part has, in ascending order: time (s) and name.
  std::vector<std::pair<double, std::string>> times() const;
  /// @throws FieldError where a part of it is not whole.
  std::vector<double> read(const std::string& time, const std::string& field, std::size_t cells,
                           int components) const;
  bool holds(const std::string& time, const std::string& field) const;
  void remove(const std::string& time) const;

 private:
  std::vector<std::filesystem::path> parts_;
};

/// The time directories of a folder in ascending order; other names are passed over.
std::vector<std::pair<double, std::filesystem::path>> time_directories(const std::filesystem::path&);

}  // namespace flowrest::foam
