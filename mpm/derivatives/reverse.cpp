#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <stdexcept>

#include "mpm/derivatives/gradient.h"
#include "mpm/derivatives/replay.h"
#include "mpm/derivatives/reverse_step.h"
#include "mpm/derivatives/revolve.h"

namespace flowrest::mpm::derivatives {

namespace {

template <int Dim>
class Backwards {
 public:
  using Source = PlainSource;
  using Run = Replay<Source, Dim>;
  using Adjoint = StepAdjoint<Dim>;
  using Particle = plain::Particle<double, Dim>;
  using Particles = std::vector<Particle>;

  Backwards(const Variations& variations, const Recording& recording)
      : variations_(variations),
        centre_(variations.centre()),
        recording_(recording),
        inputs_(plain::inputs_of<double>(centre_.settings)),
        run_(Source(centre_, centre_), recording),
        adjoint_(centre_.settings, inputs_),
        digests_(recording.rows.back().steps + 1, 0) {}

  Readings make(const std::vector<Quantity>& quantities, double memory, ReverseCost& cost,
                const Watch& watch) {
    const std::size_t steps = recording_.rows.back().steps;
    const double time = recording_.rows.back().time;
    Readings readings{time, {}, {}};
    keep();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      key_.assign(variations_.keys(), 0.0);
      bars_of_inputs_.numbers.assign(plain::numbers_of(inputs_).size(), 0.0);
      run_.restore(kept_.front());
      advance_to(steps);
      readings.value.push_back(begin(quantities[q], time));
      const double state =
          static_cast<double>(run_.body().particles().size()) * static_cast<double>(sizeof(Particle));
      const auto room = static_cast<std::size_t>(std::clamp(memory / state, 2.0, 1e9));
      Reversal reversal;
      reversal.advance_to = [&](std::size_t step) {
        cost.recomputed_steps += step - run_.made();
        advance_to(step);
      };
      reversal.keep = [&] {
        keep();
        cost.snapshots = std::max(cost.snapshots, count_);
      };
      reversal.restore = [&] { run_.restore(kept_[count_ - 1]); };
      reversal.drop = [&] { --count_; };
      reversal.back = [&](std::size_t step) {
        back(step);
        if (watch)
          watch((static_cast<double>(q) + 1.0 - static_cast<double>(step) / static_cast<double>(steps)) /
                static_cast<double>(quantities.size()));
      };
      go_back(reversal, 0, steps, room - 1);
      cost.memory = std::max(cost.memory, static_cast<double>(cost.snapshots) * state);
      end();
      readings.slope.push_back(key_);
    }
    return readings;
  }

 private:
  /// Keeps the state that the run is in, in the place of one that was dropped where there is one.
  void keep() {
    if (count_ == kept_.size())
      kept_.push_back(run_.state());
    else
      run_.store(kept_[count_]);
    ++count_;
  }

  /// So that a state that is made again is known to have the bits that it had.
  void check_bits() {
    std::uint64_t digest = 1469598103934665603ULL;
    const auto mix = [&](double x) {
      std::uint64_t bits;
      std::memcpy(&bits, &x, sizeof bits);
      digest = (digest ^ bits) * 1099511628211ULL;
    };
    for (const Particle& p : run_.body().particles()) {
      for (const double x : p.place) mix(x);
      for (const double v : p.velocity) mix(v);
      mix(p.volume_ratio);
      mix(p.stress.xy);
    }
    std::uint64_t& before = digests_[run_.made()];
    if (before != 0 && before != digest)
      throw runs::NumericsError(fmt::format(
          "step {} was made again with other bits: the gradient would be of another run", run_.made()));
    before = digest;
  }

  void advance_to(std::size_t step) {
    while (run_.made() < step) {
      run_.advance_to(run_.made() + 1);
      check_bits();
    }
  }

  /// Bars of the particles at the end; returns the reading.
  double begin(const Quantity& quantity, double time) {
    const Particles& particles = run_.body().particles();
    const auto around = surroundings_of(run_.source(), time, quantity);
    const Linearised at(quantity, centre_, particles, around);
    constexpr int width = Dim == 3 ? 12 : 10;
    using D = Dual<width>;
    std::array<double, 3> of_surroundings{};
    bars_.assign(particles.size(), Particle{});
    for (std::size_t q = 0; q < particles.size(); ++q) {
      std::size_t next = 0;
      const auto seeded = [&](double x) { return D::input(x, next++); };
      const Particle& p = particles[q];
      plain::Particle<D, Dim> local;
      local.cell = p.cell;
      for (std::size_t a = 0; a < Dim; ++a) local.place[a] = seeded(p.place[a]);
      for (std::size_t a = 0; a < Dim; ++a) local.velocity[a] = seeded(p.velocity[a]);
      local.volume_ratio = seeded(p.volume_ratio);
      local.mass = seeded(p.mass);
      local.flocculation = seeded(p.flocculation);
      Surroundings<D> seen;
      seen.density = seeded(around.density);
      seen.station = {seeded(around.station[0]), seeded(around.station[1])};
      const D part = at.part<D, Dim>(local, seen);
      next = 0;
      const auto take = [&] { return part.d[next++]; };
      Particle& bar = bars_[q];
      for (double& x : bar.place) x = take();
      for (double& v : bar.velocity) v = take();
      bar.volume_ratio = take();
      bar.mass = take();
      bar.flocculation = take();
      for (double& x : of_surroundings) x += take();
    }
    add(of_surroundings, [&](const Variation& v) { return numbers_of_surroundings(v, time, quantity); });
    return at.value();
  }

