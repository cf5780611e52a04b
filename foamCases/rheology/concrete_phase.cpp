#include "foamCases/rheology/concrete_phase.h"

#include "Enum.H"
#include "foamCases/rheology/wetting.h"
#include "fvcFlux.H"
#include "gaussGrad.H"
#include "surfaceInterpolate.H"
#include "wallFvPatch.H"

namespace flowrest::rheology {

using namespace Foam;

namespace {

const Enum<StrainRate>& strain_rate_names() {
  static const Enum<StrainRate> names{{StrainRate::mixture, "mixture"}, {StrainRate::concrete, "concrete"}};
  return names;
}

const Enum<Mixing>& mixing_names() {
  static const Enum<Mixing> names{{Mixing::arithmetic, "arithmetic"},
                                  {Mixing::harmonic, "harmonic"},
                                  {Mixing::mass_weighted, "massWeighted"},
                                  {Mixing::saturating, "saturating"}};
  return names;
}

const Enum<Wetting>& wetting_names() {
  static const Enum<Wetting> names{{Wetting::fraction, "fraction"}, {Wetting::geometric, "geometric"}};
  return names;
}

/// Pa s
const dimensionedScalar none("none", dimDynamicViscosity, 0.0);

}  // namespace

PhaseRules PhaseRules::read(const dictionary& dict) {
  PhaseRules rules;
  rules.strain_rate = strain_rate_names().getOrDefault("strainRate", dict, rules.strain_rate);
  rules.mixing = mixing_names().getOrDefault("mixing", dict, rules.mixing);
  rules.full_at = dict.getOrDefault<scalar>("fullAt", rules.full_at);
  if (!(rules.full_at > 0.0 && rules.full_at <= 1.0))
    FatalIOErrorInFunction(dict) << "fullAt is " << rules.full_at
                                 << "; it must be a volume fraction above 0 and at most 1"
                                 << exit(FatalIOError);
  rules.wetting = wetting_names().getOrDefault("wetting", dict, rules.wetting);
  return rules;
}

ConcretePhase::ConcretePhase(const volVectorField& velocity, const surfaceScalarField& flux,
                             const word& phase, const dimensionedScalar& density)
    : velocity_(velocity), flux_(flux), phase_(phase), density_(density) {}

const volScalarField* ConcretePhase::find_fraction() const {
  return mesh().findObject<volScalarField>(IOobject::groupName("alpha", phase_));
}

const incompressibleTwoPhaseMixture* ConcretePhase::find_mixture() const {
  return mesh().findObject<incompressibleTwoPhaseMixture>("transportProperties");
}

bool ConcretePhase::is_first(const incompressibleTwoPhaseMixture& mixture) const {
  return mixture.phase1Name() == phase_;
}

bool ConcretePhase::alone() const { return find_fraction() == nullptr; }

tmp<volScalarField> ConcretePhase::fraction() const {
  if (const auto* alpha = find_fraction()) return min(max(*alpha, scalar(0)), scalar(1));
  return volScalarField::New("alpha", mesh(), dimensionedScalar(1.0));
}

tmp<volScalarField> ConcretePhase::amount() const { return fraction() + dimensionedScalar(trace); }

tmp<volScalarField> ConcretePhase::old_amount() const {
  const auto* alpha = find_fraction();
  if (alpha == nullptr) return amount();
  return max(alpha->oldTime(), scalar(0)) + dimensionedScalar(trace);
}

bool ConcretePhase::find_amount_flux(tmp<surfaceScalarField>& result) const {
  if (alone()) {
    result = (1.0 + trace) * flux_;
    return true;
  }
  const auto* mass_flux = mesh().findObject<surfaceScalarField>("rhoPhi");
  const auto* mixture = find_mixture();
  if (mass_flux == nullptr || mixture == nullptr) return false;
  const auto& other = is_first(*mixture) ? mixture->rho2() : mixture->rho1();
  result = (*mass_flux - other * flux_) / (density_ - other) + trace * flux_;
  return true;
}

tmp<surfaceVectorField> ConcretePhase::face_velocity(StrainRate rule) const {
  return rule == StrainRate::concrete && !alone() ? interpolate(velocity_) : fvc::interpolate(velocity_);
}

tmp<volTensorField> ConcretePhase::gradient_of(tmp<surfaceVectorField> face_velocity) const {
  // A face that is no cell's neighbour has the boundary's own velocity, whatever the rule.
  auto& boundary = face_velocity.ref().boundaryFieldRef();
  forAll(boundary, patch) {
    if (!boundary[patch].coupled()) boundary[patch] = velocity_.boundaryField()[patch];
  }
  auto gradient = fv::gaussGrad<vector>::gradf(face_velocity(), "grad(" + velocity_.name() + ")");
  fv::gaussGrad<vector>::correctBoundaryConditions(velocity_, gradient.ref());
  return gradient;
}

tmp<volTensorField> ConcretePhase::velocity_gradient(StrainRate rule) const {
  auto velocity = face_velocity(rule);
  if (rule == StrainRate::concrete && !alone()) {
    // Cells put their velocity together from faces on either side, and where one has air behind it, it does
    // not keep the volume: a spreading plug, which thins, would seem to widen upwards as well, and not be
    // sheared.
    const surfaceVectorField normal(mesh().Sf() / mesh().magSf());
    velocity.ref() += normal * (flux_ / mesh().magSf() - (normal & velocity()));
  }
  return gradient_of(std::move(velocity));
}

tmp<volTensorField> ConcretePhase::cell_velocity_gradient(StrainRate rule) const {
  return gradient_of(face_velocity(rule));
}

tmp<volScalarField> ConcretePhase::shear_rate(const volTensorField& gradient) {
  return std::sqrt(2.0) * mag(symm(gradient));
}

tmp<volScalarField> ConcretePhase::other_viscosity() const {
  const auto* mixture = find_mixture();
  if (alone() || mixture == nullptr) return volScalarField::New("otherViscosity", mesh(), none);
  return is_first(*mixture) ? mixture->rho2() * mixture->nuModel2().nu()
                            : mixture->rho1() * mixture->nuModel1().nu();
}

tmp<volScalarField> ConcretePhase::cell_weight(const PhaseRules& rules) const {
  const auto alpha = fraction();
  if (rules.mixing == Mixing::saturating) return min(alpha / rules.full_at, scalar(1));
  if (rules.mixing == Mixing::mass_weighted) {
    const auto* mixture = find_mixture();
    const auto& other = is_first(*mixture) ? mixture->rho2() : mixture->rho1();
    return alpha() * density_ / (alpha() * density_ + (1.0 - alpha()) * other);
  }
  return alpha;
}

void ConcretePhase::wet_walls(volScalarField& share) const {
  const auto alpha = fraction();
  const auto gradient = fv::gaussGrad<scalar>::gradf(fvc::interpolate(alpha()), "grad(alpha)");
  forAll(share.boundaryField(), p) {
    const fvPatch& wall = mesh().boundary()[p];
    if (!isA<wallFvPatch>(wall)) continue;
    const vectorField normal(wall.nf());
    auto& shares = share.boundaryFieldRef()[p];
    forAll(shares, face) {
      const label cell = wall.faceCells()[face];
      const vector& slope = gradient().primitiveField()[cell];
      const scalar towards = slope & normal[face];
      shares[face] =
          wetted_share(alpha().primitiveField()[cell], towards, mag(slope - towards * normal[face]));
    }
  }
}

tmp<volScalarField> ConcretePhase::weight(const PhaseRules& rules) const {
  if (alone()) return fraction();
  tmp<volScalarField> share = cell_weight(rules);
  if (rules.wetting == Wetting::geometric) wet_walls(share.ref());
  return share;
}

tmp<volScalarField> ConcretePhase::mixture_input(const PhaseRules& rules,
                                                 const volScalarField& viscosity) const {
  if (alone() || (rules.mixing == Mixing::arithmetic && rules.wetting == Wetting::fraction))
    return viscosity / density_;
  const auto alpha = fraction();
  const auto air = other_viscosity();
  const auto mixed = rules.mixing == Mixing::harmonic
                         ? 1.0 / (alpha() / viscosity + (1.0 - alpha()) / air())
                         : weight(rules) * viscosity + (1.0 - weight(rules)) * air();
  // The mixture adds the air's part by volume.
  return max(mixed - (1.0 - alpha()) * air(), none) / (max(fraction(), dimensionedScalar(trace)) * density_);
}

template <class Type>
tmp<GeometricField<Type, fvsPatchField, surfaceMesh>> ConcretePhase::interpolate(
    const GeometricField<Type, fvPatchField, volMesh>& field) const {
  const auto weights = amount();
  return fvc::interpolate(weights() * field) / fvc::interpolate(weights());
}

template tmp<surfaceVectorField> ConcretePhase::interpolate(const volVectorField&) const;
template tmp<surfaceTensorField> ConcretePhase::interpolate(const volTensorField&) const;
template tmp<surfaceSymmTensorField> ConcretePhase::interpolate(const volSymmTensorField&) const;

}  // namespace flowrest::rheology
