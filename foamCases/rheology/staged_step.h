#pragma once

#include "fvMeshFunctionObject.H"
#include "volFields.H"

namespace Foam {
namespace functionObjects {

/// Watches how the concrete's velocity changes from step to step, and lets the step grow once it changes
/// slowly.
///
/// After every step it prints the change of the velocity over the step, and its chatter: what of that change
/// the one before did not foretell. Both are means over the concrete relative to its mean speed, or to
/// `stillness` (m/s) where it is slower than that.
///
/// The bound on the step (`maxDeltaT` of the controlDict in memory) is the part `ofTime` of the time passed,
/// between `least` and `most` (s): the speed of a slump that slows falls as a power of the time, so the
/// velocity changes by a few times `ofTime` over a step, at any time. It hangs on nothing but the time, so
/// noise cannot move it, and a run that is gone on with has the step it would have had. The Courant number
/// bounds the step as before. With `least` and `most` equal it only watches.
class stagedStep : public fvMeshFunctionObject {
 public:
  TypeName("stagedStep");

  stagedStep(const word& name, const Time& run_time, const dictionary& dict);

  bool read(const dictionary& dict) override;
  bool execute() override;
  bool write() override { return true; }

 private:
  void watch();
  void bound_step() const;

  word phase_;
  scalar least_ = 0.0, most_ = 0.0, of_time_ = 0.0, stillness_ = 0.0;
  vectorField last_, last_but_one_;  ///< velocities, empty until there are some
  scalar last_step_ = 0.0;
};

}  // namespace functionObjects
}  // namespace Foam
