#include "foamCases/rheology/elasto_viscoplastic_bingham.h"

#include "addToRunTimeSelectionTable.H"
#include "basicSymmetryFvPatchFields.H"
#include "foamCases/rheology/coulomb_friction.h"
#include "fvcSurfaceIntegrate.H"
#include "fvmLaplacian.H"
#include "zeroGradientFvPatchFields.H"

namespace Foam {
namespace laminarModels {

using incompressible::laminarModel;

defineTypeNameAndDebug(elastoViscoplasticBingham, 0);
addToRunTimeSelectionTable(laminarModel, elastoViscoplasticBingham, dictionary);

namespace {

/// A wall whose cell held less concrete than this has no memory of its own: it takes the cell's.
constexpr scalar wetted = 1e-2;

/// The pull along a face's normal, and that of a swirl about an axis, answers with 2 G dt where shear answers
/// with G dt; what is implicit must not be less, or they swing: at the surface, where incompressibility does
/// not hold them, and on the axis. (With an implicit share b and a = G dt^2 k^2 / rho, the amplification is
/// stable for all a only from b = 2.)
constexpr scalar implicitness = 2.0;

/// R s R^T with R = (I - W dt/2)^-1 (I + W dt/2), W the spin: the stress turns rigidly, its invariants
/// unchanged.
symmTensor turned(const symmTensor& stress, const tensor& gradient, scalar dt) {
  const tensor spin = 0.5 * dt * skew(gradient.T());  // OpenFOAM's gradient is d U_j / d x_i
  const tensor rotation = inv(I - spin) & (I + spin);
  return symm(rotation & stress & rotation.T());
}

scalar modulus(const dictionary& dict) {
  const scalar young = dict.get<scalar>("youngsModulus"), poisson = dict.get<scalar>("poissonRatio");
  if (!(young > 0.0) || !(poisson > -1.0 && poisson <= 0.5))
    FatalIOErrorInFunction(dict) << "youngsModulus " << young << " and poissonRatio " << poisson
                                 << "; they must be above 0, and above -1 and at most 0.5"
                                 << exit(FatalIOError);
  return young / (2.0 * (1.0 + poisson));
}

template <class Field>
Field like(const word& name, const fvMesh& mesh, const typename Field::value_type& value,
           const dimensionSet& dims, const word& patch_type,
           IOobject::writeOption write = IOobject::NO_WRITE) {
  return Field(IOobject(name, mesh.time().timeName(), mesh,
                        write == IOobject::AUTO_WRITE ? IOobject::READ_IF_PRESENT : IOobject::NO_READ, write),
               mesh, dimensioned<typename Field::value_type>(name, dims, value), patch_type);
}

const char* const calculated = "calculated";

}  // namespace

elastoViscoplasticBingham::elastoViscoplasticBingham(
    const geometricOneField& alpha, const geometricOneField& rho, const volVectorField& velocity,
    const surfaceScalarField& mass_flux, const surfaceScalarField& flux, const transportModel& transport,
    const word& properties_name, const word& type)
    : laminarModel(type, alpha, rho, velocity, mass_flux, flux, transport, properties_name),
      phase_(velocity, flux, coeffDict_.getOrDefault<word>("phase", "concrete"),
             dimensionedScalar("rho", dimDensity, coeffDict_)),
      rules_(flowrest::rheology::PhaseRules::read(coeffDict_)),
      harmonic_faces_(coeffDict_.getOrDefault<word>("faceWeight", "harmonic") == "harmonic"),
      shear_modulus_("shearModulus", dimPressure, modulus(coeffDict_)),
      stress_(like<volSymmTensorField>("stress", velocity.mesh(), Zero, dimPressure, calculated,
                                       IOobject::AUTO_WRITE)),
      plastic_rate_(like<volScalarField>("plasticShearRate", velocity.mesh(), 0.0, dimless / dimTime,
                                         calculated, IOobject::AUTO_WRITE)),
      carried_(like<volSymmTensorField>("carriedStress", velocity.mesh(), Zero, dimPressure,
                                        zeroGradientFvPatchSymmTensorField::typeName)) {
  if (rules_.mixing == flowrest::rheology::Mixing::harmonic)
    FatalIOErrorInFunction(coeffDict_)
        << "mixing harmonic mixes viscosities, which an elastic solid has none of; "
        << "allowed: arithmetic, massWeighted, saturating" << exit(FatalIOError);
  law_.yield_stress = coeffDict_.get<scalar>("yieldStress");
  law_.plastic_viscosity = coeffDict_.get<scalar>("plasticViscosity");
  law_.flow_index = coeffDict_.getOrDefault<scalar>("flowIndex", 1.0);
  if (const dictionary* thixotropy = coeffDict_.findDict("thixotropy")) {
    flocculation_ = std::make_unique<flowrest::rheology::Flocculation>(
        phase_, *thixotropy, dimensionedScalar("yieldStress", dimPressure, law_.yield_stress));
    structure_ = flocculation_->structure();
  }
}

/// Whether a patch bounds the material: not a wedge, a periodic side or a face to another subdomain.
bool elastoViscoplasticBingham::has_wall(label patch) const {
  return isA<zeroGradientFvPatchSymmTensorField>(carried_.boundaryField()[patch]);
}

void elastoViscoplasticBingham::carry() const {
  carried_.primitiveFieldRef() = stress_.primitiveField();
  const volSymmTensorField old(carried_);
  flowrest::rheology::carry_with_concrete(phase_, old, carried_);
  if (flocculation_) {
    flocculation_->carry();
    grown_ = flocculation_->grown();
  }

  const scalar dt = runTime_.deltaTValue();
  const auto gradient = phase_.velocity_gradient(rules_.strain_rate);
  const auto amount = phase_.old_amount();
  PtrList<symmTensorField> walls(carried_.boundaryField().size());
  forAll(walls, p) {
    walls.set(p, new symmTensorField(carried_.boundaryField()[p]));
    auto& wall = walls[p];
    if (!has_wall(p)) continue;
    // At rest the cell's stress does not change, and a wall's is its own.
    const labelUList& cells = mesh_.boundary()[p].faceCells();
    forAll(wall, face) {
      const label cell = cells[face];
      if (amount().primitiveField()[cell] < wetted)
        wall[face] = carried_.primitiveField()[cell];
      else
        wall[face] =
            stress_.boundaryField()[p][face] + carried_.primitiveField()[cell] - old.primitiveField()[cell];
      wall[face] = turned(wall[face], gradient().boundaryField()[p][face], dt);
    }
  }
  auto& cells = carried_.primitiveFieldRef();
  forAll(cells, i) cells[i] = turned(cells[i], gradient().primitiveField()[i], dt);
  carried_.correctBoundaryConditions();  // wedges and other subdomains
  forAll(walls, p) {
    if (has_wall(p)) carried_.boundaryFieldRef()[p] == walls[p];
  }
}

elastoViscoplasticBingham::Returned elastoViscoplasticBingham::relaxed(const symmTensor& carried,
                                                                       const tensor& gradient,
                                                                       scalar flocculation) const {
  const scalar dt = runTime_.deltaTValue(), shear = shear_modulus_.value() * dt;
  const symmTensor trial = carried + 2.0 * shear * dev(symm(gradient));  // Yu et al. 2026, Eq. 37
  const scalar tau = std::sqrt(0.5) * mag(trial);
  const auto back = flowrest::laws::ElastoViscoplastic::relax<scalar>(law_, structure_, {tau, shear}, dt,
                                                                      flocculation, grown_);
  const scalar kept = tau > VSMALL ? back.stress / tau : 1.0;
  return {kept * trial, back.rate, kept * shear, back.flocculation};
}

elastoViscoplasticBingham::Response elastoViscoplasticBingham::respond(const volTensorField& gradient) const {
  Response response{like<volSymmTensorField>("responseStress", mesh_, Zero, dimPressure, calculated),
                    like<volScalarField>("responseRate", mesh_, 0.0, dimless / dimTime, calculated),
                    like<volScalarField>("responseViscosity", mesh_, 0.0, dimDynamicViscosity, calculated),
                    like<volScalarField>("responseFlocculation", mesh_, 0.0, dimless, calculated)};
  const auto fill = [&](const symmTensorField& carried, const tensorField& gradients,
                        const scalarField* flocculations, symmTensorField& stress, scalarField& rate,
                        scalarField& viscosity, scalarField& flocculation) {
    forAll(stress, i) {
      const Returned back = relaxed(carried[i], gradients[i], flocculations ? (*flocculations)[i] : 0.0);
      stress[i] = back.stress;
      rate[i] = back.rate;
      viscosity[i] = back.viscosity;
      flocculation[i] = back.flocculation;
    }
  };
  const auto* flocculation = flocculation_ ? &flocculation_->field() : nullptr;
  fill(carried_.primitiveField(), gradient.primitiveField(),
       flocculation ? &flocculation->primitiveField() : nullptr, response.stress.primitiveFieldRef(),
       response.rate.primitiveFieldRef(), response.viscosity.primitiveFieldRef(),
       response.flocculation.primitiveFieldRef());
  forAll(response.stress.boundaryField(), p) {
    if (has_wall(p))
      fill(carried_.boundaryField()[p], gradient.boundaryField()[p],
           flocculation ? &static_cast<const scalarField&>(flocculation->boundaryField()[p]) : nullptr,
           response.stress.boundaryFieldRef()[p], response.rate.boundaryFieldRef()[p],
           response.viscosity.boundaryFieldRef()[p], response.flocculation.boundaryFieldRef()[p]);
  }
  response.stress.correctBoundaryConditions();
  response.viscosity.correctBoundaryConditions();
  hold_to_friction(response);
  return response;
}

PtrList<scalarField> elastoViscoplasticBingham::friction_limits() const {
  PtrList<scalarField> limits(mesh_.boundary().size());
  tmp<volScalarField> weight;
  forAll(limits, p) {
    const auto* wall =
        dynamic_cast<const coulombFrictionFvPatchVectorField*>(&phase_.velocity().boundaryField()[p]);
    if (wall == nullptr) continue;
    if (!weight.valid()) weight = phase_.weight(rules_);
    const scalarField& share = weight().boundaryField()[p];
    const vectorField normal(mesh_.boundary()[p].nf());
    const scalarField pull((normal & stress_.boundaryField()[p]) & normal);
    limits.set(p, new scalarField(wall->limit(share * pull) / max(share, wetted)));
  }
  return limits;
}

void elastoViscoplasticBingham::slide(volVectorField& velocity) const {
  constexpr int most_rounds = 20;
  constexpr scalar close_enough = 1e-3;  // of the limit
  const PtrList<scalarField> limits = friction_limits();
  tmp<volTensorField> gradient;
  forAll(limits, p) {
    if (!limits.set(p)) continue;
    auto& wall = refCast<coulombFrictionFvPatchVectorField>(velocity.boundaryFieldRef()[p]);
    if (!gradient.valid()) gradient = phase_.velocity_gradient(rules_.strain_rate);
    const scalarField& most = limits[p];
    const vectorField inside(wall.patchInternalField()), normals(wall.patch().nf());
    const scalarField& by_distance = wall.patch().deltaCoeffs();
    const labelUList& cells = wall.patch().faceCells();
    scalarField& fraction = wall.valueFraction();
    forAll(fraction, face) {
      const vector& n = normals[face];
      const vector onto = n * (n & inside[face]), along = inside[face] - onto;
      const tensor& in_cell = gradient().primitiveField()[cells[face]];
      const symmTensor& carried = carried_.boundaryField()[p][face];
      const scalar flocculation = flocculation_ ? flocculation_->field().boundaryField()[p][face] : 0.0;
      // Shear stress on the wall over the limit where the wall holds the part `part` of the velocity.
      const auto excess = [&](scalar part) {
        const vector slope = -by_distance[face] * (onto + part * along);
        const vector traction =
            n & relaxed(carried, in_cell + n * (slope - (n & in_cell)), flocculation).stress;
        return mag(traction - n * (n & traction)) - most[face];
      };
      scalar low = 0.0, high = 1.0, below = excess(0.0), above = excess(1.0);
      fraction[face] = above <= 0.0 ? 1.0 : 0.0;
      if (above <= 0.0 || below >= 0.0) continue;
      // Regula falsi as the Illinois algorithm has it.
      for (int round = 0; round < most_rounds && high - low > SMALL; ++round) {
        const scalar part = (low * above - high * below) / (above - below), here = excess(part);
        fraction[face] = part;
        if (mag(here) <= close_enough * most[face]) break;
        if (here > 0.0) {
          high = part;
          above = here;
          below *= 0.5;
        } else {
          low = part;
          below = here;
          above *= 0.5;
        }
      }
    }
    wall.evaluate();
  }
}

/// Shear stress that a wall no longer gives, because the pressure on it has fallen, is gone.
void elastoViscoplasticBingham::hold_to_friction(Response& response) const {
  const PtrList<scalarField> limits = friction_limits();
  forAll(limits, p) {
    if (!limits.set(p)) continue;
    const scalarField& most = limits[p];
    const vectorField normals(mesh_.boundary()[p].nf());
    symmTensorField& stress = response.stress.boundaryFieldRef()[p];
    forAll(stress, face) {
      const vector& n = normals[face];
      const vector traction = n & stress[face], along = traction - n * (n & traction);
      const scalar size = mag(along);
      if (size > most[face]) stress[face] += twoSymm(n * ((most[face] / size - 1.0) * along));
    }
  }
}

/// Concrete pulls on a face only as far as there is concrete on both sides: on the one that bounds it, it
/// does not.
surfaceScalarField elastoViscoplasticBingham::face_weight() const {
  const auto share = phase_.weight(rules_);
  if (!harmonic_faces_) return surfaceScalarField("faceWeight", fvc::interpolate(share));
  return surfaceScalarField("faceWeight", 1.0 / fvc::interpolate(1.0 / max(share, scalar(SMALL))));
}

tmp<fvVectorMatrix> elastoViscoplasticBingham::minus_divergence(volVectorField& velocity) const {
  carry();
  slide(velocity);
  const auto gradient = phase_.velocity_gradient(rules_.strain_rate);
  const Response response = respond(gradient());
  const surfaceScalarField weight(face_weight());
  const surfaceScalarField air(fvc::interpolate(phase_.other_viscosity()));
  const surfaceTensorField face_gradient(
      phase_.interpolate(phase_.cell_velocity_gradient(rules_.strain_rate)()));
  const surfaceSymmTensorField face_stress(phase_.interpolate(response.stress));
  const surfaceScalarField viscosity(
      "stressViscosity", implicitness * weight * fvc::interpolate(response.viscosity) + (1.0 - weight) * air);
  const surfaceVectorField& area = mesh_.Sf();
  surfaceVectorField pull(weight * (area & face_stress));
  forAll(pull.boundaryField(), p) {
    if (!isA<basicSymmetryFvPatchVectorField>(velocity.boundaryField()[p])) continue;
    const vectorField normal(mesh_.boundary()[p].nf());
    pull.boundaryFieldRef()[p] =
        normal * (normal & pull.boundaryField()[p]);  // a slip wall holds nothing back
  }
  pull += (area & ((1.0 - weight) * air * twoSymm(face_gradient) - viscosity * face_gradient));
  return -fvc::surfaceIntegrate(pull) - fvm::laplacian(viscosity, velocity);
}

tmp<fvVectorMatrix> elastoViscoplasticBingham::divDevRhoReff(const volScalarField&,
                                                             volVectorField& velocity) const {
  return minus_divergence(velocity);
}

tmp<fvVectorMatrix> elastoViscoplasticBingham::divDevRhoReff(volVectorField& velocity) const {
  return (1.0 / phase_.density()) * minus_divergence(velocity);
}

tmp<volSymmTensorField> elastoViscoplasticBingham::R() const { return -stress_ / phase_.density(); }

tmp<volSymmTensorField> elastoViscoplasticBingham::devRhoReff() const {
  return -phase_.weight(rules_) * stress_;
}

void elastoViscoplasticBingham::correct() {
  laminarModel::correct();
  slide(const_cast<volVectorField&>(phase_.velocity()));
  const Response response = respond(phase_.velocity_gradient(rules_.strain_rate)());
  stress_ == response.stress;
  plastic_rate_ == response.rate;
  if (flocculation_) {
    flocculation_->field().primitiveFieldRef() = response.flocculation.primitiveField();
    flocculation_->field().correctBoundaryConditions();
  }
}

}  // namespace laminarModels
}  // namespace Foam
