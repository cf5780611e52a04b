// Where blocks lie in the particles' arrays: part of SparseBlocks.
#include <algorithm>

#include "mpm/solver/sparse_blocks.h"

namespace flowrest::mpm {

namespace {

/// Blocks begin on cache lines.
constexpr std::uint32_t line = 16;
/// Blocks that are moved to make room for another, at most.
constexpr std::size_t farthest_pushed = 16;
std::uint32_t whole_lines(std::uint32_t places) { return (places + line - 1) / line * line; }

}  // namespace

/// Places for a block with so many particles: a few of its neighbours' may come.
std::uint32_t SparseBlocks::places_for(std::uint32_t count) {
  constexpr std::uint32_t least_spare = 8;
  return whole_lines(count + count / 32 + least_spare);
}

/// Particles that lie in a block's places until it is put in order, and after that.
std::uint32_t SparseBlocks::most_particles(std::uint32_t slot) const {
  const Slot& s = slots_[slot];
  return s.to_come() > 0 ? std::max(s.count(), s.to_come()) : 0;
}

std::uint32_t SparseBlocks::places_needed(std::uint32_t slot) const {
  return whole_lines(most_particles(slot));
}

/// Where the places of the block that lies at `rank` in the arrays end: where the next one begins.
std::uint32_t SparseBlocks::places_end(std::size_t rank) const {
  return rank + 1 < in_memory_.size() ? slots_[in_memory_[rank + 1]].first : room_;
}

std::uint32_t SparseBlocks::places_to_spare(std::size_t rank) const {
  const std::uint32_t has = places_end(rank) - slots_[in_memory_[rank]].first;
  return has - std::min(has, places_needed(in_memory_[rank]));
}

std::size_t SparseBlocks::rank_in_memory(std::uint32_t slot) const {
  const auto at =
      std::lower_bound(in_memory_.begin(), in_memory_.end(), slots_[slot].first,
                       [&](std::uint32_t s, std::uint32_t first) { return slots_[s].first < first; });
  return static_cast<std::size_t>(at - in_memory_.begin());
}

/// Gives every block its places anew, in the order of the blocks, with room for what comes to it now, and
/// shares out what is left. The arrays keep their size where that does.
void SparseBlocks::lay_out() {
  in_memory_.clear();
  std::size_t wanted = 0;
  for (std::uint32_t s = 0; s < slots_.size(); ++s) {
    const std::uint32_t particles = most_particles(s);
    if (particles == 0) continue;
    in_memory_.push_back(s);
    wanted += places_for(particles);
  }
  std::sort(in_memory_.begin(), in_memory_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return slots_[a].block < slots_[b].block; });
  constexpr std::size_t least_spare = 256;
  if (room_ < wanted || room_ > wanted + wanted / 16 + 2 * least_spare)
    room_ = whole_lines(static_cast<std::uint32_t>(wanted + wanted / 32 + least_spare));
  relocation_.laid_out_anew = true;
  relocation_.new_places.clear();
  const std::size_t spare = room_ - wanted;
  std::uint32_t used = 0;
  for (std::size_t rank = 0; rank < in_memory_.size(); ++rank) {
    const std::uint32_t s = in_memory_[rank];
    const auto to = used + static_cast<std::uint32_t>(spare * rank / in_memory_.size()) / line * line;
    if (slots_[s].count() > 0) relocation_.new_places.push_back({slots_[s].first, to, slots_[s].count()});
    used += places_for(most_particles(s));
    slots_[s].first = to;
  }
}

void SparseBlocks::move_block(std::size_t rank, std::uint32_t to) {
  Slot& slot = slots_[in_memory_[rank]];
  if (slot.first == to) return;
  moved_.push_back({in_memory_[rank], slot.first});
  relocation_.new_places.push_back({slot.first, to, slot.count()});
  slot.first = to;
}

/// Sees to it that a block has places for what comes to it; false where none are near.
bool SparseBlocks::make_room(std::uint32_t slot) {
  if (slots_[slot].to_come() == 0) return true;
  if (slots_[slot].count() == 0) return find_places(slot);
  const std::size_t rank = rank_in_memory(slot);
  const std::uint32_t has = places_end(rank) - slots_[slot].first, needed = places_needed(slot);
  return needed <= has || push(rank, needed - has, Side::behind) || push(rank, needed - has, Side::before);
}

/// Puts a new block where there is most to spare.
bool SparseBlocks::find_places(std::uint32_t slot) {
  std::size_t best = 0;
  std::uint32_t most = 0;
  for (std::size_t rank = 0; rank < in_memory_.size(); ++rank)
    if (const std::uint32_t spare = places_to_spare(rank); spare > most) {
      best = rank;
      most = spare;
    }
  const std::uint32_t needed = places_needed(slot);
  if (most < needed) return false;
  // Either has half of what is left.
  slots_[slot].first = places_end(best) - needed - (most - needed) / 2 / line * line;
  in_memory_.insert(in_memory_.begin() + static_cast<std::ptrdiff_t>(best) + 1, slot);
  return true;
}

/// Moves the blocks behind one, or it and those before it, to where there are places to spare, so that it has
/// at least `missing` more; false where there are too few within reach.
bool SparseBlocks::push(std::size_t rank, std::uint32_t missing, Side side) {
  const std::size_t in_reach =
      std::min<std::size_t>(farthest_pushed, side == Side::behind ? in_memory_.size() - rank - 1 : rank + 1);
  const auto pushed = [&](std::size_t i) { return side == Side::behind ? rank + 1 + i : rank - i; };
  /// What is free beyond, so that the next needs to be pushed less far.
  const auto beyond = [&](std::size_t i) {
    if (side == Side::behind) return places_to_spare(pushed(i));
    return pushed(i) > 0 ? places_to_spare(pushed(i) - 1) : slots_[in_memory_.front()].first;
  };
  const std::uint32_t slot = in_memory_[rank],
                      wanted = missing + places_for(most_particles(slot)) - places_needed(slot);
  std::array<std::uint32_t, farthest_pushed> distance{};
  std::size_t count = 0;
  std::uint32_t left = wanted;
  for (; count < in_reach && left > 0; ++count) {
    distance[count] = left;
    left -= std::min(left, (beyond(count) + line) / 2 / line * line);  // half of it stays
  }
  if (wanted - left < missing) return false;
  for (std::size_t i = count; i-- > 0;) {
    const std::uint32_t first = slots_[in_memory_[pushed(i)]].first, by = distance[i] - left;
    move_block(pushed(i), side == Side::behind ? first + by : first - by);
  }
  return true;
}

}  // namespace flowrest::mpm
