#include "compare/apparatus/slump.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "compare/apparatus/arrested_slump.h"
#include "compare/exact/film.h"
#include "compare/exact/solution_run.h"
#include "compare/findings.h"
#include "compare/measures/run_measures.h"
#include "compare/run_view.h"
#include "runs/depth.h"
#include "runs/gauges.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;
using exact::Bingham;
using exact::ExactRun;
using exact::refuse;
using report::Format;
using report::Table;
using scenes::Scene;

namespace {

/// A slump of yield-stress material about its axis.
struct SlumpFacts {
  exact::Bingham material;
  double gravity = 0.0;
  scenes::Slump cone;
};
std::optional<SlumpFacts> slump_facts(const RunView& view) {
  const auto density = setting(view, "/material/density");
  const auto yield_stress = setting(view, "/material/yield_stress");
  const auto viscosity = setting(view, "/material/plastic_viscosity");
  const auto gravity = setting(view, "/forces/gravity");
  const auto top = setting(view, "/geometry/cone_radius_top");
  const auto bottom = setting(view, "/geometry/cone_radius_bottom");
  const auto height = setting(view, "/geometry/cone_height");
  const auto domain = setting(view, "/geometry/domain_radius");
  if (!density || !yield_stress || !viscosity || !gravity || !top || !bottom || !height ||
      !(*yield_stress > 0.0) || !(*gravity > 0.0))
    return std::nullopt;
  if (word(view.run.info, "/settings/geometry/dimension") == "plane") return std::nullopt;
  const double index = setting(view, "/material/flow_index").value_or(1.0);
  return SlumpFacts{{*density, *yield_stress, *viscosity, index},
                    *gravity,
                    scenes::Slump{*height, *top, *bottom, domain.value_or(0.0), 0.0, {}}};
}

std::string fair_runs_of_slumps(const Comparison& comparison) {
  if (std::none_of(comparison.runs.begin(), comparison.runs.end(),
                   [](const RunView& v) { return v.exact; }) &&
      number(comparison.runs.front().run.info, "/settings/geometry/mould_lift_velocity"))
    return fair_runs;
  std::string text =
      "The exact profiles are quasi-static: they are the shapes at which gravity is just held by the yield "
      "stress, reached without inertia. A cone that is let go at once arrives with momentum, which may carry "
      "it past them; how far depends on its viscosity. (For Roussel's benchmark, plastic viscosities of 20, "
      "50 "
      "and 500 Pa s arrested at 557, 554 and 553 mm in one and the same scheme on 10 mm cells; taken to "
      "infinite "
      "viscosity on 5 mm cells, 553 ± 5 mm for a spread whose second-order solution is 562 mm, so that the "
      "profile's next order may be worth 10 mm.) The leading order in height over radius, whose foot lies at "
      "600 mm there, leaves out the extensional stress in the unsheared layer and is too wide; a run that "
      "matches it does so because its errors cancel. So the fair comparisons are: one run with another of "
      "the "
      "same law, which shows the discretisation; one run with another of the same solver, which shows the "
      "law; "
      "and any run with the second-order profile only to within that next order.";
  const bool axisymmetric = comparison.radial;
  return axisymmetric ? text
                      : "The exact profile is quasi-static and of leading order: inertia carries a slump "
                        "that is let go at "
                        "once past it. The fair comparisons are those between runs: the same law in two "
                        "solvers shows the "
                        "discretisation, two laws in the same solver show the law.";
}

runs::Row slump_row(double time, double spread, double height, double volume) {
  return runs::Row()
      .add(runs::column::time, time)
      .add(runs::column::spread, spread)
      .add(runs::column::height, height)
      .add(runs::column::volume, volume);
}

template <class Profile>
ExactRun write_slump(const Scene& scene, const std::filesystem::path& directory, const Profile& profile,
                     double edge, double volume, const std::string& label, const std::string& source,
                     std::optional<double> flocculation, runs::Replace replace) {
  runs::RunWriter writer = exact::open_run(directory, scene, flocculation, replace);
  std::vector<double> coordinate = exact::points_to(edge), depth;
  for (const double r : coordinate) depth.push_back(profile.depth(r));
  const double spread_depth = scene.gauges.spread_depth, spread = profile.spread(spread_depth);
  writer.info()["model"] = "bingham";
  writer.info()["label"] = label;
  writer.info()["source"] = source;
  writer.info()["radius_m"] = edge;
  writer.history(slump_row(scene.time.end, spread, profile.depth(0.0), volume));
  writer.profile(scene.time.end, coordinate, depth);
  writer.finish(runs::Status::at_rest, "the arrested shape, reached without inertia", "sound");
  return {directory, fmt::format("{}: {} at {:g} mm depth ({} at its foot), {}", label,
                                 runs::shown_length("spread", spread, spread_depth), 1000.0 * spread_depth,
                                 runs::millimetres(2.0 * edge, spread_depth),
                                 runs::shown_length("centre", profile.depth(0.0), spread_depth))};
}

std::vector<ExactRun> write_slumps(const Scene& scene, const std::filesystem::path& directory,
                                   std::optional<double> flocculation, runs::Replace replace) {
  const Bingham material = exact::material_of(scene, flocculation);
  const auto& cone = scene.slump();
  exact::check_arrests(scene, material);
  const bool plane_flow = scene.geometry.dimension == scenes::Dimension::plane;
  const double half_area = 0.5 * (cone.cone_radius_top + cone.cone_radius_bottom) * cone.cone_height;
  const auto must_spread = [&](double radius) {
    if (radius < cone.cone_radius_bottom)
      refuse(scene,
             fmt::format(
                 "the slender profile (radius {:.0f} mm) would be narrower than the cone (foot {:.0f} mm)",
                 1000.0 * radius, 1000.0 * cone.cone_radius_bottom));
  };
  if (plane_flow) {
    const auto plane = exact::plane_slump(material, scene.forces.gravity, half_area);
    must_spread(plane.half_width);
    return {write_slump(scene, directory / "leading-order", plane, plane.half_width, 2.0 * half_area,
                        "exact, leading order (plane)", "h^2 = 2 tau0 (X - x)/(rho g)", flocculation,
                        replace)};
  }
  const auto leading = exact::leading_order_slump(material, scene.forces.gravity, cone.volume());
  const auto second = exact::second_order_slump(material, scene.forces.gravity, cone.volume());
  must_spread(leading.radius);
  return {
      write_slump(scene, directory / "leading-order", leading, leading.radius, leading.volume(),
                  "exact, leading order", "Yu et al. 2026, Eq. 51, with h = sqrt(2 tau0 (R - r)/(rho g))",
                  flocculation, replace),
      write_slump(scene, directory / "second-order", second, second.radius, second.volume(),
                  "exact, second order", "h = a + sqrt(a^2 + 2 tau0 (R - r)/(rho g)), a = 1.36 tau0/(rho g)",
                  flocculation, replace)};
}

class SlumpReport : public ApparatusReport {
 public:
  SlumpReport() : ApparatusReport(scenes::Slump{}) {}

