#include "foamCases/concrete_laws.h"

#include <fmt/format.h>

#include <cctype>
#include <stdexcept>

#include "foamCases/function_object.h"
#include "foamCases/plug_in.h"
#include "foamCases/step_rules.h"
#include "foamCases/viscosity.h"

namespace flowrest::foam {

using scenes::FoamMixing;
using scenes::Scene;

namespace {

/// A law as OpenFOAM has it of its own; it takes stresses over the density.
std::string viscosity_table(const scenes::Material& material, const std::string& law) {
  std::string table = "strainRateTable\n(\n";
  for (const auto& point : regularised_table(material))
    table += fmt::format("    ({} {})\n", point.shear_rate, point.kinematic_viscosity);
  return table +
         fmt::format(
             ");\n\n"
             "// {},\n"
             "// given as a table of (rate in 1/s, viscosity in m2/s) that linear interpolation keeps "
             "to 0.1 %.\n"
             "concreteViscosity\n{{\n    transportModel  strainRateFunction;\n"
             "    strainRateFunctionCoeffs\n    {{\n        function    table "
             "$strainRateTable;\n    }}\n}}\n",
             law);
}

std::string built_in_viscosity(laws::Papanastasiou, const scenes::Material& material) {
  return viscosity_table(
      material,
      fmt::format("Papanastasiou: (eta + tau0 (1 - exp(-m rate)) / rate) / rho with eta = {} Pa s, tau0 = {} "
                  "Pa, m = {} s",
                  material.plastic_viscosity, material.yield_stress, material.regularisation_time.value()));
}

std::string built_in_viscosity(laws::HerschelBulkley, const scenes::Material& material) {
  return viscosity_table(
      material,
      fmt::format(
          "Herschel-Bulkley: (K (rate^2 + 1 / m^2)^((n - 1) / 2) + tau0 (1 - exp(-m rate)) / rate) / rho "
          "with K = {} Pa s^n, n = {}, tau0 = {} Pa, m = {} s",
          material.plastic_viscosity, material.flow_index, material.yield_stress,
          material.regularisation_time.value()));
}

std::string built_in_viscosity(laws::BiViscous, const scenes::Material& material) {
  return fmt::format(
      "// Bi-viscous: min(nu0, (tau0 / rate + eta) / rho) with eta = {} Pa s, tau0 = {} Pa; the branches "
      "meet at\n"
      "// {} 1/s. HerschelBulkley takes its stresses over the density.\n"
      "concreteViscosity\n{{\n    transportModel  HerschelBulkley;\n    HerschelBulkleyCoeffs\n    {{\n"
      "        nu0     {};\n        tau0    {};\n        k       {};\n        n       1;\n    }}\n}}\n",
      material.plastic_viscosity, material.yield_stress, material.critical_shear_rate.value(),
      viscosity_at_rest(material), material.yield_stress / material.density,
      material.plastic_viscosity / material.density);
}

std::string built_in_viscosity(laws::Newtonian, const scenes::Material& material) {
  return fmt::format(
      "// Newtonian: eta / rho with eta = {} Pa s.\n"
      "concreteViscosity\n{{\n    transportModel  Newtonian;\n    nu              {};\n}}\n",
      material.plastic_viscosity, material.plastic_viscosity / material.density);
}

std::string built_in_viscosity(laws::ElastoViscoplastic, const scenes::Material&) {
  throw std::logic_error("a law that OpenFOAM does not have");
}

/// What flowrest's plug-in calls a law.
const char* plug_in_type(laws::Papanastasiou) { return "PapanastasiouBingham"; }
const char* plug_in_type(laws::BiViscous) { return "biViscousBingham"; }
const char* plug_in_type(laws::HerschelBulkley) { return "PapanastasiouHerschelBulkley"; }
const char* plug_in_type(laws::Newtonian) { return "NewtonianConcrete"; }
const char* plug_in_type(laws::ElastoViscoplastic) { return "elastoViscoplasticBingham"; }

/// A key of [material] as OpenFOAM's dictionaries write words: regularisationTime.
std::string dictionary_word(laws::Parameter parameter) {
  std::string word;
  bool capital = false;
  for (const char* c = laws::key_of(parameter); *c != '\0'; ++c) {
    if (*c != '_') word += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(*c))) : *c;
    capital = *c == '_';
  }
  return word;
}

std::string mixing_name(FoamMixing mixing) {
  return mixing == FoamMixing::mass_weighted ? "massWeighted" : scenes::to_string(mixing);
}

/// Flocs, and where the scene has them breakdown by another power than 1 and growth with age.
std::string structure_coefficients(const scenes::Thixotropy& thixotropy, const std::string& indent) {
  std::string text = fmt::format(
      "{0}thixotropy\n{0}{{\n{0}    flocculationRate            {1};  // A_thix, Pa/s\n"
      "{0}    deflocculationCoefficient   {2};\n{0}    initialFlocculation         {3};\n",
      indent, thixotropy.flocculation_rate, thixotropy.deflocculation_coefficient,
      thixotropy.initial_flocculation);
  if (thixotropy.breakdown_exponent != 1.0)
    text += fmt::format("{}    breakdownExponent           {};\n", indent, thixotropy.breakdown_exponent);
  if (thixotropy.ageing_rate != 0.0) {
    text += fmt::format("{}    ageingRate                  {};  // Pa/s\n", indent, thixotropy.ageing_rate);
    if (thixotropy.ageing_time)
      text += fmt::format("{}    ageingTime                  {};  // s\n", indent, *thixotropy.ageing_time);
    text += fmt::format("{}    initialAge                  {};  // s\n", indent, thixotropy.initial_age);
  }
  return text + indent + "}\n";
}

