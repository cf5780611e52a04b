#include "mpm/output/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flowrest::mpm {

namespace {

/// Steps from one measurement to the next, so that it costs little; three are looked at.
constexpr int fewest_steps_between = 200;
/// Particles that spread less than this share of a cell along an axis say nothing of a gradient along it.
constexpr double least_extent = 1e-3;

CellIndex cell_of(const ParticleBatch& batch, std::size_t particle, int dimension, double cell) {
  CellIndex index{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
    index[a] = static_cast<std::int32_t>(std::floor(batch.position[a][particle] / cell));
  return index;
}

/// Particles come cell by cell: where those of the cell of particle `begin` end.
std::size_t end_of_cell(const ParticleBatch& batch, std::size_t begin, int dimension, double cell) {
  const CellIndex here = cell_of(batch, begin, dimension, cell);
  std::size_t end = begin + 1;
  while (end < batch.count && cell_of(batch, end, dimension, cell) == here) ++end;
  return end;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// One cell's particles and the orthonormal functions linear in space that they can tell apart.
class LinearFit {
 public:
  explicit LinearFit(double cell) : cell_(cell) {}

  void positions(const ParticleBatch& batch, std::size_t begin, std::size_t end, int dimension) {
    functions_ = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) {
      auto& function = basis_[functions_];
      without_linear_part(batch.position[a], begin, end, function);
      const double length = std::sqrt(dot(function, function));
      if (length < least_extent * cell_) continue;
      for (double& v : function) v /= length;
      ++functions_;
    }
    const std::size_t fitted = 1 + functions_;
    freedom_ = end - begin > fitted ? end - begin - fitted : 0;
  }

  /// Values a particle that the fit leaves free; none where it passes through them all.
  std::size_t freedom() const { return freedom_; }

  /// Mean square, per degree of freedom, of what of the values is not linear in space.
  double residual(const std::vector<double>& values, std::size_t begin, std::size_t end) {
    without_linear_part(values, begin, end, rest_);
    return dot(rest_, rest_) / static_cast<double>(freedom_);
  }

 private:
  /// Gram and Schmidt's way: less the mean, less the part along each function so far.
  void without_linear_part(const std::vector<double>& values, std::size_t begin, std::size_t end,
                           std::vector<double>& rest) const {
    rest.assign(values.begin() + static_cast<std::ptrdiff_t>(begin),
                values.begin() + static_cast<std::ptrdiff_t>(end));
    double mean = 0.0;
    for (const double v : rest) mean += v;
    mean /= static_cast<double>(rest.size());
    for (double& v : rest) v -= mean;
    for (std::size_t f = 0; f < functions_; ++f) {
      const double part = dot(rest, basis_[f]);
      for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= part * basis_[f][i];
    }
  }

  double cell_;
  std::array<std::vector<double>, 3> basis_;
  std::size_t functions_ = 0, freedom_ = 0;
  std::vector<double> rest_;
};

void note(NoiseSeen& seen, double from, double until, double noise, double speed, double bound) {
  if (!(noise > bound * speed)) return;
  seen.time += until - from;
  seen.path += noise * (until - from);
  seen.motion += speed * (until - from);
  if (seen.first < 0.0) seen.first = from;
  seen.last = until;
}

std::string words(const NoiseSeen& seen, const std::string& what) {
  return fmt::format(
      "{}, {:.0f} % of the speed between {:.2f} and {:.2f} s; it could have moved material by {:.2g} m", what,
      100.0 * seen.path / seen.motion, seen.first, seen.last, seen.path);
}

}  // namespace

std::vector<CellMotion> motion_of_cells(Solver& solver, int dimension, double cell) {
  std::vector<CellMotion> cells;
  cells.reserve(solver.occupied_cells());
  solver.visit_motion([&](const ParticleBatch& batch) {
    for (std::size_t begin = 0, end = 0; begin < batch.count; begin = end) {
      end = end_of_cell(batch, begin, dimension, cell);
      CellMotion& here = cells.emplace_back();
      here.cell = cell_of(batch, begin, dimension, cell);
      for (std::size_t i = begin; i < end; ++i) {
        here.mass += batch.mass[i];
        for (std::size_t a = 0; a < 3; ++a) here.velocity[a] += batch.mass[i] * batch.velocity[a][i];
      }
      for (double& v : here.velocity) v /= here.mass;
    }
  });
  std::sort(cells.begin(), cells.end(),
            [](const CellMotion& a, const CellMotion& b) { return a.cell < b.cell; });
  return cells;
}

VelocityNoise noise_within_cells(Solver& solver, int dimension, double cell) {
  const auto axes = static_cast<std::size_t>(dimension);
  LinearFit fit(cell);
  double mass = 0.0, motion = 0.0, judged_mass = 0.0, noise = 0.0;
  solver.visit_motion([&](const ParticleBatch& batch) {
    for (std::size_t begin = 0, end = 0; begin < batch.count; begin = end) {
      end = end_of_cell(batch, begin, dimension, cell);
      double here = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        here += batch.mass[i];
        for (const auto& v : batch.velocity) motion += batch.mass[i] * v[i] * v[i];
      }
      mass += here;
      fit.positions(batch, begin, end, dimension);
      if (fit.freedom() == 0) continue;
      judged_mass += here;
      for (std::size_t a = 0; a < axes; ++a) noise += here * fit.residual(batch.velocity[a], begin, end);
    }
  });
  VelocityNoise found;
  if (mass > 0.0) found.speed = std::sqrt(motion / mass);
  if (judged_mass > 0.0) found.within_cells = std::sqrt(noise / judged_mass);
  return found;
}

