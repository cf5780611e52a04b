#pragma once

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
  double shear_rate() const override;
  std::string fault() const override;
  void continue_from(const runs::Table& history) override;
  nlohmann::ordered_json summary() const override;

 private:
  bool is_funnel() const { return scene().kind == scenes::Kind::v_funnel; }
  void sample(double time, const ReadField&) override;
  void write_history(double time);
  double discharged() const;  ///< share of the concrete
  /// By how much the volume has changed since the start where nothing may leave; of a funnel 0.
  double volume_error() const;
  VesselGauge gauge_;
  VesselGauges now_;
  double time_ = 0.0, first_volume_ = 0.0, largest_volume_error_ = 0.0, flocculation_ = 0.0;
};

}  // namespace flowrest::foam
