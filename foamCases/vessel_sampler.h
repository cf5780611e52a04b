#pragma once

#include "foamCases/conservation.h"
#include "foamCases/sampler.h"
#include "foamCases/vessel_gauge.h"

namespace flowrest::foam {

/// Gauges an L-box, a V-funnel or a dam break.
class VesselSampler : public Sampler {
 public:
  /// `shear_rates`: whether the case writes them, as it does with the plug-in.
  VesselSampler(const scenes::Scene&, CaseFields, runs::RunWriter&, bool plug_in);

  std::size_t cells() const override { return gauge_.cells(); }
  std::string progress() const override;
  std::string fault() const override { return conservation_.fault(); }
  std::string doubt() const override { return conservation_.doubt(); }
  void continue_from(const runs::Table& history) override;
  nlohmann::ordered_json summary() const override;

 private:
  bool is_funnel() const { return scene().kind() == scenes::Kind::v_funnel; }
  void sample(double time, const ReadField&) override;
  double overstressing_rate() const override { return now_.overstressing_rate_p99; }
  void write_history(double time);
  double discharged() const;  ///< share of the concrete

  VesselGauge gauge_;
  VesselGauges now_;
  Conservation conservation_;
  double flocculation_ = 0.0;
};

}  // namespace flowrest::foam
