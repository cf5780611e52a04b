#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mpm/solver/layout.h"

namespace flowrest::mpm {

using CellIndex = std::array<std::int32_t, 3>;  ///< global cell coordinates; the third is 0 in two dimensions

/// The occupied blocks of the background grid, which particles lie in which of their cells, and the
/// neighbourhoods. Only blocks that hold particles, and those their nodes reach into, exist. Everything that
/// follows from it (the order of particles within a cell, of blocks in sums) depends on the history of the
/// motion alone, not on threads or on where a particle lies in memory.
class SparseBlocks {
 public:
  SparseBlocks() = default;
  SparseBlocks(int dimension, const std::array<AxisBounds, 3>& bounds)
      : dimension_(dimension), bounds_(bounds) {}

  /// Builds everything anew from each particle's cell; within a cell, particles keep their order.
  void build(const std::vector<CellIndex>& cells);

  /// Particles in the order of (block, cell, place in the cell).
  std::vector<std::uint32_t> sorted_order() const;
  /// To be called when particles have been rearranged by sorted_order().
  void particles_rearranged();

  /// Moves the particles that the last step's kernels reported (in the blocks' mover lists) to their new
  /// cells. A particle that would pass a plane wall stays in its cell: those are reported as (particle, axis,
  /// side) in `held`.
  struct Held {
    std::uint32_t particle;
    int axis;
    bool upper;
  };
  void relocate(std::vector<Held>& held, int threads);

  /// Share of the particles that lie in blocks whose list is not contiguous in memory.
  double disorder() const;

  std::size_t slot_count() const { return slots_.size(); }
  const std::vector<std::uint32_t>& occupied() const { return occupied_; }
  BlockView view(std::uint32_t slot);
  NodeView node_view(std::uint32_t slot) const;
  const BlockSums& sums(std::uint32_t slot) const { return slots_[slot].sums; }
  void clear_sums(std::uint32_t slot) { slots_[slot].sums = {}; }
  std::size_t fullest_cell() const { return fullest_cell_; }

  /// Slot of a block of cells, wrapped where periodic; no_slot where it does not exist.
  std::uint32_t slot_of(std::array<std::int32_t, 3> block) const {
    wrap(block);
    return slot_at(block);
  }

  /// Global cell of a particle.
  CellIndex cell_of(std::uint32_t particle) const;
  std::size_t bytes() const;

 private:
  struct Slot {
    std::array<std::int32_t, 3> block{};  ///< block coordinates
    std::vector<std::uint32_t> list;
    std::array<std::uint32_t, 65> start{};
    bool contiguous = false;
    bool touched = false;
    std::vector<Mover> movers;
    std::vector<std::uint32_t> arrivals;
    BlockSums sums;
    std::array<std::uint32_t, 8> plus{}, minus{};
  };

  std::uint32_t slot_at(const std::array<std::int32_t, 3>& block) const;
  std::uint32_t ensure_slot(const std::array<std::int32_t, 3>& block);
  std::array<std::int32_t, 3> shifted(const std::array<std::int32_t, 3>& block, int delta, int sign) const;
  void wrap(std::array<std::int32_t, 3>& block) const;
  void sort_list(std::uint32_t slot, const std::vector<std::uint32_t>& unsorted);
  void rebuild_list(std::uint32_t slot, std::vector<std::uint32_t>& scratch);
  void refresh_neighbours();
  int axes() const { return dimension_; }

  int dimension_ = 2;
  std::array<AxisBounds, 3> bounds_{};
  std::vector<Slot> slots_;
  std::unordered_map<std::uint64_t, std::uint32_t> slot_of_block_;
  std::vector<std::uint32_t> occupied_;  ///< ascending in block coordinates
  std::vector<std::uint32_t> owner_;     ///< slot of each particle
  std::vector<std::uint8_t> local_;      ///< cell within the block of each particle
  std::vector<std::uint32_t> touched_;
  std::size_t fullest_cell_ = 0;
};

}  // namespace flowrest::mpm
