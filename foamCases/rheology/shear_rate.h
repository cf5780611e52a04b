#pragma once

#include "foamCases/rheology/concrete_phase.h"
#include "fvMeshFunctionObject.H"

namespace Foam {
namespace functionObjects {

/// Keeps the field `shearRate`, sqrt(2 D:D) of the concrete in 1/s, for whoever writes it.
///
/// Keywords: `phase` (concrete unless given) and `strainRate` as the laws have it.
class shearRate : public fvMeshFunctionObject {
 public:
  TypeName("shearRate");

  shearRate(const word& name, const Time& run_time, const dictionary& dict);

  bool read(const dictionary& dict) override;
  bool execute() override;
  bool write() override { return true; }

 private:
  word phase_;
  flowrest::rheology::PhaseRules rules_;
  volScalarField rate_;
};

}  // namespace functionObjects
}  // namespace Foam
