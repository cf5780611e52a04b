#include "mpm/solver/sparse_blocks.h"

#include <algorithm>
#include <numeric>

namespace flowrest::mpm {

namespace {

std::int32_t floor_divide(std::int32_t a) { return a >> 2; }  // by block_edge, towards minus infinity
static_assert(block_edge == 4);

std::uint64_t key_of(const std::array<std::int32_t, 3>& block) {
  std::uint64_t key = 0;
  for (const auto c : block) key = key << 21 | (static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffff);
  return key;
}

int local_index(int dimension, const CellIndex& in_block) {
  return dimension == 3 ? (in_block[0] * 4 + in_block[1]) * 4 + in_block[2] : in_block[0] * 4 + in_block[1];
}

CellIndex local_coordinates(int dimension, int local) {
  return dimension == 3 ? CellIndex{local / 16, local / 4 % 4, local % 4}
                        : CellIndex{local / 4, local % 4, 0};
}

/// Blocks begin on cache lines.
constexpr std::uint32_t line = 16;
/// Blocks that are moved to make room for another, at most.
constexpr std::size_t farthest_pushed = 16;
std::uint32_t whole_lines(std::uint32_t places) { return (places + line - 1) / line * line; }

/// Places for a block with so many particles: a few of its neighbours' may come.
std::uint32_t places_for(std::uint32_t count) {
  constexpr std::uint32_t least_spare = 8;
  return whole_lines(count + count / 32 + least_spare);
}

}  // namespace

void SparseBlocks::wrap(std::array<std::int32_t, 3>& block) const {
  for (int a = 0; a < axes(); ++a) {
    const AxisBounds& b = bounds_[static_cast<std::size_t>(a)];
    if (!b.periodic) continue;
    const std::int32_t first = floor_divide(b.lower_cell),
                       period = (b.upper_cell - b.lower_cell) / block_edge;
    auto& c = block[static_cast<std::size_t>(a)];
    c = first + ((c - first) % period + period) % period;
  }
}

std::uint32_t SparseBlocks::slot_at(const std::array<std::int32_t, 3>& block) const {
  const auto found = slot_of_block_.find(key_of(block));
  return found == slot_of_block_.end() ? no_slot : found->second;
}

std::uint32_t SparseBlocks::ensure_slot(const std::array<std::int32_t, 3>& block) {
  const auto [it, fresh] =
      slot_of_block_.try_emplace(key_of(block), static_cast<std::uint32_t>(slots_.size()));
  if (fresh) {
    slots_.emplace_back();
    slots_.back().block = block;
  }
  return it->second;
}

std::array<std::int32_t, 3> SparseBlocks::shifted(const std::array<std::int32_t, 3>& block, int delta,
                                                  int sign) const {
  auto to = block;
  for (int a = 0; a < axes(); ++a)
    if (delta >> (axes() - 1 - a) & 1) to[static_cast<std::size_t>(a)] += sign;
  wrap(to);
  return to;
}

void SparseBlocks::refresh_neighbours() {
  occupied_.clear();
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (slots_[i].count() > 0) occupied_.push_back(static_cast<std::uint32_t>(i));
  std::sort(occupied_.begin(), occupied_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return slots_[a].block < slots_[b].block; });
  for (std::size_t rank = 0; rank < occupied_.size(); ++rank)
    slots_[occupied_[rank]].arena = static_cast<std::uint32_t>(rank);
  const int neighbours = 1 << axes();
  for (const std::uint32_t slot : occupied_)
    for (int delta = 0; delta < neighbours; ++delta) {
      const std::uint32_t to = ensure_slot(shifted(slots_[slot].block, delta, +1));
      slots_[slot].plus[static_cast<std::size_t>(delta)] = to;
    }
  for (auto& slot : slots_)
    for (int delta = 0; delta < neighbours; ++delta) {
      const std::uint32_t from = slot_at(shifted(slot.block, delta, -1));
      slot.minus[static_cast<std::size_t>(delta)] =
          from != no_slot && slots_[from].count() > 0 ? slots_[from].arena : no_slot;
    }
}

