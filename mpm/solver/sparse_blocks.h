#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mpm/solver/block_shares.h"
#include "mpm/solver/layout.h"
#include "mpm/solver/team.h"

namespace flowrest::mpm {

/// The occupied blocks of the background grid, which particles lie in which of their cells, and the
/// neighbourhoods. Only blocks that hold particles, and those their nodes reach into, exist. The particles of
/// a block lie side by side in their arrays, in the order of its cells, with some room behind them; where a
/// block outgrows it, those that lie next to it in memory make way.
/// Everything that matters to an answer (the order of particles within a cell, of blocks in sums) depends on
/// the history of the motion alone, not on threads or on where a block lies in memory.
class SparseBlocks {
 public:
  SparseBlocks() = default;
  SparseBlocks(int dimension, const std::array<AxisBounds, 3>& bounds)
      : dimension_(dimension), bounds_(bounds) {}

  /// Builds everything anew from each particle's cell; within a cell, particles keep their order. Returns
  /// each particle's place in the arrays.
  std::vector<std::uint32_t> build(const std::vector<CellIndex>& cells);

  /// Places that the particles' arrays need to have.
  std::size_t room() const { return room_; }
  /// The cells of a block's particles, in their order.
  std::vector<CellIndex> cells_of(std::uint32_t slot) const;

  /// Where the particles of a block go that the last step's kernels reported in its mover list. Blocks may
  /// be asked side by side, each once before relocate().
  void plan_movers(std::uint32_t slot);

  /// Relocation of all of them. What is asked of the blocks afterwards is as if everything had moved already;
  /// the arrays follow (Particles::make_way, then Particles::settle for every block before its particles are
  /// looked at). Threads plan for the blocks that are theirs: a share is a range of occupied().
  ///
  /// A particle that would pass a plane wall stays in its cell: it is in `held`, at the place where it is
  /// before anything moves. `departing` particles are to be set aside, in this order; blocks that make room
  /// for each other move to `new_places`, one after the other, or all of them into arrays of room() at once
  /// where `laid_out_anew`.
  struct Held {
    std::uint32_t place;
    int axis;
    bool upper;
  };
  struct NewPlace {
    std::uint32_t from, to, count;
  };
  struct Relocation {
    std::vector<Held> held;
    std::vector<std::uint32_t> departing;    ///< places
    std::vector<std::size_t> departing_end;  ///< of those that every thread's blocks set aside
    std::vector<NewPlace> new_places;
    bool laid_out_anew = false;
    bool other_blocks = false;  ///< are occupied now
  };
  const Relocation& relocate(const BlockShares&, Team&);

  /// What the arrays still owe to a block, by index in it: `pieces` that change their place, in the order of
  /// where they go, with a hole for each of the `arrivals`, which are among those set aside.
  struct Piece {
    std::uint32_t from, to, count;
  };
  struct Arrival {
    std::uint32_t departed, to;
  };
  struct Reordering {
    std::uint32_t first = 0;
    std::vector<Piece> pieces;
    std::vector<Arrival> arrivals;
  };
  Reordering& reordering(std::uint32_t slot) { return slots_[slot].reordering; }

  std::size_t slot_count() const { return slots_.size(); }
  const std::vector<std::uint32_t>& occupied() const { return occupied_; }
  /// A view holds until other blocks are occupied, if it follows every relocation.
  BlockView view(std::uint32_t slot);
  void follow(BlockView&);
  NodeView node_view(std::uint32_t slot) const;
  std::size_t fullest_cell() const { return fullest_cell_; }

  const std::array<std::int32_t, 3>& block(std::uint32_t slot) const { return slots_[slot].block; }
  /// Slot of a block of cells, wrapped where periodic; no_slot where it does not exist.
  std::uint32_t slot_of(std::array<std::int32_t, 3> block) const {
    wrap(block);
    return slot_at(block);
  }

