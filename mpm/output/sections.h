#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mpm/solver/solver.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

/// Writes sections.csv of a strand that is printed along x: at each time its outline, over stretches of the path each as
/// long as the section gauge's, as far as the nozzle has gone. Rows are one cell high: their half width is what they
/// hold over length and height.
class SectionWriter {
 public:
  static constexpr const char* header = "time_s,x_m,layer,z_m,half_width_m";

  /// Writes nothing for a scene without straight strands. What was written after `resume_time` is cut off;
  /// below 0 the file begins anew.
  SectionWriter(const std::filesystem::path& directory, const scenes::Pieces&, double cell,
                double resume_time);
  /// Each time once.
  void write(double time, Solver&);

 private:
  int layer_of(double height, double time) const;

  std::filesystem::path file_;
  const scenes::Pieces& pieces_;
  std::optional<scenes::SectionGauge> gauge_;
  double cell_, last_ = -1.0;
};

}  // namespace flowrest::mpm
