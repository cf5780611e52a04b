// Slumps against their asymptotes. These leave out what a computation has, so that their bounds are wide;
// what is judged besides is how the answer converges.
#include <fmt/format.h>

#include <cmath>

#include "compare/exact/solutions.h"
#include "studies/verification/scene_runs.h"

namespace flowrest::studies::verification {

namespace {

constexpr double density = 2300.0, gravity = 9.81;

struct Variant {
  std::vector<std::string> set;
  std::string words;
  bool quick = false;
};

std::vector<std::string> with(std::vector<std::string> settings, const Variant& v, double cell) {
  settings.push_back(setting("mpm.cell", cell));
  settings.insert(settings.end(), v.set.begin(), v.set.end());
  return settings;
}

/// The arrested Roussel slump against the second-order profile: quasi-static, while the slump arrives with
/// inertia.
Case roussel(const Variant& v) {
  Case c;
  c.name = "Roussel slump, arrested spread";
  c.variant = v.words;
  c.against = "second-order profile, which knows no inertia (asymptote)";
  c.norm = "relative error of the spread";
  c.value_name = "spread";
  c.value_unit = "mm";
  c.grids = {0.020, 0.0125, 0.010};
  c.largest_error = 0.05;
  c.quick = v.quick;
  c.cost = 5.0;
  c.compute = [=](double cell, const Workplace& place) {
    const auto run = run_scene("roussel-slump", with({}, v, cell), "mpm", place);
    const double volume = 5.497787143782138e-3;  // of the Abrams cone, m3
    const auto profile = compare::exact::second_order_slump({density, 50.0, 50.0}, gravity, volume);
    const double spread = run.history.at("spread_mm").back();
    return Measured{std::abs(1e-3 * spread / profile.spread(scenes::Gauges{}.spread_depth) - 1.0), spread};
  };
  return c;
}

/// A Newtonian slump after 10 s. r = 0.894 (g V^3 / (3 nu))^(1/8) t^(1/8) (Huppert 1982, axisymmetric, of
/// constant volume), which forgets how it began: the one slump whose spread in time is known.
Case gravity_current(const Variant& v, const std::string& solver = "mpm") {
  const double volume = 5.497787143782138e-3, kinematic = 50.0 / density, time = 10.0;
  const double exact =
      2e3 * 0.894 * std::pow(gravity * std::pow(volume, 3) * time / (3.0 * kinematic), 0.125);
  Case c;
  c.name = "Viscous gravity current";
  c.variant = v.words;
  c.against = "Huppert 1982, similarity solution of lubrication, after 10 s";
  c.norm = "relative error of the spread";
  c.value_name = "spread";
  c.value_unit = "mm";
  c.exact_value = exact;
  c.grids = {0.020, 0.0125, 0.010};
  c.largest_error = 0.025;
  c.quick = v.quick;
  c.cost = solver == "foam" ? 60.0 : 3.0;
  c.compute = [=](double cell, const Workplace& place) {
    std::vector<std::string> set = {"runs.mpm=['newtonian']", "runs.foam=['newtonian']",
                                    "material.model=newtonian", setting("time.end", time)};
    set.insert(set.end(), v.set.begin(), v.set.end());
    set.push_back(setting(solver + ".cell", cell));
    const double spread = run_scene("roussel-slump", set, solver, place).history.at("spread_mm").back();
    return Measured{std::abs(spread / exact - 1.0), spread};
  };
  return c;
}

/// Lubrication at rest: X = (9 X0^2 / (8 B))^(1/3), lengths over H0, B = tau0 / (rho g H0). The stress along
/// the plug, which it leaves out, holds the front back.
Case planar(const Variant& v) {
  Case c;
  c.name = "Planar slump, arrested front";
  c.variant = v.words;
  c.against = "lubrication, which leaves the plug's own stress out (asymptote)";
  c.norm = "relative error of the front";
  c.value_name = "front";
  c.value_unit = "mm";
  c.grids = {0.025, 0.020, 0.0125};
  c.largest_error = 0.15;
  c.quick = v.quick;
  c.cost = 8.0;
  c.compute = [=](double cell, const Workplace& place) {
    const double yield = 200.0, height = 0.3, half_width = 0.1;
    const auto run =
        run_scene("roussel-slump",
                  with({"geometry.dimension=plane", "geometry.cone_radius_top=0.1",
                        "geometry.cone_radius_bottom=0.1", "geometry.domain_radius=1.5",
                        "material.plastic_viscosity=200", setting("material.yield_stress", yield)},
                       v, cell),
                  "mpm", place);
    const double group = yield / (density * gravity * height);
    const double exact = height * std::cbrt(9.0 * std::pow(half_width / height, 2) / (8.0 * group));
    const double front = 0.5 * run.history.at("spread_mm").back();
    return Measured{std::abs(1e-3 * front / exact - 1.0), front};
  };
  return c;
}

/// s / H = 1 - x (1 - ln x), x = sqrt(3) tau0 / (rho g H) (Pashias et al. 1996, with von Mises' yield):
/// slices that do not hold each other.
Case cylinder(const Variant& v) {
  const double height = 0.2, yield = 1400.0, x = std::sqrt(3.0) * yield / (density * gravity * height);
  const double exact = 1.0 - x * (1.0 - std::log(x));
  Case c;
  c.name = "Cylinder that barely slumps";
  c.variant = v.words;
  c.against = "Pashias et al. 1996, slices that do not hold each other (asymptote)";
  c.norm = "difference of the slump, as a share of the height";
  c.value_name = "slump";
  c.value_unit = "of the height";
  c.exact_value = exact;
  c.grids = {0.025, 0.020, 0.0125};
  c.largest_error = 0.065;
  c.quick = v.quick;
  c.cost = 6.0;
  c.compute = [=](double cell, const Workplace& place) {
    const auto run = run_scene(
        "roussel-slump",
        with({"geometry.cone_radius_top=0.1", "geometry.cone_radius_bottom=0.1", "geometry.cone_height=0.2",
              "walls.base=slip", "time.end=5", "material.plastic_viscosity=1000",
              "material.youngs_modulus=1e6", setting("material.yield_stress", yield)},
             v, cell),
        "mpm", place);
    const double slump = 1.0 - 1e-3 * run.history.at("height_mm").back() / height;
    return Measured{std::abs(slump - exact), slump};
  };
  return c;
}

}  // namespace

std::vector<Case> slump_cases() {
  const std::vector<std::string> linear = {"mpm.scheme=linear-flip"}, single = {"mpm.precision=float"};
  const std::string quadratic = "MPM quadratic-apic, elasto-viscoplastic, ";
  std::vector<Case> cases = {roussel({{}, quadratic + "double", true}),
                             roussel({single, quadratic + "float"}),
                             roussel({linear, "MPM linear-flip, elasto-viscoplastic, double"}),
                             planar({{}, quadratic + "double"}),
                             planar({single, quadratic + "float"}),
                             cylinder({{}, quadratic + "double"}),
                             cylinder({linear, "MPM linear-flip, elasto-viscoplastic, double"}),
                             gravity_current({{}, "MPM quadratic-apic, newtonian, double", true}),
                             gravity_current({single, "MPM quadratic-apic, newtonian, float"}),
                             gravity_current({linear, "MPM linear-flip, newtonian, double"})};
#ifdef FLOWREST_HAS_FOAM
  cases.push_back(gravity_current({{}, "OpenFOAM, newtonian"}, "foam"));
#endif
  return cases;
}

}  // namespace flowrest::studies::verification