  /// Adds what numbers that hang on the keys make of their bars.
  template <class Bars, class Numbers>
  void add(const Bars& bars, const Numbers& numbers) {
    bool any = false;
    for (const double bar : bars) any = any || bar != 0.0;
    if (!any) return;
    for (std::size_t k = 0; k < key_.size(); ++k) {
      const std::vector<double> slopes = variations_.slopes(k, numbers);
      for (std::size_t i = 0; i < bars.size(); ++i) key_[k] += bars[i] * slopes[i];
    }
  }

  typename Adjoint::Step step_of(const StepTaken& taken) const {
    typename Adjoint::Step step;
    step.time = taken.time;
    step.step = taken.step;
    step.keep = plain::kept_share(taken.apic_relaxation_time, taken.step);
    step.acceleration = driving_of<Dim>(run_.source(), taken);
    for (std::size_t n = 0; n < centre_.settings.nozzles.size(); ++n)
      if (centre_.settings.nozzles[n].is_there(taken.time))
        step.nozzles.push_back({n, centre_.nozzle(n, taken.time, taken.step)});
    return step;
  }

  /// From the state before a step: makes it, and takes the bars from after it to before it.
  void back(std::size_t number) {
    const StepTaken& taken = recording_.steps[number];
    const typename Adjoint::Step step = step_of(taken);
    const bool come = run_.arrivals().come_after(taken);
    adjoint_.forwards(run_.body(), step);
    if (come) {
      Particles all = run_.body().particles();
      const std::size_t here = all.size();
      const auto seeds_of = run_.arrivals().seeds_after(taken);
      for (auto& p : particles_of<Dim>(run_.source(), seeds_of)) all.push_back(std::move(p));
      const auto sorted = plain::body_of<double, Dim>(centre_.settings, inputs_, all);
      Particles apart(bars_.size());
      for (std::size_t i = 0; i < bars_.size(); ++i) apart[sorted.came_from()[i]] = bars_[i];
      add_seeds({apart.begin() + static_cast<std::ptrdiff_t>(here), apart.end()}, seeds_of);
      bars_.assign(apart.begin(), apart.begin() + static_cast<std::ptrdiff_t>(here));
    }
    adjoint_.backwards(run_.body(), step, bars_, bars_of_inputs_);
    add(bars_of_inputs_.acceleration, [&](const Variation& v) { return v.acceleration(taken.time); });
    for (std::size_t i = 0; i < step.nozzles.size(); ++i)
      add(bars_of_inputs_.nozzles[i],
          [&](const Variation& v) { return v.nozzle(step.nozzles[i].number, taken.time, taken.step); });
  }

  /// Bars of particles that seeds have made.
  template <class SeedsOf>
  void add_seeds(const Particles& bars, const SeedsOf& seeds_of) {
    std::vector<double> numbers;
    for (const Particle& bar : bars)
      plain::visit_state<Dim>(bar, centre_.settings.thixotropic, [&](double x) { numbers.push_back(x); });
    const std::vector<Seed> recorded = seeds_of(centre_);
    add(numbers,
        [&](const Variation& v) { return numbers_of_seeds<Dim>(v.settings, seeds_of(v), recorded); });
  }

  /// At the start of the run: what it begins with, and the material.
  void end() {
    run_.restore(kept_.front());
    // The body has sorted what it began with.
    const std::vector<Seed>& seeds = centre_.seeds;
    const auto unsorted = particles_of<Dim>(run_.source(), [](const Variation& v) { return v.seeds; });
    const auto sorted = plain::body_of<double, Dim>(centre_.settings, inputs_, unsorted);
    Particles bars(seeds.size());
    for (std::size_t i = 0; i < bars_.size(); ++i) bars[sorted.came_from()[i]] = bars_[i];
    add_seeds(bars, [](const Variation& v) { return v.seeds; });
    add(bars_of_inputs_.numbers,
        [](const Variation& v) { return plain::numbers_of(plain::inputs_of<double>(v.settings)); });
  }

  const Variations& variations_;
  const Variation& centre_;
  const Recording& recording_;
  plain::Inputs<double> inputs_;
  Run run_;
  Adjoint adjoint_;
  std::vector<typename Run::State> kept_;
  std::size_t count_ = 0;               ///< of those that are kept; others wait to be used again
  std::vector<std::uint64_t> digests_;  ///< of the state after so many steps; 0: not made yet
  Particles bars_;                      ///< of the particles in the state that is gone back to
  InputBars<Dim> bars_of_inputs_;
  std::vector<double> key_;
};

}  // namespace

std::string not_served_in_reverse(const SolverSettings& settings) {
  return StepAdjoint<3>::not_served(settings);
}

Readings reverse(const Variations& variations, const Recording& recording,
                 const std::vector<Quantity>& quantities, double memory, ReverseCost& cost,
                 const Watch& watch) {
  const SolverSettings& settings = variations.centre().settings;
  if (const std::string what = not_served_in_reverse(settings); !what.empty())
    throw std::invalid_argument("reverse differentiation does not serve " + what);
  return settings.dimension == 3 ? Backwards<3>(variations, recording).make(quantities, memory, cost, watch)
                                 : Backwards<2>(variations, recording).make(quantities, memory, cost, watch);
}

}  // namespace flowrest::mpm::derivatives
