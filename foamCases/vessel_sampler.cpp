#include "foamCases/vessel_sampler.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "foamCases/vessel.h"
#include "runs/gauges.h"

namespace flowrest::foam {

VesselSampler::VesselSampler(const scenes::Scene& scene, std::vector<MeshCell> cells, CaseFields fields,
                             runs::RunWriter& writer, bool plug_in)
    : Sampler(scene, std::move(fields), writer, plug_in),
      runs_out_(scenes::pieces_of(scene).runs_out),
      gauge_(scene, std::move(cells)),
      conservation_(scene, initial_volume(scene)) {}

void VesselSampler::sample(double time, const ReadField& read) {
  VesselFields fields{read("alpha.concrete", 1), read("U", 3), {}, {}};
  if (plug_in() && time > 0.0) fields.shear_rate = read("shearRate", 1);
  if (thixotropic()) {
    const auto lambda = flocculation(time, read);
    flocculation_ = gauge_.mean_over_concrete(fields.fraction, lambda);
    fields.structure = structure(time, lambda);
  }
  now_ = gauge_.measure(fields);
  conservation_.add(time, now_.volume, now_.kinetic_energy);
  if (history_is_due(time)) write_history(time);
  if (profile_is_due(time)) writer().profile(time, now_.place, now_.depth);
}

double VesselSampler::discharged() const { return 1.0 - now_.over_outlet / conservation_.first_volume(); }

void VesselSampler::write_history(double time) {
  using namespace runs::column;
  runs::Row row;
  row.add(runs::column::time, time);
  if (runs_out_) {
    row.add(runs::column::discharged, discharged()).add(thinnest_sight, now_.thinnest_over_outlet);
  } else {
    row.add(front, now_.front)
        .add(front_of_mass, now_.front_mass_995)
        .add(end_height, now_.end_height)
        .add(start_height, now_.start_height);
  }
  row.add(volume, now_.volume)
      .add(kinetic_energy, now_.kinetic_energy)
      .add(potential_energy, now_.potential_energy);
  if (plug_in()) row.add(shear_rate, now_.shear_rate_p99);
  row.add(base_shear_rate, now_.base_shear_rate_p99)
      .add(resolution_until(time, now_.layer.layer()))
      .add(steps_until(time))
      .add(volume_error, conservation_.error());
  if (thixotropic()) row.add(structure_columns(time, flocculation_));
  writer().history(row);
}

std::string VesselSampler::progress() const {
  return runs_out_ ? fmt::format("discharged {:.1f} %", 100.0 * discharged())
                   : runs::shown_length("front", now_.front, scene().gauges.front_depth);
}

void VesselSampler::continue_from(const runs::Table& history) {
  Sampler::continue_from(history);
  if (history.rows() == 0) return;
  conservation_.continue_from(history);
  if (runs_out_) {
    now_.over_outlet = conservation_.first_volume() * (1.0 - history.at("discharged_fraction").back());
    now_.thinnest_over_outlet = 1e-3 * history.at("thinnest_sight_mm").back();
  } else {
    now_.front = 1e-3 * history.at("front_mm").back();
    now_.end_height = 1e-3 * history.at("end_height_mm").back();
    now_.start_height = 1e-3 * history.at("start_height_mm").back();
  }
}

nlohmann::ordered_json VesselSampler::summary() const {
  nlohmann::ordered_json gauges;
  if (runs_out_) {
    gauges = {{"discharged_fraction", discharged()}, {"thinnest_sight_mm", 1e3 * now_.thinnest_over_outlet}};
  } else {
    gauges = {{"front_mm", 1e3 * now_.front},
              {"end_height_mm", 1e3 * now_.end_height},
              {"start_height_mm", 1e3 * now_.start_height},
              {"volume_error", conservation_.largest_error()}};
  }
  gauges["initial_volume_error"] = conservation_.initial_error();
  return gauges;
}

}  // namespace flowrest::foam
