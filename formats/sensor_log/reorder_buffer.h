#pragma once

/// sensor_log: from messages to the sensors of a rig: their topics, order, decoding and regularity, and back into a
/// log.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/formats/sensor_log.h"

namespace rayfield::formats {

/// A serialised message on its way to the decoder.
struct BufferedMessage {
  std::int64_t stamp_ns = 0;  ///< its own stamp, or the recording time where it has none
  std::int64_t record_time_ns = 0;
  std::int64_t log_clock_ns = 0;  ///< recording time that passed since the first message, clock jumps taken out
  std::uint64_t arrival = 0;      ///< breaks ties between equal stamps
  std::uint64_t offset = 0;       ///< in the file, for messages
  std::vector<std::byte> data;
};

/// Puts the messages of each topic into the order of their stamps within a window, removes duplicates, and cuts the
/// log into segments where a topic's clock jumps. Holds at most the window, or 64 MiB, of messages.
class ReorderBuffer {
 public:
  using Deliver = std::function<Result<void>(SensorKind, const BufferedMessage&)>;

  ReorderBuffer(const LogOptions& options, Deliver deliver);

  /// Every message of the log, those of other topics too, advances the log's clock.
  void advance(std::int64_t record_time_ns);
  /// A message of a topic; delivers what is ripe. `stamp_ns` 0 means that it has none.
  Result<void> add(SensorKind kind, std::int64_t stamp_ns, std::int64_t record_time_ns, std::uint64_t offset,
                   std::span<const std::byte> data);
  /// Delivers the rest.
  Result<void> finish();

  /// Fills the counts that arise here; `delivered` and what the decoders find are the caller's.
  void report(SensorKind kind, TopicReport& topic) const;
  std::vector<LogSegment> segments(SensorKind kind) const;

 private:
  struct Topic {
    std::vector<BufferedMessage> heap;       // the smallest (stamp, arrival) on top
    std::optional<BufferedMessage> suspect;  // its stamp is far from the others': a stray or the first after a jump
    bool started = false;
    std::int64_t newest_stamp_ns = 0, newest_clock_ns = 0;  // of the message with the latest stamp in the segment
    bool delivered_any = false;
    std::int64_t last_stamp_ns = 0;  // last one out
    std::vector<std::byte> last_data;
    std::size_t segment = 0;
    std::vector<LogSegment> segments;
    TopicReport counts;
  };

  bool plausible(std::int64_t stamp_ns, std::int64_t clock_ns, const BufferedMessage& next) const;
  void drop_suspect(Topic& from);
  Result<void> accept(SensorKind kind, BufferedMessage message);
  Result<void> begin_segment(SensorKind kind);
  Result<void> release(std::int64_t ripe_before_ns, std::size_t keep_bytes);
  Result<void> pop(SensorKind kind);
  std::vector<std::byte> copy(std::span<const std::byte> data);
  void recycle(std::vector<std::byte>&& data);
  Topic& topic(SensorKind kind) { return topics_[static_cast<std::size_t>(kind)]; }

  std::int64_t window_ns_, back_ns_, forward_ns_;
  std::size_t wanted_segment_;
  Deliver deliver_;
  std::array<Topic, 4> topics_;
  std::vector<std::vector<std::byte>> spare_;  // buffers to use again
  std::size_t buffered_bytes_ = 0;
  std::uint64_t arrivals_ = 0;
  bool clock_started_ = false;
  std::int64_t last_record_ns_ = 0, log_clock_ns_ = 0;
};

}  // namespace rayfield::formats
