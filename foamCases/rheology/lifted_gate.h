#pragma once

#include "Pair.H"
#include "fvMeshFunctionObject.H"

namespace Foam {
namespace functionObjects {

/// A plate between cells that is lifted: a face is wall until its middle is passed, and then open.
///
/// Every face of the plate is four, one upon another (createBaffles): a wall to either side, and a pair of
/// cyclic faces through which the cells behind and before it are neighbours. Either the walls have the face's
/// area or the cyclic ones, so what the walls do (law of contact, pressure) and what flows through the
/// opening is each as on any other face. The edge moves after every step, with the time that is reached.
///
/// Keywords: `walls` and `openings` (names of two patches each), `velocity` (m/s, upwards), `edge` (height of
/// the plate's edge at time 0, m).
class liftedGate : public fvMeshFunctionObject {
 public:
  TypeName("liftedGate");

  liftedGate(const word& name, const Time& run_time, const dictionary& dict);

  bool read(const dictionary& dict) override;
  bool execute() override;
  bool write() override { return true; }

 private:
  /// Volumes and centres of the cells at the gate, in which OpenFOAM counts its faces twice.
  void mend_cells() const;
  /// Areas of a patch's faces, which have them where the gate has passed, or where it has not.
  void set_areas(const word& patch, scalar edge, bool open) const;

  Pair<word> walls_, openings_;
  scalar velocity_ = 0.0, edge_ = 0.0;
};

}  // namespace functionObjects
}  // namespace Foam
