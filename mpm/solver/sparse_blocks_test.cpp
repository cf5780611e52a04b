#include "mpm/solver/sparse_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "mpm/solver/particles.h"
#include "mpm/test_random.h"

using namespace flowrest::mpm;
using flowrest::mpm::test::Random;

namespace {

using Block = std::array<std::int32_t, 3>;

std::int32_t floor_quarter(std::int32_t c) { return c >= 0 ? c / 4 : -((3 - c) / 4); }

/// The same bookkeeping without any block: every particle's cell, and the order all particles come in.
struct BruteForce {
  int dimension;
  std::array<AxisBounds, 3> bounds;
  std::vector<CellIndex> cells;
  std::vector<std::uint32_t> order;

  Block block_of(const CellIndex& c) const {
    Block b{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) b[a] = floor_quarter(c[a]);
    return b;
  }

  /// Moves each particle, holding it at walls and wrapping it where periodic. Residents of a block stay
  /// before arrivals.
  std::set<std::pair<std::uint32_t, int>> move(const std::vector<std::array<int, 3>>& shifts) {
    std::set<std::pair<std::uint32_t, int>> held;
    std::vector<bool> arrived(cells.size(), false);
    for (std::uint32_t p = 0; p < cells.size(); ++p) {
      const Block before = block_of(cells[p]);
      for (int a = 0; a < dimension; ++a) {
        const auto i = static_cast<std::size_t>(a);
        std::int32_t to = cells[p][i] + shifts[p][i];
        const AxisBounds& b = bounds[i];
        if (b.periodic) {
          const int period = b.upper_cell - b.lower_cell;
          to = b.lower_cell + ((to - b.lower_cell) % period + period) % period;
        } else if ((b.lower != PlaneWall::none && to < b.lower_cell) ||
                   (b.upper != PlaneWall::none && to >= b.upper_cell)) {
          held.insert({p, a});
          continue;
        }
        cells[p][i] = to;
      }
      arrived[p] = block_of(cells[p]) != before;
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const Block block_a = block_of(cells[a]), block_b = block_of(cells[b]);
      if (block_a != block_b) return block_a < block_b;
      if (cells[a] != cells[b]) return cells[a] < cells[b];
      return !arrived[a] && arrived[b];
    });
    return held;
  }
};

/// Particles that carry nothing but their numbers, where the blocks say.
struct Numbered {
  Particles<double> particles{ParticleLayout{}};

  Numbered(SparseBlocks& blocks, const std::vector<CellIndex>& cells) {
    const auto places = blocks.build(cells);
    particles.make_room(blocks.room());
    for (int k = 0; k < particles.array_count(); ++k)
      for (std::size_t p = 0; p < places.size(); ++p) particles.array(k)[places[p]] = number(p, k);
  }
  /// In every array another one.
  static double number(std::size_t p, int array) { return static_cast<double>(p) + 1e6 * array; }
  std::uint32_t at(std::size_t place) const {
    const auto p = static_cast<std::uint32_t>(particles.array(0)[place]);
    for (int k = 1; k < particles.array_count(); ++k)
      EXPECT_EQ(particles.array(k)[place], number(p, k)) << "a particle's values stay together";
    return p;
  }
};

