#include "mpm/gauges/body_gauge.h"

#include <variant>

namespace flowrest::mpm {

namespace {

struct Make {
  const GaugeCase& of;
  std::unique_ptr<BodyGauge> operator()(const scenes::SpreadGauge& g) const { return spread_gauge(of, g); }
  std::unique_ptr<BodyGauge> operator()(const scenes::ChannelGauge& g) const { return channel_gauge(of, g); }
  std::unique_ptr<BodyGauge> operator()(const scenes::OutletGauge& g) const { return outlet_gauge(of, g); }
  std::unique_ptr<BodyGauge> operator()(const scenes::PlatesGauge& g) const { return plates_gauge(of, g); }
  std::unique_ptr<BodyGauge> operator()(const scenes::SectionGauge& g) const { return section_gauge(of, g); }
};

}  // namespace

std::unique_ptr<BodyGauge> body_gauge(const GaugeCase& of) { return std::visit(Make{of}, of.pieces.gauged); }

}  // namespace flowrest::mpm
