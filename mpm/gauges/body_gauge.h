#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mpm/solver/solver.h"
#include "runs/columns.h"
#include "scenes/pieces.h"

/// What an apparatus is judged by, read off its particles: one class and one file for each of the gauges that
/// pieces name (scenes/pieces.h, Gauged).
namespace flowrest::mpm {

/// What such a gauge reads at one time.
struct BodyReading {
  runs::Row columns;                      ///< its columns of history.csv
  std::vector<double> coordinate, value;  ///< the profile: along pieces' profile axis, depth or velocity
  double main = 0.0;                      ///< the number shown while a run goes on: mm, per cent or m/s
  std::string words;                      ///< the same as text: "spread 543.2 mm"
  double farthest = 0.0;                  ///< m from the middle, of what spreads; else 0
};

/// Reads one state: `begin`, then every batch of particles, then `finish`.
class BodyGauge {
 public:
  virtual ~BodyGauge() = default;
  /// Looks at what needs a list of all particles, before others make theirs.
  virtual void begin(Solver&) {}
  virtual void add(const ParticleBatch&) = 0;
  virtual BodyReading finish() = 0;
};

/// What a gauge is made from.
struct GaugeCase {
  const scenes::Scene& scene;
  const scenes::Pieces& pieces;
  double cell;           ///< m
  std::size_t vertical;  ///< axis of the computation
  double time;           ///< s
};

std::unique_ptr<BodyGauge> spread_gauge(const GaugeCase&, const scenes::SpreadGauge&);
std::unique_ptr<BodyGauge> channel_gauge(const GaugeCase&, const scenes::ChannelGauge&);
std::unique_ptr<BodyGauge> outlet_gauge(const GaugeCase&, const scenes::OutletGauge&);
std::unique_ptr<BodyGauge> plates_gauge(const GaugeCase&, const scenes::PlatesGauge&);
std::unique_ptr<BodyGauge> section_gauge(const GaugeCase&, const scenes::SectionGauge&);

/// The gauge of what pieces are gauged by.
std::unique_ptr<BodyGauge> body_gauge(const GaugeCase&);

}  // namespace flowrest::mpm
