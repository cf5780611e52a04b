#include "compare/exact/funnel.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace flowrest::compare::exact {

namespace {

/// Parts of the height over which integrals are taken by Simpson's and Runge's rules.
constexpr int parts = 160;
/// s, of Heun's rule for the flow; a funnel runs out in a second or two.
constexpr double largest_step = 5e-4;
/// Of the height: a layer above the exit that is thinner has left.
constexpr double thinnest_layer = 1e-3;

}  // namespace

double Funnel::volume_below(double at) const {
  constexpr int pieces = 200;
  const double step = at / pieces;
  double sum = 0.0;
  for (int i = 0; i < pieces; ++i)
    sum += area(i * step) + 4.0 * area((i + 0.5) * step) + area((i + 1) * step);
  return sum * step / 6.0;
}

FunnelFlow::FunnelFlow(const Funnel& funnel, double density, double gravity, double friction, Neck neck)
    : funnel_(funnel), density_(density), gravity_(gravity), friction_(friction), neck_(neck) {
  if (!(funnel.height > funnel.neck) || !(funnel.neck >= 0.0) || !(funnel.depth > 0.0) || !(density > 0.0) ||
      !(gravity > 0.0) || !(friction >= 0.0))
    throw std::invalid_argument("a funnel needs sizes, a density and a gravity above 0, and friction from 0");
  exit_ = neck == Neck::lets_go ? funnel.neck : 0.0;
}

/// Goes down from the surface, where the pressure is 0.
FunnelFlow::Profile FunnelFlow::pressure(double surface, double flow, double acceleration) const {
  const double step = (surface - exit_) / parts;
  const auto slope = [&](double at, double p) {
    const double area = funnel_.area(at), perimeter = 2.0 * (funnel_.width(at) + funnel_.depth);
    return density_ * (gravity_ - acceleration / area) - friction_ * std::max(p, 0.0) * perimeter / area;
  };
  const auto head = [&](double at) { return 0.5 * density_ * std::pow(flow / funnel_.area(at), 2); };
  Profile profile;
  double p = 0.0, at = surface;
  for (int i = 0; i < parts; ++i) {
    // The speed's head is a difference of states; what is left is integrated by the midpoint rule.
    const double middle = at - 0.5 * step, below = at - step;
    const double half = p + 0.5 * step * slope(at, p) + head(at) - head(middle);
    p += step * slope(middle, half) + head(at) - head(below);
    at = below;
    profile.lowest_pressure = std::min(profile.lowest_pressure, p);
  }
  profile.exit_pressure = p;
  return profile;
}

/// Q' for which nothing presses on the exit. The pressure there falls with it: Illinois' rule.
double FunnelFlow::acceleration(double surface, double flow) const {
  const double area = funnel_.area(exit_);
  double low = -20.0 * gravity_ * area, high = 2.0 * gravity_ * area * (surface - exit_ > 0.0 ? 10.0 : 1.0);
  double at_low = pressure(surface, flow, low).exit_pressure,
         at_high = pressure(surface, flow, high).exit_pressure;
  constexpr int most_rounds = 60;
  const double close = 1e-9 * density_ * gravity_ * funnel_.height;
  for (int i = 0; i < most_rounds && std::abs(at_high - at_low) > close; ++i) {
    const double next = (low * at_high - high * at_low) / (at_high - at_low);
    const double here = pressure(surface, flow, next).exit_pressure;
    if (std::abs(here) <= close) return next;
    if ((here > 0.0) == (at_low > 0.0)) {
      low = next;
      at_low = here;
      at_high *= 0.5;
    } else {
      high = next;
      at_high = here;
      at_low *= 0.5;
    }
  }
  return 0.5 * (low + high);
}

std::vector<FunnelFlow::State> FunnelFlow::run(double end, double interval) const {
  const double whole = funnel_.volume_below(funnel_.height), in_neck = funnel_.volume_below(exit_);
  const double thinnest = thinnest_layer * funnel_.height;
  // What has passed the exit, and what is still on its way down the neck: when it leaves, and how much it is.
  std::vector<std::pair<double, double>> falling;
  constexpr int slices = 50;
  for (int i = 0; i < slices && exit_ > 0.0; ++i)
    falling.emplace_back(std::sqrt(2.0 * (i + 0.5) / slices * exit_ / gravity_), in_neck / slices);
  const auto landing = [&](double time, double speed) {
    return time + (std::sqrt(speed * speed + 2.0 * gravity_ * exit_) - speed) / gravity_;
  };

  std::vector<State> states;
  double time = 0.0, flow = 0.0, surface = funnel_.height, suction = 0.0;
  const auto record = [&](double at) {
    double gone = neck_ == Neck::seals ? whole - funnel_.volume_below(surface) : 0.0;
    for (const auto& [when, volume] : falling)
      if (when <= at) gone += volume;
    states.push_back({at, surface, std::min(1.0, gone / whole), suction});
  };
  record(0.0);
  for (int row = 1; row * interval <= end * (1.0 + 1e-12); ++row) {
    const double until = row * interval;
    const int steps = static_cast<int>(std::ceil(interval / largest_step));
    const double step = interval / steps;
    for (int i = 0; i < steps && surface - exit_ > thinnest; ++i) {
      const double first = acceleration(surface, flow);
      suction = -pressure(surface, flow, first).lowest_pressure;
      const double moved = surface - step * flow / funnel_.area(surface);
      const double second = moved - exit_ > thinnest ? acceleration(moved, flow + step * first) : first;
      const double before = flow;
      flow = std::max(0.0, flow + 0.5 * step * (first + second));
      const double passed = 0.5 * step * (before + flow);
      surface = std::max(exit_, surface - passed / funnel_.area(0.5 * (surface + moved)));
      time += step;
      if (neck_ == Neck::lets_go) falling.emplace_back(landing(time, flow / funnel_.area(exit_)), passed);
      if (surface - exit_ <= thinnest && neck_ == Neck::lets_go)
        falling.emplace_back(landing(time, flow / funnel_.area(exit_)),
                             funnel_.volume_below(surface) - in_neck);
    }
    if (surface - exit_ <= thinnest && neck_ == Neck::seals) surface = exit_;
    time = until;
    record(until);
    if (states.back().discharged > 1.0 - 1e-9) break;
  }
  return states;
}

}  // namespace flowrest::compare::exact
