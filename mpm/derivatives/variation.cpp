#include "mpm/derivatives/variation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/plain/inputs.h"
#include "mpm/sampling/sampling.h"
#include "mpm/solver/settings.h"

namespace flowrest::mpm::derivatives {

namespace {

constexpr double relative_step = 1e-3;

std::vector<Seed> seeds_of_start(const scenes::Scene& scene, Feeds feeds) {
  return feeds.any() ? feeds.due(0.0, first_feed_step) : seed_particles(scene);
}

/// What the law reads of the settings' numbers.
std::vector<double> numbers_of(const SolverSettings& settings) {
  auto inputs = plain::inputs_of<double>(settings);
  for (const laws::Parameter parameter : laws::every_parameter)
    if (!laws::needs(settings.law, parameter))
      inputs.material.parameters.*laws::member_of<double>(parameter) = 0.0;
  return plain::numbers_of(inputs);
}

/// What moves where nodes or walls stand, in words; empty where nothing does.
std::string moved_part(const Variation& a, const Variation& b) {
  const SolverSettings &s = a.settings, &t = b.settings;
  if (s.cell != t.cell) return "the cells' size";
  for (std::size_t i = 0; i < 3; ++i)
    if (s.bounds[i].lower_cell != t.bounds[i].lower_cell ||
        s.bounds[i].upper_cell != t.bounds[i].upper_cell || s.bounds[i].lower != t.bounds[i].lower ||
        s.bounds[i].upper != t.bounds[i].upper)
      return "where walls stand";
  if (s.walls.size() != t.walls.size()) return "how many walls there are";
  const double end = a.scene.time.end;
  for (std::size_t w = 0; w < s.walls.size(); ++w)
    for (const double time : {0.0, 0.1 * end, 0.5 * end, end}) {
      const Vector place = {0.11 * end, 0.07 * end, 0.13 * end};
      if (s.walls[w].stands(time) != t.walls[w].stands(time) ||
          s.walls[w].motion.displacement(time) != t.walls[w].motion.displacement(time) ||
          s.walls[w].distance(place, 0.0) != t.walls[w].distance(place, 0.0))
        return "where walls stand";
    }
  if (a.seeds.size() != b.seeds.size()) return "how many particles there are";
  if (s.nozzles.size() != t.nozzles.size()) return "how many nozzles there are";
  return "";
}

/// Whether nothing that the solver takes differs.
bool is_same(const Variation& a, const Variation& b) {
  if (numbers_of(a.settings) != numbers_of(b.settings)) return false;
  const double end = a.scene.time.end;
  for (int i = 0; i <= 64; ++i) {
    const double time = end * i / 64.0;
    if (acceleration_at(a.scene, time) != acceleration_at(b.scene, time)) return false;
    for (std::size_t n = 0; n < a.settings.nozzles.size(); ++n)
      if (a.settings.nozzles[n].mouth(time) != b.settings.nozzles[n].mouth(time) ||
          a.settings.nozzles[n].extruded(time) != b.settings.nozzles[n].extruded(time))
        return false;
  }
  for (std::size_t i = 0; i < a.seeds.size(); ++i) {
    const Seed &x = a.seeds[i], &y = b.seeds[i];
    if (x.cell != y.cell || x.position != y.position || x.volume != y.volume || x.velocity != y.velocity ||
        x.flocculation != y.flocculation || x.volume_ratio != y.volume_ratio || x.deviator != y.deviator)
      return false;
  }
  return true;
}

}  // namespace

Variation::Variation(const scenes::Scene& of)
    : scene(of),
      pieces(scenes::pieces_of(scene)),
      settings(settings_of(scene)),
      feeds(settings, scene.mpm.particles_per_cell.back(), pieces.whole_over_computed > 1.0,
            scene.thixotropy ? scene.thixotropy->initial_flocculation : 0.0),
      seeds(seeds_of_start(scene, feeds)) {}

std::array<double, 2> Variation::station(double time, const std::optional<double>& place) const {
  const auto* gauge = std::get_if<scenes::SectionGauge>(&pieces.gauged);
  std::array<double, 2> between{};
  if (!gauge) return between;
  for (const scenes::Feed& feed : pieces.feeds) {
    if (time <= feed.begins_at) continue;
    const double until = std::min(time, feed.gone_at);
    const double begin = feed.mouth(feed.begins_at)[0], axis = feed.mouth(until)[0];
    if (place) {
      const double middle = axis > begin ? begin + *place : begin - *place;
      return {middle - settings.cell, middle + settings.cell};
    }
    if (std::abs(axis - begin) < gauge->behind + gauge->length) continue;
    const double way = axis > begin ? 1.0 : -1.0;
    const double near = axis - way * gauge->behind, far = near - way * gauge->length;
    between = {std::min(near, far), std::max(near, far)};
  }
  return between;
}

std::vector<double> Variation::nozzle(std::size_t number, double time, double step) const {
  const Nozzle& own = settings.nozzles[number];
  const Vector mouth = own.mouth(time), next = own.mouth(time + step);
  return {mouth[0],
          mouth[1],
          mouth[2],
          next[0],
          next[1],
          next[2],
          own.extruded(time + step) - own.extruded(time)};
}

std::vector<double> Variation::acceleration(double time) const {
  const auto a = acceleration_at(scene, time);
  return {a.begin(), a.end()};
}

Variations::Variations(const std::vector<std::string>& names, const std::vector<double>& values,
                       const SceneAt& scene_at)
    : values_(values), scene_at_(scene_at), centre_(std::make_unique<Variation>(scene_at(values))) {
  constexpr double steps[] = {-1.0, 1.0, -2.0, 2.0};
  for (std::size_t k = 0; k < values.size(); ++k) {
    Difference d;
    if (values[k] == 0.0)
      throw scenes::SceneError(
          fmt::format("{}: {} is 0, where a derivative is one to one side alone; allowed: a key with a value "
                      "other than 0",
                      centre_->scene.path.string(), names[k]));
    d.step = relative_step * std::abs(values[k]);
    for (std::size_t i = 0; i < 4; ++i) {
      std::vector<double> at = values;
      at[k] += steps[i] * d.step;
      d.at[i] = std::make_unique<Variation>(scene_at(at));
    }
    check_goes_through(names[k], d);
    about_.push_back(std::move(d));
  }
}

void Variations::check_goes_through(const std::string& name, const Difference& d) const {
  for (const auto& at : d.at)
    if (const std::string part = moved_part(*centre_, *at); !part.empty())
      throw scenes::SceneError(
          fmt::format("{}: {} changes {}, through which no derivative goes; allowed: keys of [material], "
                      "[thixotropy], [forces], friction of [walls], and speeds of [process]",
                      centre_->scene.path.string(), name, part));
  if (is_same(*d.at[0], *d.at[1]))
    throw scenes::SceneError(fmt::format("{}: {} has no effect on this run; allowed: a key that has",
                                         centre_->scene.path.string(), name));
}

std::unique_ptr<Variation> Variations::moved(const std::vector<double>& values) const {
  return std::make_unique<Variation>(scene_at_(values));
}

}  // namespace flowrest::mpm::derivatives
