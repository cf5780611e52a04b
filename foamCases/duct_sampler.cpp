#include "foamCases/duct_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace flowrest::foam {

DuctSampler::DuctSampler(const scenes::Scene& scene, std::size_t cells, CaseFields fields,
                         runs::RunWriter& writer, bool plug_in)
    : Sampler(scene, std::move(fields), writer, plug_in),
      walls_(scenes::pieces_of(scene), 2),
      between_plates_(scene.body_height()),
      height_(cells) {
  for (std::size_t i = 0; i < height_.size(); ++i)
    height_[i] = (static_cast<double>(i) + 0.5) * between_plates_ / static_cast<double>(height_.size());
}

void DuctSampler::sample(double time, const ReadField& read) {
  const auto field = read("U", 3);
  std::vector<double> velocity(cells());
  for (std::size_t i = 0; i < cells(); ++i) velocity[i] = field[3 * i];
  const double spacing = between_plates_ / static_cast<double>(cells());
  const auto lambda = thixotropic() ? flocculation(time, read) : std::vector<double>(cells(), 0.0);
  const auto state = structure(time, lambda);
  overstressing_rate_ = 0.0;
  // The rate over a distance, where the structure of the weaker of what it shears is this.
  const auto shear = [&](double velocity_over, double distance, double weaker) {
    overstressing_rate_ = std::max(
        overstressing_rate_,
        runs::overstressing_rate(std::abs(velocity_over) / distance, weaker, scene().material.flow_index));
  };
  if (scene().base.law != scenes::Wall::slip) {
    shear(velocity.front(), 0.5 * spacing, state.front());
    shear(velocity.back(), 0.5 * spacing, state.back());
  }
  for (std::size_t i = 1; i < cells(); ++i)
    shear(velocity[i] - velocity[i - 1], spacing, std::min(state[i - 1], state[i]));
  const std::size_t middle = cells() / 2;
  plug_velocity_ = cells() < 2 ? velocity.front() : 0.5 * (velocity[middle - 1] + velocity[middle]);
  mean_velocity_ = std::accumulate(velocity.begin(), velocity.end(), 0.0) / static_cast<double>(cells());
  if (history_is_due(time)) {
    runs::Row row;
    row.add(runs::column::time, time)
        .add(runs::column::plug_velocity, plug_velocity_)
        .add(runs::column::mean_velocity, mean_velocity_)
        .add(resolution_until(time, sheared_layer(velocity, spacing)))
        .add(steps_until(time));
    if (thixotropic())
      row.add(structure_columns(
          time, std::accumulate(lambda.begin(), lambda.end(), 0.0) / static_cast<double>(cells())));
    writer().history(row);
  }
  if (profile_is_due(time)) writer().profile(time, height_, velocity);
}

/// Faces between cells have the mean of both, those on the plates none of it. Of a metre square of the
/// plates.
runs::ShearedLayer DuctSampler::sheared_layer(const std::vector<double>& velocity, double spacing) const {
  runs::LayerMeter meter;
  for (std::size_t i = 0; i < cells(); ++i) {
    const double below = i == 0 ? 0.0 : 0.5 * (velocity[i - 1] + velocity[i]);
    const double above = i + 1 == cells() ? 0.0 : 0.5 * (velocity[i] + velocity[i + 1]);
    meter.add({walls_.distance(0.0, 0.0, height_[i]), spacing, spacing, spacing,
               std::abs(above - below) / spacing});
  }
  return meter.layer();
}

std::string DuctSampler::progress() const { return fmt::format("plug {:.4g} m/s", plug_velocity_); }

nlohmann::ordered_json DuctSampler::summary() const {
  return {{"plug_velocity_m_s", plug_velocity_}, {"mean_velocity_m_s", mean_velocity_}};
}

}  // namespace flowrest::foam
