#include "compare/measures/series.h"

#include <algorithm>
#include <cmath>

namespace flowrest::compare {

namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

double interpolate(std::span<const double> xs, std::span<const double> ys, double x) {
  const auto above = std::upper_bound(xs.begin(), xs.end(), x);
  if (above == xs.begin()) return ys.front();
  if (above == xs.end()) return ys.back();
  const auto i = static_cast<std::size_t>(above - xs.begin());
  return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
}

double Series::at(double t) const { return interpolate(time, value, t); }

std::optional<Trend> trend(const Series& series, double from, double to) {
  std::vector<double> time, value;
  for (std::size_t i = 0; i < series.time.size(); ++i)
    if (series.time[i] >= from && series.time[i] <= to) {
      time.push_back(series.time[i]);
      value.push_back(series.value[i]);
    }
  if (time.size() < 3 || !(time.back() > time.front())) return std::nullopt;
  // All pairs of at most 300 samples: the median does not need more.
  const std::size_t stride = (time.size() + 299) / 300;
  std::vector<double> slopes;
  for (std::size_t i = 0; i < time.size(); i += stride)
    for (std::size_t j = i + stride; j < time.size(); j += stride)
      if (time[j] > time[i]) slopes.push_back((value[j] - value[i]) / (time[j] - time[i]));
  if (slopes.empty()) return std::nullopt;
  Trend result;
  result.slope = median(slopes);
  std::vector<double> offsets(time.size());
  for (std::size_t i = 0; i < time.size(); ++i) offsets[i] = value[i] - result.slope * time[i];
  std::vector<double> sorted = offsets;
  const double offset = median(sorted);
  for (double& o : offsets) o = std::abs(o - offset);
  result.scatter = 1.4826 * median(offsets);
  return result;
}

Series rate_of_change(const Series& series, double window) {
  Series rate;
  std::size_t first = 0, last = 0;
  const auto& t = series.time;
  for (std::size_t i = 0; i < t.size(); ++i) {
    while (t[first] < t[i] - 0.5 * window) ++first;
    while (last < t.size() && t[last] <= t[i] + 0.5 * window) ++last;
    double mean_time = 0.0, mean_value = 0.0, covariance = 0.0, variance = 0.0;
    const auto count = static_cast<double>(last - first);
    for (std::size_t j = first; j < last; ++j) {
      mean_time += t[j] / count;
      mean_value += series.value[j] / count;
    }
    for (std::size_t j = first; j < last; ++j) {
      covariance += (t[j] - mean_time) * (series.value[j] - mean_value);
      variance += (t[j] - mean_time) * (t[j] - mean_time);
    }
    if (!(variance > 0.0)) continue;  // a window that holds one time says nothing about a rate
    rate.time.push_back(t[i]);
    rate.value.push_back(covariance / variance);
  }
  return rate;
}

std::optional<double> settles_below(const Series& series, double threshold) {
  std::size_t i = series.time.size();
  while (i > 0 && std::abs(series.value[i - 1]) <= threshold) --i;
  if (i == series.time.size()) return std::nullopt;
  return series.time[i];
}

ProfileError profile_error(std::span<const double> coordinate, std::span<const double> value,
                           std::span<const double> reference, bool radial, double floor) {
  ProfileError error;
  double area = 0.0, sum = 0.0, squares = 0.0, reference_sum = 0.0, reference_squares = 0.0;
  for (std::size_t i = 0; i < coordinate.size(); ++i) {
    if (std::abs(value[i]) <= floor && std::abs(reference[i]) <= floor) continue;
    const double left = i > 0 ? coordinate[i - 1] : coordinate[i];
    const double right = i + 1 < coordinate.size() ? coordinate[i + 1] : coordinate[i];
    const double weight = 0.5 * (right - left) * (radial ? std::abs(coordinate[i]) : 1.0);
    const double difference = std::abs(value[i] - reference[i]);
    area += weight;
    sum += weight * difference;
    squares += weight * difference * difference;
    reference_sum += weight * std::abs(reference[i]);
    reference_squares += weight * reference[i] * reference[i];
    error.linf = std::max(error.linf, difference);
  }
  if (area > 0.0) {
    error.l1 = sum / area;
    error.l2 = std::sqrt(squares / area);
  }
  if (reference_sum > 0.0) error.l1_relative = sum / reference_sum;
  if (reference_squares > 0.0) error.l2_relative = std::sqrt(squares / reference_squares);
  return error;
}

double round_step(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  double best = power;
  for (const double factor : {2.0, 2.5, 5.0, 10.0})
    if (std::abs(std::log(factor * power / value)) < std::abs(std::log(best / value))) best = factor * power;
  return best;
}

}  // namespace flowrest::compare