  const Gauge& gauge() const override {
    static const Gauge gauge = millimetres("spread", "spread_mm", "wider", "narrower",
                                           "Spread: twice the radius at which the depth falls through "
                                           "{depth:g} mm. A thin dotted tail continues a "
                                           "run that has come to rest.");
    return gauge;
  }
  const std::vector<Gauge>& further_gauges() const override {
    static const Gauge height = millimetres("height in the middle", "height_mm", "higher", "lower",
                                            "The depth on the axis of the slump.");
    static const std::vector<Gauge> all = {height, flocculation()};
    return all;
  }
  const std::vector<Reading>& readings() const override {
    static const std::vector<Reading> all = {reading_named("spread_mm"), reading_named("rest_s")};
    return all;
  }

  std::optional<double> predicted_creep(const RunView& view,
                                        const exact::RegularisedFluid& fluid) const override {
    const auto facts = slump_facts(view);
    if (!facts) return std::nullopt;
    const auto slump = exact::leading_order_slump(facts->material, facts->gravity, facts->cone.volume());
    return exact::spread_creep(fluid, slump.radius, slump.depth(0.5 * slump.radius),
                               view.gauge.empty() ? slump.radius : 0.5 * view.gauge.value.back());
  }
  void measure_approach(Comparison& comparison) const override {
    // Before that, a slump's inertia and its start decide.
    const double unit = comparison.thresholds.time_unit, earliest = 5.0 * unit;
    std::map<std::vector<double>, exact::Approach> known;
    for (RunView& view : comparison.runs) {
      Measures& m = view.measures;
      const bool moves = m.cause == Cause::approaching_rest || m.cause == Cause::within_bound ||
                         m.cause == Cause::unexplained;
      if (view.exact || !moves) continue;
      const auto facts = slump_facts(view);
      const bool film = facts && facts->cone.domain_radius > 0.0 && facts->material.plastic_viscosity > 0.0 &&
                        facts->material.flow_index == 1.0 &&
                        word(view.run.info, "/settings/walls/base") == "no-slip" &&
                        !view.run.info.contains(Json::json_pointer("/settings/thixotropy"));
      if (!film || !m.end || *m.end < earliest) continue;
      const auto& [material, gravity, cone] = *facts;
      const double end = unit * std::round(*m.end / unit);
      const std::vector<double> key = {
          material.density,        material.yield_stress, material.plastic_viscosity, gravity,
          cone.cone_radius_bottom, cone.volume(),         cone.domain_radius,         end,
          view.gauges.spread_depth};
      auto found = known.find(key);
      if (found == known.end())
        found = known
                    .emplace(key, exact::approach_to_rest(material, gravity, cone.cone_radius_bottom,
                                                          cone.volume(), cone.domain_radius, end,
                                                          view.gauges.spread_depth))
                    .first;
      if (!std::isfinite(found->second.film) || !std::isfinite(found->second.under_plug)) continue;
      m.approach_least = std::min(found->second.film, found->second.under_plug);
      m.approach_most = std::max(found->second.film, found->second.under_plug);
      if (m.cause == Cause::unexplained && *m.residual >= 0.0 &&
          *m.residual <= *m.approach_most + comparison.thresholds.creep_factor * *m.predicted_creep)
        m.cause = Cause::approaching_rest;
    }
  }

