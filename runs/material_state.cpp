#include "runs/material_state.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <tuple>
#include <variant>

#include "runs/errors.h"
#include "scenes/pieces.h"

namespace flowrest::runs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// By what share a state's volume may differ from that of the scene's body.
constexpr double volume_allowed = 1e-3;

[[noreturn]] void refuse(const MaterialState& state, const std::string& what) {
  throw RunError(fmt::format("--from {}: {}", state.from, what));
}

double volume_of_body(const scenes::Scene& scene) {
  const scenes::Pieces pieces = scenes::pieces_of(scene);
  double volume = 0.0;
  for (const auto& body : pieces.bodies) volume += body.volume;
  return pieces.whole_over_computed * volume;
}

/// What no state can be handed to.
void check_apparatus(const scenes::Scene& scene, const MaterialState& state) {
  const std::string kind = scenes::name_of(scene.geometry.apparatus);
  if (!can_be_handed_over(scene))
    refuse(state, fmt::format("the scene {} is a {}; allowed: what stands freely on a plate, as a slump does",
                              scene.name, kind));
  const auto dimension = scene.geometry.dimension;
  if (dimension != scenes::Dimension::axisymmetric && dimension != scenes::Dimension::plane &&
      dimension != scenes::Dimension::quarter)
    refuse(state, fmt::format("geometry.dimension is {}; allowed: axisymmetric, plane, quarter",
                              scenes::to_string(dimension)));
  if (state.kind != kind)
    refuse(state,
           fmt::format("it is the state of a {}, and the scene {} is a {}; allowed: the same apparatus",
                       state.kind, scene.name, kind));
  if (state.dimension != scene.geometry.dimension)
    refuse(state,
           fmt::format("it was computed as {}, and geometry.dimension is {} here; allowed: the same",
                       scenes::to_string(state.dimension), scenes::to_string(scene.geometry.dimension)));
}

void check_body(const scenes::Scene& scene, const MaterialState& state) {
  if (std::abs(state.density - scene.material.density) > 1e-9 * scene.material.density)
    refuse(state,
           fmt::format("its density is {:g} kg/m3, and material.density is {:g} here; allowed: the same",
                       state.density, scene.material.density));
  const double body = volume_of_body(scene), held = state.volume();
  if (!(std::abs(held - body) <= volume_allowed * body))
    refuse(state,
           fmt::format("it holds {:.6g} m3 of material, and the scene's body {:.6g} m3; allowed: the same "
                       "within {:g} %",
                       held, body, 100.0 * volume_allowed));
}

void check_extent(const scenes::Scene& scene, const MaterialState& state) {
  const auto domain = scenes::pieces_of(scene).domain;
  if (!domain) return;
  double reach = 0.0, height = 0.0;
  for (const Parcel& parcel : state.parcels) {
    reach = std::max(reach, std::hypot(parcel.high[0], parcel.high[1]));
    height = std::max(height, parcel.high[2]);
  }
  for (const auto& [name, there, here] : {std::tuple{"geometry.domain_radius", reach, domain->radius},
                                          std::tuple{"geometry.domain_height", height, domain->height}})
    if (there > here)
      refuse(state, fmt::format("its material reaches {:.4g} m, and {} is {:g} m; allowed: more than that",
                                there, name, here));
}

}  // namespace

double DepthColumns::area(Plan plan, double west, double east, double south, double north) {
  switch (plan) {
    case Plan::rings:
      return std::numbers::pi * (east - west) * (east + west);
    case Plan::strips:
      return 2.0 * (east - west);
    case Plan::squares:
      return 4.0 * (east - west) * (north - south);
  }
  return 0.0;
}

double MaterialState::volume() const {
  double sum = 0.0;
  for (const Parcel& parcel : parcels) sum += parcel.volume;
  return sum;
}

std::array<double, 3> MaterialState::momentum() const {
  std::array<double, 3> sum{};
  for (const Parcel& parcel : parcels)
    for (std::size_t a = 0; a < 3; ++a) sum[a] += density * parcel.volume * parcel.velocity[a];
  return sum;
}

double MaterialState::flocculation() const {
  double sum = 0.0;
  for (const Parcel& parcel : parcels) sum += parcel.volume * parcel.flocculation;
  return sum / volume();
}

StateName state_name(const std::string& from) {
  const auto at = from.rfind('@');
  if (at == std::string::npos) return {from, std::nullopt};
  const std::string text = from.substr(at + 1);
  double time = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  if (error != std::errc{} || end != text.data() + text.size() || !(time >= 0.0) || !std::isfinite(time) ||
      at == 0)
    throw RunError(
        fmt::format("--from {}: '{}' is no time; allowed: RUN@5.0, a run and seconds from 0, or RUN for "
                    "its latest state",
                    from, text));
  return {from.substr(0, at), time};
}

bool can_be_handed_over(const scenes::Scene& scene) {
  const scenes::Pieces pieces = scenes::pieces_of(scene);
  return std::holds_alternative<scenes::SpreadGauge>(pieces.gauged) && pieces.feeds.empty();
}

std::string settled_name(const std::string& from) {
  const StateName name = state_name(from);
  std::error_code error;
  std::string run = name.run;
  if (fs::exists(run, error)) {
    fs::path path = fs::weakly_canonical(run, error);
    run = (path.has_filename() ? path : path.parent_path()).string();
  }
  return name.time ? fmt::format("{}@{}", run, *name.time) : run;
}

std::size_t recorded_time(const StateName& name, const std::vector<double>& times, double tolerance) {
  if (times.empty())
    throw RunError(fmt::format("--from {}: it has recorded no state; allowed: a run that has", name.run));
  if (!name.time) return times.size() - 1;
  const auto nearest = std::min_element(times.begin(), times.end(), [&](double a, double b) {
    return std::abs(a - *name.time) < std::abs(b - *name.time);
  });
  if (std::abs(*nearest - *name.time) <= tolerance) return static_cast<std::size_t>(nearest - times.begin());
  // A long run has many.
  constexpr std::size_t most = 12;
  std::vector<std::string> words;
  for (std::size_t i = 0; i < times.size(); ++i)
    if (times.size() <= most || i < most / 2 || i >= times.size() - most / 2)
      words.push_back(fmt::format("{:g}", times[i]));
    else if (words.back() != "...")
      words.push_back("...");
  throw RunError(fmt::format("--from {}@{:g}: it has recorded no state then; allowed: {} s", name.run,
                             *name.time, fmt::join(words, ", ")));
}

void check_start(const scenes::Scene& scene, const MaterialState& state) {
  check_apparatus(scene, state);
  check_body(scene, state);
  check_extent(scene, state);
  if (scene.time.end <= state.time)
    refuse(state, fmt::format("it is the state at {:g} s, and time.end is {:g} s; allowed: a later end",
                              state.time, scene.time.end));
  if (scene.thixotropy && !state.flocculates)
    refuse(state,
           "the scene is thixotropic, and it does not say how far its material has flocculated; allowed: the "
           "state of a thixotropic run");
}

Json started_from_json(const MaterialState& state) {
  return {{"from", settled_name(state.from)},
          {"run", state.run},
          {"solver", state.solver},
          {"model", state.model},
          {"time_s", state.time},
          {"volume_m3", state.volume()}};
}

std::string started_from(const Json& info) {
  const auto found = info.find(started_from_key);
  if (found == info.end() || !found->is_object()) return "";
  return found->value("from", "");
}

}  // namespace flowrest::runs
