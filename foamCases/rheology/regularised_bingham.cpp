#include "foamCases/rheology/regularised_bingham.h"

#include "addToRunTimeSelectionTable.H"
#include "laws/bi_viscous.h"
#include "laws/herschel_bulkley.h"
#include "laws/papanastasiou.h"

namespace Foam {
namespace viscosityModels {

defineTypeNameAndDebug(PapanastasiouBingham, 0);
addToRunTimeSelectionTable(viscosityModel, PapanastasiouBingham, dictionary);
defineTypeNameAndDebug(biViscousBingham, 0);
addToRunTimeSelectionTable(viscosityModel, biViscousBingham, dictionary);
defineTypeNameAndDebug(PapanastasiouHerschelBulkley, 0);
addToRunTimeSelectionTable(viscosityModel, PapanastasiouHerschelBulkley, dictionary);
defineTypeNameAndDebug(NewtonianConcrete, 0);
addToRunTimeSelectionTable(viscosityModel, NewtonianConcrete, dictionary);

namespace {

scalar positive(const dictionary& dict, const word& key) {
  const scalar value = dict.get<scalar>(key);
  if (!(value > 0.0))
    FatalIOErrorInFunction(dict) << key << " is " << value << "; it must be above 0" << exit(FatalIOError);
  return value;
}

}  // namespace

RegularisedBingham::RegularisedBingham(const word& name, const dictionary& properties,
                                       const dictionary& coefficients, const volVectorField& velocity,
                                       const surfaceScalarField& flux)
    : viscosityModel(name, properties, velocity, flux),
      phase_(velocity, flux, properties.dictName(), dimensionedScalar("rho", dimDensity, properties)),
      rules_(flowrest::rheology::PhaseRules::read(coefficients)),
      yield_stress_("yieldStress", dimPressure, coefficients),
      plastic_viscosity_("plasticViscosity", dimDynamicViscosity, coefficients),
      nu_(IOobject(name, velocity.time().timeName(), velocity.db(), IOobject::NO_READ, IOobject::AUTO_WRITE),
          velocity.mesh(), plastic_viscosity_ / phase_.density(), calculatedFvPatchScalarField::typeName) {
  if (const dictionary* thixotropy = coefficients.findDict("thixotropy"))
    flocculation_ = std::make_unique<flowrest::rheology::Flocculation>(phase_, *thixotropy, yield_stress_);
}

tmp<volScalarField> RegularisedBingham::yield_stress(const volScalarField& rate) {
  if (!flocculation_) return volScalarField::New("yieldStress", phase_.mesh(), yield_stress_);
  flocculation_->advance(rate);
  // Yu et al. 2026, Eq. 11
  return yield_stress_ * (1.0 + flocculation_->field()) +
         dimensionedScalar("grown", dimPressure, flocculation_->grown());
}

void RegularisedBingham::correct() {
  // Of the velocities that the viscosity will act on: by the flux's own, thin cells (8:1) chatter.
  const auto rate = phase_.shear_rate(phase_.cell_velocity_gradient(rules_.strain_rate)());
  const auto yield = yield_stress(rate());
  volScalarField mu(IOobject("mu", phase_.mesh().time().timeName(), phase_.mesh()), phase_.mesh(),
                    plastic_viscosity_);
  const auto fill = [&](const scalarField& rates, const scalarField& yields, scalarField& viscosities) {
    forAll(viscosities, i) viscosities[i] = viscosity(plastic_viscosity_.value(), yields[i], rates[i]);
  };
  fill(rate().primitiveField(), yield().primitiveField(), mu.primitiveFieldRef());
  forAll(mu.boundaryField(), patch)
      fill(rate().boundaryField()[patch], yield().boundaryField()[patch], mu.boundaryFieldRef()[patch]);
  nu_ = phase_.mixture_input(rules_, mu);
}

bool RegularisedBingham::read(const dictionary& properties) { return viscosityModel::read(properties); }

PapanastasiouBingham::PapanastasiouBingham(const word& name, const dictionary& properties,
                                           const volVectorField& velocity, const surfaceScalarField& flux)
    : RegularisedBingham(name, properties, properties.optionalSubDict(word(typeName) + "Coeffs"), velocity,
                         flux),
      regularisation_time_(
          positive(properties.optionalSubDict(word(typeName) + "Coeffs"), "regularisationTime")) {}

scalar PapanastasiouBingham::viscosity(scalar plastic_viscosity, scalar yield_stress, scalar rate) const {
  return flowrest::laws::Papanastasiou::viscosity<scalar>(
      {yield_stress, plastic_viscosity, regularisation_time_, 0.0}, rate);
}

biViscousBingham::biViscousBingham(const word& name, const dictionary& properties,
                                   const volVectorField& velocity, const surfaceScalarField& flux)
    : RegularisedBingham(name, properties, properties.optionalSubDict(word(typeName) + "Coeffs"), velocity,
                         flux),
      critical_shear_rate_(
          positive(properties.optionalSubDict(word(typeName) + "Coeffs"), "criticalShearRate")) {}

scalar biViscousBingham::viscosity(scalar plastic_viscosity, scalar yield_stress, scalar rate) const {
  return flowrest::laws::BiViscous::viscosity<scalar>(
      {yield_stress, plastic_viscosity, 0.0, critical_shear_rate_}, rate);
}

PapanastasiouHerschelBulkley::PapanastasiouHerschelBulkley(const word& name, const dictionary& properties,
                                                           const volVectorField& velocity,
                                                           const surfaceScalarField& flux)
    : RegularisedBingham(name, properties, properties.optionalSubDict(word(typeName) + "Coeffs"), velocity,
                         flux),
      regularisation_time_(
          positive(properties.optionalSubDict(word(typeName) + "Coeffs"), "regularisationTime")),
      flow_index_(positive(properties.optionalSubDict(word(typeName) + "Coeffs"), "flowIndex")) {}

scalar PapanastasiouHerschelBulkley::viscosity(scalar plastic_viscosity, scalar yield_stress,
                                               scalar rate) const {
  return flowrest::laws::HerschelBulkley::viscosity<scalar>(
      {yield_stress, plastic_viscosity, regularisation_time_, 0.0, flow_index_}, rate);
}

NewtonianConcrete::NewtonianConcrete(const word& name, const dictionary& properties,
                                     const volVectorField& velocity, const surfaceScalarField& flux)
    : RegularisedBingham(name, properties, properties.optionalSubDict(word(typeName) + "Coeffs"), velocity,
                         flux) {}

}  // namespace viscosityModels
}  // namespace Foam
