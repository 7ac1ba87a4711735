#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

#include "rayfield/core/progress.h"

namespace rayfield::density {

/// A stage that is shown only once something in it has to be made: files that are taken as they are need no line.
/// Safe to use from several threads.
class LazyStage {
 public:
  LazyStage(Progress& progress, std::string name, std::uint64_t total, std::string unit)
      : progress_(progress), name_(std::move(name)), unit_(std::move(unit)), total_(total) {}

  /// Something is made now.
  void begin() {
    const std::lock_guard lock(mutex_);
    if (begun_) return;
    begun_ = true;
    progress_.stage(name_, total_, unit_);
    progress_.advance(taken_);
  }

  /// `count` more units are done, made or taken.
  void advance(std::uint64_t count) {
    const std::lock_guard lock(mutex_);
    if (begun_)
      progress_.advance(count);
    else
      taken_ += count;
  }

 private:
  Progress& progress_;
  std::string name_, unit_;
  std::uint64_t total_, taken_ = 0;
  bool begun_ = false;
  std::mutex mutex_;
};

}  // namespace rayfield::density
