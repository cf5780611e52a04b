#pragma once

#include <memory>

#include "foamCases/rheology/flocculation.h"
#include "viscosityModel.H"

/// Viscosity models for `transportModel` in transportProperties: concrete as a regularised Bingham fluid, as
/// that of Herschel and Bulkley, and as a Newtonian one.
namespace Foam {
namespace viscosityModels {

/// What they share. Keywords, beside those of flowrest::rheology::PhaseRules: `rho` (kg/m3), `yieldStress`
/// (Pa), `plasticViscosity` (Pa s) and, for thixotropy, a dictionary `thixotropy` as
/// flowrest::rheology::Flocculation has it.
class RegularisedBingham : public viscosityModel {
 public:
  RegularisedBingham(const word& name, const dictionary& properties, const dictionary& coefficients,
                     const volVectorField& velocity, const surfaceScalarField& flux);

  tmp<volScalarField> nu() const override { return nu_; }
  tmp<scalarField> nu(const label patch) const override { return nu_.boundaryField()[patch]; }
  void correct() override;
  bool read(const dictionary& properties) override;

 protected:
  /// Apparent viscosity at a yield stress that includes flocculation, Pa s.
  virtual scalar viscosity(scalar plastic_viscosity, scalar yield_stress, scalar rate) const = 0;

 private:
  tmp<volScalarField> yield_stress(const volScalarField& rate);

  flowrest::rheology::ConcretePhase phase_;
  flowrest::rheology::PhaseRules rules_;
  dimensionedScalar yield_stress_;
  dimensionedScalar plastic_viscosity_;
  std::unique_ptr<flowrest::rheology::Flocculation> flocculation_;
  volScalarField nu_;
};

/// Papanastasiou's law (Yu et al. 2026, Eq. 10); keyword `regularisationTime` (s).
class PapanastasiouBingham : public RegularisedBingham {
 public:
  TypeName("PapanastasiouBingham");
  PapanastasiouBingham(const word& name, const dictionary& properties, const volVectorField& velocity,
                       const surfaceScalarField& flux);

 protected:
  scalar viscosity(scalar plastic_viscosity, scalar yield_stress, scalar rate) const override;

 private:
  scalar regularisation_time_;
};

/// The bi-viscous law, tau = eta rate + tau0 min(rate / critical, 1); keyword `criticalShearRate` (1/s).
class biViscousBingham : public RegularisedBingham {
 public:
  TypeName("biViscousBingham");
  biViscousBingham(const word& name, const dictionary& properties, const volVectorField& velocity,
                   const surfaceScalarField& flux);

 protected:
  scalar viscosity(scalar plastic_viscosity, scalar yield_stress, scalar rate) const override;

 private:
  scalar critical_shear_rate_;
};

/// Herschel and Bulkley's law with Papanastasiou's regularisation (laws/herschel_bulkley.h), the consistency
/// (Pa s^n) as `plasticViscosity`; keywords `regularisationTime` (s) and `flowIndex`.
class PapanastasiouHerschelBulkley : public RegularisedBingham {
 public:
  TypeName("PapanastasiouHerschelBulkley");
  PapanastasiouHerschelBulkley(const word& name, const dictionary& properties, const volVectorField& velocity,
                               const surfaceScalarField& flux);

 protected:
  scalar viscosity(scalar plastic_viscosity, scalar yield_stress, scalar rate) const override;

 private:
  scalar regularisation_time_;
  scalar flow_index_;
};

/// One viscosity, mixed with the air's and held by walls as that of the other laws is.
class NewtonianConcrete : public RegularisedBingham {
 public:
  TypeName("NewtonianConcrete");
  NewtonianConcrete(const word& name, const dictionary& properties, const volVectorField& velocity,
                    const surfaceScalarField& flux);

 protected:
  scalar viscosity(scalar plastic_viscosity, scalar, scalar) const override { return plastic_viscosity; }
};

}  // namespace viscosityModels
}  // namespace Foam
