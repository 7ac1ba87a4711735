#include "libdensity/tiles/recently_used.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace rayfield::density {
namespace {

using Values = RecentlyUsed<int, int>;

class Loads {
 public:
  Result<std::shared_ptr<const int>> get(Values& values, int key) {
    return values.get(
        key,
        [&]() -> Result<int> {
          ++count_;
          return 10 * key;
        },
        [](int) { return std::size_t{1}; });
  }
  int count() const { return count_; }

 private:
  std::atomic<int> count_ = 0;
};

TEST(RecentlyUsed, LoadsAValueOnceWhileThereIsRoomForIt) {
  Values values(3);
  Loads loads;
  for (const int key : {1, 2, 3, 1, 2, 3, 3}) EXPECT_EQ(**loads.get(values, key), 10 * key);
  EXPECT_EQ(loads.count(), 3);
}

TEST(RecentlyUsed, DropsTheOneThatWasNotUsedForTheLongestTime) {
  Values values(2);
  Loads loads;
  for (const int key : {1, 2, 1, 3}) static_cast<void>(loads.get(values, key));  // drops 2
  EXPECT_EQ(loads.count(), 3);
  static_cast<void>(loads.get(values, 1));
  EXPECT_EQ(loads.count(), 3);
  static_cast<void>(loads.get(values, 2));
  EXPECT_EQ(loads.count(), 4);
}

TEST(RecentlyUsed, KeepsAtLeastOneAndWhatCallersHoldStaysWhole) {
  Values values(0);
  Loads loads;
  const auto held = loads.get(values, 1);
  static_cast<void>(loads.get(values, 2)), static_cast<void>(loads.get(values, 2));
  EXPECT_EQ(loads.count(), 2);
  EXPECT_EQ(**held, 10);
}

TEST(RecentlyUsed, WhatCannotBeLoadedIsTriedAgain) {
  Values values(2);
  const auto one = [](int) { return std::size_t{1}; };
  const auto failed = values.get(
      1, []() -> Result<int> { return fail(ErrorCode::damaged, "cannot read", "there", "gone"); }, one);
  EXPECT_EQ(failed.error().code, ErrorCode::damaged);
  EXPECT_EQ(**values.get(
                1, []() -> Result<int> { return 7; }, one),
            7);
}

TEST(RecentlyUsed, ThreadsThatWantTheSameLoadItOnce) {
  Values values(100);
  Loads loads;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int key = 0; key < 50; ++key) EXPECT_EQ(**loads.get(values, key), 10 * key);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(loads.count(), 50);
}

}  // namespace
}  // namespace rayfield::density
