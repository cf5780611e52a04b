#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

/// Reads the internal field of an OpenFOAM field file: ascii or binary, uniform or not, scalars or vectors.
namespace flowrest::foam {

/// A field file that cannot be read, or not yet: it may still be being written.
class FieldError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The internal field, `components` numbers to a cell (1 for a scalar, 3 for a vector), cell after cell.
/// @throws FieldError naming the file where it is not a whole field of `cells` cells.
std::vector<double> read_internal_field(const std::filesystem::path&, std::size_t cells, int components);

/// As read_internal_field, of a file's bytes; `name` is used in messages.
std::vector<double> parse_internal_field(const std::string& bytes, const std::string& name, std::size_t cells,
                                         int components);

/// A list of labels, such as which cells of the whole mesh a part holds.
/// @throws FieldError where it is none, or not whole.
std::vector<int> read_labels(const std::filesystem::path&);

}  // namespace flowrest::foam