/// What every law of the plug-in is told.
std::string common_coefficients(const Scene& scene, const std::string& indent) {
  const auto& material = scene.material;
  std::string text =
      fmt::format("{0}yieldStress         {1};  // Pa\n{0}plasticViscosity    {2};  // Pa s{3}\n", indent,
                  laws::has_yield_stress(material.model) ? material.yield_stress : 0.0,
                  material.plastic_viscosity, material.flow_index == 1.0 ? "" : "^n");
  if (carries_flocculation(scene)) text += structure_coefficients(*scene.thixotropy, indent);
  text += fmt::format("{}mixing              {};\n", indent, mixing_name(scene.foam.mixing));
  if (scene.foam.mixing == FoamMixing::saturating)
    text += fmt::format("{}fullAt              {};\n", indent, scene.foam.full_at);
  text += fmt::format("{}wetting             {};\n", indent, scenes::to_string(scene.foam.wetting));
  return text + fmt::format("{}strainRate          {};\n", indent, scenes::to_string(scene.foam.strain_rate));
}

/// What a law is told that others do not have.
std::string own_coefficients(const scenes::Material& material, const std::string& indent) {
  std::string own;
  for (const laws::Parameter parameter : laws::every_parameter) {
    const bool common =
        parameter == laws::Parameter::yield_stress || parameter == laws::Parameter::plastic_viscosity;
    if (common || !laws::needs(material.model, parameter)) continue;
    const std::string unit = laws::unit_of(parameter);
    own += fmt::format("{}{:<22}{};{}\n", indent, dictionary_word(parameter),
                       material.flow_curve().parameters.*laws::member_of<double>(parameter),
                       unit.empty() ? "" : "  // " + unit);
  }
  return own;
}

std::string plug_in_viscosity(const Scene& scene) {
  const auto& material = scene.material;
  const std::string indent(4, ' ');
  return fmt::format("concreteViscosity\n{{\n    transportModel      {};\n{}{}}}\n",
                     laws::visit(material.model, [](auto law) { return plug_in_type(law); }),
                     common_coefficients(scene, indent), own_coefficients(material, indent));
}

/// A law that can rest is a stress model; what the mixture is given as viscosity it does not use.
std::string plug_in_stress(const Scene& scene) {
  const auto& material = scene.material;
  const std::string indent(12, ' ');
  return fmt::format(
      "concreteViscosity\n{{\n    transportModel      Newtonian;\n    nu                  {1};\n}}\n\n"
      "concreteStress\n{{\n    laminar\n    {{\n        laminarModel        {0};\n        {0}Coeffs\n"
      "        {{\n{2}phase               concrete;\n{2}rho                 {3};  // kg/m3\n"
      "{2}faceWeight          {7};\n"
      "{2}youngsModulus       {4};  // Pa\n{2}poissonRatio        {5};\n{6}        }}\n    }}\n}}\n",
      laws::visit(material.model, [](auto law) { return plug_in_type(law); }),
      material.plastic_viscosity / material.density, indent, material.density, material.youngs_modulus,
      material.poisson_ratio, common_coefficients(scene, indent) + own_coefficients(material, indent),
      scenes::to_string(scene.foam.face_weight));
}

/// Watches the velocity from step to step, and lets a slump's step grow.
std::string staged_step(const ApparatusCase& apparatus) {
  constexpr double cells_per_second = 1e-3;
  return function_object("stagedStep",
                         fmt::format("        least           {};  // s\n        most            {};  // s\n"
                                     "        ofTime          {};\n        stillness       {};  // m/s\n",
                                     largest_step(apparatus), grown_step(apparatus), step_of_time,
                                     cells_per_second * apparatus.scene().foam.cell));
}

/// What is done to the concrete after every step, or read off it.
std::string after_every_step(const ApparatusCase& apparatus, bool plug_in) {
  const Scene& scene = apparatus.scene();
  std::string text;
  if (plug_in && writes_shear_rate(apparatus))
    text += function_object(
        "shearRate", fmt::format("        strainRate      {};\n", scenes::to_string(scene.foam.strain_rate)));
  text += apparatus.function_objects(plug_in);
  if (plug_in) text += staged_step(apparatus);
  return fmt::format("afterEveryStep\n{{\n{}}}\n", text);
}

/// Correctors of the pressure. Concrete that slows under a surface chatters with fewer, whatever its step.
int pressure_correctors(const ApparatusCase& apparatus, bool plug_in) {
  return plug_in && apparatus.slows() ? 12 : 6;
}

std::string stress_model(const Scene& scene, bool plug_in) {
  const std::string none = "\nconcreteStress\n{\n}\n";
  if (!plug_in)
    return laws::visit(scene.material.model,
                       [&](auto law) { return built_in_viscosity(law, scene.material); }) +
           none;
  if (laws::can_rest(scene.material.model)) return plug_in_stress(scene);
  return plug_in_viscosity(scene) + none;
}

}  // namespace

bool writes_shear_rate(const ApparatusCase& apparatus) {
  return !apparatus.rates_follow_from_velocities() || apparatus.scene().base.law == scenes::Wall::friction;
}

std::string concrete_laws(const ApparatusCase& apparatus, bool plug_in) {
  const Scene& scene = apparatus.scene();
  std::string sampled, state;
  if (plug_in && writes_shear_rate(apparatus)) sampled += " shearRate";
  if (plug_in && carries_flocculation(scene)) sampled += " flocculation";
  if (laws::can_rest(scene.material.model)) {
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
             pressure_correctors(apparatus, plug_in), after_every_step(apparatus, plug_in)) +
         stress_model(scene, plug_in);
}

}  // namespace flowrest::foam
