#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "mpm/derivatives/dual.h"
#include "mpm/derivatives/quantities.h"
#include "mpm/derivatives/recording.h"
#include "mpm/derivatives/variation.h"
#include "mpm/plain/inputs.h"
#include "mpm/solver/settings.h"
#include "runs/errors.h"

/// A recorded run, made again by the plain step over any scalar.
namespace flowrest::mpm::derivatives {

/// What goes into a run over doubles: the numbers of one variation. Discs of a feed come when the recorded run's
/// came.
class PlainSource {
 public:
  using Scalar = double;
  PlainSource(const Variation& of, const Variation& recorded) : of_(of), recorded_(recorded) {}

  const Variation& recorded() const { return recorded_; }
  template <class Numbers>
  std::vector<double> numbers(const Numbers& of) const {
    return of(of_);
  }

 private:
  const Variation &of_, &recorded_;
};

/// The same over numbers with derivatives by up to N keys, from the key numbered `first` on.
template <int N>
class DualSource {
 public:
  using Scalar = Dual<N>;
  DualSource(const Variations& of, std::size_t first) : of_(of), first_(first) {}

  const Variation& recorded() const { return of_.centre(); }
  template <class Numbers>
  std::vector<Dual<N>> numbers(const Numbers& of) const {
    const std::vector<double> values = of(of_.centre());
    std::vector<Dual<N>> x(values.begin(), values.end());
    for (std::size_t k = 0; k < count(); ++k) {
      const std::vector<double> slopes = of_.slopes(first_ + k, of);
      for (std::size_t i = 0; i < x.size(); ++i) x[i].d[k] = slopes[i];
    }
    return x;
  }
  std::size_t count() const { return std::min<std::size_t>(N, of_.keys() - first_); }

 private:
  const Variations& of_;
  std::size_t first_;
};

/// All numbers of particles that seeds make, in their order, each place counted from the cell that the recorded
/// run's particle is in.
template <int Dim>
std::vector<double> numbers_of_seeds(const SolverSettings& settings, const std::vector<Seed>& seeds,
                                     const std::vector<Seed>& recorded) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    auto p = plain::particle_of<double, Dim>(settings, seeds[i]);
    for (std::size_t a = 0; a < Dim; ++a) p.place[a] += seeds[i].cell[a] - recorded[i].cell[a];
    plain::visit_state<Dim>(p, settings.thixotropic, [&](double number) { numbers.push_back(number); });
  }
  return numbers;
}

/// Particles of these seeds.
template <int Dim, class Source, class SeedsOf>
auto particles_of(const Source& source, const SeedsOf& seeds_of) {
  using T = typename Source::Scalar;
  const Variation& recorded = source.recorded();
  const std::vector<Seed> seeds = seeds_of(recorded);
  const std::vector<T> numbers = source.numbers(
      [&](const Variation& v) { return numbers_of_seeds<Dim>(v.settings, seeds_of(v), seeds); });
  std::vector<plain::Particle<T, Dim>> particles(seeds.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    particles[i].cell = plain::cell_of<Dim>(seeds[i].cell);
    plain::visit_state<Dim>(particles[i], recorded.settings.thixotropic,
                            [&](T& number) { number = numbers[next++]; });
    if (!recorded.settings.thixotropic) particles[i].flocculation = T(0);
  }
  return particles;
}

template <class Source>
plain::Inputs<typename Source::Scalar> inputs_of(const Source& source) {
  using T = typename Source::Scalar;
  auto inputs = plain::inputs_of<T>(source.recorded().settings);
  const std::vector<T> numbers = source.numbers(
      [](const Variation& v) { return plain::numbers_of(plain::inputs_of<double>(v.settings)); });
  std::size_t next = 0;
  plain::visit_numbers(inputs, [&](T& number) { number = numbers[next++]; });
  return inputs;
}

/// The nozzles that are there in a step.
template <class Source>
std::vector<NozzleMotion<typename Source::Scalar>> nozzles_of(const Source& source, const StepTaken& step) {
  using T = typename Source::Scalar;
  std::vector<NozzleMotion<T>> there;
  const SolverSettings& s = source.recorded().settings;
  for (std::size_t n = 0; n < s.nozzles.size(); ++n) {
    if (!s.nozzles[n].is_there(step.time)) continue;
    const std::vector<T> x =
        source.numbers([&](const Variation& v) { return v.nozzle(n, step.time, step.step); });
    there.push_back(motion_from(s.nozzles[n], s.cell, x, step.step));
  }
  return there;
}

/// Uniform acceleration of a step, m/s2.
template <int Dim, class Source>
plain::Vec<typename Source::Scalar, Dim> driving_of(const Source& source, const StepTaken& step) {
  const auto a = source.numbers([&](const Variation& v) { return v.acceleration(step.time); });
  plain::Vec<typename Source::Scalar, Dim> driving;
  std::copy_n(a.begin(), Dim, driving.begin());
  return driving;
}

