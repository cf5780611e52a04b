#include "foamCases/slump_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "runs/depth.h"
#include "runs/gauges.h"
#include "scenes/pieces.h"

namespace flowrest::foam {

SlumpSampler::SlumpSampler(const scenes::Scene& scene, CaseFields fields, runs::RunWriter& writer,
                           bool plug_in, bool shear_rates)
    : Sampler(scene, std::move(fields), writer, plug_in),
      mesh_(slump_mesh(scene)),
      conservation_(scene, initial_volume(scene)),
      shear_rates_(shear_rates) {}

void SlumpSampler::sample(double time, const ReadField& read) {
  SlumpFields fields{read("alpha.concrete", 1), read("U", 3)};
  if (shear_rates_ && is_solved(time)) fields.shear_rate = read("shearRate", 1);
  if (thixotropic()) {
    const auto lambda = flocculation(time, read);
    state_.flocculation = mesh_->mean_over_concrete(fields.fraction, lambda);
    fields.structure = structure(time, lambda);
    fields.flow_index = scene().material.flow_index;
  }
  const auto gauges = mesh_->gauge(fields, scene().material.density, scene().base.law == scenes::Wall::slip);
  conservation_.add(time, gauges.volume, gauges.kinetic_energy);
  state_.time = time;
  const double spread_depth = scene().gauges.spread_depth;
  state_.spread = runs::spread(gauges.profile(), spread_depth);
  state_.front = gauges.front;
  state_.height = runs::centre_depth(gauges.profile(), spread_depth);
  state_.rim_depth = gauges.rim_depth;
  state_.overstressing_rate = gauges.overstressing_rate_p99;
  state_.trapped_air = gauges.trapped_air;
  state_.most_trapped_air = std::max(state_.most_trapped_air, gauges.trapped_air);
  if (history_is_due(time)) write_history(time, gauges);
  if (profile_is_due(time)) writer().profile(time, gauges.radius, gauges.depth);
}

void SlumpSampler::write_history(double time, const SlumpGauges& gauges) {
  using namespace runs::column;
  runs::Row row;
  row.add(runs::column::time, time)
      .add(runs::spread_columns(gauges.profile(), scene().gauges))
      .add(front, gauges.front)
      .add(height, state_.height)
      .add(volume, gauges.volume)
      .add(kinetic_energy, gauges.kinetic_energy)
      .add(runs::column::shear_rate, gauges.shear_rate_p99)
      .add(base_shear_rate, gauges.base_shear_rate_p99)
      .add(resolution_until(time, gauges.layer.layer()))
      .add(steps_until(time))
      .add(trapped_air, gauges.trapped_air)
      .add(volume_error, conservation_.error());
  if (thixotropic()) row.add(structure_columns(time, state_.flocculation));
  writer().history(row);
}

std::string SlumpSampler::progress() const {
  return runs::shown_length("spread", state_.spread, scene().gauges.spread_depth);
}

std::string SlumpSampler::fault() const {
  if (state_.rim_depth > scene().gauges.spread_depth)
    return fmt::format(
        "the concrete reached the rim of the mesh at {:.4g} s: geometry.domain_radius = {:g} m must be "
        "larger",
        state_.time, scenes::pieces_of(scene()).domain->radius);
  return conservation_.fault();
}

void SlumpSampler::continue_from(const runs::Table& history) {
  Sampler::continue_from(history);
  if (history.rows() == 0) return;
  conservation_.continue_from(history);
  for (const double air : history.at("trapped_air_m3"))
    state_.most_trapped_air = std::max(state_.most_trapped_air, air);
  state_.trapped_air = history.at("trapped_air_m3").back();
  state_.time = time();
  state_.spread = 1e-3 * history.at("spread_mm").back();
  state_.front = 1e-3 * history.at("front_mm").back();
  state_.height = 1e-3 * history.at("height_mm").back();
}

nlohmann::ordered_json SlumpSampler::summary() const {
  return {{"spread_mm", 1e3 * state_.spread},
          {"front_mm", 1e3 * state_.front},
          {"height_mm", 1e3 * state_.height},
          {"initial_volume_error", conservation_.initial_error()},
          {"volume_error", conservation_.largest_error()},
          {"trapped_air_m3", state_.trapped_air},
          {"trapped_air_max_m3", state_.most_trapped_air}};
}

}  // namespace flowrest::foam
