#include "scenes/apparatus/apparatus.h"

#include <algorithm>
#include <cmath>

#include "scenes/pieces.h"

namespace flowrest::scenes {

std::string name_of(const Apparatus& apparatus) {
  return std::visit([](const auto& a) -> std::string { return a.name; }, apparatus);
}

MainGauge main_gauge_of(const Apparatus& apparatus) {
  return std::visit([](const auto& a) { return a.main_gauge; }, apparatus);
}

std::vector<std::string> apparatus_names() {
  std::vector<std::string> names;
  for_each_apparatus([&](const auto& a) { names.emplace_back(a.name); });
  return names;
}

const Apparatus* apparatus_named(const std::string& name) {
  static const std::vector<Apparatus> all = [] {
    std::vector<Apparatus> each;
    for_each_apparatus([&](const auto& a) { each.emplace_back(a); });
    return each;
  }();
  for (const Apparatus& one : all)
    if (name_of(one) == name) return &one;
  return nullptr;
}

std::optional<Load> load_of(const Scene& scene) {
  return std::visit([&](const auto& a) { return a.load(scene); }, scene.geometry.apparatus);
}

double cell_with_half(double height, double wanted) {
  return height / (std::max(1.0, std::round(height / wanted - 0.5)) + 0.5);
}

Pieces pieces_of(const Scene& scene) {
  return std::visit([&](const auto& a) { return a.pieces(scene); }, scene.geometry.apparatus);
}

}  // namespace flowrest::scenes
