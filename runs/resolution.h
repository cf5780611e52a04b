#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runs/columns.h"
#include "runs/csv.h"
#include "runs/sheared_layer.h"

/// Whether a run's cells resolve what is sheared in it, whichever solver it comes from.
namespace flowrest::runs {

/// Follows the sheared layer over a run, a row of the history at a time.
///
/// A run is judged by the median of the cells over the layer, each moment counting by the strain that the
/// body undergoes in it (the mean shear rate times the time): half of the way was made with fewer. That is
/// the phase that decides how far the material gets; the last creep of a slump, whose layer thins to nothing
/// as it comes to rest, has no say in it, nor has the first moment of a duct.
class Resolution {
 public:
  /// Cells over the sheared layer from which a run counts as resolved; what fewer cost is measured in
  /// docs/measured/2026-12-01-cells-over-the-sheared-layer.md.
  static constexpr double cells_wanted = 5.0;
  /// Below this many cells across a passage, or over a depth, no layer is resolved, whatever is seen of it.
  static constexpr double cells_across_wanted = 3.0;

  struct Moment {
    double time = 0.0;  ///< s
    ShearedLayer layer;
    double strain = 0.0;  ///< since the moment before, the mean over the body
  };

  /// Takes in the layer at `time` (s), as holding since the row before.
  /// @returns what history.csv says of it; nothing where nothing is sheared along a wall.
  Row add(double time, const ShearedLayer&);
  /// Takes in the rows that a run has behind it.
  void continue_from(const Table& history);

  /// The moment that the run is judged by; nothing where nothing was sheared along a wall.
  std::optional<Moment> judged() const;
  /// What the cells do not resolve, in words; empty where they resolve it all. `passage_cells` lie across the
  /// narrowest passage (infinite where there is none), `depth_cells` over a slump's depth at its centre, where
  /// that is known.
  std::string fault(double passage_cells, std::optional<double> depth_cells) const;
  /// Why a run that comes to rest now may rest for its grid's sake: the layer in which it was last sheared is
  /// thinner than a cell. Empty where it is not.
  std::string limit_of_rest() const;
  /// run.json's `resolution`; null where nothing was sheared along a wall.
  nlohmann::ordered_json json() const;

 private:
  void hold(double time, double thickness_mm, double cells, double mean_rate);

  double last_ = 0.0;  ///< s
  std::vector<Moment> moments_;
};

}  // namespace flowrest::runs
