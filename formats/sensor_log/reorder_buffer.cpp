#include "formats/sensor_log/reorder_buffer.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "formats/rosbag/ros_header.h"

namespace rayfield::formats {
namespace {

constexpr std::size_t kMaxBufferedBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxSegments = 1000;

/// std::push_heap keeps the largest on top, so "less" means "later".
bool later(const BufferedMessage& a, const BufferedMessage& b) {
  return a.stamp_ns != b.stamp_ns ? a.stamp_ns > b.stamp_ns : a.arrival > b.arrival;
}

std::int64_t nanoseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

ReorderBuffer::ReorderBuffer(const LogOptions& options, Deliver deliver)
    : window_ns_(nanoseconds(options.reorder_window_s)),
      back_ns_(nanoseconds(options.clock_jump_back_s)),
      forward_ns_(nanoseconds(options.clock_jump_forward_s)),
      wanted_segment_(static_cast<std::size_t>(options.segment)),
      deliver_(std::move(deliver)) {}

void ReorderBuffer::advance(std::int64_t record_time_ns) {
  const std::int64_t step = clock_started_ ? record_time_ns - last_record_ns_ : 0;
  // A step that is no passing of time (jump, pause) does not move the clock, so that a sensor that was silent for a
  // while is told apart from one whose clock jumped.
  if (step > 0 && step <= forward_ns_) log_clock_ns_ += step;
  clock_started_ = true;
  last_record_ns_ = record_time_ns;
}

bool ReorderBuffer::plausible(std::int64_t stamp_ns, std::int64_t clock_ns, const BufferedMessage& next) const {
  const std::int64_t step = next.stamp_ns - stamp_ns;
  return step >= -back_ns_ && step - (next.log_clock_ns - clock_ns) <= forward_ns_;
}

std::vector<std::byte> ReorderBuffer::copy(std::span<const std::byte> data) {
  std::vector<std::byte> buffer;
  if (!spare_.empty()) {
    buffer = std::move(spare_.back());
    spare_.pop_back();
  }
  buffer.assign(data.begin(), data.end());
  buffered_bytes_ += data.size();
  return buffer;
}

void ReorderBuffer::recycle(std::vector<std::byte>&& data) {
  constexpr std::size_t kMaxSpare = 64;
  if (spare_.size() < kMaxSpare) spare_.push_back(std::move(data));
}

/// Counts the suspect as a stray stamp; nothing where there is none.
void ReorderBuffer::drop_suspect(Topic& from) {
  if (!from.suspect) return;
  ++from.counts.stray_stamps;
  buffered_bytes_ -= from.suspect->data.size();
  recycle(std::move(from.suspect->data));
  from.suspect.reset();
}

Result<void> ReorderBuffer::add(SensorKind kind, std::int64_t stamp_ns, std::int64_t record_time_ns,
                                std::uint64_t offset, std::span<const std::byte> data) {
  Topic& to = topic(kind);
  ++to.counts.messages;
  if (stamp_ns == 0) {
    ++to.counts.without_stamp;
    stamp_ns = record_time_ns;
  }
  BufferedMessage message{stamp_ns, record_time_ns, log_clock_ns_, ++arrivals_, offset, copy(data)};
  if (!to.started || plausible(to.newest_stamp_ns, to.newest_clock_ns, message)) {
    drop_suspect(to);
    RAYFIELD_CHECK(accept(kind, std::move(message)));
  } else if (to.suspect && plausible(to.suspect->stamp_ns, to.suspect->log_clock_ns, message)) {
    RAYFIELD_CHECK(begin_segment(kind));
    RAYFIELD_CHECK(accept(kind, *std::exchange(to.suspect, std::nullopt)));
    RAYFIELD_CHECK(accept(kind, std::move(message)));
  } else {
    drop_suspect(to);
    to.suspect = std::move(message);
  }
  return release(record_time_ns - window_ns_, kMaxBufferedBytes);
}

Result<void> ReorderBuffer::accept(SensorKind kind, BufferedMessage message) {
  Topic& to = topic(kind);
  if (!to.started) {
    // A topic that begins late begins in the segment where the others are.
    for (const Topic& other : topics_) to.segment = std::max(to.segment, other.segment);
    to.segments.resize(to.segment + 1);
    to.started = true;
    to.newest_stamp_ns = message.stamp_ns;
    to.newest_clock_ns = message.log_clock_ns;
  }
  if (message.stamp_ns < to.newest_stamp_ns) ++to.counts.reordered;
  if (message.stamp_ns >= to.newest_stamp_ns) {
    to.newest_stamp_ns = message.stamp_ns;
    to.newest_clock_ns = message.log_clock_ns;
  }
  to.heap.push_back(std::move(message));
  std::push_heap(to.heap.begin(), to.heap.end(), later);
  return {};
}

/// Everything before the jump goes out first; the next accepted message starts afresh. A first message that stands
/// alone before the jump was itself the stray one.
Result<void> ReorderBuffer::begin_segment(SensorKind kind) {
  Topic& to = topic(kind);
  if (to.heap.size() == 1 && !to.delivered_any) {
    ++to.counts.stray_stamps;
    buffered_bytes_ -= to.heap.front().data.size();
    to.heap.clear();
  } else {
    while (!to.heap.empty()) RAYFIELD_CHECK(pop(kind));
    if (to.segment + 1 < kMaxSegments) {
      ++to.segment;
      to.segments.emplace_back();
    }
  }
  to.delivered_any = false;
  to.newest_stamp_ns = to.suspect->stamp_ns;
  to.newest_clock_ns = to.suspect->log_clock_ns;
  return {};
}

/// Delivers, in the order of recording across topics, what was recorded before `ripe_before_ns` and whatever exceeds
/// `keep_bytes`. A topic's top goes first even if it came last: the others of that topic wait behind it.
Result<void> ReorderBuffer::release(std::int64_t ripe_before_ns, std::size_t keep_bytes) {
  for (;;) {
    std::optional<SensorKind> oldest;
    std::int64_t oldest_record_ns = 0;
    std::uint64_t oldest_arrival = 0;
    for (const SensorKind kind : kSensorKinds) {
      if (topic(kind).heap.empty()) continue;
      const BufferedMessage& top = topic(kind).heap.front();
      if (oldest && std::pair(top.record_time_ns, top.arrival) > std::pair(oldest_record_ns, oldest_arrival)) continue;
      oldest = kind;
      oldest_record_ns = top.record_time_ns;
      oldest_arrival = top.arrival;
    }
    if (!oldest || (oldest_record_ns > ripe_before_ns && buffered_bytes_ <= keep_bytes)) return {};
    RAYFIELD_CHECK(pop(*oldest));
  }
}

/// Takes the earliest message of a topic out of its heap and delivers it, unless it is too late, a duplicate, or of a
/// segment that nobody asked for.
Result<void> ReorderBuffer::pop(SensorKind kind) {
  Topic& from = topic(kind);
  std::pop_heap(from.heap.begin(), from.heap.end(), later);
  BufferedMessage message = std::move(from.heap.back());
  from.heap.pop_back();
  buffered_bytes_ -= message.data.size();
  if (from.delivered_any && message.stamp_ns < from.last_stamp_ns) {
    ++from.counts.late;
    recycle(std::move(message.data));
    return {};
  }
  // Stamps are delivered in seconds, where those within 0.24 µs of each other can be the same. A lidar may send a sweep
  // in several messages of one stamp; the other sensors cannot measure twice at once.
  const double stamp_s = seconds_from_ns(message.stamp_ns);
  if (from.delivered_any && stamp_s == seconds_from_ns(from.last_stamp_ns) &&
      (kind != SensorKind::lidar || message.data == from.last_data)) {
    ++from.counts.duplicates;
    recycle(std::move(message.data));
    return {};
  }
  LogSegment& segment = from.segments[from.segment];
  if (segment.messages == 0) segment.first_s = stamp_s;
  segment.last_s = stamp_s;
  ++segment.messages;
  from.delivered_any = true;
  from.last_stamp_ns = message.stamp_ns;
  Result<void> delivered;
  if (from.segment == wanted_segment_) {
    delivered = deliver_(kind, message);
  } else {
    ++from.counts.other_segments;
  }
  from.last_data.swap(message.data);
  recycle(std::move(message.data));
  return delivered;
}

Result<void> ReorderBuffer::finish() {
  for (Topic& each : topics_) drop_suspect(each);
  return release(std::numeric_limits<std::int64_t>::max(), 0);
}

void ReorderBuffer::report(SensorKind kind, TopicReport& report) const {
  const TopicReport& counts = topics_[static_cast<std::size_t>(kind)].counts;
  report.messages = counts.messages;
  report.duplicates = counts.duplicates;
  report.reordered = counts.reordered;
  report.late = counts.late;
  report.stray_stamps = counts.stray_stamps;
  report.without_stamp = counts.without_stamp;
  report.other_segments = counts.other_segments;
}

std::vector<LogSegment> ReorderBuffer::segments(SensorKind kind) const {
  return topics_[static_cast<std::size_t>(kind)].segments;
}

}  // namespace rayfield::formats
