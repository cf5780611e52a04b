#include "foamCases/concrete_laws.h"

#include <fmt/format.h>

#include <stdexcept>

#include "foamCases/plug_in.h"
#include "foamCases/vessel_mesh.h"
#include "foamCases/viscosity.h"
#include "scenes/step_limits.h"

namespace flowrest::foam {

using scenes::FoamMixing;
using scenes::Model;
using scenes::Scene;

namespace {

std::string strain_rate_table(const scenes::Material& material) {
  std::string text = "strainRateTable\n(\n";
  for (const auto& point : papanastasiou_table(material))
    text += fmt::format("    ({} {})\n", point.shear_rate, point.kinematic_viscosity);
  return text + ");\n\n";
}

/// OpenFOAM's own laws; they take stresses over the density.
std::string built_in_viscosity(const scenes::Material& material) {
  const double k = material.plastic_viscosity / material.density;
  switch (material.model) {
    case Model::papanastasiou:
      return strain_rate_table(material) + fmt::format(
                                               "// Papanastasiou: (eta + tau0 (1 - exp(-m rate)) / rate) / "
                                               "rho with eta = {} Pa s, tau0 = {} Pa, "
                                               "m = {} s,\n"
                                               "// given as a table of (rate in 1/s, viscosity in m2/s) that "
                                               "linear interpolation keeps to 0.1 "
                                               "%.\n"
                                               "concreteViscosity\n{{\n    transportModel  "
                                               "strainRateFunction;\n    strainRateFunctionCoeffs\n    "
                                               "{{\n"
                                               "        function    table $strainRateTable;\n    }}\n}}\n",
                                               material.plastic_viscosity, material.yield_stress,
                                               material.regularisation_time.value());
    case Model::bi_viscous:
      return fmt::format(
          "// Bi-viscous: min(nu0, (tau0 / rate + eta) / rho) with eta = {} Pa s, tau0 = {} Pa; the branches "
          "meet at\n"
          "// {} 1/s. HerschelBulkley takes its stresses over the density.\n"
          "concreteViscosity\n{{\n    transportModel  HerschelBulkley;\n    HerschelBulkleyCoeffs\n    {{\n"
          "        nu0     {};\n        tau0    {};\n        k       {};\n        n       1;\n    }}\n}}\n",
          material.plastic_viscosity, material.yield_stress, material.critical_shear_rate.value(),
          bi_viscous_viscosity_at_rest(material), material.yield_stress / material.density, k);
    case Model::newtonian:
      return fmt::format(
          "// Newtonian: eta / rho with eta = {} Pa s.\n"
          "concreteViscosity\n{{\n    transportModel  Newtonian;\n    nu              {};\n}}\n",
          material.plastic_viscosity, k);
    case Model::elasto_viscoplastic:
      break;
  }
  throw std::logic_error("a law that OpenFOAM does not have");
}

std::string mixing_name(FoamMixing mixing) {
  return mixing == FoamMixing::mass_weighted ? "massWeighted" : scenes::to_string(mixing);
}

/// What every law of the plug-in is told.
std::string common_coefficients(const Scene& scene, const std::string& indent) {
  const auto& material = scene.material;
  std::string text = fmt::format("{0}yieldStress         {1};  // Pa\n{0}plasticViscosity    {2};  // Pa s\n",
                                 indent, material.model == Model::newtonian ? 0.0 : material.yield_stress,
                                 material.plastic_viscosity);
  if (carries_flocculation(scene))
    text += fmt::format(
        "{0}thixotropy\n{0}{{\n{0}    flocculationRate            {1};  // A_thix, Pa/s\n"
        "{0}    deflocculationCoefficient   {2};\n{0}    initialFlocculation         {3};\n{0}}}\n",
        indent, scene.thixotropy->flocculation_rate, scene.thixotropy->deflocculation_coefficient,
        scene.thixotropy->initial_flocculation);
  text += fmt::format("{}mixing              {};\n", indent, mixing_name(scene.foam.mixing));
  if (scene.foam.mixing == FoamMixing::saturating)
    text += fmt::format("{}fullAt              {};\n", indent, scene.foam.full_at);
  text += fmt::format("{}wetting             {};\n", indent, scenes::to_string(scene.foam.wetting));
  return text + fmt::format("{}strainRate          {};\n", indent, scenes::to_string(scene.foam.strain_rate));
}

std::string plug_in_viscosity(const Scene& scene) {
  const auto& material = scene.material;
  std::string type, own;
  switch (material.model) {
    case Model::papanastasiou:
      type = "PapanastasiouBingham";
      own = fmt::format("    regularisationTime    {};  // s\n", material.regularisation_time.value());
      break;
    case Model::bi_viscous:
      type = "biViscousBingham";
      own = fmt::format("    criticalShearRate     {};  // 1/s\n", material.critical_shear_rate.value());
      break;
    case Model::newtonian:
      type = "NewtonianConcrete";
      break;
    case Model::elasto_viscoplastic:
      throw std::logic_error("a stress model, not a viscosity");
  }
  return fmt::format("concreteViscosity\n{{\n    transportModel      {};\n{}{}}}\n", type,
                     common_coefficients(scene, "    "), own);
}

/// The elasto-viscoplastic law is a stress model; what the mixture is given as viscosity it does not use.
std::string plug_in_stress(const Scene& scene) {
  const auto& material = scene.material;
  const std::string indent(12, ' ');
  return fmt::format(
      "concreteViscosity\n{{\n    transportModel      Newtonian;\n    nu                  {};\n}}\n\n"
      "concreteStress\n{{\n    laminar\n    {{\n        laminarModel        elastoViscoplasticBingham;\n"
      "        elastoViscoplasticBinghamCoeffs\n        {{\n"
      "{}phase               concrete;\n{}rho                 {};  // kg/m3\n"
      "{}youngsModulus       {};  // Pa\n{}poissonRatio        {};\n{}        }}\n    }}\n}}\n",
      material.plastic_viscosity / material.density, indent, indent, material.density, indent,
      material.youngs_modulus, indent, material.poisson_ratio, common_coefficients(scene, indent));
}

std::string function_object(const std::string& type, const std::string& keywords) {
  return fmt::format(
      "    {0}\n    {{\n        type            {0};\n        libs            $rheologyLibraries;\n{1}    "
      "}}\n",
      type, keywords);
}

/// Watches the velocity from step to step, and lets a slump's step grow.
std::string staged_step(const Scene& scene) {
  constexpr double cells_per_second = 1e-3;
  return function_object("stagedStep",
                         fmt::format("        least           {};  // s\n        most            {};  // s\n"
                                     "        ofTime          {};\n        stillness       {};  // m/s\n",
                                     scenes::largest_foam_step(scene), scenes::grown_foam_step(scene),
                                     scenes::foam_step_of_time, cells_per_second * scene.foam.cell));
}

/// The plate that createBafflesDict lays between the cells.
std::string lifted_gate(const Gate& gate) {
  return function_object(
      "liftedGate", fmt::format("        walls           (gateBehind gateBefore);\n"
                                "        openings        (openingBehind openingBefore);\n"
                                "        velocity        {};  // m/s\n        edge            {};  // m\n",
                                gate.velocity, gate.low[2]));
}

/// What is done to the concrete after every step, or read off it.
std::string after_every_step(const Scene& scene, bool plug_in) {
  std::string text;
  if (plug_in && is_vessel(scene))
    text += function_object(
        "shearRate", fmt::format("        strainRate      {};\n", scenes::to_string(scene.foam.strain_rate)));
  if (plug_in && scene.kind == scenes::Kind::slump && scene.foam.air_rise_time.value_or(0.0) > 0.0)
    text += function_object("airRises",
                            fmt::format("        time            {};  // s\n", *scene.foam.air_rise_time));
  if (const auto gate = gate_of(scene)) text += lifted_gate(*gate);
  if (plug_in) text += staged_step(scene);
  return fmt::format("afterEveryStep\n{{\n{}}}\n", text);
}

/// Correctors of the pressure. Concrete that slows under a surface chatters with fewer, whatever its step.
int pressure_correctors(const Scene& scene, bool plug_in) {
  const bool slows = scene.kind != scenes::Kind::duct && scene.kind != scenes::Kind::dam_break;
  return plug_in && slows ? 12 : 6;
}

std::string stress_model(const Scene& scene, bool plug_in) {
  const std::string none = "\nconcreteStress\n{\n}\n";
  if (!plug_in) return built_in_viscosity(scene.material) + none;
  if (scene.material.model == Model::elasto_viscoplastic) return plug_in_stress(scene);
  return plug_in_viscosity(scene) + none;
}

}  // namespace

std::string concrete_laws(const Scene& scene, bool plug_in) {
  std::string sampled, state;
  if (plug_in && is_vessel(scene)) sampled += " shearRate";
  if (plug_in && carries_flocculation(scene)) sampled += " flocculation";
  if (scene.material.model == Model::elasto_viscoplastic) {
    sampled += " plasticShearRate";
    state += " stress";
  }
  return fmt::format(
             "// Libraries the solver loads beside its own; fields sampled for the history, and those of a "
             "full "
             "state.\n"
             "rheologyLibraries   ({});\n"
             "historyObjects      (alpha.concrete U{});\n"
             "stateObjects        (alpha.concrete U p_rgh phi{}{});\n"
             "pressureCorrectors  {};\n{}\n",
             plug_in ? "\"$FOAM_CASE/libflowrestRheology.so\"" : "", sampled, sampled, state,
             pressure_correctors(scene, plug_in), after_every_step(scene, plug_in)) +
         stress_model(scene, plug_in);
}

}  // namespace flowrest::foam
