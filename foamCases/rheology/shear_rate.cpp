#include "foamCases/rheology/shear_rate.h"

#include "addToRunTimeSelectionTable.H"

namespace Foam {
namespace functionObjects {

defineTypeNameAndDebug(shearRate, 0);
addToRunTimeSelectionTable(functionObject, shearRate, dictionary);

shearRate::shearRate(const word& name, const Time& run_time, const dictionary& dict)
    : fvMeshFunctionObject(name, run_time, dict),
      rate_(IOobject("shearRate", run_time.timeName(), mesh_, IOobject::NO_READ, IOobject::NO_WRITE), mesh_,
            dimensionedScalar(dimless / dimTime, Zero)) {
  read(dict);
}

bool shearRate::read(const dictionary& dict) {
  phase_ = dict.getOrDefault<word>("phase", "concrete");
  rules_ = flowrest::rheology::PhaseRules::read(dict);
  return fvMeshFunctionObject::read(dict);
}

bool shearRate::execute() {
  const auto* velocity = mesh_.findObject<volVectorField>("U");
  const auto* flux = mesh_.findObject<surfaceScalarField>("phi");
  if (velocity == nullptr || flux == nullptr) return true;
  const flowrest::rheology::ConcretePhase concrete(*velocity, *flux, phase_,
                                                   dimensionedScalar("rho", dimDensity, 1.0));
  rate_ = flowrest::rheology::ConcretePhase::shear_rate(concrete.velocity_gradient(rules_.strain_rate));
  return true;
}

}  // namespace functionObjects
}  // namespace Foam