std::vector<std::uint32_t> SparseBlocks::build(const std::vector<CellIndex>& cells) {
  slots_.clear();
  slot_of_block_.clear();
  touched_.clear();
  const std::size_t count = cells.size();
  std::vector<std::uint32_t> slot_of(count);
  std::vector<std::uint8_t> local(count);
  for (std::size_t p = 0; p < count; ++p) {
    std::array<std::int32_t, 3> block{};
    CellIndex inside{};
    for (int a = 0; a < axes(); ++a) {
      const auto i = static_cast<std::size_t>(a);
      block[i] = floor_divide(cells[p][i]);
      inside[i] = cells[p][i] - block[i] * block_edge;
    }
    slot_of[p] = ensure_slot(block);
    local[p] = static_cast<std::uint8_t>(local_index(dimension_, inside));
    ++slots_[slot_of[p]].start[local[p] + 1u];
  }
  fullest_cell_ = 0;
  for (auto& slot : slots_)
    for (std::size_t c = 0; c < 64; ++c) {
      fullest_cell_ = std::max<std::size_t>(fullest_cell_, slot.start[c + 1]);
      slot.start[c + 1] += slot.start[c];
    }
  refresh_neighbours();
  lay_out();
  std::vector<std::array<std::uint32_t, 64>> next(slots_.size());
  for (std::size_t s = 0; s < slots_.size(); ++s) std::copy_n(slots_[s].start.begin(), 64, next[s].begin());
  std::vector<std::uint32_t> places(count);
  for (std::size_t p = 0; p < count; ++p) places[p] = slots_[slot_of[p]].first + next[slot_of[p]][local[p]]++;
  return places;
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

std::vector<std::uint32_t> SparseBlocks::sorted_places() const {
  std::vector<std::uint32_t> places;
  for (const auto s : occupied_)
    for (std::uint32_t i = 0; i < slots_[s].count(); ++i) places.push_back(slots_[s].first + i);
  return places;
}

std::vector<CellIndex> SparseBlocks::sorted_cells() const {
  std::vector<CellIndex> cells;
  for (const auto s : occupied_)
    for (int c = 0; c < 64; ++c) {
      const auto i = static_cast<std::size_t>(c);
      CellIndex cell = local_coordinates(dimension_, c);
      for (std::size_t a = 0; a < 3; ++a) cell[a] += slots_[s].block[a] * block_edge;
      cells.insert(cells.end(), slots_[s].start[i + 1] - slots_[s].start[i], cell);
    }
  return cells;
}

void SparseBlocks::touch(std::uint32_t slot) {
  if (slots_[slot].touched) return;
  slots_[slot].touched = true;
  slots_[slot].count_to_come = slots_[slot].count();
  touched_.push_back(slot);
}

void SparseBlocks::plan_mover(std::uint32_t slot, const Mover& mover) {
  CellIndex inside = local_coordinates(dimension_, mover.cell);
  auto block = slots_[slot].block;
  for (int a = 0; a < axes(); ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (mover.shift[a] == 0) continue;
    const std::int32_t cell = block[i] * block_edge + inside[i] + mover.shift[a];
    const AxisBounds& b = bounds_[i];
    if (!b.periodic && ((b.lower != PlaneWall::none && cell < b.lower_cell) ||
                        (b.upper != PlaneWall::none && cell >= b.upper_cell))) {
      relocation_.held.push_back({slots_[slot].first + mover.index, a, mover.shift[a] > 0});
      continue;
    }
    block[i] = floor_divide(cell);
    inside[i] = cell - block[i] * block_edge;
  }
  wrap(block);
  const int after = local_index(dimension_, inside);
  const bool departs = block != slots_[slot].block;
  if (!departs && after == mover.cell) return;
  touch(slot);
  slots_[slot].changes.push_back(
      {mover.index, mover.cell, departs ? no_cell : static_cast<std::uint8_t>(after)});
  if (!departs) return;
  --slots_[slot].count_to_come;
  const std::uint32_t to = ensure_slot(block);
  if (slots_[to].count() == 0) occupancy_changed_ = true;
  touch(to);
  ++slots_[to].count_to_come;
  slots_[to].arrivals.push_back(
      {static_cast<std::uint32_t>(relocation_.departing.size()), no_cell, static_cast<std::uint8_t>(after)});
  relocation_.departing.push_back(slots_[slot].first + mover.index);
}

const SparseBlocks::Relocation& SparseBlocks::relocate() {
  relocation_ = {std::move(relocation_.held), std::move(relocation_.departing),
                 std::move(relocation_.new_places), false};
  relocation_.held.clear();
  relocation_.departing.clear();
  relocation_.new_places.clear();
  touched_.clear();
  occupancy_changed_ = false;
  for (const auto slot : occupied_) {
    const std::uint32_t movers = slots_[slot].sums.movers;
    for (std::uint32_t m = 0; m < movers; ++m) plan_mover(slot, slots_[slot].movers[m]);
  }
  for (const auto slot : touched_)
    if (slots_[slot].count_to_come == 0)
      in_memory_.erase(in_memory_.begin() + static_cast<std::ptrdiff_t>(rank_in_memory(slot)));
  if (!std::all_of(touched_.begin(), touched_.end(), [&](std::uint32_t s) { return make_room(s); })) {
    // Nothing has moved yet.
    for (auto m = moved_.rbegin(); m != moved_.rend(); ++m) slots_[m->slot].first = m->first;
    lay_out();
  }
  moved_.clear();
  for (const auto slot : touched_) {
    Slot& s = slots_[slot];
    plan_reordering(s);
    s.touched = false;
    if (s.count() == 0) occupancy_changed_ = true;
    for (std::size_t c = 0; c < 64; ++c)
      fullest_cell_ = std::max<std::size_t>(fullest_cell_, s.start[c + 1] - s.start[c]);
  }
  if (occupancy_changed_) refresh_neighbours();
  return relocation_;
}

void SparseBlocks::add_piece(Reordering& out, std::uint32_t from, std::uint32_t to, std::uint32_t count) {
  if (count == 0 || from == to) return;
  if (!out.pieces.empty()) {
    Piece& last = out.pieces.back();
    if (last.from + last.count == from && last.to + last.count == to) {
      last.count += count;
      return;
    }
  }
  out.pieces.push_back({from, to, count});
}

/// A cell takes its particles in the order of where they were: those from cells before it, those that stay,
/// those from cells after it; then those from other blocks.
void SparseBlocks::plan_reordering(Slot& s) {
  constexpr std::uint32_t none = ~0u;
  const auto before = s.start;
  std::array<std::uint32_t, 64> size{}, first_change, first_arrival;
  first_change.fill(none);
  first_arrival.fill(none);
  for (std::size_t c = 0; c < 64; ++c) size[c] = before[c + 1] - before[c];
  // Backwards, so that every cell's list of what comes to it is in order.
  links_.resize(s.changes.size() + s.arrivals.size());
  const auto list = [&](std::array<std::uint32_t, 64>& heads, std::size_t i, std::size_t cell,
                        std::size_t link) {
    links_[link] = heads[cell];
    heads[cell] = static_cast<std::uint32_t>(i);
    ++size[cell];
  };
  for (std::size_t i = s.changes.size(); i-- > 0;) {
    --size[s.changes[i].old_cell];
    if (s.changes[i].cell != no_cell) list(first_change, i, s.changes[i].cell, i);
  }
  for (std::size_t i = s.arrivals.size(); i-- > 0;)
    list(first_arrival, i, s.arrivals[i].cell, s.changes.size() + i);
  for (std::size_t c = 0; c < 64; ++c) s.start[c + 1] = s.start[c] + size[c];

  Reordering& out = s.reordering;
  out.first = s.first;
  out.pieces.clear();
  out.arrivals.clear();
  std::size_t leaver = 0;
  for (std::size_t c = 0; c < 64; ++c) {
    std::uint32_t to = s.start[c], incoming = first_change[c];
    for (; incoming != none && s.changes[incoming].from < before[c]; incoming = links_[incoming])
      add_piece(out, s.changes[incoming].from, to++, 1);
    std::uint32_t from = before[c];
    for (; leaver < s.changes.size() && s.changes[leaver].from < before[c + 1]; ++leaver) {
      add_piece(out, from, to, s.changes[leaver].from - from);
      to += s.changes[leaver].from - from;
      from = s.changes[leaver].from + 1;
    }
    add_piece(out, from, to, before[c + 1] - from);
    to += before[c + 1] - from;
    for (; incoming != none; incoming = links_[incoming]) add_piece(out, s.changes[incoming].from, to++, 1);
    for (std::uint32_t i = first_arrival[c]; i != none; i = links_[s.changes.size() + i]) {
      out.pieces.push_back({0, to, 1});
      out.arrivals.push_back({s.arrivals[i].from, to++});
    }
  }
  s.changes.clear();
  s.arrivals.clear();
}

BlockView SparseBlocks::view(std::uint32_t slot) {
  Slot& s = slots_[slot];
  if (s.movers.size() < s.count()) {
    s.movers.reserve(places_for(s.count()));  // or else there would be room for twice as many
    s.movers.resize(places_for(s.count()));
  }
  BlockView v;
  for (int a = 0; a < axes(); ++a) v.origin[a] = s.block[static_cast<std::size_t>(a)] * block_edge;
  v.slot = slot;
  v.arena = s.arena;
  v.first = s.first;
  v.start = s.start.data();
  v.plus = s.plus.data();
  v.movers = s.movers.data();
  v.sums = &s.sums;
  return v;
}

NodeView SparseBlocks::node_view(std::uint32_t slot) const { return {slot, slots_[slot].minus.data()}; }

std::size_t SparseBlocks::bytes() const {
  std::size_t total = 0;
  for (const auto& s : slots_)
    total += sizeof(Slot) + s.movers.capacity() * sizeof(Mover) +
             (s.changes.capacity() + s.arrivals.capacity()) * sizeof(Change) +
             s.reordering.pieces.capacity() * sizeof(Piece) +
             s.reordering.arrivals.capacity() * sizeof(Arrival);
  return total;
}

}  // namespace flowrest::mpm