double alternation(const std::array<std::vector<CellMotion>, 3>& moments, double first, double second) {
  double mass = 0.0, sum = 0.0;
  auto before = moments[0].begin(), between = moments[1].begin();
  for (const CellMotion& now : moments[2]) {
    while (before != moments[0].end() && before->cell < now.cell) ++before;
    while (between != moments[1].end() && between->cell < now.cell) ++between;
    if (before == moments[0].end() || between == moments[1].end()) break;
    if (before->cell != now.cell || between->cell != now.cell) continue;
    mass += now.mass;
    for (std::size_t a = 0; a < 3; ++a) {
      // An alternating velocity of amplitude 1 changes by 2 and by -2.
      const double change = between->velocity[a] - before->velocity[a];
      const double next = (now.velocity[a] - between->velocity[a]) * first / second;
      sum += now.mass * (next - change) * (next - change) / 16.0;
    }
  }
  return mass > 0.0 ? std::sqrt(sum / mass) : 0.0;
}

void NoiseMeter::begin() {
  if (since_begin_ < 0 || since_begin_ >= fewest_steps_between) since_begin_ = 0;
}

bool NoiseMeter::add(Solver& solver, double step) {
  if (since_begin_ < 0) return false;
  const auto moment = static_cast<std::size_t>(since_begin_++);
  if (moment >= moments_.size()) return false;
  steps_[moment] = step;
  moments_[moment] = motion_of_cells(solver, dimension_, cell_);
  if (moment + 1 < moments_.size()) return false;
  noise_ = noise_within_cells(solver, dimension_, cell_);
  noise_.between_steps = alternation(moments_, steps_[1], steps_[2]);
  moments_ = {};
  return true;
}

std::vector<double> NoiseMeter::state() const {
  std::vector<double> numbers = {static_cast<double>(since_begin_)};
  numbers.insert(numbers.end(), steps_.begin(), steps_.end());
  const int under_way = since_begin_ < static_cast<int>(moments_.size()) ? since_begin_ : 0;
  for (int moment = 0; moment < under_way; ++moment) {
    const auto& cells = moments_[static_cast<std::size_t>(moment)];
    numbers.push_back(static_cast<double>(cells.size()));
    for (const CellMotion& cell : cells) {
      numbers.insert(numbers.end(), cell.cell.begin(), cell.cell.end());
      numbers.push_back(cell.mass);
      numbers.insert(numbers.end(), cell.velocity.begin(), cell.velocity.end());
    }
  }
  return numbers;
}

void NoiseMeter::restore(const std::vector<double>& state) {
  std::size_t next = 0;
  const auto take = [&] { return state.at(next++); };
  since_begin_ = static_cast<int>(take());
  for (double& step : steps_) step = take();
  for (auto& cells : moments_) cells.clear();
  for (std::size_t moment = 0; next < state.size(); ++moment) {
    auto& cells = moments_.at(moment);
    for (auto left = static_cast<std::size_t>(take()); left > 0; --left) {
      CellMotion& cell = cells.emplace_back();
      for (auto& index : cell.cell) index = static_cast<std::int32_t>(take());
      cell.mass = take();
      for (double& v : cell.velocity) v = take();
    }
  }
}

void NoiseRecord::add(double time, const VelocityNoise& noise) {
  note(within_cells, judged_until, time, noise.within_cells, noise.speed, within_cells_bound);
  note(between_steps, judged_until, time, noise.between_steps, noise.speed, between_steps_bound);
  judged_until = time;
}

std::string NoiseRecord::fault(double body_height) const {
  if (within_cells.path > path_allowed * body_height)
    return words(within_cells, "velocities differ within cells in ways that the grid does not feel");
  if (between_steps.path > path_allowed * body_height)
    return words(between_steps, "velocities alternate from step to step");
  return {};
}

}  // namespace flowrest::mpm
