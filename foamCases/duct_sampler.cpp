#include "foamCases/duct_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "foamCases/case_filler.h"

namespace flowrest::foam {

DuctSampler::DuctSampler(const scenes::Scene& scene, CaseFields fields, runs::RunWriter& writer, bool plug_in)
    : Sampler(scene, std::move(fields), writer, plug_in), height_(duct_cells(scene)) {
  for (std::size_t i = 0; i < height_.size(); ++i)
    height_[i] = (static_cast<double>(i) + 0.5) * scene.duct().height / static_cast<double>(height_.size());
  std::vector<std::string> columns{"time_s", "plug_velocity_m_s", "mean_velocity_m_s"};
  name_steps(columns);
  if (thixotropic()) columns.push_back("flocculation_mean");
  writer.history_columns(columns);
}

void DuctSampler::sample(double time, const ReadField& read) {
  const auto field = read("U", 3);
  std::vector<double> velocity(cells());
  for (std::size_t i = 0; i < cells(); ++i) velocity[i] = field[3 * i];
  const double spacing = scene().duct().height / static_cast<double>(cells());
  shear_rate_ = 0.0;
  if (scene().base.law != scenes::Wall::slip)
    shear_rate_ = std::max(std::abs(velocity.front()), std::abs(velocity.back())) / (0.5 * spacing);
  for (std::size_t i = 1; i < cells(); ++i)
    shear_rate_ = std::max(shear_rate_, std::abs(velocity[i] - velocity[i - 1]) / spacing);
  const std::size_t middle = cells() / 2;
  plug_velocity_ = cells() < 2 ? velocity.front() : 0.5 * (velocity[middle - 1] + velocity[middle]);
  mean_velocity_ = std::accumulate(velocity.begin(), velocity.end(), 0.0) / static_cast<double>(cells());
  if (history_is_due(time)) {
    std::vector<double> row{time, plug_velocity_, mean_velocity_};
    add_steps(time, row);
    if (thixotropic()) {
      const auto state = flocculation(time, read);
      row.push_back(std::accumulate(state.begin(), state.end(), 0.0) / static_cast<double>(cells()));
    }
    writer().history(row);
  }
  if (profile_is_due(time)) writer().profile(time, height_, velocity);
}

std::string DuctSampler::progress() const { return fmt::format("plug {:.4g} m/s", plug_velocity_); }

nlohmann::ordered_json DuctSampler::summary() const {
  return {{"plug_velocity_m_s", plug_velocity_}, {"mean_velocity_m_s", mean_velocity_}};
}

}  // namespace flowrest::foam
