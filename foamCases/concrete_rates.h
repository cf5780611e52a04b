#pragma once

#include <vector>

#include "runs/quantile.h"
#include "runs/rest.h"

namespace flowrest::foam {

/// Shear rates of cells full of concrete, and what of them overstresses it: runs::overstressing_rate.
class ConcreteRates {
 public:
  /// `flow_index`: the power of the rate by which the concrete flows.
  explicit ConcreteRates(double flow_index) : flow_index_(flow_index) {}

  /// A cell's rate in 1/s and its concrete in m3; the part by which every cell's yield stress passes tau0, or
  /// none.
  void add(double rate, double concrete, const std::vector<double>& structure, std::size_t cell) {
    rates_.emplace_back(rate, concrete);
    if (!structure.empty())
      overstressing_.emplace_back(runs::overstressing_rate(rate, structure[cell], flow_index_), concrete);
  }
  /// 1/s, which one per cent of the concrete exceeds; `runs::nothing` without any.
  double percentile() const { return runs::percentile_99(rates_); }
  double overstressing_percentile() const {
    return runs::percentile_99(overstressing_.empty() ? rates_ : overstressing_);
  }

 private:
  double flow_index_;
  std::vector<runs::Weighted> rates_, overstressing_;
};

}  // namespace flowrest::foam
