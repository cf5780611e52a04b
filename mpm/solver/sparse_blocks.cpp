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

std::vector<CellIndex> SparseBlocks::cells_of(std::uint32_t slot) const {
  const Slot& s = slots_[slot];
  std::vector<CellIndex> cells;
  cells.reserve(s.count());
  for (int c = 0; c < 64; ++c) {
    const auto i = static_cast<std::size_t>(c);
    CellIndex cell = local_coordinates(dimension_, c);
    for (std::size_t a = 0; a < 3; ++a) cell[a] += s.block[a] * block_edge;
    cells.insert(cells.end(), s.start[i + 1] - s.start[i], cell);
  }
  return cells;
}

void SparseBlocks::touch(std::uint32_t slot) {
  if (slots_[slot].touched) return;
  slots_[slot].touched = true;
  slots_[slot].count_to_come = slots_[slot].count();
  touched_.push_back(slot);
}

/// Where a block's movers go, as far as the block itself is concerned.
void SparseBlocks::plan_movers(std::uint32_t of) {
  Slot& slot = slots_[of];
  slot.changes.clear();
  slot.departures.clear();
  slot.held.clear();
  for (std::uint32_t m = 0; m < slot.sums.movers; ++m) plan_mover(slot, slot.movers[m]);
}

void SparseBlocks::plan_mover(Slot& slot, const Mover& mover) const {
  CellIndex inside = local_coordinates(dimension_, mover.cell);
  auto block = slot.block;
  for (int a = 0; a < axes(); ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (mover.shift[a] == 0) continue;
    const std::int32_t cell = block[i] * block_edge + inside[i] + mover.shift[a];
    const AxisBounds& b = bounds_[i];
    if (!b.periodic && ((b.lower != PlaneWall::none && cell < b.lower_cell) ||
                        (b.upper != PlaneWall::none && cell >= b.upper_cell))) {
      slot.held.push_back({slot.first + mover.index, a, mover.shift[a] > 0});
      continue;
    }
    block[i] = floor_divide(cell);
    inside[i] = cell - block[i] * block_edge;
  }
  wrap(block);
  const int after = local_index(dimension_, inside);
  const bool departs = block != slot.block;
  if (!departs && after == mover.cell) return;
  slot.changes.push_back({mover.index, mover.cell, departs ? no_cell : static_cast<std::uint8_t>(after)});
  if (departs)
    slot.departures.push_back({mover.index, static_cast<std::uint8_t>(after), block, slot_at(block)});
}

/// Sends a block's departures to where they arrive, block after block.
void SparseBlocks::depart(std::uint32_t from) {
  relocation_.held.insert(relocation_.held.end(), slots_[from].held.begin(), slots_[from].held.end());
  if (slots_[from].changes.empty()) return;
  touch(from);
  slots_[from].count_to_come -= static_cast<std::uint32_t>(slots_[from].departures.size());
  for (std::size_t d = 0; d < slots_[from].departures.size(); ++d) {
    const Departure departure = slots_[from].departures[d];
    const std::uint32_t to = departure.to != no_slot ? departure.to : ensure_slot(departure.block);
    if (slots_[to].count() == 0) relocation_.other_blocks = true;
    touch(to);
    ++slots_[to].count_to_come;
    slots_[to].arrivals.push_back(
        {static_cast<std::uint32_t>(relocation_.departing.size()), no_cell, departure.cell});
    relocation_.departing.push_back(slots_[from].first + departure.index);
  }
}

const SparseBlocks::Relocation& SparseBlocks::relocate(const BlockShares& shares, Team& team) {
  relocation_.held.clear();
  relocation_.departing.clear();
  relocation_.departing_end.assign(static_cast<std::size_t>(shares.threads()), 0);
  relocation_.new_places.clear();
  relocation_.laid_out_anew = relocation_.other_blocks = false;
  touched_.clear();
  auto& ends = relocation_.departing_end;
  for (const auto slot : occupied_) {
    depart(slot);
    ends[static_cast<std::size_t>(shares.owner(slots_[slot].arena))] = relocation_.departing.size();
  }
  for (std::size_t t = 1; t < ends.size(); ++t) ends[t] = std::max(ends[t], ends[t - 1]);
  for (const auto slot : touched_)
    if (slots_[slot].count_to_come == 0)
      in_memory_.erase(in_memory_.begin() + static_cast<std::ptrdiff_t>(rank_in_memory(slot)));
  if (!std::all_of(touched_.begin(), touched_.end(), [&](std::uint32_t s) { return make_room(s); })) {
    // Nothing has moved yet.
    for (auto m = moved_.rbegin(); m != moved_.rend(); ++m) slots_[m->slot].first = m->first;
    lay_out();
  }
  moved_.clear();
  plan_reorderings(shares, team);
  if (relocation_.other_blocks) refresh_neighbours();
  return relocation_;
}

