#pragma once

#include <memory>

#include "foamCases/rheology/flocculation.h"
#include "laws/elasto_viscoplastic.h"
#include "turbulentTransportModel.H"

namespace Foam {
namespace laminarModels {

/// Stress model for `laminarModel` in turbulenceProperties: concrete as an elasto-viscoplastic Bingham solid
/// (Yu et al. 2026; of Saramito's type), which truly comes to rest because below yield its stress needs no
/// flow.
///
/// The deviatoric stress is state: carried with the concrete, turned with the spin (Hughes and Winget 1980),
/// strained elastically with the new velocity and returned to the flow law, cell by cell and
/// on the walls, once the velocity of the step is known. The momentum equation takes it semi-implicitly: in
/// the face's traction
///
///   n.s(U) + mu n.grad(U_new) - mu n.grad(U),   mu = 2 (tau / tau_trial) G dt,
///
/// s(U) is the law at the latest velocity, the second term implicit and compact, the third interpolated from
/// cells. The two cancel as the velocity settles (so a state at rest is one of the law alone), make elastic
/// waves implicit (no limit dx / sqrt(G / rho) on the step) and tie neighbouring cells' velocities together.
///
/// Walls with friction (coulombFriction) slide where the law would have them take more shear stress than they
/// give: the part of the velocity they then follow is the one that makes the wall's stress that limit, and
/// what a wall remembers never passes it.
///
/// Coefficients: `phase` (concrete unless given), `rho` (kg/m3), `youngsModulus` (Pa), `poissonRatio`,
/// `yieldStress` (Pa), `plasticViscosity` (Pa s), `flowIndex` (1 unless given), those of flowrest::rheology::PhaseRules, `faceWeight`
/// (harmonic | linear) and the optional `thixotropy` of flowrest::rheology::Flocculation. Fields: `stress`
/// (Pa) and `plasticShearRate` (1/s).
class elastoViscoplasticBingham : public incompressible::laminarModel {
 public:
  TypeName("elastoViscoplasticBingham");

  elastoViscoplasticBingham(const geometricOneField& alpha, const geometricOneField& rho,
                            const volVectorField& velocity, const surfaceScalarField& mass_flux,
                            const surfaceScalarField& flux, const transportModel& transport,
                            const word& properties_name = turbulenceModel::propertiesName,
                            const word& type = typeName);

  tmp<volSymmTensorField> R() const override;
  tmp<volSymmTensorField> devRhoReff() const override;
  tmp<fvVectorMatrix> divDevRhoReff(volVectorField& velocity) const override;
  tmp<fvVectorMatrix> divDevRhoReff(const volScalarField& rho, volVectorField& velocity) const override;
  void correct() override;

 private:
  /// What the law makes of the latest velocity.
  struct Response {
    volSymmTensorField stress;
    volScalarField rate;
    volScalarField viscosity;  ///< (tau / tau_trial) G dt, Pa s
    volScalarField flocculation;
  };

  bool has_wall(label patch) const;
  /// The stress as the step finds it: carried and turned; from the old time however often it is called.
  void carry() const;
  Response respond(const volTensorField& gradient) const;
  /// The law at a place whose trial stress is known.
  struct Returned {
    symmTensor stress;
    scalar rate, viscosity, flocculation;
  };
  Returned relaxed(const symmTensor& carried, const tensor& gradient, scalar flocculation) const;
  /// Lets walls with friction slide as the velocity and what is carried ask for; holds what they return.
  void slide(volVectorField& velocity) const;
  void hold_to_friction(Response&) const;
  /// Largest shear stress in the concrete on each wall with friction, Pa; nothing for other patches.
  PtrList<scalarField> friction_limits() const;
  surfaceScalarField face_weight() const;
  /// minus the divergence of the stress, Pa/m times volume.
  tmp<fvVectorMatrix> minus_divergence(volVectorField& velocity) const;

  flowrest::rheology::ConcretePhase phase_;
  flowrest::rheology::PhaseRules rules_;
  bool harmonic_faces_;
  dimensionedScalar shear_modulus_;
  flowrest::laws::Parameters<scalar> law_;
  flowrest::laws::Structure<scalar> structure_;
  std::unique_ptr<flowrest::rheology::Flocculation> flocculation_;
  volSymmTensorField stress_;  ///< after the last completed step
  volScalarField plastic_rate_;
  mutable volSymmTensorField carried_;  ///< at the new time, before the step's strain
  mutable scalar grown_ = 0.0;          ///< Pa, of the yield stress with age, at the new time
};

}  // namespace laminarModels
}  // namespace Foam
