#include "foamCases/vessel_sampler.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "foamCases/vessel_mesh.h"
#include "runs/gauges.h"

namespace flowrest::foam {

VesselSampler::VesselSampler(const scenes::Scene& scene, CaseFields fields, runs::RunWriter& writer,
                             bool plug_in)
    : Sampler(scene, std::move(fields), writer, plug_in),
      gauge_(scene),
      conservation_(scene, initial_volume(scene)) {
  std::vector<std::string> columns{"time_s"};
  const auto add = [&](std::initializer_list<std::string> more) { columns.insert(columns.end(), more); };
  if (is_funnel()) {
    add({"discharged_fraction", "thinnest_sight_mm"});
  } else {
    add({"front_mm", "front_mass_995_mm", "end_height_mm", "start_height_mm"});
  }
  add({"volume_m3", "kinetic_energy_J", "potential_energy_J"});
  if (plug_in) add({"shear_rate_p99_1_s"});
  add({"base_shear_rate_p99_1_s"});
  name_steps(columns);
  add({"volume_error"});
  if (thixotropic()) add({"flocculation_mean"});
  writer.history_columns(columns);
}

void VesselSampler::sample(double time, const ReadField& read) {
  VesselFields fields{read("alpha.concrete", 1), read("U", 3), {}};
  if (plug_in() && time > 0.0) fields.shear_rate = read("shearRate", 1);
  if (thixotropic()) flocculation_ = gauge_.mean_over_concrete(fields.fraction, flocculation(time, read));
  now_ = gauge_.measure(fields);
  conservation_.add(time, now_.volume, now_.kinetic_energy);
  if (history_is_due(time)) write_history(time);
  if (profile_is_due(time)) writer().profile(time, now_.place, now_.depth);
}

double VesselSampler::discharged() const { return 1.0 - now_.over_outlet / conservation_.first_volume(); }

double VesselSampler::shear_rate() const {
  return gauge_.floor_holds() ? std::fmax(now_.shear_rate_p99, now_.base_shear_rate_p99)
                              : now_.shear_rate_p99;
}

void VesselSampler::write_history(double time) {
  std::vector<double> row{time};
  const auto add = [&](std::initializer_list<double> more) { row.insert(row.end(), more); };
  if (is_funnel()) {
    add({discharged(), 1e3 * now_.thinnest_over_outlet});
  } else {
    add({1e3 * now_.front, 1e3 * now_.front_mass_995, 1e3 * now_.end_height, 1e3 * now_.start_height});
  }
  add({now_.volume, now_.kinetic_energy, now_.potential_energy});
  if (plug_in()) add({now_.shear_rate_p99});
  add({now_.base_shear_rate_p99});
  add_steps(time, row);
  add({conservation_.error()});
  if (thixotropic()) add({flocculation_});
  writer().history(row);
}

std::string VesselSampler::progress() const {
  return is_funnel() ? fmt::format("discharged {:.1f} %", 100.0 * discharged())
                     : runs::shown_length("front", now_.front, scene().gauges.front_depth);
}

void VesselSampler::continue_from(const runs::Table& history) {
  Sampler::continue_from(history);
  if (history.rows() == 0) return;
  conservation_.continue_from(history);
  if (is_funnel()) {
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
  if (is_funnel()) {
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
