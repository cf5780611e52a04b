#pragma once

#include <vector>

#include "runs/quantile.h"

namespace flowrest::foam {

/// Shear rates of cells full of concrete, and what of them overstresses it: the rate over 1 + flocculation
/// (runs/rest.h);
/// exactly so where the flow index is 1.
class ConcreteRates {
 public:
  /// A cell's rate in 1/s and its concrete in m3; the flocculation of all cells, or none.
  void add(double rate, double concrete, const std::vector<double>& flocculation, std::size_t cell) {
    rates_.emplace_back(rate, concrete);
    if (!flocculation.empty()) overstressing_.emplace_back(rate / (1.0 + flocculation[cell]), concrete);
  }
  /// 1/s, which one per cent of the concrete exceeds; `runs::nothing` without any.
  double percentile() const { return runs::percentile_99(rates_); }
  double overstressing_percentile() const {
    return runs::percentile_99(overstressing_.empty() ? rates_ : overstressing_);
  }

 private:
  std::vector<runs::Weighted> rates_, overstressing_;
};

}  // namespace flowrest::foam
