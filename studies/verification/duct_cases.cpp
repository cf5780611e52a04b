// Flow between plates against its closed forms: Yu et al. 2026, section 3.3, and what the regularised laws
// make of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/exact/creep.h"
#include "compare/exact/duct.h"
#include "compare/exact/solutions.h"
#include "studies/verification/scene_runs.h"

namespace flowrest::studies::verification {

namespace {

using compare::exact::DuctFlow;
using compare::exact::RegularisedFluid;

constexpr double height = 0.5, density = 2000.0, viscosity = 30.0;  // of poiseuille-step-down
constexpr double regularisation = 10.0;                             // s

/// Velocities on the points of a profile, y from the middle.
using Velocity = std::function<double(double)>;

/// v(y) = (1/F) int_{F y}^{F H/2} g(tau) dtau by Simpson's rule, g the law's shear rate at a stress.
double regularised_velocity(const RegularisedFluid& fluid, double force, double from_middle) {
  constexpr int intervals = 400;
  const double low = force * std::abs(from_middle), high = 0.5 * force * height, h = (high - low) / intervals;
  double sum = 0.0;
  for (int i = 0; i <= intervals; ++i) {
    const double weight = i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += weight * fluid.rate(low + i * h);
  }
  return sum * h / 3.0 / force;
}

struct Variant {
  std::string solver, model;
  std::vector<std::string> set;
  std::string words;
  std::optional<double> largest_error = {};
  std::optional<double> least_order = {};
  bool quick = false;
};

RegularisedFluid fluid_of(const Variant& v, double yield) {
  return compare::exact::regularised_fluid(scenes::model_from_name(v.model), yield, viscosity,
                                           regularisation);
}

std::string cell_key(const Variant& v) { return v.solver == "foam" ? "foam.cell" : "mpm.cell"; }

std::vector<std::string> settings_of(const Variant& v, double cell, std::vector<std::string> more) {
  more.push_back(setting(cell_key(v), cell));
  if (v.solver == "foam") more.push_back("mpm.cell=0.05");  // not used, but must fit
  more.push_back(fmt::format("material.model={}", v.model));
  more.insert(more.end(), v.set.begin(), v.set.end());
  return more;
}

/// A case of a variant on the usual grids; what it is compared with is left open.
Case case_of(const Variant& v, const std::string& name, double cost) {
  Case c;
  c.name = name;
  c.variant = v.words;
  c.grids = {0.05, 0.025, 0.0125};
  c.largest_error = v.largest_error;
  c.least_order = v.least_order;
  c.quick = v.quick;
  c.cost = cost;
  return c;
}

/// The flow of a steadily driven duct at its end.
Measured steady(const Variant& v, double cell, std::vector<std::string> more, const Velocity& exact,
                const Workplace& place) {
  const auto run = run_scene("poiseuille-step-down", settings_of(v, cell, std::move(more)), v.solver, place);
  const auto& profile = run.profiles.back();
  return {compare::exact::profile_error(profile, height, exact), run.history.at("mean_velocity_m_s").back()};
}

/// At 300 Pa s it is steady within a second. A tenth of the benchmark's force: an elastic fluid whose stress
/// turns with the material is thinner by (rate viscosity / modulus)^2 (Johnson and Segalman 1977).
Case newtonian(const Variant& v) {
  const double force = 200.0, eta = 300.0;
  const DuctFlow flow{{density, 0.0, eta}, height, force};
  Case c = case_of(v, "Poiseuille flow, Newtonian", 3.0);
  c.against = "u = F ((H/2)^2 - y^2) / (2 eta)";
  c.norm = "relative L2 of the velocity";
  c.value_name = "mean velocity";
  c.value_unit = "m/s";
  c.exact_value = flow.mean_velocity();
  c.compute = [=](double cell, const Workplace& place) {
    return steady(
        v, cell,
        {setting("material.plastic_viscosity", eta), "time.end=3", "forces.body_force=[[0.0, 200.0]]"},
        [=](double y) { return flow.velocity(y); }, place);
  };
  return c;
}

/// Yu et al. 2026, Eqs. 48 to 50; of a regularised fluid by quadrature of its own law.
Case bingham(const Variant& v, double yield) {
  const double force = 2000.0;
  const DuctFlow flow{{density, yield, viscosity}, height, force};
  const RegularisedFluid fluid = fluid_of(v, yield);
  const bool exactly_bingham = laws::can_rest(scenes::model_from_name(v.model));
  const Velocity exact = exactly_bingham
                             ? Velocity([=](double y) { return flow.velocity(y); })
                             : Velocity([=](double y) { return regularised_velocity(fluid, force, y); });
  Case c = case_of(v, fmt::format("Poiseuille flow, yield stress {:g} Pa", yield), 10.0);
  c.against = exactly_bingham ? "Yu et al. 2026, Eqs. 48-50" : "quadrature of the fluid's own law";
  c.norm = "relative L2 of the velocity";
  c.value_name = "mean velocity";
  c.value_unit = "m/s";
  if (exactly_bingham) c.exact_value = flow.mean_velocity();
  c.compute = [=](double cell, const Workplace& place) {
    return steady(
        v, cell,
        {setting("material.yield_stress", yield), "time.end=12", "output.profile_interval=12",
         setting("material.regularisation_time", regularisation), "forces.body_force=[[0.0, 2000.0]]"},
        exact, place);
  };
  return c;
}

Case stopping(const Variant& v) {
  const double slow = 2e-3;
  Case c = case_of(v, "Duct stepped down below yield, stop", 12.0);
  c.against = "finite differences in one dimension";
  c.norm = "relative error of the stopping time";
  c.value_name = "stopping time";
  c.value_unit = std::string("s");
  c.compute = [=](double cell, const Workplace& place) {
    const auto run =
        run_scene("poiseuille-step-down",
                  settings_of(v, cell, {"time.end=17.5", "output.profile_interval=20"}), v.solver, place);
    const auto &time = run.history.at("time_s"), &plug = run.history.at("plug_velocity_m_s");
    for (std::size_t i = 1; i < time.size(); ++i) {
      if (time[i] <= 12.0 || plug[i] >= slow) continue;
      const double stop =
          time[i - 1] + (time[i] - time[i - 1]) * (plug[i - 1] - slow) / (plug[i - 1] - plug[i]) - 12.0;
      const double exact =
          compare::exact::duct_stopping_time({{density, 100.0, viscosity}, height, 2000.0}, 360.0, slow);
      return Measured{std::abs(stop / exact - 1.0), stop};
    }
    throw runs::NumericsError("it does not stop");
  };
  return c;
}

Case creeping(const Variant& v) {
  const RegularisedFluid fluid = fluid_of(v, 100.0);
  const double exact = compare::exact::duct_creep(fluid, height, 360.0);
  Case c = case_of(v, "Duct below yield, creep", 2.0);
  c.against = "quadrature of the fluid's own law";
  c.norm = "relative error of the middle's velocity";
  c.value_name = "creep of the middle";
  c.value_unit = "m/s";
  c.exact_value = exact;
  c.compute = [=](double cell, const Workplace& place) {
    const auto run = run_scene("poiseuille-step-down",
                               settings_of(v, cell,
                                           {"forces.body_force=[[0.0, 360.0]]", "time.end=2",
                                            setting("material.regularisation_time", regularisation)}),
                               v.solver, place);
    const double creep = run.history.at("plug_velocity_m_s").back();
    return Measured{std::abs(creep / exact - 1.0), creep};
  };
  return c;
}

}  // namespace

std::vector<Case> duct_cases() {
  const std::string evp = "elasto-viscoplastic";
  const std::vector<std::string> linear = {"mpm.scheme=linear-flip"}, single = {"mpm.precision=float"},
                                 single_linear = {"mpm.scheme=linear-flip", "mpm.precision=float"};
  std::vector<Case> cases = {
      newtonian({"mpm", "newtonian", {}, "MPM quadratic-apic, double", 1e-3, 1.8, true}),
      newtonian({"mpm", "newtonian", single, "MPM quadratic-apic, float", 1e-3, {}, true}),
      newtonian({"mpm", "newtonian", linear, "MPM linear-flip, double", 5e-2}),
      bingham({"mpm", evp, {}, "MPM quadratic-apic, elasto-viscoplastic, double", 2e-3, {}, true}, 100.0),
      bingham({"mpm", evp, single, "MPM quadratic-apic, elasto-viscoplastic, float", 2e-3}, 100.0),
      bingham({"mpm", evp, linear, "MPM linear-flip, elasto-viscoplastic, double", 5e-2}, 100.0),
      newtonian({"mpm", "newtonian", single_linear, "MPM linear-flip, float", 5e-2}),
      bingham({"mpm", evp, single_linear, "MPM linear-flip, elasto-viscoplastic, float", 5e-2}, 100.0),
      bingham({"mpm", evp, {}, "MPM quadratic-apic, elasto-viscoplastic, double", 2e-3}, 10.0),
      bingham({"mpm", evp, {}, "MPM quadratic-apic, elasto-viscoplastic, double", 3e-3}, 200.0),
      bingham({"mpm", "papanastasiou", {}, "MPM quadratic-apic, papanastasiou, double", 5e-3}, 100.0),
      bingham({"mpm", "bi-viscous", {}, "MPM quadratic-apic, bi-viscous, double", 5e-3}, 100.0),
      bingham({"mpm", "papanastasiou", single, "MPM quadratic-apic, papanastasiou, float", 5e-3}, 100.0),
      stopping({"mpm", evp, {}, "MPM quadratic-apic, elasto-viscoplastic, double", 0.02, {}, true}),
      stopping({"mpm", evp, single, "MPM quadratic-apic, elasto-viscoplastic, float", 0.02}),
      creeping({"mpm", "papanastasiou", {}, "MPM quadratic-apic, papanastasiou, double", 0.05, {}, true}),
      creeping({"mpm", "papanastasiou", single, "MPM quadratic-apic, papanastasiou, float", 0.05}),
      creeping({"mpm", "bi-viscous", {}, "MPM quadratic-apic, bi-viscous, double", 0.05}),
  };
#ifdef FLOWREST_HAS_FOAM
  cases.push_back(newtonian({"foam", "newtonian", {}, "OpenFOAM", 1e-2, 1.5, true}));
  cases.push_back(bingham({"foam", "papanastasiou", {}, "OpenFOAM, papanastasiou", 1e-2}, 100.0));
  cases.push_back(bingham({"foam", "bi-viscous", {}, "OpenFOAM, bi-viscous", 1e-2}, 100.0));
  cases.push_back(creeping({"foam", "papanastasiou", {}, "OpenFOAM, papanastasiou", 0.05, {}, true}));
#ifdef FLOWREST_HAS_PLUG_IN
  cases.push_back(bingham({"foam", evp, {}, "OpenFOAM, elasto-viscoplastic", 1e-2}, 100.0));
  cases.push_back(stopping({"foam", evp, {}, "OpenFOAM, elasto-viscoplastic", 0.05}));
#endif
#endif
  return cases;
}

}  // namespace flowrest::studies::verification
