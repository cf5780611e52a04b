#pragma once

#include "partialSlipFvPatchFields.H"

namespace Foam {

/// Velocity at a rough wall: concrete sticks to it while that takes no more shear stress than the wall's
/// friction gives, and slides at that stress beyond (Coulomb): |t| <= mu max(p_n, 0), p_n the pressure on the
/// wall, the weight of what lies over it included.
///
/// The wall's velocity is the part (1 - valueFraction) of the velocity along the wall in the cell on it, so
/// the stress is implicit in the velocity and never turns it round: a layer that is slowed comes to a stop.
/// For a viscosity (any law, any mixture) the fraction that gives the limit is found here; a stress model
/// with a state of its own finds it itself and calls let_slide.
///
/// Keywords: `friction`, and `valueFraction` (1 unless given) to start from.
class coulombFrictionFvPatchVectorField : public partialSlipFvPatchVectorField {
 public:
  TypeName("coulombFriction");

  coulombFrictionFvPatchVectorField(const fvPatch&, const DimensionedField<vector, volMesh>&);
  coulombFrictionFvPatchVectorField(const fvPatch&, const DimensionedField<vector, volMesh>&,
                                    const dictionary&);
  coulombFrictionFvPatchVectorField(const coulombFrictionFvPatchVectorField&, const fvPatch&,
                                    const DimensionedField<vector, volMesh>&, const fvPatchFieldMapper&);
  coulombFrictionFvPatchVectorField(const coulombFrictionFvPatchVectorField&);
  coulombFrictionFvPatchVectorField(const coulombFrictionFvPatchVectorField&,
                                    const DimensionedField<vector, volMesh>&);

  tmp<fvPatchVectorField> clone() const override {
    return tmp<fvPatchVectorField>(new coulombFrictionFvPatchVectorField(*this));
  }
  tmp<fvPatchVectorField> clone(const DimensionedField<vector, volMesh>& field) const override {
    return tmp<fvPatchVectorField>(new coulombFrictionFvPatchVectorField(*this, field));
  }

  void updateCoeffs() override;
  void evaluate(const Pstream::commsTypes comms = Pstream::commsTypes::blocking) override;
  tmp<vectorField> snGradTransformDiag() const override;
  void write(Ostream&) const override;

  /// Largest shear stress that the wall gives, Pa; `pull` is the deviatoric stress along the normal that the
  /// concrete pulls at it with.
  tmp<scalarField> limit(const scalarField& pull) const;

 private:
  scalar friction_ = 0.0;
  scalarField implicit_;  ///< part of the wall's stress that answers to the new velocity
};

}  // namespace Foam
