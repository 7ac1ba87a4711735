#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

/// The container of ROS 1 bags, format version 2.0 (docs/rosbag.md). For the meaning of messages see sensor_log.h.
namespace rayfield::formats {

struct BagConnection {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;        ///< "sensor_msgs/Imu"
  std::string md5sum;      ///< of the message definition; "*" where the recorder did not know it
  std::string definition;  ///< full text of the message definition
};

/// One recorded message. Pointers and spans are valid until the next call of BagReader::next().
struct BagMessage {
  const BagConnection* connection = nullptr;
  std::int64_t record_time_ns = 0;  ///< when the recorder received it, Unix time
  std::span<const std::byte> data;  ///< serialised message
  std::uint64_t offset = 0;         ///< of its record in the file, or of its chunk where that is compressed
};

/// Part of the file whose messages could not be read.
struct BagLoss {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;         ///< on disk, bytes missing behind the end of a cut file included where known
  double seconds = 0;              ///< of recording time
  bool seconds_estimated = false;  ///< from the mean byte rate: no later message gives the time
  std::string reason;
};

struct BagSummary {
  std::uint64_t file_bytes = 0;
  bool indexed = false;  ///< closed by the recorder: chunks and connections are listed at the end
  std::uint64_t chunks = 0, complete_chunks = 0;
  std::uint64_t messages = 0;         ///< delivered
  std::uint64_t orphan_messages = 0;  ///< without a readable connection record: topic unknown, not delivered
  std::int64_t last_record_time_ns = 0;
  std::vector<BagLoss> losses;  ///< in file order; at most 100 are listed, all are counted
  std::uint64_t loss_count = 0, lost_bytes = 0;
  double lost_s = 0;

  /// One line for each loss and for a missing index; empty for a sound bag.
  std::vector<std::string> problems() const;
};

/// Sizes in headers are checked against these and against what is left of the file before memory is taken.
struct BagReadOptions {
  std::uint64_t max_chunk_bytes = std::uint64_t{256} << 20;    ///< decompressed; uncompressed chunks have no limit
  std::uint64_t max_message_bytes = std::uint64_t{256} << 20;  ///< larger ones count as damage
  std::size_t max_connections = 4096;                          ///< topics × publishers
  Result<void> validate() const;
};

/// Reads the messages of a bag in file order, without its index and in bounded memory. Damage (a cut file, a flipped
/// bit, a chunk that does not decompress) loses the messages it hits and no others; see summary().
class BagReader {
 public:
  /// Errors: bad_input (missing, not a ROS 1 bag v2.0, encrypted), resources, usage (options).
  static Result<BagReader> open(const std::string& path, const BagReadOptions& options = {});
  BagReader(BagReader&&) noexcept;
  BagReader& operator=(BagReader&&) noexcept;
  ~BagReader();

  /// Next message; false at the end. Errors: only what the system refuses (I/O, memory); damage is not an error.
  Result<bool> next(BagMessage& message);
  /// What was read and lost so far; complete once next() has returned false.
  const BagSummary& summary() const;
  /// Connections known so far: in a closed bag all of them from the start.
  std::vector<BagConnection> connections() const;
  /// Position in the file, for progress.
  std::uint64_t position() const;

 private:
  struct Impl;
  explicit BagReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
