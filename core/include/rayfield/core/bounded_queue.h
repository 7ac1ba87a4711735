#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "rayfield/core/result.h"

namespace rayfield {

/// A queue of bounded length from one producing thread to one consuming thread.
template <class T>
class BoundedQueue {
 public:
  /// At most `capacity` items wait.
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room. False once nobody will take items any more.
  bool push(T&& item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return items_.size() < capacity_ || abandoned_; });
    if (!abandoned_) items_.push_back(std::move(item));
    changed_.notify_all();
    return !abandoned_;
  }
  /// Ends the stream, with its result.
  void end(Result<void> result) {
    const std::scoped_lock lock(mutex_);
    result_ = std::move(result);
    changed_.notify_all();
  }

  /// Waits for the next item; nothing at the end.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !items_.empty() || result_.has_value(); });
    if (items_.empty()) return std::nullopt;
    T item = std::move(items_.front());
    items_.pop_front();
    changed_.notify_all();
    return item;
  }
  /// The consumer has stopped: whatever is pushed from now on is dropped.
  void abandon() {
    const std::scoped_lock lock(mutex_);
    abandoned_ = true;
    changed_.notify_all();
  }
  /// After the end.
  Result<void> result() const { return *result_; }

 private:
  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> items_;                 // guarded by mutex_
  std::optional<Result<void>> result_;  // guarded by mutex_ until it is there
  bool abandoned_ = false;              // guarded by mutex_
};

}  // namespace rayfield
