#pragma once

#include "foamCases/rheology/concrete_phase.h"
#include "laws/structure.h"

namespace flowrest::rheology {

/// Roussel's flocculation state lambda (Yu et al. 2026, Eqs. 11 and 12), d lambda / dt = A_thix / tau0 -
/// alpha rate^m lambda, carried along with the concrete: what is conserved is its integral over the concrete,
/// so that air neither thins it nor adds to it. Written as the field `flocculation`. With it what the yield
/// stress grows by with age, which is that of all the concrete (laws/structure.h).
class Flocculation {
 public:
  /// Reads `flocculationRate` (Pa/s), `deflocculationCoefficient` and `initialFlocculation` from the
  /// dictionary, and where it has them `breakdownExponent`, `ageingRate` (Pa/s), `ageingTime` (s) and
  /// `initialAge` (s); the field itself from the start time where it is there.
  Flocculation(const ConcretePhase&, const Foam::dictionary&, const Foam::dimensionedScalar& yield_stress);

  const Foam::volScalarField& field() const { return field_; }
  Foam::volScalarField& field() { return field_; }
  const laws::Structure<Foam::scalar>& structure() const { return structure_; }
  /// What the yield stress has grown by with age at the step's end, Pa.
  Foam::scalar grown() const;

  /// lambda carried to the new time without growth or breakdown. Starts from the old time however often it is
  /// called in a step; before the first step it changes nothing.
  void carry();
  /// carry(), then growth and breakdown at a shear rate (1/s), implicitly: never below 0.
  void advance(const Foam::volScalarField& rate);

 private:
  const ConcretePhase& phase_;
  laws::Structure<Foam::scalar> structure_;
  laws::Ageing<Foam::scalar> ageing_;
  Foam::volScalarField field_;
};

/// A field that the concrete carries, from the old to the new time: conserves the integral of field times
/// concrete, first order upwind and implicit, hence bounded by what it was. `field` holds the old values and
/// receives the new ones; `old` are those of the old time.
template <class Type>
void carry_with_concrete(const ConcretePhase&,
                         const Foam::GeometricField<Type, Foam::fvPatchField, Foam::volMesh>& old,
                         Foam::GeometricField<Type, Foam::fvPatchField, Foam::volMesh>& field);

}  // namespace flowrest::rheology
