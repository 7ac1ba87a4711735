#pragma once

#include <cstdint>

#include "rayfield/core/progress.h"

namespace rayfield::formats {

/// Tells about every MiB of a file that has been read.
class ReadProgress {
 public:
  explicit ReadProgress(Progress* progress) : progress_(progress) {}
  /// False where the user wants to stop.
  bool advance(std::uint64_t position) {
    if (progress_ == nullptr || position < reported_ + (std::uint64_t{1} << 20)) return true;
    progress_->advance(position - reported_);
    reported_ = position;
    return !progress_->cancelled();
  }

 private:
  Progress* progress_;
  std::uint64_t reported_ = 0;
};

}  // namespace rayfield::formats
