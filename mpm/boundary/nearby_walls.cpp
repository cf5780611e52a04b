#include "mpm/boundary/nearby_walls.h"

#include <cmath>

namespace flowrest::mpm {

namespace {

/// How far walls may move before cells are looked at again, in cells.
constexpr double leeway = 0.25;
/// The set's last member stands for all walls from there on.
constexpr std::size_t last_of_set = 8 * sizeof(WallSet) - 1;

bool holds(WallSet set, std::size_t wall) { return (set >> std::min(wall, last_of_set) & 1) != 0; }

}  // namespace

bool NearbyWalls::follow(double time) {
  bool moved = false;
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    if (!walls_[w].motion.moves()) continue;
    const Vector now = walls_[w].motion.displacement(time);
    double square = 0.0;
    for (std::size_t a = 0; a < 3; ++a) square += (now[a] - marked_at_[w][a]) * (now[a] - marked_at_[w][a]);
    moved |= square > leeway * leeway * cell_ * cell_;
  }
  if (!moved) return false;
  for (std::size_t w = 0; w < walls_.size(); ++w) marked_at_[w] = walls_[w].motion.displacement(time);
  time_ = time;
  for (Block& block : blocks_) block.known = false;
  return true;
}

WallSet NearbyWalls::closer_than(double reach, const Vector& place, WallSet among) const {
  WallSet found = 0;
  for (std::size_t w = 0; w < walls_.size(); ++w)
    if (holds(among, w) && walls_[w].distance(place, time_) < reach)
      found |= WallSet{1} << std::min(w, last_of_set);
  return found;
}

const WallSet* NearbyWalls::of_block(std::uint32_t slot, const int (&origin)[3]) {
  if (slot >= blocks_.size()) blocks_.resize(slot + 1u);
  Block& block = blocks_[slot];
  if (!block.known) {
    block.known = true;
    block.cells.clear();
    const double diagonal = std::sqrt(dimension_);
    const auto middle = [&](int first, double edge) { return (first + 0.5 * edge) * cell_; };
    Vector centre{};
    for (int a = 0; a < dimension_; ++a) centre[static_cast<std::size_t>(a)] = middle(origin[a], block_edge);
    // From a block as far as a particle goes at most, one cell along every axis.
    const WallSet near =
        closer_than((0.5 * block_edge * diagonal + diagonal + leeway) * cell_, centre, ~WallSet{0});
    const int depth = dimension_ == 3 ? block_edge : 1;
    if (near != 0)
      for (int i = 0; i < block_edge; ++i)
        for (int j = 0; j < block_edge; ++j)
          for (int k = 0; k < depth; ++k) {
            const int inside[3] = {i, j, k};
            for (int a = 0; a < dimension_; ++a)
              centre[static_cast<std::size_t>(a)] = middle(origin[a] + inside[a], 1.0);
            block.cells.push_back(closer_than((0.5 * diagonal + wall_reach + leeway) * cell_, centre, near));
          }
  }
  return block.cells.empty() ? nullptr : block.cells.data();
}

bool NearbyWalls::hold(WallSet set, const Vector& place, double time) const {
  for (std::size_t w = 0; w < walls_.size(); ++w)
    if (holds(set, w) && walls_[w].stands(time) && walls_[w].distance(place, time) < 0.0) return true;
  return false;
}

}  // namespace flowrest::mpm
