#pragma once

#include "rayfield/core/sensor_log.h"

namespace rayfield::slam {

/// Feeds `sink` what `read` delivers, in the same order and from the calling thread, while a thread of its own reads
/// some tens of thousands of points ahead. With `threads` = 1 the log is read by the calling thread.
/// Errors: those of `read`; internal where it throws.
Result<void> read_ahead(const LogReader& read, SensorSink& sink, int threads);

}  // namespace rayfield::slam