/// Every thread plans for those of the touched blocks that are its own.
void SparseBlocks::plan_reorderings(const BlockShares& shares, Team& team) {
  const auto threads = static_cast<std::size_t>(shares.threads());
  if (planners_.size() != threads) {
    planners_.resize(threads);
    touched_shares_ = BlockShares(shares.threads());
  }
  const auto owner_of = [&](std::uint32_t slot) {
    return static_cast<std::size_t>(shares.owner(slots_[slot].arena));
  };
  std::vector<std::uint32_t> ends(threads, 0);
  for (const auto slot : touched_) ++ends[owner_of(slot)];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  touched_of_threads_.resize(touched_.size());
  std::vector<std::uint32_t> next(threads, 0);
  std::copy(ends.begin(), ends.end() - 1, next.begin() + 1);
  for (const auto slot : touched_) touched_of_threads_[next[owner_of(slot)]++] = slot;
  touched_shares_.share_out(std::move(ends));

  for (Planner& planner : planners_) {
    planner.fullest = 0;
    planner.emptied = false;
  }
  team.run(touched_shares_, [&](std::uint32_t i, int thread) {
    Slot& s = slots_[touched_of_threads_[i]];
    Planner& planner = planners_[static_cast<std::size_t>(thread)];
    plan_reordering(s, planner.links);
    s.touched = false;
    planner.emptied = planner.emptied || s.count() == 0;
    for (std::size_t c = 0; c < 64; ++c)
      planner.fullest = std::max(planner.fullest, s.start[c + 1] - s.start[c]);
  });
  for (const Planner& planner : planners_) {
    fullest_cell_ = std::max<std::size_t>(fullest_cell_, planner.fullest);
    relocation_.other_blocks = relocation_.other_blocks || planner.emptied;
  }
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
/// `links` go from one change of the block to the next that goes to the same cell.
void SparseBlocks::plan_reordering(Slot& s, std::vector<std::uint32_t>& links) {
  constexpr std::uint32_t none = ~0u;
  const auto before = s.start;
  std::array<std::uint32_t, 64> size{}, first_change, first_arrival;
  first_change.fill(none);
  first_arrival.fill(none);
  for (std::size_t c = 0; c < 64; ++c) size[c] = before[c + 1] - before[c];
  // Backwards, so that every cell's list of what comes to it is in order.
  links.resize(s.changes.size() + s.arrivals.size());
  const auto list = [&](std::array<std::uint32_t, 64>& heads, std::size_t i, std::size_t cell,
                        std::size_t link) {
    links[link] = heads[cell];
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
    for (; incoming != none && s.changes[incoming].from < before[c]; incoming = links[incoming])
      add_piece(out, s.changes[incoming].from, to++, 1);
    std::uint32_t from = before[c];
    for (; leaver < s.changes.size() && s.changes[leaver].from < before[c + 1]; ++leaver) {
      add_piece(out, from, to, s.changes[leaver].from - from);
      to += s.changes[leaver].from - from;
      from = s.changes[leaver].from + 1;
    }
    add_piece(out, from, to, before[c + 1] - from);
    to += before[c + 1] - from;
    for (; incoming != none; incoming = links[incoming]) add_piece(out, s.changes[incoming].from, to++, 1);
    for (std::uint32_t i = first_arrival[c]; i != none; i = links[s.changes.size() + i]) {
      out.pieces.push_back({0, to, 1});
      out.arrivals.push_back({s.arrivals[i].from, to++});
    }
  }
  s.changes.clear();
  s.arrivals.clear();
}

BlockView SparseBlocks::view(std::uint32_t slot) {
  Slot& s = slots_[slot];
  BlockView v;
  for (int a = 0; a < axes(); ++a) v.origin[a] = s.block[static_cast<std::size_t>(a)] * block_edge;
  v.slot = slot;
  v.arena = s.arena;
  v.start = s.start.data();
  v.plus = s.plus.data();
  v.sums = &s.sums;
  follow(v);
  return v;
}

void SparseBlocks::follow(BlockView& view) {
  Slot& s = slots_[view.slot];
  if (s.movers.size() < s.count()) {
    s.movers.reserve(places_for(s.count()));  // or else there would be room for twice as many
    s.movers.resize(places_for(s.count()));
  }
  view.first = s.first;
  view.movers = s.movers.data();
}

NodeView SparseBlocks::node_view(std::uint32_t slot) const { return {slot, slots_[slot].minus.data()}; }

std::size_t SparseBlocks::bytes() const {
  std::size_t total = 0;
  for (const auto& s : slots_)
    total += sizeof(Slot) + s.movers.capacity() * sizeof(Mover) +
             (s.changes.capacity() + s.arrivals.capacity()) * sizeof(Change) +
             s.departures.capacity() * sizeof(Departure) + s.held.capacity() * sizeof(Held) +
             s.reordering.pieces.capacity() * sizeof(Piece) +
             s.reordering.arrivals.capacity() * sizeof(Arrival);
  return total;
}

}  // namespace flowrest::mpm
