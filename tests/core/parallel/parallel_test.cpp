#include "rayfield/core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <stdexcept>
#include <string>
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

TEST(ParallelFor, BeginsNothingAfterTheLowestErrorAndFinishesWhatComesBeforeIt) {
  for (int run = 0; run < 50; ++run) {
    std::vector<std::atomic<int>> calls(2000);
    const Result<void> result = parallel_for(calls.size(), 4, [&](std::size_t i, int) -> Result<void> {
      ++calls[i];
      if (i == 700 || i == 300) return fail(ErrorCode::usage, "stop", std::to_string(i), "");
      return {};
    });
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().where, "300");
    for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(calls[i], 1);
  }
}

TEST(ParallelFor, RunsInTheCallingThreadInsideATask) {
  std::vector<std::atomic<int>> calls(40);
  ASSERT_TRUE(parallel_for(4, 4, [&](std::size_t i, int) {
    return parallel_for(10, 4, [&, i](std::size_t k, int) -> Result<void> {
      ++calls[10 * i + k];
      return {};
    });
  }));
  for (const auto& count : calls) EXPECT_EQ(count, 1);
}

TEST(ParallelTeam, EveryWorkerIsCalledOnceAndWhatOneThrowsIsThrown) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> calls(5);
    parallel_team(threads, [&](int worker) { ++calls[static_cast<std::size_t>(worker)]; });
    int workers = 0;
    for (const auto& count : calls) {
      EXPECT_LE(count, 1);
      workers += count;
    }
    EXPECT_GE(workers, 1);
    EXPECT_LE(workers, threads);
    EXPECT_THROW(parallel_team(threads, [](int) { throw std::runtime_error("no"); }), std::runtime_error);
  }
}

TEST(ParallelOrdered, AddsUpTheSameAtAnyThreadCount) {
  // Floating-point sums depend on their order: equal bits show that the order is kept.
  const auto sum = [](int threads) {
    std::vector<double> parts(3000);
    double total = 0;
    EXPECT_TRUE(parallel_ordered(
        parts.size(), threads, 16,
        [&](std::size_t i, int) -> Result<void> {
          parts[i] = 1.0 / static_cast<double>(i + 1);
          return {};
        },
        [&](std::size_t i) -> Result<void> {
          total += parts[i];
          return {};
        }));
    return total;
  };
  const double expected = sum(1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(sum(threads), expected);
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
