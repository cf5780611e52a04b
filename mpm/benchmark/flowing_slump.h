#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mpm/sampling/sampling.h"
#include "mpm/solver/settings.h"

namespace flowrest::mpm::bench {

/// The slump in full flow, so that its particles are no longer a lattice.
class FlowingSlump {
 public:
  /// @param set `KEY=VALUE` over the scene `roussel-slump`. @param change of the solver's settings, after
  /// them. The transfer acts once in every step, or over a time, s.
  explicit FlowingSlump(const std::vector<std::string>& set,
                        const std::function<void(SolverSettings&)>& change = {},
                        double apic_relaxation_time = 0.0) {
    scenes::Overrides overrides;
    overrides.set = set;
    scene_ = std::make_unique<scenes::Scene>(scenes::load_scene("roussel-slump", overrides));
    SolverSettings settings = settings_of(*scene_);
    if (change) change(settings);
    solver_ = make_solver(settings, seed_particles(*scene_));
    solver_->set_apic_relaxation_time(apic_relaxation_time);
    step_ = 0.5 * settings.cell / scene_->material.longitudinal_speed();
    for (int i = 0; i < steps_until_it_flows; ++i) advance();
  }

  void advance() {
    solver_->step(step_, acceleration_at(*scene_, time_));
    time_ += step_;
  }
  const Solver& solver() const { return *solver_; }
  Solver& solver() { return *solver_; }
  const scenes::Scene& scene() const { return *scene_; }
  double step() const { return step_; }  ///< s
  double particles() const { return static_cast<double>(solver_->particle_count()); }

 private:
  static constexpr int steps_until_it_flows = 60;
  std::unique_ptr<scenes::Scene> scene_;
  std::unique_ptr<Solver> solver_;
  double step_ = 0.0, time_ = 0.0;
};

/// A quarter of the slump in 3D with about as many particles as the published code's, on one thread.
inline std::vector<std::string> quarter_44k() {
  return {"geometry.dimension=quarter", "mpm.cell=0.0063", "mpm.particles_per_cell=8", "mpm.threads=1"};
}
/// The same with a million: larger than the caches.
inline std::vector<std::string> quarter_1m() {
  return {"geometry.dimension=quarter", "mpm.cell=0.0022", "mpm.particles_per_cell=8", "mpm.threads=1"};
}
inline std::vector<std::string> with(std::vector<std::string> base, const std::vector<std::string>& more) {
  base.insert(base.end(), more.begin(), more.end());
  return base;
}

}  // namespace flowrest::mpm::bench
