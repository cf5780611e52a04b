#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mpm/sampling/feed.h"
#include "mpm/solver/solver.h"
#include "scenes/pieces.h"
#include "scenes/scene.h"

namespace flowrest::mpm::derivatives {

/// A scene as the solver sees it.
struct Variation {
  scenes::Scene scene;
  scenes::Pieces pieces;
  SolverSettings settings;
  Feeds feeds;              ///< as they are before the first step
  std::vector<Seed> seeds;  ///< what the run begins with

  explicit Variation(const scenes::Scene&);

  /// Two numbers along the strand (m) between which a section is read: behind the nozzle at a time, as the section
  /// gauge does, or over two cells about a `place` (m from where the nozzle begins); both nought where there is none.
  std::array<double, 2> station(double time, const std::optional<double>& place) const;

  // Numbers that keys may change, of a moment (s): the recorded run's, so that they are of all variations alike.
  /// What moves a nozzle in a step, see motion_from.
  std::vector<double> nozzle(std::size_t number, double time, double step) const;
  /// Uniform acceleration, m/s2 along each axis.
  std::vector<double> acceleration(double time) const;
};

/// The motion of a nozzle in a step by seven numbers: its mouth's place before and after it, and what has come of the
/// column, m.
template <class T>
NozzleMotion<T> motion_from(const Nozzle& nozzle, double cell, const std::vector<T>& x, double step) {
  return {nozzle.bore, nozzle.wall, cell, {x[0], x[1], x[2]}, {x[3], x[4], x[5]}, x[6], step};
}

/// A scene, and the scenes about it in which one key each is a little larger or smaller: from them the derivatives
/// of all that goes into the solver by the keys. Differences of fourth order over a thousandth of a key's value: what is
/// linear in a key is exact to round-off, all else to 1e-12.
class Variations {
 public:
  /// The scene with its keys at these values. @throws scenes::SceneError where it cannot be.
  using SceneAt = std::function<scenes::Scene(const std::vector<double>& values)>;

  /// `names` and `values`: of the keys, as in the scene; `units` for messages.
  /// @throws scenes::SceneError where a key changes what no derivative goes through (how many particles there
  /// are, where walls stand, the grid), or has no effect on the run.
  Variations(const std::vector<std::string>& names, const std::vector<double>& values, const SceneAt&);

  const Variation& centre() const { return *centre_; }
  std::size_t keys() const { return values_.size(); }
  /// The scene with all keys moved at once.
  std::unique_ptr<Variation> moved(const std::vector<double>& values) const;
  const std::vector<double>& values() const { return values_; }

  /// The derivatives by a key of numbers that a variation has.
  template <class Numbers>
  std::vector<double> slopes(std::size_t key, const Numbers& numbers) const {
    const Difference& d = about_[key];
    const std::vector<double> a = numbers(*d.at[0]), b = numbers(*d.at[1]), c = numbers(*d.at[2]),
                              e = numbers(*d.at[3]);
    std::vector<double> slope(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      slope[i] = (8.0 * (b[i] - a[i]) - (e[i] - c[i])) / (12.0 * d.step);
    return slope;
  }

 private:
  /// One step below and above, two steps below and above.
  struct Difference {
    double step;
    std::unique_ptr<Variation> at[4];
  };

  void check_goes_through(const std::string& name, const Difference&) const;

  std::vector<double> values_;
  SceneAt scene_at_;
  std::unique_ptr<Variation> centre_;
  std::vector<Difference> about_;
};

}  // namespace flowrest::mpm::derivatives
