#include "mpm/solver/block_shares.h"

#include <gtest/gtest.h>

#include <thread>

using flowrest::mpm::BlockShares;

namespace {

/// How often every block's body is run in a loop.
std::vector<int> run_all(BlockShares& shares, std::uint32_t blocks, bool one_only) {
  std::vector<std::atomic<int>> runs(blocks);
  shares.begin();
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < (one_only ? 1 : shares.threads()); ++t)
      threads.emplace_back([&, t] { shares.run(t, [&](std::uint32_t b) { ++runs[b]; }); });
  }
  return {runs.begin(), runs.end()};
}

}  // namespace

TEST(BlockShares, EveryLoopRunsEveryBlockOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    BlockShares shares(threads);
    for (const std::uint32_t blocks : {0u, 1u, 7u, 1000u}) {
      // All but the last thread's shares are small, and the first has none.
      std::vector<std::uint32_t> ends(static_cast<std::size_t>(threads), blocks);
      for (std::size_t t = 0; t + 1 < ends.size(); ++t)
        ends[t] = std::min(blocks, static_cast<std::uint32_t>(2 * t));
      shares.share_out(ends);
      for (const bool one_only : {false, true})
        for (int again = 0; again < 20; ++again)
          ASSERT_EQ(run_all(shares, blocks, one_only), std::vector<int>(blocks, 1))
              << threads << " threads, " << blocks << " blocks";
      shares.share_out_evenly(blocks);
      ASSERT_EQ(run_all(shares, blocks, false), std::vector<int>(blocks, 1)) << threads << " threads";
    }
  }
}

TEST(BlockShares, AThreadBeginsWithItsOwnAndHelpsFromTheEnd) {
  BlockShares shares(2);
  shares.share_out({3, 6});
  shares.begin();
  std::vector<std::uint32_t> order;
  shares.run(1, [&](std::uint32_t b) { order.push_back(b); });
  EXPECT_EQ(order, (std::vector<std::uint32_t>{3, 4, 5, 2, 1, 0}));
}

TEST(BlockShares, OwnersAreThoseOfTheRanges) {
  BlockShares shares(3);
  shares.share_out({2, 2, 5});
  std::vector<int> owners;
  for (std::uint32_t b = 0; b < 7; ++b) owners.push_back(shares.owner(b));
  EXPECT_EQ(owners, (std::vector<int>{0, 0, 2, 2, 2, 2, 2}));
  EXPECT_EQ(BlockShares(1).owner(4), 0);
}
