#include "libdensity/scan/echo_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace rayfield::density {
namespace {

TEST(EchoSample, TheFirstTilesAreSpreadOverTheBlock) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{37}, std::size_t{200}}) {
    std::vector<std::size_t> order = spread_order(count), all(count);
    ASSERT_EQ(order.size(), count);
    for (const std::size_t parts : {std::size_t{4}, std::size_t{16}}) {
      if (count < 2 * parts) continue;
      // One of each of so many equal parts of the block, but for two: their ends are not at powers of two.
      std::vector<int> met(parts);
      for (std::size_t i = 0; i < 2 * parts; ++i) met[order[i] * parts / count] = 1;
      EXPECT_GE(std::accumulate(met.begin(), met.end(), 0), static_cast<int>(parts) - 2) << count << ", " << parts;
    }
    std::sort(order.begin(), order.end());
    std::iota(all.begin(), all.end(), std::size_t{0});
    EXPECT_EQ(order, all);
  }
}

TEST(EchoSample, TellsEnoughWithManyEchoesOfEachKind) {
  SampledEchoes sampled;
  EXPECT_FALSE(tells_enough(sampled));  // thin beams
  EchoStatistics& statistics = sampled.statistics.emplace();
  for (int i = 0; i < 200000; ++i) statistics.add_echo(100, 0.03);
  EXPECT_FALSE(tells_enough(sampled));
  statistics.add_full_echoes(std::vector<FullEcho>(4999));
  MixedEchoes mixed;
  mixed.gaps[7].all = 4000, mixed.gaps[20].all = 2000;
  statistics.add_mixed_echoes(mixed);
  EXPECT_FALSE(tells_enough(sampled));
  statistics.add_full_echoes(std::vector<FullEcho>(1));
  EXPECT_TRUE(tells_enough(sampled));
}

}  // namespace
}  // namespace rayfield::density
