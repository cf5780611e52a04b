#include "foamCases/rheology/inclined_cells.h"

#include "addToRunTimeSelectionTable.H"
#include "foamCases/rheology/openfoam_version.h"
#include "fvcSnGrad.H"
#include "uniformDimensionedFields.H"

namespace Foam {
namespace fv {

defineTypeNameAndDebug(inclinedCells, 0);
addToRunTimeSelectionTable(option, inclinedCells, dictionary);

namespace {

/// Calls visit(face, its part of each of its cells) for every face: owner with +1, neighbour with -1.
template <class Visit>
void for_each_face(const fvMesh& mesh, Visit visit) {
  const labelUList& owner = mesh.owner();
  const labelUList& neighbour = mesh.neighbour();
  forAll(owner, face) {
    visit(owner[face], mesh.Sf()[face], mesh.magSf()[face], -1, face);
    visit(neighbour[face], mesh.Sf()[face], mesh.magSf()[face], -1, face);
  }
  forAll(mesh.boundary(), p) {
    const labelUList& cells = mesh.boundary()[p].faceCells();
    forAll(cells, face) visit(cells[face], mesh.Sf().boundaryField()[p][face],
                              mesh.magSf().boundaryField()[p][face], p, face);
  }
}

tensorField inverse_of_areas(const fvMesh& mesh) {
  tensorField sum(mesh.nCells(), Zero);
  for_each_face(mesh, [&](label cell, const vector& area, scalar size, label, label) {
    sum[cell] += area * area / size;
  });
  forAll(sum, cell) {
    const tensor whole = sum[cell];
    sum[cell] = inv(whole);
  }
  return sum;
}

}  // namespace

inclinedCells::inclinedCells(const word& name, const word& model, const dictionary& dict, const fvMesh& mesh)
    : option(name, model, dict, mesh), inverse_(inverse_of_areas(mesh)) {
  fieldNames_ = wordList(1, "U");
  applied_.setSize(1, false);
  find_faulty();
}

void inclinedCells::find_faulty() {
  const Reconstruct reconstruct = reconstruct_of_solver();
  if (reconstruct == nullptr) {
    Info << "inclinedCells: this solver does not say how it takes forces to cells; it is taken to be right"
         << endl;
    return;
  }
  const vector uniform(1.0, 2.0, 3.0);
  constexpr scalar noticeable = 1e-9;
  const surfaceScalarField flux("uniformFlux", mesh_.Sf() & dimensionedVector("uniform", dimless, uniform));
  const auto found = reconstruct(flux);
  forAll(inverse_, cell) {
    const vector& value = found().primitiveField()[cell];
    if (mag(value - uniform) < noticeable) continue;
    faulty_.append(cell);
    if (mag(mended(cell, value) - uniform) > noticeable)
      FatalErrorInFunction << "this build of the solver takes forces to the cell " << cell
                           << " in a wrong way that is not known: a force of " << uniform << " becomes "
                           << value << exit(FatalError);
  }
  const label count = returnReduce(faulty_.size(), sumOp<label>());
  if (count > 0)
    Info << "inclinedCells: this build of the solver takes forces to cells that lean in the wrong way; "
         << count << " cells are mended" << endl;
}

vector inclinedCells::mended(label cell, const vector& wrong) const {
  const tensor& t = inverse_[cell];
  // Both wrong.y and wrong.z took wrong.x for b.x.
  const scalar y = wrong.y() - t.yx() * wrong.x(), z = wrong.z() - t.zx() * wrong.x();
  const scalar determinant = t.yy() * t.zz() - t.yz() * t.zy();
  vector b;
  b.y() = (y * t.zz() - z * t.yz()) / determinant;
  b.z() = (z * t.yy() - y * t.zy()) / determinant;
  b.x() = (wrong.x() - t.xy() * b.y() - t.xz() * b.z()) / t.xx();
  return t & b;
}

tmp<vectorField> inclinedCells::to_cells(const surfaceScalarField& flux) const {
  vectorField sum(mesh_.nCells(), Zero);
  for_each_face(mesh_, [&](label cell, const vector& area, scalar size, label patch, label face) {
    sum[cell] += area / size * (patch < 0 ? flux[face] : flux.boundaryField()[patch][face]);
  });
  forAll(sum, cell) {
    const vector whole = sum[cell];
    sum[cell] = inverse_[cell] & whole;
  }
  return tmp<vectorField>(new vectorField(sum));
}

void inclinedCells::remember() {
  const volScalarField diagonal(equation_->A());
  const volVectorField rest(equation_->H());
  begins_with_ = rest.primitiveField() / diagonal.primitiveField();
}

void inclinedCells::constrain(fvMatrix<vector>& equation, label) {
  inverse_ = inverse_of_areas(mesh_);  // a gate that is lifted changes areas (liftedGate)
  const auto& density = mesh_.lookupObject<volScalarField>("rho");
  const auto& pressure = mesh_.lookupObject<volScalarField>("p_rgh");
  const auto& gravity = mesh_.time().lookupObject<uniformDimensionedVectorField>("g");
  const surfaceScalarField height(gravity & mesh_.Cf());
  const surfaceScalarField flux((-height * fvc::snGrad(density) - fvc::snGrad(pressure)) * mesh_.magSf());
  volVectorField::Internal force(IOobject("faceForces", mesh_.time().timeName(), mesh_), mesh_,
                                 dimensionedVector(dimPressure / dimLength, Zero));
  force.field() = to_cells(flux);
  Foam::solve(equation == force);
  equation_ = &equation;
  remember();
}

void inclinedCells::correct(volVectorField& velocity) {
  if (equation_ == nullptr || begins_with_.size() != velocity.size()) return;
  vectorField& u = velocity.primitiveFieldRef();
  for (const label cell : faulty_) u[cell] = begins_with_[cell] + mended(cell, u[cell] - begins_with_[cell]);
  velocity.correctBoundaryConditions();
  remember();
}

}  // namespace fv
}  // namespace Foam
