#pragma once

#include <memory>

#include "foamCases/conservation.h"
#include "foamCases/sampler.h"
#include "foamCases/slump_mesh.h"

namespace flowrest::foam {

/// The state of a slump when it was last sampled. What had nothing to read is `runs::nothing`.
struct SlumpState {
  double time = 0.0;                ///< s
  double spread = 0.0;              ///< m, at gauges.spread_depth
  double front = 0.0;               ///< m
  double height = 0.0;              ///< m, centre depth
  double rim_depth = 0.0;           ///< m
  double overstressing_rate = 0.0;  ///< 1/s
  double trapped_air = 0.0;         ///< m3
  double most_trapped_air = 0.0;    ///< m3, so far
  double flocculation = 0.0;        ///< mean over the concrete
};

/// Gauges a slump, in a wedge or a quarter.
class SlumpSampler : public Sampler {
 public:
  /// `shear_rates`: whether the case writes them.
  SlumpSampler(const scenes::Scene&, CaseFields, runs::RunWriter&, bool plug_in, bool shear_rates);

  std::size_t cells() const override { return mesh_->cells(); }
  std::string progress() const override;
  std::string fault() const override;
  std::string doubt() const override { return conservation_.doubt(); }
  void continue_from(const runs::Table& history) override;
  nlohmann::ordered_json summary() const override;

 private:
  void sample(double time, const ReadField&) override;
  double overstressing_rate() const override { return state_.overstressing_rate; }
  void write_history(double time, const SlumpGauges&);

  std::unique_ptr<SlumpMesh> mesh_;
  Conservation conservation_;
  bool shear_rates_;
  SlumpState state_;
};

}  // namespace flowrest::foam