  std::size_t bytes() const;

 private:
  /// A particle that changes cells within a block (from its index), or arrives (from the departed, out of no
  /// cell), or departs (to no cell).
  struct Change {
    std::uint32_t from;
    std::uint8_t old_cell, cell;
  };
  static constexpr std::uint8_t no_cell = 0xff;
  /// A particle on its way to a cell of another block, which may not have a slot yet.
  struct Departure {
    std::uint32_t index;
    std::uint8_t cell;
    std::array<std::int32_t, 3> block;
    std::uint32_t to;
  };
  struct Slot {
    std::array<std::int32_t, 3> block{};  ///< block coordinates
    std::uint32_t first = 0;              ///< of its places
    std::uint32_t arena = no_slot;        ///< its rank among the occupied blocks
    std::array<std::uint32_t, 65> start{};
    bool touched = false;
    std::uint32_t count_to_come = 0;  ///< particles after the relocation that is planned
    std::vector<Mover> movers;
    std::vector<Change> changes, arrivals;
    std::vector<Departure> departures;
    std::vector<Held> held;
    Reordering reordering;
    BlockSums sums;
    std::array<std::uint32_t, 8> plus{}, minus{};
    std::uint32_t count() const { return start[64]; }
    std::uint32_t to_come() const { return touched ? count_to_come : count(); }
  };

  std::uint32_t slot_at(const std::array<std::int32_t, 3>& block) const;
  std::uint32_t ensure_slot(const std::array<std::int32_t, 3>& block);
  std::array<std::int32_t, 3> shifted(const std::array<std::int32_t, 3>& block, int delta, int sign) const;
  void wrap(std::array<std::int32_t, 3>& block) const;
  void touch(std::uint32_t slot);
  void plan_mover(Slot&, const Mover&) const;
  void depart(std::uint32_t from);
  void plan_reorderings(const BlockShares&, Team&);
  static void plan_reordering(Slot&, std::vector<std::uint32_t>& links);
  static void add_piece(Reordering&, std::uint32_t from, std::uint32_t to, std::uint32_t count);
  // block_places.cpp
  void lay_out();
  static std::uint32_t places_for(std::uint32_t count);
  std::uint32_t most_particles(std::uint32_t slot) const;
  std::uint32_t places_needed(std::uint32_t slot) const;
  std::uint32_t places_end(std::size_t rank) const;
  std::uint32_t places_to_spare(std::size_t rank) const;
  std::size_t rank_in_memory(std::uint32_t slot) const;
  void move_block(std::size_t rank, std::uint32_t to);
  bool make_room(std::uint32_t slot);
  bool find_places(std::uint32_t slot);
  enum class Side { before, behind };
  bool push(std::size_t rank, std::uint32_t missing, Side);

  void refresh_neighbours();
  int axes() const { return dimension_; }

  int dimension_ = 2;
  std::array<AxisBounds, 3> bounds_{};
  std::vector<Slot> slots_;
  std::unordered_map<std::uint64_t, std::uint32_t> slot_of_block_;
  std::vector<std::uint32_t> occupied_;  ///< ascending in block coordinates
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint32_t> touched_of_threads_;  ///< the same, those of each thread together
  BlockShares touched_shares_;
  /// What a thread finds while it plans, and its room to do so.
  struct alignas(64) Planner {
    std::vector<std::uint32_t> links;
    std::uint32_t fullest = 0;
    bool emptied = false;
  };
  std::vector<Planner> planners_;
  Relocation relocation_;
  std::uint32_t room_ = 0;                ///< places of the arrays
  std::vector<std::uint32_t> in_memory_;  ///< blocks with places, which reach to the next one's
  struct Moved {
    std::uint32_t slot, first;
  };
  std::vector<Moved> moved_;  ///< blocks that are about to, and where they lie
  std::size_t fullest_cell_ = 0;
};

}  // namespace flowrest::mpm
