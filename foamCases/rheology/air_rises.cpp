#include "foamCases/rheology/air_rises.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "addToRunTimeSelectionTable.H"
#include "foamCases/rheology/column.h"
#include "incompressibleTwoPhaseMixture.H"

namespace Foam {
namespace functionObjects {

defineTypeNameAndDebug(airRises, 0);
addToRunTimeSelectionTable(functionObject, airRises, dictionary);

airRises::airRises(const word& name, const Time& run_time, const dictionary& dict)
    : fvMeshFunctionObject(name, run_time, dict) {
  read(dict);
  find_columns();
}

bool airRises::read(const dictionary& dict) {
  phase_ = dict.getOrDefault<word>("phase", "concrete");
  time_ = dict.get<scalar>("time");
  if (!(time_ > 0.0))
    FatalIOErrorInFunction(dict) << "time is " << time_ << " s; it must be above 0" << exit(FatalIOError);
  return fvMeshFunctionObject::read(dict);
}

/// Cells whose centres lie one over another: the same x and y to a micrometre.
void airRises::find_columns() {
  constexpr scalar resolution = 1e-6;  // m
  const vectorField& centres = mesh_.C().primitiveField();
  std::map<std::pair<long, long>, std::vector<label>> found;
  forAll(centres, cell) {
    const vector& c = centres[cell];
    found[{std::lround(c.x() / resolution), std::lround(c.y() / resolution)}].push_back(cell);
  }
  columns_.setSize(label(found.size()));
  label next = 0;
  for (auto& [place, cells] : found) {
    std::sort(cells.begin(), cells.end(), [&](label a, label b) { return centres[a].z() < centres[b].z(); });
    labelList& column = columns_[next++];
    column.setSize(label(cells.size()));
    std::copy(cells.begin(), cells.end(), column.begin());
  }
}

void airRises::settle(const labelList& cells, volScalarField& fraction, volScalarField* flocculation,
                      scalar share) {
  flowrest::rheology::Column column;
  for (const label cell : cells) {
    column.fraction.push_back(fraction.primitiveField()[cell]);
    column.volume.push_back(mesh_.V()[cell]);
  }
  const flowrest::rheology::Column before = column;
  const scalar moved = flowrest::rheology::let_air_rise(column, share);
  if (!(moved > 0.0)) return;
  // What comes down is flocculated as it was where it came from.
  scalar carried = 0.0;
  if (flocculation != nullptr) {
    forAll(cells, i) {
      const scalar taken = std::max(before.fraction[i] - column.fraction[i], 0.0) * column.volume[i];
      carried += taken * flocculation->primitiveField()[cells[i]] / moved;
    }
  }
  forAll(cells, i) {
    const scalar gained = column.fraction[i] - before.fraction[i];
    if (flocculation != nullptr && gained > 0.0) {
      scalar& value = flocculation->primitiveFieldRef()[cells[i]];
      value = (std::max(before.fraction[i], 0.0) * value + gained * carried) /
              (std::max(before.fraction[i], 0.0) + gained);
    }
    fraction.primitiveFieldRef()[cells[i]] = column.fraction[i];
  }
}

bool airRises::execute() {
  auto* fraction = mesh_.getObjectPtr<volScalarField>(IOobject::groupName("alpha", phase_));
  auto* density = mesh_.getObjectPtr<volScalarField>("rho");
  const auto* mixture = mesh_.findObject<incompressibleTwoPhaseMixture>("transportProperties");
  if (fraction == nullptr || density == nullptr || mixture == nullptr) return true;
  const bool first = mixture->phase1Name() == phase_;
  auto* other = mesh_.getObjectPtr<volScalarField>(
      IOobject::groupName("alpha", first ? mixture->phase2Name() : mixture->phase1Name()));
  auto* flocculation = mesh_.getObjectPtr<volScalarField>("flocculation");
  const scalar share = 1.0 - std::exp(-mesh_.time().deltaTValue() / time_);
  for (const labelList& column : columns_) settle(column, *fraction, flocculation, share);
  fraction->correctBoundaryConditions();
  if (flocculation != nullptr) flocculation->correctBoundaryConditions();
  if (other != nullptr) *other = 1.0 - *fraction;
  // The old density of the next step is that of the old fraction: nothing is pushed by the exchange.
  const auto& own = first ? mixture->rho1() : mixture->rho2();
  const auto& others = first ? mixture->rho2() : mixture->rho1();
  *density == *fraction* own + (1.0 - *fraction) * others;
  return true;
}

}  // namespace functionObjects
}  // namespace Foam
