#include "foamCases/rheology/coulomb_friction.h"

#include <algorithm>

#include "IStringStream.H"
#include "addToRunTimeSelectionTable.H"
#include "turbulenceModel.H"
#include "volFields.H"

namespace Foam {

namespace {

/// The dictionary with what a user need not write.
dictionary completed(const dictionary& dict) {
  dictionary whole(dict);
  if (!whole.found("valueFraction")) whole.merge(dictionary(IStringStream("valueFraction uniform 1;")()));
  return whole;
}

}  // namespace

coulombFrictionFvPatchVectorField::coulombFrictionFvPatchVectorField(
    const fvPatch& patch, const DimensionedField<vector, volMesh>& field)
    : partialSlipFvPatchVectorField(patch, field) {}

coulombFrictionFvPatchVectorField::coulombFrictionFvPatchVectorField(
    const fvPatch& patch, const DimensionedField<vector, volMesh>& field, const dictionary& dict)
    : partialSlipFvPatchVectorField(patch, field, completed(dict)), friction_(dict.get<scalar>("friction")) {
  if (!(friction_ >= 0.0))
    FatalIOErrorInFunction(dict) << "friction is " << friction_ << "; it must be at least 0"
                                 << exit(FatalIOError);
}

coulombFrictionFvPatchVectorField::coulombFrictionFvPatchVectorField(
    const coulombFrictionFvPatchVectorField& other, const fvPatch& patch,
    const DimensionedField<vector, volMesh>& field, const fvPatchFieldMapper& mapper)
    : partialSlipFvPatchVectorField(other, patch, field, mapper), friction_(other.friction_) {}

coulombFrictionFvPatchVectorField::coulombFrictionFvPatchVectorField(
    const coulombFrictionFvPatchVectorField& other)
    : partialSlipFvPatchVectorField(other), friction_(other.friction_) {}

coulombFrictionFvPatchVectorField::coulombFrictionFvPatchVectorField(
    const coulombFrictionFvPatchVectorField& other, const DimensionedField<vector, volMesh>& field)
    : partialSlipFvPatchVectorField(other, field), friction_(other.friction_) {}

tmp<scalarField> coulombFrictionFvPatchVectorField::limit(const scalarField& pull) const {
  const auto* pressure = db().findObject<volScalarField>("p");
  if (pressure == nullptr) return tmp<scalarField>(new scalarField(patch().size(), 0.0));
  return friction_ * max(pressure->boundaryField()[patch().index()] - pull, scalar(0));
}

void coulombFrictionFvPatchVectorField::updateCoeffs() {
  if (updated()) return;
  const auto* model = db().findObject<turbulenceModel>(turbulenceModel::propertiesName);
  const auto* density = db().findObject<volScalarField>("rho");
  const bool state_is_stress = db().foundObject<volSymmTensorField>("stress");
  if (model != nullptr && density != nullptr && !state_is_stress) {
    const label p = patch().index();
    const scalarField& rho = density->boundaryField()[p];
    const scalarField& by_distance = patch().deltaCoeffs();
    const scalarField viscosity(rho * model->nuEff(p));
    const vectorField normal(patch().nf());
    const vectorField inside(patchInternalField());
    const scalarField onto(inside & normal);
    // n.D.n at the wall, which nothing passes.
    const scalarField pull(-2.0 * viscosity * onto * by_distance);
    const scalarField most(limit(pull));
    const scalar dt = db().time().deltaTValue();
    scalarField& fraction = valueFraction();
    implicit_.setSize(fraction.size());
    forAll(fraction, face) {
      const scalar speed = mag(inside[face] - onto[face] * normal[face]);
      const scalar stuck = viscosity[face] * by_distance[face] * speed;
      const bool slides = stuck > most[face];
      fraction[face] = slides ? most[face] / stuck : 1.0;
      // What the wall takes from the cell on it in a step, were the cell alone.
      const scalar taken = 0.5 * most[face] * by_distance[face] * dt / rho[face];
      implicit_[face] = slides ? min(1.0, taken / speed) : 1.0;
    }
  }
  partialSlipFvPatchVectorField::updateCoeffs();
}

/// Face by face: the base's product of a tensor with a temporary vector is written over while it is made on
/// walls that lean (see inclinedCells).
void coulombFrictionFvPatchVectorField::evaluate(const Pstream::commsTypes) {
  if (!updated()) updateCoeffs();
  vectorField along(patchInternalField());
  const vectorField normal(patch().nf());
  forAll(along, face) {
    const vector inside = along[face];
    along[face] = (1.0 - valueFraction()[face]) * (inside - normal[face] * (normal[face] & inside));
  }
  vectorField::operator=(along);
  fvPatchVectorField::evaluate();
}

tmp<vectorField> coulombFrictionFvPatchVectorField::snGradTransformDiag() const {
  if (implicit_.size() != patch().size()) return partialSlipFvPatchVectorField::snGradTransformDiag();
  const scalarField held(implicit_ * valueFraction());
  vectorField diagonal(patch().nf());
  forAll(diagonal, face) {
    for (direction d = 0; d < vector::nComponents; ++d)
      diagonal[face][d] = held[face] + (1.0 - held[face]) * mag(diagonal[face][d]);
  }
  return tmp<vectorField>(new vectorField(diagonal));
}

void coulombFrictionFvPatchVectorField::write(Ostream& stream) const {
  partialSlipFvPatchVectorField::write(stream);
  stream.writeEntry("friction", friction_);
}

makePatchTypeField(fvPatchVectorField, coulombFrictionFvPatchVectorField);

}  // namespace Foam
