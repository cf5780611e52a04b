#include "foamCases/conservation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scenes/pieces.h"

namespace flowrest::foam {

namespace {

constexpr double volume_bound = 0.1;  // relative, beyond which the flow diverges

/// What the concrete gives where all of it falls by its height, J; without gravity nothing bounds it here.
double energy_of_the_fall(const scenes::Scene& scene, double volume) {
  const double weight = scene.material.density * scene.forces.gravity * volume;
  return weight > 0.0 ? weight * scene.body_height() : std::numeric_limits<double>::infinity();
}

}  // namespace

double initial_volume(const scenes::Scene& scene) {
  const auto pieces = scenes::pieces_of(scene);
  double volume = 0.0;
  for (const auto& body : pieces.bodies) volume += body.volume;
  return pieces.whole_over_computed * volume;
}

Conservation::Conservation(const scenes::Scene& scene, double volume)
    : may_leave_(scenes::pieces_of(scene).runs_out),
      scene_volume_(volume),
      energy_bound_(energy_of_the_fall(scene, volume)) {}

void Conservation::add(double time, double volume, double kinetic_energy) {
  if (!std::exchange(has_begun_, true)) first_volume_ = volume;
  time_ = time;
  volume_ = volume;
  kinetic_energy_ = kinetic_energy;
  note_error(time, error());
}

void Conservation::continue_from(const runs::Table& history) {
  if (history.rows() == 0) return;
  const auto& times = history.at("time_s");
  const auto& errors = history.at("volume_error");
  for (std::size_t row = 0; row < times.size(); ++row) note_error(times[row], errors[row]);
  has_begun_ = true;
  first_volume_ = history.at("volume_m3").front();
  volume_ = history.at("volume_m3").back();
  kinetic_energy_ = history.at("kinetic_energy_J").back();
  time_ = times.back();
}

double Conservation::error() const { return may_leave_ ? 0.0 : volume_ / first_volume_ - 1.0; }

void Conservation::note_error(double time, double error) {
  if (std::isnan(largest_error_)) return;
  if (largest_error_ <= volume_allowed) doubted_since_ = time;
  if (!(std::abs(error) <= largest_error_)) largest_error_ = std::abs(error);  // also where it is no number
}

std::string Conservation::fault() const {
  const double gained = may_leave_ ? std::max(0.0, volume_ / first_volume_ - 1.0) : largest_error_;
  if (!(gained < volume_bound))
    return fmt::format("the volume of concrete is off by {:.0f} % at {:.4g} s: the flow diverges",
                       100.0 * gained, time_);
  if (!(kinetic_energy_ < energy_bound_))
    return fmt::format(
        "the concrete moves with {:.3g} J at {:.4g} s, and all its weight can give is {:.3g} J: the flow "
        "diverges",
        kinetic_energy_, time_, energy_bound_);
  return "";
}

std::string Conservation::doubt() const {
  if (!(largest_error_ > volume_allowed)) return "";
  return fmt::format("the volume of concrete is off by {:.2g} % since {:.3g} s, where {:g} % are allowed",
                     100.0 * largest_error_, doubted_since_, 100.0 * volume_allowed);
}

}  // namespace flowrest::foam
