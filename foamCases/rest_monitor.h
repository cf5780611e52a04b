#pragma once

#include <optional>

#include "scenes/scene.h"

/// When an elasto-viscoplastic run is at rest: once the growth of its spread that is still to come is
/// bounded.
namespace flowrest::foam {

/// Follows the shear rate of the concrete. D ~ tau0^(-1/5), so a slump whose stress nowhere passes the yield
/// stress by more than the part eps = eta rate / tau0 can grow by the part eps / 5 at most; and a base that
/// has stopped shearing carries no flow.
class RestMonitor {
 public:
  explicit RestMonitor(const scenes::Scene&);

  /// `shear_rate` is the largest that counts, at the base or inside, 1/s; `runs::nothing` where there is none
  /// to read, which is no rest.
  void add(double time, double shear_rate);
  /// Back to where a run is gone on with.
  void restart() { calm_since_.reset(); }

  /// Relative growth still to come at most; nothing for a fluid, which always has some to come, and
  /// where no shear rate is read.
  std::optional<double> growth_to_come() const { return growth_; }
  /// Since when, where the bound has held long enough to be believed. s
  std::optional<double> rest_time() const;
  /// Whether the run is to end now.
  bool at_rest() const { return stops_ && rest_time().has_value(); }

 private:
  bool can_rest_;
  bool stops_;
  double growth_per_rate_ = 0.0;  ///< s
  double bound_;
  double patience_;  ///< s
  double time_ = 0.0;
  std::optional<double> growth_;
  std::optional<double> calm_since_;
};

}  // namespace flowrest::foam
