#include "rayfield/core/bounded_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace rayfield {
namespace {

TEST(BoundedQueue, HandsOverEverythingInOrderAndNeverHoldsMoreThanItsCapacity) {
  BoundedQueue<int> queue(3);
  std::atomic<int> pushed{0};
  std::thread producer([&] {
    for (int i = 0; i < 1000; ++i) {
      queue.push(int{i});
      ++pushed;
    }
    queue.end({});
  });
  for (int i = 0; i < 1000; ++i) {
    const auto item = queue.pop();
    ASSERT_TRUE(item);
    EXPECT_EQ(*item, i);
    EXPECT_LE(pushed - i, 3 + 1) << "the one just taken makes room for one more";
  }
  EXPECT_FALSE(queue.pop());
  EXPECT_TRUE(queue.result());
  producer.join();
}

TEST(BoundedQueue, AProducerIsLetGoWhenNobodyTakesAnyMore) {
  BoundedQueue<int> queue(1);
  std::atomic<bool> refused{false};
  std::thread producer([&] {
    while (queue.push(1)) {
    }
    refused = true;
  });
  EXPECT_TRUE(queue.pop());
  queue.abandon();
  producer.join();
  EXPECT_TRUE(refused);
}

TEST(BoundedQueue, WhatWasPushedBeforeAnErrorIsStillHandedOver) {
  BoundedQueue<int> queue(4);
  queue.push(1);
  queue.end(fail(ErrorCode::bad_input, "cannot read", "log", "it ends here"));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_FALSE(queue.pop());
  EXPECT_EQ(queue.result().error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield
