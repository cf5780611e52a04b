#include "compare/square.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/apparatus/apparatus.h"
#include "compare/measures/run_measures.h"
#include "compare/run_view.h"
#include "runs/depth.h"

namespace flowrest::compare {

namespace {

/// Over which a run's scatter is taken, as a share of the time over which growth is: short, for a collapse is
/// no straight line.
constexpr double scatter_over_rate_window = 0.25;

/// The first run of a solver and model that has a gauge.
std::optional<std::size_t> corner(const Comparison& comparison, const std::string& solver,
                                  const std::string& model) {
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    if (view.solver == solver && view.model == model && !view.gauge.empty()) return i;
  }
  return std::nullopt;
}

/// The fluid that most corners are filled with.
std::string common_fluid(const Comparison& comparison) {
  std::string best;
  int most = 0;
  for (const laws::Law law : laws::every_law) {
    if (!laws::creeps(law)) continue;
    const std::string model = laws::name_of(law);
    const int filled =
        corner(comparison, "mpm", model).has_value() + corner(comparison, "foam", model).has_value();
    if (filled > most) {
      best = model;
      most = filled;
    }
  }
  return best;
}

/// What a reading of the gauge at one time is good to: scatter about its trend, and half the change between
/// two ways to read the edge.
double noise_of(const Comparison& comparison, const RunView& view, double time) {
  double noise = 0.0;
  const double half = 0.5 * scatter_over_rate_window * comparison.thresholds.rate_window;
  if (time < view.gauge.end())
    if (const auto line = trend(view.gauge, time - half, time + half)) noise = line->scatter;
  if (!comparison.apparatus->spreads()) return noise;
  const Series thin = column(view.run, "spread_1p5_mm", 1e-3), thick = column(view.run, "spread_6_mm", 1e-3);
  if (thin.empty() || thick.empty()) return noise;
  const double sensitivity = thin.at(time) - thick.at(time);
  return ends_in_film(comparison, sensitivity) ? std::hypot(noise, 0.5 * sensitivity) : noise;
}

std::optional<Square::At> split(const Comparison& comparison, const Square& square, double time) {
  const auto gauge = [&](const std::optional<std::size_t>& run) {
    return comparison.runs[*run].gauge_at(time);
  };
  const auto mpm_solid = gauge(square.mpm_solid), mpm_fluid = gauge(square.mpm_fluid),
             foam_solid = gauge(square.foam_solid), foam_fluid = gauge(square.foam_fluid);
  if (!mpm_solid || !mpm_fluid || !foam_solid || !foam_fluid) return std::nullopt;
  Square::At at{.time = time};
  at.total = *foam_fluid - *mpm_solid;
  at.law = 0.5 * ((*mpm_fluid - *mpm_solid) + (*foam_fluid - *foam_solid));
  at.discretisation = 0.5 * ((*foam_solid - *mpm_solid) + (*foam_fluid - *mpm_fluid));
  at.interaction = 0.5 * ((*foam_fluid - *foam_solid) - (*mpm_fluid - *mpm_solid));
  for (const auto& run : {square.mpm_solid, square.mpm_fluid, square.foam_solid, square.foam_fluid})
    at.noise = std::hypot(at.noise, noise_of(comparison, comparison.runs[*run], time));
  return at;
}

}  // namespace

void fill_square(Comparison& comparison) {
  Square square;
  square.fluid = common_fluid(comparison);
  if (square.fluid.empty()) return;
  const std::string solid = laws::name_of(laws::Law::elasto_viscoplastic);
  const std::pair<std::optional<std::size_t> Square::*, std::pair<const char*, std::string>> corners[] = {
      {&Square::mpm_solid, {"mpm", solid}},
      {&Square::mpm_fluid, {"mpm", square.fluid}},
      {&Square::foam_solid, {"foam", solid}},
      {&Square::foam_fluid, {"foam", square.fluid}}};
  int filled = 0;
  for (const auto& [member, made_by] : corners) {
    square.*member = corner(comparison, made_by.first, made_by.second);
    filled += (square.*member).has_value();
    if (square.*member) continue;
    if (const auto command = command_for(comparison, made_by.first, made_by.second))
      square.missing.push_back(*command);
  }
  if (filled < 2) return;
  // Where the scene names no run in OpenFOAM there is no square to want.
  const nlohmann::ordered_json::json_pointer named("/settings/runs/foam");
  const auto& info = comparison.runs.front().run.info;
  if (!square.foam_solid && !square.foam_fluid && info.contains(named) && info.at(named).empty()) return;
  if (filled == 4)
    for (const double time : comparison.frames)
      if (const auto at = split(comparison, square, time)) square.at.push_back(*at);
  comparison.square = std::move(square);
}

}  // namespace flowrest::compare
