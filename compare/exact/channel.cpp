#include "compare/exact/channel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runs/depth.h"

namespace flowrest::compare::exact {

namespace {

/// Gauss-Legendre, five points, on pieces of one length.
template <class Function>
double integral(const Function& f, double low, double high) {
  constexpr std::array<double, 3> at{0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> weight{0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  constexpr int pieces = 32;
  double sum = 0.0;
  for (int i = 0; i < pieces; ++i) {
    const double half = 0.5 * (high - low) / pieces, middle = low + (2 * i + 1) * half;
    sum += half * weight[0] * f(middle);
    for (std::size_t k = 1; k < at.size(); ++k)
      sum += half * weight[k] * (f(middle - half * at[k]) + f(middle + half * at[k]));
  }
  return sum;
}

/// Where a rising function passes `value`.
template <class Function>
double inverse(const Function& rising, double value, double low, double high) {
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (rising(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

ArrestedChannel::ArrestedChannel(const Bingham& material, double gravity, const Channel& channel,
                                 double volume)
    : weight_(material.density * gravity), yield_stress_(material.yield_stress), channel_(channel) {
  const double area = volume / channel.width;
  double most = std::sqrt(area);
  while (area_between(0.0, most) < area) most *= 2.0;
  start_height_ = inverse([&](double high) { return area_between(0.0, high); }, area, 0.0, most);
  front_ = length_between(0.0, start_height_);
  if (front_ <= channel.length) return;
  front_ = channel.length;
  // It leans on the far end: as much higher there as the volume asks for.
  const auto start_over = [&](double end) {
    return inverse([&](double high) { return length_between(end, high); }, channel.length, end, end + most);
  };
  end_height_ = inverse([&](double end) { return area_between(end, start_over(end)); }, area, 0.0,
                        area / channel.length);
  start_height_ = start_over(end_height_);
}

double ArrestedChannel::run_of(double height) const {
  if (height <= 0.0) return std::isfinite(channel_.friction) ? 1.0 / channel_.friction : 0.0;
  const double most = channel_.friction * weight_ * height;
  const double floor = std::min(yield_stress_, most);
  // Over the side wall's upper part the pressure does not let it give the yield stress.
  const double side = most <= yield_stress_
                          ? 0.5 * most * height
                          : yield_stress_ * (height - 0.5 * yield_stress_ / (channel_.friction * weight_));
  return weight_ * height / (floor + 2.0 * side / channel_.width);
}

template <class Function>
double ArrestedChannel::over_heights(const Function& f, double low, double high) const {
  // Below this height no wall gives the yield stress.
  const double kink = std::clamp(yield_stress_ / (channel_.friction * weight_), low, high);
  return integral(f, low, kink) + integral(f, kink, high);
}

double ArrestedChannel::length_between(double low, double high) const {
  return over_heights([this](double h) { return run_of(h); }, low, high);
}

double ArrestedChannel::area_between(double low, double high) const {
  return over_heights([this](double h) { return h * run_of(h); }, low, high);
}

double ArrestedChannel::depth(double x) const {
  if (x > front_) return 0.0;
  if (x <= 0.0) return start_height_;
  return inverse([&](double h) { return length_between(end_height_, h); }, front_ - x, end_height_,
                 start_height_);
}

double ArrestedChannel::reach(double threshold) const {
  if (threshold >= start_height_) return runs::nothing;
  return front_ - length_between(end_height_, std::max(threshold, end_height_));
}

}  // namespace flowrest::compare::exact
