#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "elements/slump.h"

namespace flowrest::elements {

/// Writes velocity (m/s), pressure (Pa) and shear rate (1/s) of a slump as VTK XML, `fields_NNNNNN.vtu`,
/// biquadratic quadrilaterals in the x-z plane, and brings `fields.pvd`, which ParaView opens as a time
/// series, up to date. They are those of the middle of the last step, on the mesh at its end.
class FieldWriter {
 public:
  /// `directory` is made with the first field.
  explicit FieldWriter(std::filesystem::path directory) : directory_(std::move(directory)) {}
  void write(const Slump&);

 private:
  std::filesystem::path directory_;
  std::vector<std::pair<std::string, double>> series_;
};

/// The text of one such file.
std::string vtu_of(const Slump&);

}  // namespace flowrest::elements
