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
    if (!slots_[i].list.empty()) occupied_.push_back(static_cast<std::uint32_t>(i));
  std::sort(occupied_.begin(), occupied_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return slots_[a].block < slots_[b].block; });
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
          from != no_slot && !slots_[from].list.empty() ? from : no_slot;
    }
}

void SparseBlocks::build(const std::vector<CellIndex>& cells) {
  slots_.clear();
  slot_of_block_.clear();
  touched_.clear();
  const std::size_t count = cells.size();
  owner_.resize(count);
  local_.resize(count);
  std::vector<std::vector<std::uint32_t>> members;
  for (std::size_t p = 0; p < count; ++p) {
    std::array<std::int32_t, 3> block{};
    CellIndex inside{};
    for (int a = 0; a < axes(); ++a) {
      const auto i = static_cast<std::size_t>(a);
      block[i] = floor_divide(cells[p][i]);
      inside[i] = cells[p][i] - block[i] * block_edge;
    }
    const std::uint32_t slot = ensure_slot(block);
    if (members.size() < slots_.size()) members.resize(slots_.size());
    members[slot].push_back(static_cast<std::uint32_t>(p));
    owner_[p] = slot;
    local_[p] = static_cast<std::uint8_t>(local_index(dimension_, inside));
  }
  fullest_cell_ = 0;
  for (std::size_t s = 0; s < members.size(); ++s) sort_list(static_cast<std::uint32_t>(s), members[s]);
  for (const auto& slot : slots_)
    for (std::size_t c = 0; c < 64; ++c)
      fullest_cell_ = std::max<std::size_t>(fullest_cell_, slot.start[c + 1] - slot.start[c]);
  refresh_neighbours();
}

void SparseBlocks::sort_list(std::uint32_t slot, const std::vector<std::uint32_t>& unsorted) {
  Slot& s = slots_[slot];
  s.start.fill(0);
  for (const auto p : unsorted) ++s.start[local_[p] + 1u];
  for (std::size_t c = 0; c < 64; ++c) s.start[c + 1] += s.start[c];
  std::array<std::uint32_t, 64> next;
  std::copy_n(s.start.begin(), 64, next.begin());
  s.list.resize(unsorted.size());
  for (const auto p : unsorted) s.list[next[local_[p]]++] = p;
  s.contiguous = true;
  for (std::size_t i = 1; i < s.list.size() && s.contiguous; ++i) s.contiguous = s.list[i] == s.list[0] + i;
}

void SparseBlocks::rebuild_list(std::uint32_t slot, std::vector<std::uint32_t>& scratch) {
  Slot& s = slots_[slot];
  scratch.clear();
  for (const auto p : s.list)
    if (owner_[p] == slot) scratch.push_back(p);
  scratch.insert(scratch.end(), s.arrivals.begin(), s.arrivals.end());
  s.arrivals.clear();
  s.touched = false;
  sort_list(slot, scratch);
}

std::vector<std::uint32_t> SparseBlocks::sorted_order() const {
  std::vector<std::uint32_t> order;
  order.reserve(owner_.size());
  for (const auto slot : occupied_)
    order.insert(order.end(), slots_[slot].list.begin(), slots_[slot].list.end());
  return order;
}

void SparseBlocks::particles_rearranged() {
  std::uint32_t next = 0;
  std::vector<std::uint8_t> local(local_.size());
  for (const auto slot : occupied_) {
    Slot& s = slots_[slot];
    for (auto& p : s.list) {
      local[next] = local_[p];
      p = next++;
    }
    s.contiguous = true;
  }
  local_ = std::move(local);
  for (const auto slot : occupied_)
    for (const auto p : slots_[slot].list) owner_[p] = slot;
}

