#pragma once

#include "fvMeshFunctionObject.H"
#include "volFields.H"

namespace Foam {
namespace functionObjects {

/// Lets air that concrete has rolled over rise through it, column by column of cells, after every step.
///
/// A front that does not slip rolls: it lays itself on a film of air which a grid cannot drain. On cells of a
/// few millimetres the film is a cushion without friction, on larger ones a deficit of the base cells. Within
/// `time` the film changes places with concrete from the column's surface: volume of concrete and, where it
/// is carried, flocculation are conserved, the density follows, momentum is that of where the concrete comes
/// to lie.
///
/// Keywords: `phase` (concrete unless given), `time` (s). Columns run along z.
class airRises : public fvMeshFunctionObject {
 public:
  TypeName("airRises");

  airRises(const word& name, const Time& run_time, const dictionary& dict);

  bool read(const dictionary& dict) override;
  bool execute() override;
  bool write() override { return true; }

 private:
  void find_columns();
  void settle(const labelList& column, volScalarField& fraction, volScalarField* flocculation, scalar share);

  word phase_;
  scalar time_ = 0.1;
  List<labelList> columns_;  ///< cells one over another, from below upwards
};

}  // namespace functionObjects
}  // namespace Foam