/// The discs that a run's feeds let in, step by step.
class Arrivals {
 public:
  explicit Arrivals(const Variation& recorded) : feeds_(recorded.feeds), so_far_(feeds_.count_due(0.0)) {
    feeds_.pass_over(so_far_);
  }

  bool come_after(const StepTaken& step) const {
    const auto counts = feeds_.count_due(step.end);
    return std::any_of(counts.begin(), counts.end(), [](std::size_t n) { return n > 0; });
  }
  /// The seeds that come after a step, which has to be the next one with any, for every variation of the run.
  auto seeds_after(const StepTaken& step) const {
    return [counts = feeds_.count_due(step.end), before = so_far_, step](const Variation& v) {
      Feeds feeds = v.feeds;
      feeds.pass_over(before);
      return feeds.next(counts, step.end, step.step);
    };
  }
  /// Takes them for come.
  void pass(const StepTaken& step) {
    const std::vector<std::size_t> counts = feeds_.count_due(step.end);
    feeds_.pass_over(counts);
    for (std::size_t f = 0; f < counts.size(); ++f) so_far_[f] += counts[f];
  }

 private:
  Feeds feeds_;
  std::vector<std::size_t> so_far_;  ///< discs of each feed
};

/// A recorded run over a source's scalar.
template <class Source, int Dim>
class Replay {
 public:
  using T = typename Source::Scalar;
  using Body = plain::Body<T, Dim>;

  Replay(Source source, const Recording& recording)
      : source_(std::move(source)),
        recording_(recording),
        arrivals_(source_.recorded()),
        body_(
            plain::body_of<T, Dim>(source_.recorded().settings, inputs_of(source_),
                                   particles_of<Dim>(source_, [](const Variation& v) { return v.seeds; }))) {}

  /// Goes on until so many steps have been made.
  /// @throws runs::NumericsError where a particle moves further than a cell.
  void advance_to(std::size_t steps) {
    for (; made_ < steps; ++made_) {
      const StepTaken& step = recording_.steps[made_];
      const auto outcome =
          body_.step(step.time, T(step.step), driving_of<Dim>(source_, step),
                     T(plain::kept_share(step.apic_relaxation_time, step.step)), nozzles_of(source_, step));
      require_stable(outcome.faults, value(outcome.dissipated), step.step);
      if (!arrivals_.come_after(step)) continue;
      auto particles = body_.particles();
      for (auto& p : particles_of<Dim>(source_, arrivals_.seeds_after(step)))
        particles.push_back(std::move(p));
      arrivals_.pass(step);
      body_.take(particles);
    }
  }

  /// Where a replay stands, to go on from later.
  struct State {
    std::vector<plain::Particle<T, Dim>> particles;
    Arrivals arrivals;
    std::size_t made;
  };
  State state() const { return {body_.particles(), arrivals_, made_}; }
  void store(State& state) const {
    state.particles = body_.particles();
    state.arrivals = arrivals_;
    state.made = made_;
  }
  /// Goes back, or forth, to where it stood; goes on from there with the same bits. Walls of any shape start from the
  /// last step's forces, which a state has not.
  void restore(const State& state) {
    body_.take(state.particles);
    arrivals_ = state.arrivals;
    made_ = state.made;
  }

  const Body& body() const { return body_; }
  Body& body() { return body_; }
  std::size_t made() const { return made_; }
  const Arrivals& arrivals() const { return arrivals_; }
  const Source& source() const { return source_; }

 private:
  static double value(const T& x) {
    using plain::value;
    return value(x);
  }

  Source source_;
  const Recording& recording_;
  Arrivals arrivals_;
  Body body_;
  std::size_t made_ = 0;
};

/// A particle's values alone.
template <class T, int Dim>
plain::Particle<double, Dim> values_of(const plain::Particle<T, Dim>& p, bool thixotropic) {
  plain::Particle<double, Dim> values;
  values.cell = p.cell;
  std::vector<double> numbers;
  using plain::value;
  plain::visit_state<Dim>(p, thixotropic, [&](const T& x) { numbers.push_back(value(x)); });
  std::size_t next = 0;
  plain::visit_state<Dim>(values, thixotropic, [&](double& x) { x = numbers[next++]; });
  return values;
}

/// The numbers of Surroundings, of a reading at a time (s).
inline std::vector<double> numbers_of_surroundings(const Variation& v, double time,
                                                   const Quantity& quantity) {
  const auto station = v.station(time, quantity.place);
  return {v.settings.density, station[0], station[1]};
}

/// What a reading needs at a time (s) beside the particles.
template <class Source>
Surroundings<typename Source::Scalar> surroundings_of(const Source& source, double time,
                                                      const Quantity& quantity) {
  const auto x =
      source.numbers([&](const Variation& v) { return numbers_of_surroundings(v, time, quantity); });
  return {x[0], {x[1], x[2]}};
}

template <class T>
Surroundings<double> values_of(const Surroundings<T>& s) {
  using plain::value;
  return {value(s.density), {value(s.station[0]), value(s.station[1])}};
}

}  // namespace flowrest::mpm::derivatives