void SparseBlocks::relocate(std::vector<Held>& held, int threads) {
  held.clear();
  touched_.clear();
  bool occupancy_changed = false;
  const auto touch = [&](std::uint32_t slot) {
    if (slots_[slot].touched) return;
    slots_[slot].touched = true;
    touched_.push_back(slot);
  };
  for (const auto slot : occupied_) {
    const std::uint32_t movers = slots_[slot].sums.movers;
    for (std::uint32_t m = 0; m < movers; ++m) {
      const Mover mover = slots_[slot].movers[m];
      CellIndex inside = local_coordinates(dimension_, local_[mover.particle]);
      auto block = slots_[slot].block;
      for (int a = 0; a < axes(); ++a) {
        const auto i = static_cast<std::size_t>(a);
        if (mover.shift[a] == 0) continue;
        const std::int32_t cell = block[i] * block_edge + inside[i] + mover.shift[a];
        const AxisBounds& b = bounds_[i];
        if (!b.periodic && ((b.lower != PlaneWall::none && cell < b.lower_cell) ||
                            (b.upper != PlaneWall::none && cell >= b.upper_cell))) {
          held.push_back({mover.particle, a, mover.shift[a] > 0});
          continue;
        }
        block[i] = floor_divide(cell);
        inside[i] = cell - block[i] * block_edge;
      }
      wrap(block);
      local_[mover.particle] = static_cast<std::uint8_t>(local_index(dimension_, inside));
      touch(slot);
      if (block == slots_[slot].block) continue;
      const std::uint32_t to = ensure_slot(block);
      owner_[mover.particle] = to;
      slots_[to].arrivals.push_back(mover.particle);
      if (slots_[to].list.empty()) occupancy_changed = true;
      touch(to);
    }
  }
  const auto count = static_cast<std::int64_t>(touched_.size());
#pragma omp parallel num_threads(threads) if (count > 8 * threads)
  {
    std::vector<std::uint32_t> scratch;
#pragma omp for schedule(static)
    for (std::int64_t i = 0; i < count; ++i) rebuild_list(touched_[static_cast<std::size_t>(i)], scratch);
  }
  for (const auto slot : touched_) {
    const Slot& s = slots_[slot];
    if (s.list.empty()) occupancy_changed = true;
    for (std::size_t c = 0; c < 64; ++c)
      fullest_cell_ = std::max<std::size_t>(fullest_cell_, s.start[c + 1] - s.start[c]);
  }
  if (occupancy_changed) refresh_neighbours();
}

double SparseBlocks::disorder() const {
  std::size_t scattered = 0;
  for (const auto slot : occupied_)
    if (!slots_[slot].contiguous) scattered += slots_[slot].list.size();
  return owner_.empty() ? 0.0 : static_cast<double>(scattered) / static_cast<double>(owner_.size());
}

BlockView SparseBlocks::view(std::uint32_t slot) {
  Slot& s = slots_[slot];
  if (s.movers.size() < s.list.size()) s.movers.resize(s.list.size() + s.list.size() / 4);
  BlockView v;
  for (int a = 0; a < axes(); ++a) v.origin[a] = s.block[static_cast<std::size_t>(a)] * block_edge;
  v.slot = slot;
  v.list = s.list.data();
  v.start = s.start.data();
  v.contiguous = s.contiguous;
  v.plus = s.plus.data();
  v.movers = s.movers.data();
  v.sums = &s.sums;
  return v;
}

NodeView SparseBlocks::node_view(std::uint32_t slot) const { return {slot, slots_[slot].minus.data()}; }

CellIndex SparseBlocks::cell_of(std::uint32_t particle) const {
  CellIndex cell = local_coordinates(dimension_, local_[particle]);
  const auto& block = slots_[owner_[particle]].block;
  for (std::size_t a = 0; a < 3; ++a) cell[a] += block[a] * block_edge;
  return cell;
}

std::size_t SparseBlocks::bytes() const {
  std::size_t total = owner_.capacity() * sizeof(std::uint32_t) + local_.capacity();
  for (const auto& s : slots_)
    total += sizeof(Slot) + s.list.capacity() * sizeof(std::uint32_t) + s.movers.capacity() * sizeof(Mover);
  return total;
}

}  // namespace flowrest::mpm
