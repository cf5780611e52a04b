#include "foamCases/rheology/lifted_gate.h"

#include <algorithm>

#include "addToRunTimeSelectionTable.H"
#include "surfaceFields.H"

namespace Foam {
namespace functionObjects {

defineTypeNameAndDebug(liftedGate, 0);
addToRunTimeSelectionTable(functionObject, liftedGate, dictionary);

liftedGate::liftedGate(const word& name, const Time& run_time, const dictionary& dict)
    : fvMeshFunctionObject(name, run_time, dict) {
  read(dict);
  execute();  // before the first step, also of a run that is gone on with
  mend_cells();
}

bool liftedGate::read(const dictionary& dict) {
  walls_ = dict.get<Pair<word>>("walls");
  openings_ = dict.get<Pair<word>>("openings");
  velocity_ = dict.get<scalar>("velocity");
  edge_ = dict.get<scalar>("edge");
  if (!(velocity_ > 0.0))
    FatalIOErrorInFunction(dict) << "velocity is " << velocity_ << "; it must be above 0 m/s"
                                 << exit(FatalIOError);
  for (const Pair<word>* pair : {&walls_, &openings_})
    for (const word& patch : *pair)
      if (mesh_.boundaryMesh().findPatchID(patch) < 0)
        FatalIOErrorInFunction(dict) << "the mesh has no patch " << patch << "; it has "
                                     << mesh_.boundaryMesh().names() << exit(FatalIOError);
  return fvMeshFunctionObject::read(dict);
}

bool liftedGate::execute() {
  const scalar edge = edge_ + velocity_ * time_.value();
  for (const word& patch : walls_) set_areas(patch, edge, false);
  for (const word& patch : openings_) set_areas(patch, edge, true);
  return true;
}

void liftedGate::mend_cells() const {
  auto& centres = const_cast<vectorField&>(mesh_.cellCentres());
  auto& volumes = const_cast<scalarField&>(mesh_.cellVolumes());
  const polyBoundaryMesh& patches = mesh_.boundaryMesh();
  const auto is_opening = [&](label face) {
    return !mesh_.isInternalFace(face) && openings_.found(patches[patches.whichPatch(face)].name());
  };
  const vectorField& middles = mesh_.faceCentres();
  for (const word& patch : walls_)
    for (const label cell : mesh_.boundary()[patches.findPatchID(patch)].faceCells()) {
      const vector apex = centres[cell];
      scalar volume = 0.0;
      vector moment = Zero;
      for (const label face : mesh_.cells()[cell]) {
        if (is_opening(face)) continue;
        const scalar outwards = mesh_.faceOwner()[face] == cell ? 1.0 : -1.0;
        const vector area = mesh_.faces()[face].areaNormal(mesh_.points());
        const scalar pyramid = outwards / 3.0 * (area & (middles[face] - apex));
        volume += pyramid;
        moment += pyramid * (0.75 * middles[face] + 0.25 * apex);
      }
      volumes[cell] = volume;
      centres[cell] = moment / volume;
    }
  const_cast<fvMesh&>(mesh_).surfaceInterpolation::movePoints();  // distances are to be taken anew
}

void liftedGate::set_areas(const word& name, scalar edge, bool open) const {
  // A face of no area has no direction. What passes through this much is nothing, but not for air, which is
  // a thousand times lighter: through a share of 1e-9 it moves so fast that concrete at rest chatters.
  // A share in between would be no slot, either: while there is air before it, it holds back nothing.
  constexpr scalar shut = 1e-13;
  const fvPatch& patch = mesh_.boundary()[mesh_.boundaryMesh().findPatchID(name)];
  auto& areas = const_cast<vectorField&>(static_cast<const vectorField&>(patch.Sf()));
  auto& sizes = const_cast<scalarField&>(patch.magSf());
  forAll(patch, i) {
    const face& corners = patch.patch()[i];
    scalar low = GREAT, high = -GREAT;
    for (const point& corner : corners.points(mesh_.points())) {
      low = std::min(low, corner.z());
      high = std::max(high, corner.z());
    }
    const bool passed = edge > 0.5 * (low + high);
    areas[i] = (open == passed ? 1.0 - shut : shut) * corners.areaNormal(mesh_.points());
    sizes[i] = mag(areas[i]);
  }
}

}  // namespace functionObjects
}  // namespace Foam