void expect_agreement(SparseBlocks& blocks, const Numbered& numbers, const BruteForce& truth, int round) {
  std::vector<std::uint32_t> order;
  std::vector<CellIndex> cells;
  for (const auto slot : blocks.occupied()) {
    const BlockView view = blocks.view(slot);
    cells.clear();
    for (std::uint32_t i = 0; i < view.start[power(4, truth.dimension)]; ++i) {
      ASSERT_LT(view.first + i, blocks.room());
      order.push_back(numbers.at(view.first + i));
      cells.push_back(truth.cells[order.back()]);
    }
    ASSERT_EQ(blocks.cells_of(slot), cells) << "round " << round;
  }
  ASSERT_EQ(order, truth.order) << "round " << round;
  std::map<Block, std::uint32_t> slots;
  Block before{};
  bool first = true;
  std::size_t listed = 0;
  for (const auto slot : blocks.occupied()) {
    const BlockView v = blocks.view(slot);
    Block origin{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(truth.dimension); ++a) origin[a] = v.origin[a] / 4;
    ASSERT_TRUE(first || before < origin) << "blocks come in ascending order";
    before = origin;
    first = false;
    slots[origin] = slot;
    const int count = power(4, truth.dimension);
    ASSERT_GT(v.start[count], 0u) << "only blocks with particles are occupied";
    for (int c = 0; c < count; ++c)
      for (std::uint32_t i = v.start[c]; i < v.start[c + 1]; ++i) {
        const CellIndex cell = truth.cells[numbers.at(v.first + i)];
        const CellIndex inside =
            truth.dimension == 3 ? CellIndex{c / 16, c / 4 % 4, c % 4} : CellIndex{c / 4, c % 4, 0};
        for (std::size_t a = 0; a < 3; ++a)
          ASSERT_EQ(4 * origin[a] + inside[a], cell[a]) << "round " << round;
      }
    listed += v.start[count];
  }
  ASSERT_EQ(listed, truth.cells.size());

  // Every block's nodes reach into those at +1: they exist, and know who reaches into them.
  const int neighbours = 1 << truth.dimension;
  const auto shifted = [&](Block b, int delta, int sign) {
    for (int a = 0; a < truth.dimension; ++a) {
      const auto i = static_cast<std::size_t>(a);
      if (delta >> (truth.dimension - 1 - a) & 1) b[i] += sign;
      const AxisBounds& bound = truth.bounds[i];
      if (!bound.periodic) continue;
      const int period = (bound.upper_cell - bound.lower_cell) / 4, from = floor_quarter(bound.lower_cell);
      b[i] = from + ((b[i] - from) % period + period) % period;
    }
    return b;
  };
  std::map<std::uint32_t, Block> reached;
  for (const auto& [block, slot] : slots)
    for (int delta = 0; delta < neighbours; ++delta) {
      const std::uint32_t to = blocks.view(slot).plus[delta];
      ASSERT_LT(to, blocks.slot_count());
      const Block there = shifted(block, delta, 1);
      if (slots.count(there)) {
        ASSERT_EQ(to, slots[there]) << "round " << round;
      }
      const auto known = reached.emplace(to, there).first;
      ASSERT_EQ(known->second, there) << "two blocks share a slot";
    }
  for (const auto& [slot, block] : reached)
    for (int delta = 0; delta < neighbours; ++delta) {
      const auto from = slots.find(shifted(block, delta, -1));
      ASSERT_EQ(blocks.node_view(slot).minus[delta],
                from == slots.end() ? no_slot : blocks.view(from->second).arena)
          << "round " << round;
    }
}

BlockShares shared_out(int threads, std::size_t blocks) {
  BlockShares shares(threads);
  std::vector<std::uint32_t> ends;
  for (int t = 1; t <= threads; ++t)
    ends.push_back(static_cast<std::uint32_t>(blocks * static_cast<std::size_t>(t * t) /
                                              static_cast<std::size_t>(threads * threads)));
  shares.share_out(std::move(ends));
  return shares;
}

/// How often blocks outgrew their places, each way that they can.
struct Outgrown {
  int laid_out_anew = 0, made_way = 0;
};

Outgrown wander(int dimension, const std::array<AxisBounds, 3>& bounds, const std::vector<CellIndex>& start,
                int rounds, double liveliness, std::uint64_t seed) {
  Random random(seed);
  SparseBlocks blocks(dimension, bounds);
  Numbered numbers(blocks, start);
  BruteForce truth{dimension, bounds, start, {}};
  truth.order.resize(start.size());
  for (std::uint32_t p = 0; p < start.size(); ++p) truth.order[p] = p;
  truth.move(std::vector<std::array<int, 3>>(start.size()));
  expect_agreement(blocks, numbers, truth, -1);
  std::size_t held_in_all = 0;
  Outgrown outgrown;
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::array<int, 3>> shifts(start.size());
    for (auto& shift : shifts)
      for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
        if (random.chance(liveliness)) shift[a] = random.chance(0.5) ? 1 : -1;
    for (const auto slot : blocks.occupied()) {
      const BlockView v = blocks.view(slot);
      *v.sums = {};
      const int count = power(4, dimension);
      int cell = 0;
      for (std::uint32_t i = 0; i < v.start[count]; ++i) {
        while (v.start[cell + 1] <= i) ++cell;
        const auto& shift = shifts[numbers.at(v.first + i)];
        if (shift == std::array<int, 3>{}) continue;
        Mover mover{i, {}, static_cast<std::uint8_t>(cell)};
        for (std::size_t a = 0; a < 3; ++a) mover.shift[a] = static_cast<std::int8_t>(shift[a]);
        v.movers[v.sums->movers++] = mover;
      }
    }
    for (const auto slot : blocks.occupied()) blocks.plan_movers(slot);
    Team team(1 + round % 3);
    const auto& plan = blocks.relocate(shared_out(team.threads(), blocks.occupied().size()), team);
    std::set<std::pair<std::uint32_t, int>> reported;
    for (const auto& h : plan.held) {
      const std::uint32_t p = numbers.at(h.place);
      reported.insert({p, h.axis});
      EXPECT_EQ(h.upper, shifts[p][static_cast<std::size_t>(h.axis)] > 0);
    }
    outgrown.laid_out_anew += plan.laid_out_anew;
    outgrown.made_way += !plan.laid_out_anew && !plan.new_places.empty();
    numbers.particles.make_way(blocks, plan, team);
    std::vector<double> taken;
    for (const auto slot : blocks.occupied()) numbers.particles.settle(blocks.reordering(slot), taken);
    EXPECT_EQ(reported, truth.move(shifts)) << "round " << round;
    held_in_all += reported.size();
    expect_agreement(blocks, numbers, truth, round);
    if (testing::Test::HasFailure()) return outgrown;
  }
  const bool walled = bounds[0].lower != PlaneWall::none || bounds[1].lower != PlaneWall::none;
  EXPECT_EQ(held_in_all > 0, walled);
  return outgrown;
}

