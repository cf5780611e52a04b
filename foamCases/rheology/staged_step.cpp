#include "foamCases/rheology/staged_step.h"

#include <algorithm>

#include "addToRunTimeSelectionTable.H"

namespace Foam {
namespace functionObjects {

defineTypeNameAndDebug(stagedStep, 0);
addToRunTimeSelectionTable(functionObject, stagedStep, dictionary);

stagedStep::stagedStep(const word& name, const Time& run_time, const dictionary& dict)
    : fvMeshFunctionObject(name, run_time, dict) {
  read(dict);
  bound_step();  // a run that is gone on with goes on as it was
}

bool stagedStep::read(const dictionary& dict) {
  phase_ = dict.getOrDefault<word>("phase", "concrete");
  least_ = dict.get<scalar>("least");
  most_ = dict.get<scalar>("most");
  of_time_ = dict.get<scalar>("ofTime");
  stillness_ = dict.get<scalar>("stillness");
  if (!(least_ > 0.0 && most_ >= least_ && of_time_ > 0.0 && stillness_ > 0.0))
    FatalIOErrorInFunction(dict) << "least, ofTime and stillness must be above 0, and most at least "
                                 << least_ << exit(FatalIOError);
  return fvMeshFunctionObject::read(dict);
}

void stagedStep::bound_step() const {
  if (most_ > least_)
    const_cast<dictionary&>(time_.controlDict())
        .set("maxDeltaT", std::clamp(of_time_ * time_.value(), least_, most_));
}

bool stagedStep::execute() {
  watch();
  bound_step();
  return true;
}

void stagedStep::watch() {
  const auto* velocity = mesh_.findObject<volVectorField>("U");
  const auto* fraction = mesh_.findObject<volScalarField>(IOobject::groupName("alpha", phase_));
  if (velocity == nullptr || fraction == nullptr) return;
  const vectorField& now = velocity->primitiveField();
  const scalar step = time_.deltaTValue();
  if (last_but_one_.size() == now.size()) {
    constexpr scalar concrete = 0.5;
    const scalar ratio = step / last_step_;
    vector sums = Zero;  // changed unforeseen and moved, m4/s; volume, m3
    forAll(now, cell) {
      if (fraction->primitiveField()[cell] < concrete) continue;
      const scalar volume = mesh_.V()[cell];
      const vector change = now[cell] - last_[cell];
      sums += volume * vector(mag(change - ratio * (last_[cell] - last_but_one_[cell])), mag(now[cell]), 1.0);
    }
    reduce(sums, sumOp<vector>());
    Info << "Chatter of U = " << sums.x() / (std::max(sums.y(), stillness_ * sums.z()) + VSMALL) << nl
         << "Noise of U = " << sums.x() / (sums.z() + VSMALL) << endl;
  }
  last_but_one_ = last_;
  last_ = now;
  last_step_ = step;
}

}  // namespace functionObjects
}  // namespace Foam
