#pragma once

#include <filesystem>

#include "foamCases/sampler.h"
#include "foamCases/wedge_gauge.h"
#include "foamCases/wedge_grid.h"

namespace flowrest::foam {

/// The state of a slump when it was last sampled.
struct SlumpState {
  double time = 0.0;          ///< s
  double spread = 0.0;        ///< m, at 3 mm depth
  double front = 0.0;         ///< m
  double height = 0.0;        ///< m, centre depth
  double volume = 0.0;        ///< m3
  double rim_depth = 0.0;     ///< m
  double volume_error = 0.0;  ///< largest so far, relative to the first sample
  double first_volume = 0.0;  ///< m3
  double flocculation = 0.0;  ///< mean over the concrete
};

/// Gauges a slump in a wedge.
class SlumpSampler : public Sampler {
 public:
  SlumpSampler(const scenes::Scene&, std::filesystem::path case_directory, runs::RunWriter&);

  std::size_t cells() const override { return grid_.cells(); }
  std::string progress() const override;
  std::string fault() const override;
  nlohmann::ordered_json summary() const override;

 private:
  void sample(double time, const std::filesystem::path& directory) override;
  void write_history(double time, const SlumpGauges&);

  WedgeGrid grid_;
  SlumpState state_;
};

}  // namespace flowrest::foam