std::vector<CellIndex> cloud(int dimension, int count, int lowest, int highest, std::uint64_t seed) {
  Random random(seed);
  std::vector<CellIndex> cells(static_cast<std::size_t>(count));
  for (auto& c : cells)
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
      c[a] = random.integer(lowest, highest);
  return cells;
}

}  // namespace

TEST(SparseBlocks, RelocationAgreesWithBruteForceInOpenSpace) {
  wander(2, {}, cloud(2, 400, -9, 9, 1), 60, 0.3, 2);
  EXPECT_GT(wander(3, {}, cloud(3, 800, -6, 6, 3), 40, 0.3, 4).laid_out_anew, 0);
}

TEST(SparseBlocks, BlocksMakeWayForThoseThatGrow) {
  const Outgrown scattered = wander(3, {}, cloud(3, 2000, 0, 3, 13), 40, 0.3, 14);
  EXPECT_GT(scattered.laid_out_anew, 0);
  EXPECT_GT(scattered.made_way, 4 * scattered.laid_out_anew);
}

TEST(SparseBlocks, RelocationAgreesWithBruteForceBetweenWalls) {
  std::array<AxisBounds, 3> bounds{};
  bounds[0] = {PlaneWall::slip, PlaneWall::slip, 0, 7, false};
  bounds[1] = {PlaneWall::no_slip, PlaneWall::none, 0, 0, false};
  wander(2, bounds, cloud(2, 300, 0, 6, 5), 60, 0.5, 6);
  bounds[2] = {PlaneWall::no_slip, PlaneWall::no_slip, -3, 7, false};
  wander(3, bounds, cloud(3, 500, 0, 6, 7), 40, 0.5, 8);
}

TEST(SparseBlocks, RelocationAgreesWithBruteForceRoundAPeriodicAxis) {
  std::array<AxisBounds, 3> bounds{};
  bounds[0] = {PlaneWall::none, PlaneWall::none, 0, 4,
               true};  // a block that is its own neighbour, as in a duct
  bounds[1] = {PlaneWall::no_slip, PlaneWall::no_slip, 0, 10, false};
  EXPECT_GT(wander(2, bounds, cloud(2, 1200, 0, 3, 9), 60, 0.4, 10).made_way, 0);
  bounds[0] = {PlaneWall::none, PlaneWall::none, -8, 8, true};
  wander(2, bounds, cloud(2, 300, 0, 7, 11), 60, 0.4, 12);
}

TEST(SparseBlocks, WhatStaysKeepsItsOrder) {
  const std::vector<CellIndex> cells(20, CellIndex{1, 2, 0});
  SparseBlocks blocks(2, {});
  const auto places = blocks.build(cells);
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(places[i], i);
  EXPECT_EQ(blocks.fullest_cell(), 20u);
}

TEST(SparseBlocks, OnlyOccupiedBlocksAndThoseTheirNodesReachExist) {
  SparseBlocks blocks(3, {});
  blocks.build({{0, 0, 0}, {400000, -400000, 3}});
  EXPECT_EQ(blocks.occupied().size(), 2u);
  EXPECT_EQ(blocks.slot_count(), 16u);
  EXPECT_LT(blocks.bytes(), 1u << 15);
}