  void describe(Comparison& comparison) const override {
    describe_growth(comparison);
    comparison.fair = fair_runs_of_slumps(comparison);
  }

  std::vector<RunColumn> measure_columns(const Comparison& comparison) const override {
    std::vector<RunColumn> columns;
    const double depth_mm = 1e3 * comparison.gauges.spread_depth;
    const Format mm = lengths(comparison), finer = lengths(comparison, 1), seconds = times(comparison, 1);
    columns = {measure_column("Spread at the end", "mm", mm, &Measures::gauge_end, 1e3),
               measure_column("±", "mm", mm, &Measures::uncertainty, 1e3),
               measure_column(fmt::format("at {:g} mm depth", 0.5 * depth_mm), "mm", mm,
                              &Measures::spread_at_half, 1e3),
               measure_column(fmt::format("at {:g} mm depth", 2.0 * depth_mm), "mm", mm,
                              &Measures::spread_at_twice, 1e3),
               measure_column("Centre", "mm", finer, &Measures::centre_depth, 1e3),
               {{"Recorded until", "s", times(comparison, 0)},
                [](const RunView& view) { return view.exact ? Table::Cell() : cell(view.measures.end); }},
               measure_column("Rest, declared", "s", seconds, &Measures::rest_declared),
               measure_column("Still to come, at most", "mm", finer, &Measures::growth_to_come, 1e3),
               measure_column("Rest by shear rate", "s", seconds, &Measures::rest_by_shear_rate),
               measure_column("Rest by spread rate", "s", seconds, &Measures::rest_by_spread_rate)};
    for (const double time : comparison.thresholds.overshoot_times)
      columns.push_back(
          {{fmt::format("Past the arrested spread at {:g} s", time), "mm", signed_lengths(comparison)},
           [time](const RunView& view) {
             const auto at = view.measures.overshoot.find(time);
             return at == view.measures.overshoot.end() ? Table::Cell() : Table::Cell(1e3 * at->second);
           }});
    return columns;
  }
  std::string residual_caption(const Comparison& comparison) const override {
    return fmt::format(
        "Measured: the median slope of the spread over the last {:g} s (of a short record, its last fifth). "
        "Predicted: on the arrested profile, "
        "whose base carries "
        "the yield stress, the law gives a depth-mean velocity u at half the radius; a shape that stays "
        "similar then grows in "
        "diameter by 4 u. Past the arrested radius the base stress falls with its fifth power, and the creep "
        "with it. A run of "
        "a law that comes to rest has no predicted creep. Exact: how fast a thin film of the exact material "
        "still approaches rest at that time, with the pull of its plug and without, where creep does not "
        "explain what moves.",
        comparison.thresholds.residual_window);
  }
  Json measures_json(const Measures& m) const override {
    Json json;
    json["spread_end_mm"] = scaled(m.gauge_end, 1e3);
    json["spread_end_uncertainty_mm"] = scaled(m.uncertainty, 1e3);
    json["spread_end_uncertainty_source"] = m.uncertainty_source;
    // By their names of the standard cone: at half and at twice the depth that `thresholds` has.
    json["spread_end_at_1.5mm_mm"] = scaled(m.spread_at_half, 1e3);
    json["spread_end_at_6mm_mm"] = scaled(m.spread_at_twice, 1e3);
    json["centre_end_mm"] = scaled(m.centre_depth, 1e3);
    json["rest_declared_s"] = scaled(m.rest_declared);
    json["growth_to_come_mm"] = scaled(m.growth_to_come, 1e3);
    json["rest_by_shear_rate_s"] = scaled(m.rest_by_shear_rate);
    json["rest_by_spread_rate_s"] = scaled(m.rest_by_spread_rate);
    json["overshoot_reference_run"] = m.overshoot_reference_run;
    json["overshoot_reference_mm"] = scaled(m.overshoot_reference, 1e3);
    for (const auto& [time, value] : m.overshoot)
      json[fmt::format("overshoot_at_{:g}s_mm", time)] = 1e3 * value;
    json["residual_mm_s"] = scaled(m.residual, 1e3);
    json["residual_scatter_mm"] = scaled(m.residual_scatter, 1e3);
    json["predicted_creep_mm_s"] = scaled(m.predicted_creep, 1e3);
    json["approach_to_rest_least_mm_s"] = scaled(m.approach_least, 1e3);
    json["approach_to_rest_most_mm_s"] = scaled(m.approach_most, 1e3);
    json["arbitrary_stop_lowest_mm"] = scaled(m.stop_lowest, 1e3);
    json["arbitrary_stop_highest_mm"] = scaled(m.stop_highest, 1e3);
    return json;
  }

