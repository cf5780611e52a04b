#pragma once

#include "foamCases/conservation.h"
#include "foamCases/sampler.h"
#include "foamCases/vessel_gauge.h"

namespace flowrest::foam {

/// Gauges what runs out of a vessel, or along one.
class VesselSampler : public Sampler {
 public:
  /// `shear_rates`: whether the case writes them, as it does with the plug-in.
  VesselSampler(const scenes::Scene&, std::vector<MeshCell>, CaseFields, runs::RunWriter&, bool plug_in);

  std::size_t cells() const override { return gauge_.cells(); }
  std::string progress() const override;
  std::string fault() const override { return conservation_.fault(); }
  std::string doubt() const override { return conservation_.doubt(); }
  void continue_from(const runs::Table& history) override;
  nlohmann::ordered_json summary() const override;

 private:
  void sample(double time, const ReadField&) override;
  double overstressing_rate() const override { return now_.overstressing_rate_p99; }
  void write_history(double time);
  double discharged() const;  ///< share of the concrete

  bool runs_out_;  ///< of an outlet, or else along a channel
  VesselGauge gauge_;
  VesselGauges now_;
  Conservation conservation_;
  double flocculation_ = 0.0;
};

}  // namespace flowrest::foam
