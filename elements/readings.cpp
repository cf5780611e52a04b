#include "elements/readings.h"

#include <cmath>

namespace flowrest::elements {

Reading reading_of(const Slump& slump) {
  const Surface& surface = slump.surface();
  const double depth = slump.problem().spread_depth;
  return {slump.time(),
          surface.spread(depth),
          surface.spread(0.5 * depth),
          surface.spread(2.0 * depth),
          surface.markers().front().y(),
          surface.volume(slump.problem().symmetry)};
}

Follower::Follower(const Problem& problem, const Resolution& resolution)
    : slump_(problem, resolution),
      before_(reading_of(slump_)),
      now_(before_),
      surface_before_(slump_.surface()) {}

void Follower::reach(double time, double stop) {
  while (slump_.time() < time) {
    before_ = now_;
    surface_before_ = slump_.surface();
    slump_.step(stop);
    now_ = reading_of(slump_);
  }
}

double Follower::share_of_step(double time) const {
  const double step = now_.time - before_.time;
  return step > 0.0 ? (time - before_.time) / step : 1.0;
}

Reading Follower::at(double time) const {
  const double share = share_of_step(time);
  const auto between = [&](double Reading::*value) { return std::lerp(before_.*value, now_.*value, share); };
  return {time,
          between(&Reading::spread),
          between(&Reading::spread_half),
          between(&Reading::spread_double),
          between(&Reading::height),
          between(&Reading::volume)};
}

DepthProfile Follower::profile(double time) const {
  constexpr int points = 200;
  const double share = share_of_step(time), reach_before = surface_before_.radius(),
               reach_now = slump_.surface().radius();
  DepthProfile profile;
  for (int i = points; i >= 0; --i) {
    // Closer towards the edge, where the depth falls steeply; the last just beyond it.
    const double x = static_cast<double>(i) / points, part = i > 0 ? 1.0 - x * x : 1.0 + 1e-9;
    profile.radius.push_back(part * std::lerp(reach_before, reach_now, share));
    profile.depth.push_back(std::lerp(surface_before_.depth(part * reach_before),
                                      slump_.surface().depth(part * reach_now), share));
  }
  return profile;
}

}  // namespace flowrest::elements
