#pragma once

#include <vector>

#include "foamCases/sampler.h"
#include "runs/held_walls.h"

namespace flowrest::foam {

/// Gauges a duct: the velocity profile of its one column of cells.
class DuctSampler : public Sampler {
 public:
  /// `cells`: from plate to plate.
  DuctSampler(const scenes::Scene&, std::size_t cells, CaseFields, runs::RunWriter&, bool plug_in);

  std::size_t cells() const override { return height_.size(); }
  std::string progress() const override;
  std::string fault() const override { return ""; }
  std::string doubt() const override { return ""; }
  nlohmann::ordered_json summary() const override;

 private:
  void sample(double time, const ReadField&) override;
  double overstressing_rate() const override { return overstressing_rate_; }

  /// Along the plates.
  runs::ShearedLayer sheared_layer(const std::vector<double>& velocity, double spacing) const;

  runs::HeldWalls walls_;
  double between_plates_;            ///< m
  std::vector<double> height_;       ///< m, of the cell centres over the lower plate
  double plug_velocity_ = 0.0;       ///< m/s, the mean of the innermost two cells
  double mean_velocity_ = 0.0;       ///< m/s
  double overstressing_rate_ = 0.0;  ///< 1/s, the largest, at the plates or between cells
};

}  // namespace flowrest::foam
