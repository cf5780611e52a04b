#pragma once

#include "fvMatrix.H"
#include "fvOption.H"
#include "surfaceFields.H"
#include "volFields.H"

namespace Foam {
namespace fv {

/// Solves the momentum predictor on cells that lean, and mends the velocity that a faulty build makes of it.
///
/// interFoam takes forces from faces to cells by U = inv(sum n S) & sum n f. In Debian's 1912 (as rebuilt
/// with a later compiler) the product of every second cell writes over the vector while it still reads from
/// it: y and z take the new x. On boxes along the axes the tensor is diagonal and nothing is seen;
/// where cells lean, around bars and on slopes, metres per second come out of nothing in the first step. The
/// product is undone here and made anew after every corrector, which interFoam lets an option do (`correct`).
/// What it would do in its predictor cannot be mended afterwards: the case says `momentumPredictor no`, and
/// this option solves it (`constrain`).
///
/// Which cells the running program has wrong, if any, is asked of its own function, once. Cases on boxes do
/// not need this.
class inclinedCells : public option {
 public:
  TypeName("inclinedCells");

  inclinedCells(const word& name, const word& model, const dictionary& dict, const fvMesh& mesh);

  void constrain(fvMatrix<vector>& equation, label field) override;
  void correct(volVectorField& velocity) override;
  bool read(const dictionary&) override { return true; }

 private:
  /// From faces to cells, as it is meant.
  tmp<vectorField> to_cells(const surfaceScalarField& flux) const;
  /// Asks the running program which cells it has wrong.
  void find_faulty();
  /// What a product should have been that was written over while it was made.
  vector mended(label cell, const vector& wrong) const;
  /// Remembers what the next corrector begins with.
  void remember();

  tensorField inverse_;  ///< of sum n S, 1/m2
  DynamicList<label> faulty_;
  const fvMatrix<vector>* equation_ = nullptr;  ///< of the step, while it is being corrected
  vectorField begins_with_;                     ///< H / A, m/s
};

}  // namespace fv
}  // namespace Foam
