#include "rayfield/core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <stdexcept>
#include <vector>

namespace rayfield {
namespace {

TEST(ParallelFor, CallsEachIndexExactlyOnceAtAnyThreadCount) {
  for (const int threads : {1, 2, 4, 9}) {
    std::vector<std::atomic<int>> calls(1000);
    ASSERT_TRUE(parallel_for(calls.size(), threads, [&](std::size_t i, int worker) -> Result<void> {
      EXPECT_GE(worker, 0);
      EXPECT_LT(worker, threads);
      ++calls[i];
      return {};
    }));
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, ReportsTheErrorWithTheLowestIndexAndTurnsExceptionsIntoErrors) {
  const auto failing = [](std::size_t i, int) -> Result<void> {
    if (i == 3) throw std::runtime_error("three");
    if (i == 4) return fail(ErrorCode::usage, "four", "", "");
    return {};
  };
  for (const int threads : {1, 2, 4}) {
    const Result<void> result = parallel_for(5, threads, failing);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::internal);
    EXPECT_EQ(result.error().why, "three");
  }
}

TEST(ParallelFor, CallsLackOfMemoryAResourceProblem) {
  const Result<void> result = parallel_for(1, 1, [](std::size_t, int) -> Result<void> { throw std::bad_alloc(); });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resources);
}

TEST(ParallelEach, ThrowsWhatATaskThrows) {
  std::vector<int> done(200, 0);
  parallel_each(done.size(), 3, [&](std::size_t k, int) { done[k] = 1; });
  EXPECT_EQ(std::count(done.begin(), done.end(), 1), 200);
  for (const int threads : {1, 3})
    EXPECT_THROW(parallel_each(50, threads,
                               [](std::size_t k, int) {
                                 if (k == 20) throw std::bad_alloc();
                               }),
                 std::bad_alloc);
}

TEST(ParallelOrdered, ConsumesInOrderAndKeepsWithinItsWindow) {
  for (const int threads : {1, 2, 4}) {
    std::vector<std::size_t> order;
    std::atomic<int> ahead{0}, most{0};
    ASSERT_TRUE(parallel_ordered(
        500, threads, 3,
        [&](std::size_t, int) -> Result<void> {
          const int now = ++ahead;
          int seen = most;
          while (now > seen && !most.compare_exchange_weak(seen, now)) {
          }
          return {};
        },
        [&](std::size_t i) -> Result<void> {
          --ahead;
          order.push_back(i);
          return {};
        }));
    ASSERT_EQ(order.size(), 500U);
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
    EXPECT_LE(most, 3);
  }
}

TEST(ParallelOrdered, StopsAtAConsumerErrorWithoutConsumingMore) {
  for (const int threads : {1, 4}) {
    std::size_t last = 0;
    const Result<void> result = parallel_ordered(
        100, threads, 4, [](std::size_t, int) -> Result<void> { return {}; },
        [&](std::size_t i) -> Result<void> {
          last = i;
          if (i == 10) return fail(ErrorCode::interrupted, "stop", "", "");
          return {};
        });
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::interrupted);
    EXPECT_EQ(last, 10U);
  }
}

}  // namespace
}  // namespace rayfield
