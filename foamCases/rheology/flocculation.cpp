#include "foamCases/rheology/flocculation.h"

#include "fvMatrices.H"
#include "fvmSup.H"
#include "gaussConvectionScheme.H"
#include "upwind.H"
#include "zeroGradientFvPatchFields.H"

namespace flowrest::rheology {

using namespace Foam;

namespace {

/// The matrix is an upwind one with a dominant diagonal: a few sweeps reach round-off.
dictionary solver_settings() {
  dictionary settings;
  settings.add("solver", word("smoothSolver"));
  settings.add("smoother", word("symGaussSeidel"));
  settings.add("tolerance", scalar(1e-13));
  settings.add("relTol", scalar(0));
  settings.add("maxIter", label(50));
  return settings;
}

}  // namespace

template <class Type>
void carry_with_concrete(const ConcretePhase& phase, const GeometricField<Type, fvPatchField, volMesh>& old,
                         GeometricField<Type, fvPatchField, volMesh>& field) {
  tmp<surfaceScalarField> flux;
  if (!phase.find_amount_flux(flux)) return;
  const fvMesh& mesh = phase.mesh();
  const dimensionedScalar per_step = 1.0 / mesh.time().deltaT();
  fvMatrix<Type> equation(
      fvm::Sp(per_step * phase.amount()(), field) +
          fv::gaussConvectionScheme<Type>(
              mesh, flux(), tmp<surfaceInterpolationScheme<Type>>(new upwind<Type>(mesh, flux())))
              .fvmDiv(flux(), field) ==
      per_step * phase.old_amount() * old);
  const int told = SolverPerformance<Type>::debug;
  SolverPerformance<Type>::debug = 0;  // a line for every component and step would drown the log
  equation.solve(solver_settings());
  SolverPerformance<Type>::debug = told;
}

template void carry_with_concrete(const ConcretePhase&, const volScalarField&, volScalarField&);
template void carry_with_concrete(const ConcretePhase&, const volSymmTensorField&, volSymmTensorField&);

Flocculation::Flocculation(const ConcretePhase& phase, const dictionary& dict,
                           const dimensionedScalar& yield_stress)
    : phase_(phase),
      structure_{(dimensionedScalar("flocculationRate", dimPressure / dimTime, dict) / yield_stress).value(),
                 dict.get<scalar>("deflocculationCoefficient"),
                 dict.getOrDefault<scalar>("breakdownExponent", 1.0)},
      ageing_{dict.getOrDefault<scalar>("ageingRate", 0.0),
              dict.found("ageingTime") ? 1.0 / dict.get<scalar>("ageingTime") : 0.0,
              dict.getOrDefault<scalar>("initialAge", 0.0)},
      field_(IOobject("flocculation", phase.mesh().time().timeName(), phase.mesh(), IOobject::READ_IF_PRESENT,
                      IOobject::AUTO_WRITE),
             phase.mesh(), dimensionedScalar("initialFlocculation", dimless, dict),
             zeroGradientFvPatchScalarField::typeName) {
  field_.oldTime();
}

scalar Flocculation::grown() const { return ageing_.grown(phase_.mesh().time().value()); }

void Flocculation::carry() {
  const Time& time = phase_.mesh().time();
  if (time.timeIndex() <= time.startTimeIndex()) return;
  const volScalarField old(field_.oldTime());
  carry_with_concrete(phase_, old, field_);
}

void Flocculation::advance(const volScalarField& rate) {
  const Time& time = phase_.mesh().time();
  if (time.timeIndex() <= time.startTimeIndex()) return;
  carry();
  const scalar step = time.deltaTValue();
  auto& cells = field_.primitiveFieldRef();
  forAll(cells, i) cells[i] = structure_.stepped(cells[i], rate.primitiveField()[i], step);
  field_.correctBoundaryConditions();
}

}  // namespace flowrest::rheology
