#include "studies/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "compare/input_part.h"
#include "compare/measures/gauges.h"
#include "compare/measures/series.h"
#include "scenes/text.h"

namespace flowrest::studies {

namespace {

/// Columns of histories that say something of the flow.
const std::vector<std::string> columns = {
    "spread_mm",           "spread_1p5_mm",      "spread_6_mm",       "spread_mass_995_mm",
    "height_mm",           "plug_velocity_m_s",  "mean_velocity_m_s", "volume_m3",
    "kinetic_energy_J",    "potential_energy_J", "elastic_energy_J",  "dissipated_energy_J",
    "numerical_energy_J",  "shear_rate_p99_1_s", "flocculation_mean", "front_mm",
    "start_height_mm",     "end_height_mm",      "thinnest_sight_mm", "discharged_fraction",
    "yield_stress_mean_Pa"};
/// Moments, which are of the whole run.
const std::vector<std::string> moments = {"rest_time_s", "arrival_s", "light_s"};
const std::vector<std::string> differences = {"profile_l1", "profile_l2"};

bool is_moment(const std::string& base) {
  return std::find(moments.begin(), moments.end(), base) != moments.end();
}

struct Name {
  std::string base;
  std::optional<double> time;  ///< s
  bool well_formed = true;
};

Name parsed(const std::string& quantity) {
  Name name;
  const auto at = quantity.find('@');
  name.base = quantity.substr(0, at);
  if (at == std::string::npos) return name;
  double time = 0.0;
  const char* const end = quantity.data() + quantity.size();
  const auto [last, error] = std::from_chars(quantity.data() + at + 1, end, time);
  name.well_formed = error == std::errc{} && last == end && std::isfinite(time) && time >= 0.0;
  name.time = time;
  return name;
}

std::vector<std::string> every_name() {
  std::vector<std::string> names = columns;
  for (const auto* more : {&moments, &differences}) names.insert(names.end(), more->begin(), more->end());
  return names;
}

bool came_to_its_end(const runs::Run& run) {
  return run.status() == runs::Status::at_rest || run.status() == runs::Status::end_time;
}

std::optional<double> of_history(const runs::Run& run, const Name& name) {
  if (!run.history.has(name.base) || run.history.rows() == 0) return std::nullopt;
  const auto& time = run.history.at("time_s");
  const auto& value = run.history.at(name.base);
  double result = value.back();
  if (!name.time) {
    if (!came_to_its_end(run)) return std::nullopt;
  } else if (*name.time > time.back() && run.status() != runs::Status::at_rest) {
    return std::nullopt;  // what is at rest stays as it is; nothing else may be carried on
  } else {
    // Between a reading and nothing there is nothing; at a row's own time its neighbours do not count.
    const auto row = std::find(time.begin(), time.end(), *name.time);
    result = row != time.end() ? value[static_cast<std::size_t>(row - time.begin())]
                               : compare::interpolate(time, value, *name.time);
  }
  return std::isfinite(result) ? std::optional(result) : std::nullopt;
}

/// What `flowrest gradient` has left beside the run; nothing where it has not, or where it failed its check.
std::optional<double> of_gradient(const runs::Run& run, const DerivativeName& name) {
  for (const auto& quantity : compare::sound_gradients(run)) {
    if (quantity.value("quantity", "") != name.of && quantity.value("asked_for", "") != name.of) continue;
    for (const auto& derivative : quantity.value("derivatives", nlohmann::json::array())) {
      if (derivative.value("key", "") != name.by) continue;
      const auto& value = derivative[name.elasticity ? "elasticity" : "value"];
      if (value.is_number()) return value.get<double>();
    }
  }
  return std::nullopt;
}

/// The profile in force at a time: the last one not after it, or the run's last.
const runs::Profile* profile_at(const runs::Run& run, const std::optional<double>& time) {
  const runs::Profile* found = nullptr;
  for (const auto& profile : run.profiles)
    if (!time || profile.time <= *time * (1.0 + 1e-9) + 1e-12) found = &profile;
  return found;
}

/// By what runs of this one's apparatus are judged; nothing where it is unknown.
std::optional<scenes::MainGauge> judged_by(const runs::Run& run) {
  const auto* apparatus = scenes::apparatus_named(run.info.at("kind").get<std::string>());
  return apparatus ? std::optional(scenes::main_gauge_of(*apparatus)) : std::nullopt;
}

bool is_radial(const runs::Run& run) {
  if (judged_by(run) != scenes::MainGauge::spread) return false;
  const auto settings = run.info.find("settings");
  if (settings == run.info.end() || !settings->contains("geometry")) return true;
  return (*settings)["geometry"].value("dimension", "axisymmetric") != "plane";
}

/// Reference coordinates count from the middle between plates or from one; both are laid from the middle.
std::vector<double> from_middle(const runs::Run& run, const std::vector<double>& coordinate) {
  if (judged_by(run) != scenes::MainGauge::velocity || coordinate.empty() || coordinate.front() < 0.0)
    return coordinate;
  const auto settings = run.info.find("settings");
  if (settings == run.info.end()) return coordinate;
  const double height = (*settings)["geometry"].value("height", 0.0);
  std::vector<double> shifted;
  for (const double y : coordinate) shifted.push_back(y - 0.5 * height);
  return shifted;
}

std::optional<double> of_profile(const runs::Run& run, const Name& name, const runs::Run& reference) {
  const auto* mine = profile_at(run, name.time);
  const auto* other = profile_at(reference, name.time);
  if (!mine || !other || mine->coordinate.size() < 2 || other->coordinate.size() < 2) return std::nullopt;
  if (!name.time && !came_to_its_end(run)) return std::nullopt;
  const auto own = from_middle(run, mine->coordinate), theirs = from_middle(reference, other->coordinate);
  const double low = std::min(own.front(), theirs.front()), high = std::max(own.back(), theirs.back());
  constexpr int points = 1000;
  std::vector<double> grid, a, b;
  for (int i = 0; i <= points; ++i) {
    const double x = low + (high - low) * i / points;
    grid.push_back(x);
    a.push_back(x > own.back() && is_radial(run) ? 0.0 : compare::interpolate(own, mine->value, x));
    b.push_back(x > theirs.back() && is_radial(run) ? 0.0 : compare::interpolate(theirs, other->value, x));
  }
  const auto error = compare::profile_error(grid, a, b, is_radial(run), 0.0);
  return name.base == "profile_l1" ? error.l1_relative : error.l2_relative;
}

}  // namespace

std::optional<DerivativeName> derivative_named(const std::string& quantity) {
  for (const bool elasticity : {false, true}) {
    const std::string begin = elasticity ? "elasticity(" : "derivative(";
    if (!quantity.starts_with(begin) || !quantity.ends_with(")")) continue;
    const std::string inside = quantity.substr(begin.size(), quantity.size() - begin.size() - 1);
    const auto comma = inside.find(',');
    if (comma == std::string::npos) return std::nullopt;
    const auto key = inside.find_first_not_of(' ', comma + 1);
    if (comma == 0 || key == std::string::npos) return std::nullopt;
    return DerivativeName{elasticity, inside.substr(0, comma), inside.substr(key)};
  }
  return std::nullopt;
}

std::string complaint_about(const std::string& quantity) {
  if (derivative_named(quantity)) return {};
  if (quantity.starts_with("derivative(") || quantity.starts_with("elasticity("))
    return fmt::format(
        "{}, which names no quantity and key; allowed: such as elasticity(spread_mm, "
        "material.yield_stress)",
        scenes::quoted(quantity));
  const Name name = parsed(quantity);
  const auto known = every_name();
  if (std::find(known.begin(), known.end(), name.base) == known.end()) {
    const std::string near = scenes::nearest(name.base, known);
    return fmt::format("the unknown quantity {}{}; allowed: {}, each also at a time (spread_mm@1.5)",
                       scenes::quoted(quantity), near.empty() ? "" : ", nearest is " + near,
                       scenes::joined(known));
  }
  if (!name.well_formed)
    return fmt::format("{}, whose time is no number of seconds; allowed: such as spread_mm@1.5",
                       scenes::quoted(quantity));
  if (name.time && is_moment(name.base)) return fmt::format("{0} at a time; allowed: {0} alone", name.base);
  return {};
}

std::vector<std::string> quantity_examples() {
  return {"spread_mm", "height_mm", "rest_time_s", "profile_l1"};
}

bool is_difference(const std::string& quantity) { return parsed(quantity).base.starts_with("profile_"); }

std::string unit_of(const std::string& quantity) {
  if (const auto derivative = derivative_named(quantity))
    return derivative->elasticity ? "% per %" : unit_of(derivative->of) + " per unit of the key";
  const std::string base = parsed(quantity).base;
  const std::vector<std::pair<std::string, std::string>> endings = {
      {"_mm", "mm"}, {"_m_s", "m/s"}, {"_1_s", "1/s"}, {"_m3", "m3"}, {"_J", "J"}, {"_s", "s"}};
  for (const auto& [ending, unit] : endings)
    if (base.ends_with(ending)) return unit;
  return "1";
}

std::optional<double> measure(const runs::Run& run, const std::string& quantity, const runs::Run* reference) {
  if (const auto derivative = derivative_named(quantity)) return of_gradient(run, *derivative);
  const Name name = parsed(quantity);
  if (is_moment(name.base)) return compare::read(run, name.base == "rest_time_s" ? "rest_s" : name.base);
  if (is_difference(quantity)) return reference ? of_profile(run, name, *reference) : std::nullopt;
  return of_history(run, name);
}

}  // namespace flowrest::studies