  std::vector<ExactRun> write_exact_runs(const Scene& scene, const std::filesystem::path& directory,
                                         std::optional<double> flocculation,
                                         runs::Replace replace) const override {
    return write_slumps(scene, directory, flocculation, replace);
  }
  void check_film(const Scene& scene) const override {
    if (scene.geometry.dimension == scenes::Dimension::plane) ApparatusReport::check_film(scene);
    if (scene.thixotropy || scene.base.law != scenes::Wall::no_slip || !(scene.forces.gravity > 0.0) ||
        !(scene.material.yield_stress > 0.0) || !(scene.material.plastic_viscosity > 0.0) ||
        scene.material.flow_index != 1.0)
      refuse(scene,
             "the film is of Bingham material without thixotropy, under gravity, on a base without slip");
  }
  ExactRun write_film_run(const Scene& scene, const std::filesystem::path& directory, bool plug_pulls,
                          runs::Replace replace) const override {
    check_film(scene);
    constexpr int rings = 225;
    const Bingham material = exact::material_of(scene);
    const auto& cone = scene.slump();
    const double gravity = scene.forces.gravity;
    exact::SpreadingFilm film = exact::bingham_film(material, gravity, cone.cone_radius_bottom, cone.volume(),
                                                    cone.domain_radius, rings, plug_pulls);
    runs::RunWriter writer = exact::open_run(directory, scene, std::nullopt, replace);
    writer.info()["model"] = "bingham";
    const std::string label = plug_pulls ? "thin film under its plug's pull, Bingham" : "thin film, Bingham";
    writer.info()["label"] = label;
    writer.info()["source"] = "lubrication of a yield-stress film (Liu and Mei 1989), solved numerically";
    const auto& output = scene.output;
    const auto rows = static_cast<int>(std::ceil(scene.time.end / output.history_interval * (1.0 - 1e-12)));
    const int rows_per_profile =
        std::max(1, static_cast<int>(std::lround(output.profile_interval / output.history_interval)));
    const double spread_depth = scene.gauges.spread_depth;
    double spread = 0.0, height = 0.0;
    for (int row = 0; row <= rows; ++row) {
      film.advance_to(std::min(row * output.history_interval, scene.time.end));
      const auto& state = film.state();
      const auto radius = state.centres();
      const runs::DepthView profile{radius, state.depth};
      spread = runs::spread(profile, spread_depth);
      height = runs::centre_depth(profile, spread_depth);
      writer.history(slump_row(state.time, spread, height, state.volume()));
      if (row % rows_per_profile == 0 || row == rows) writer.profile(state.time, radius, state.depth);
    }
    writer.finish(runs::Status::end_time, "", "sound");
    return {directory, fmt::format("{}: {} at {:g} s, still growing; {}", label,
                                   runs::shown_length("spread", spread, spread_depth), scene.time.end,
                                   runs::shown_length("centre", height, spread_depth))};
  }
};

}  // namespace

const ApparatusReport& own_report(const scenes::Slump&) {
  static const SlumpReport report;
  return report;
}

}  // namespace flowrest::compare
