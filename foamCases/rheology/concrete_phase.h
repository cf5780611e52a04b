#pragma once

#include "incompressibleTwoPhaseMixture.H"
#include "surfaceFields.H"
#include "volFields.H"

/// Concrete as one phase of a mixture: its fraction, its own velocity gradient and its share of the stress.
namespace flowrest::rheology {

/// Whose velocity gradient a law is given in cells that hold concrete and air.
enum class StrainRate {
  mixture,  ///< that of the mixture's velocity, as OpenFOAM has it: air moving past shears the concrete
  concrete  ///< faces take the velocity of the cell that holds more concrete
};

/// How concrete's stress and that of the air make the stress of a cell that holds both.
enum class Mixing {
  arithmetic,     ///< by volume fraction, as OpenFOAM has it
  harmonic,       ///< common stress: 1 / (alpha / mu + (1 - alpha) / mu_air)
  mass_weighted,  ///< by mass fraction: a cell with a tenth of concrete has the whole of its stress
  saturating      ///< by min(alpha / fullAt, 1): full stress from the fraction `fullAt` on
};

/// How much of a wall the concrete in a cell is held by.
enum class Wetting {
  fraction,  ///< as much of it as the cell holds concrete, as OpenFOAM has it
  geometric  ///< as much as a straight surface in the cell leaves wetted (wetted_share)
};

/// How a law meets the cells of a mixture; keywords `strainRate` (mixture | concrete), `mixing` (arithmetic |
/// harmonic | massWeighted | saturating), `fullAt` (0.5 unless given)
/// and `wetting` (fraction | geometric).
struct PhaseRules {
  StrainRate strain_rate = StrainRate::mixture;
  Mixing mixing = Mixing::arithmetic;
  double full_at = 0.5;
  Wetting wetting = Wetting::fraction;

  /// Ends the program with the allowed words where one is not known.
  static PhaseRules read(const Foam::dictionary&);
};

/// The concrete of a case: a phase of interFoam, or the whole of a single-phase solver's fluid.
class ConcretePhase {
 public:
  /// `phase` is the phase's name; a case without a field alpha.<phase> holds nothing but concrete.
  ConcretePhase(const Foam::volVectorField& velocity, const Foam::surfaceScalarField& flux,
                const Foam::word& phase, const Foam::dimensionedScalar& density);

  /// A fraction below which a cell's concrete is of no consequence; it keeps what concrete carries defined in
  /// air, where it is carried along by the air.
  static constexpr double trace = 1e-6;

  bool alone() const;  ///< no other phase
  const Foam::fvMesh& mesh() const { return velocity_.mesh(); }
  const Foam::volVectorField& velocity() const { return velocity_; }
  const Foam::dimensionedScalar& density() const { return density_; }  ///< kg/m3

  /// Volume fraction, within 0 and 1.
  Foam::tmp<Foam::volScalarField> fraction() const;
  /// Fraction and trace together, at the new and at the old time: what a conserved quantity is stored by.
  Foam::tmp<Foam::volScalarField> amount() const;
  Foam::tmp<Foam::volScalarField> old_amount() const;
  /// The volume flux of amount(), m3/s: consistent with its change over the step while the velocity's flux is
  /// still the one that carried it, that is before the pressure is solved. False where there is none yet.
  bool find_amount_flux(Foam::tmp<Foam::surfaceScalarField>&) const;

  /// d U_j / d x_i by the rule, 1/s; its boundary values hold the wall's own normal derivative. Of concrete
  /// what crosses a face is the flux, so that the trace is the flux's divergence: none.
  Foam::tmp<Foam::volTensorField> velocity_gradient(StrainRate) const;
  /// The same of the cells' velocities alone, on which viscosities and Laplacians act.
  Foam::tmp<Foam::volTensorField> cell_velocity_gradient(StrainRate) const;
  /// sqrt(2 D:D), 1/s, as OpenFOAM's own viscosity models have it.
  static Foam::tmp<Foam::volScalarField> shear_rate(const Foam::volTensorField& gradient);

  /// Dynamic viscosity of the other phase, Pa s; 0 where there is none.
  Foam::tmp<Foam::volScalarField> other_viscosity() const;

  /// Share of concrete's stress in a cell's, and on the walls, by the rules; not for harmonic, which mixes
  /// viscosities.
  Foam::tmp<Foam::volScalarField> weight(const PhaseRules&) const;

  /// The kinematic viscosity to be given to OpenFOAM's mixture, which mixes by volume, so that the mixture's
  /// dynamic viscosity is the one the rule says. m2/s
  Foam::tmp<Foam::volScalarField> mixture_input(const PhaseRules&,
                                                const Foam::volScalarField& viscosity) const;

  /// As Gauss' linear interpolation, but weighted by the amount of concrete in the two cells.
  template <class Type>
  Foam::tmp<Foam::GeometricField<Type, Foam::fvsPatchField, Foam::surfaceMesh>> interpolate(
      const Foam::GeometricField<Type, Foam::fvPatchField, Foam::volMesh>& field) const;

 private:
  Foam::tmp<Foam::surfaceVectorField> face_velocity(StrainRate) const;
  Foam::tmp<Foam::volTensorField> gradient_of(Foam::tmp<Foam::surfaceVectorField>) const;
  const Foam::volScalarField* find_fraction() const;
  Foam::tmp<Foam::volScalarField> cell_weight(const PhaseRules&) const;
  void wet_walls(Foam::volScalarField& share) const;
  const Foam::incompressibleTwoPhaseMixture* find_mixture() const;
  bool is_first(const Foam::incompressibleTwoPhaseMixture&) const;

  const Foam::volVectorField& velocity_;
  const Foam::surfaceScalarField& flux_;
  Foam::word phase_;
  Foam::dimensionedScalar density_;
};

}  // namespace flowrest::rheology
