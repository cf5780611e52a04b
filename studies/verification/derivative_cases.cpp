// Derivatives of runs: of a duct against the series solution's, of a slump against differences of perturbed runs.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "studies/verification/scene_runs.h"

namespace flowrest::studies::verification {

namespace {

/// d(velocity in the middle) / d(force) of a Newtonian fluid that starts between plates, by the series of Zhang et al.
/// 2026, appendix B.1, at a time in s: that velocity over the force, for it is linear in it.
double start_up_per_force(double height, double viscosity, double density, double time) {
  const double steady = height * height / (8.0 * viscosity);
  double rest = 0.0;
  for (int n = 1; n < 400; n += 2) {
    const double sign = n % 4 == 1 ? 1.0 : -1.0;
    const double wave = n * std::numbers::pi / height;
    rest += sign / (n * n * n) * std::exp(-wave * wave * viscosity / density * time);
  }
  return steady - 4.0 * height * height / (viscosity * std::pow(std::numbers::pi, 3)) * rest;
}

/// Of a stiffer fluid than the scene's, whose stress lags less behind its rate, at a time before particles have crossed
/// many cells (docs/manual/gradients.md).
Case duct() {
  Case c;
  c.name = "Derivative of start-up flow by its force";
  c.variant = "forward, MPM quadratic-apic, newtonian";
  c.against = "series solution, linear in the force (Zhang et al. 2026, B.1)";
  c.norm = "relative error of d(velocity in the middle) / d(force)";
  c.value_name = "derivative";
  c.value_unit = "m/s per N/m3";
  constexpr double time = 0.2;
  c.exact_value = start_up_per_force(1e-3, 1e-3, 1000.0, time);
  c.grids = {1e-4, 5e-5, 2.5e-5};
  c.largest_error = 5e-3;
  c.quick = true;
  c.cost = 3.0;
  c.compute = [exact = *c.exact_value](double cell, const Workplace& place) -> Measured {
    const auto json =
        run_gradient("poiseuille-newtonian",
                     {setting("mpm.cell", cell), setting("time.end", time), "material.bulk_modulus=100"},
                     "plug_velocity_m_s", "forces.body_force", "forward", place);
    const double value = json["derivatives"][0]["value"];
    return {std::abs(value / exact - 1.0), value};
  };
  return c;
}

/// Both ways are held against differences over ever smaller steps of the key.
Case slump(const std::string& mode) {
  Case c;
  c.name = "Derivative of a slump's radius by its viscosity";
  c.variant = mode + ", MPM quadratic-apic, elasto-viscoplastic";
  c.against = "central differences of perturbed runs with the same steps";
  c.norm = "relative difference";
  c.value_name = "difference";
  c.value_unit = "mm per Pa s";
  c.refined = "relative step of the difference";
  c.grids = {0.02, 0.005, 7.8125e-5};
  c.largest_error = 1e-4;
  c.quick = true;
  c.cost = 5.0;
  c.compute = [mode](double step, const Workplace& place) -> Measured {
    const auto json = run_gradient("roussel-slump", {setting("mpm.cell", 0.02), setting("time.end", 1.0)},
                                   "rms_radius_mm", "material.plastic_viscosity", mode, place);
    const auto& derivative = json["derivatives"][0];
    for (const auto& difference : derivative["check"]["differences"])
      if (std::abs(difference["relative_step"].get<double>() / step - 1.0) < 1e-6) {
        const double value = difference["value"];
        return {std::abs(value / derivative["value"].get<double>() - 1.0), value};
      }
    throw runs::NumericsError(fmt::format("--check made no difference over a step of {:g}", step));
  };
  return c;
}

}  // namespace

std::vector<Case> derivative_cases() { return {duct(), slump("forward"), slump("reverse")}; }

}  // namespace flowrest::studies::verification
