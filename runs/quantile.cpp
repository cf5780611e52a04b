#include "runs/quantile.h"

#include <algorithm>

#include "runs/depth.h"

namespace flowrest::runs {

double quantile(std::vector<Weighted>& values, double share) {
  std::sort(values.begin(), values.end());
  double total = 0.0;
  for (const auto& v : values) total += v.second;
  double sum = 0.0;
  for (const auto& v : values)
    if ((sum += v.second) >= share * total) return v.first;
  return values.empty() ? nothing : values.back().first;
}

}  // namespace flowrest::runs
