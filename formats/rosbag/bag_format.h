#pragma once

/// rosbag: the container of ROS 1 bags, and the serialisation of the messages that rayfield reads and writes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "rayfield/core/byte_cursor.h"
#include "rayfield/formats/rosbag_reader.h"

/// ROS 1 bag, version 2.0. All numbers are little-endian.
///   file    "#ROSBAG V2.0\n", then records to the end
///   record  u32 header length, header, u32 data length, data
///   header  fields: u32 length of the rest, "name=value"; every record has the field op (u8):
///     3 bag header   index_pos u64, conn_count u32, chunk_count u32; padded to 4096 bytes by its data
///     5 chunk        compression "none|bz2|lz4", size u32 (decompressed); data = connection and message records
///     7 connection   conn u32, topic; data = fields topic, type, md5sum, message_definition
///     2 message      conn u32, time (u32 s, u32 ns); data = serialised message
///     4 index        ver u32 = 1, conn u32, count u32; data = count × (time, u32 offset in the chunk); after its chunk
///     6 chunk info   ver u32 = 1, chunk_pos u64, start_time, end_time, count u32; data = count × (u32 conn, u32 count)
/// index_pos is where the connection and chunk info records at the end begin; 0 until the recorder closes the file.
namespace rayfield::formats {

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
inline constexpr std::size_t kBagHeaderBytes = 4096;  ///< of the bag header record without its two lengths
/// Longest record header taken for real: the longest field is a topic name.
inline constexpr std::size_t kMaxRecordHeader = std::size_t{64} << 10;

enum class BagOp : std::uint8_t { message = 2, bag_header = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

/// The fields of a record header that a reader needs; views point into the header.
struct BagHeader {
  std::optional<BagOp> op;
  std::optional<std::uint32_t> conn, size;
  std::optional<std::int64_t> time_ns;
  std::optional<std::uint64_t> index_pos;
  std::string_view compression, topic, encryptor;
};

/// Parses header fields; nothing where a length or the size of a known field is wrong or `op` is missing.
std::optional<BagHeader> parse_bag_header(std::span<const std::byte> fields);

/// Parses the data of a connection record; nothing where it is malformed.
std::optional<BagConnection> parse_bag_connection(const BagHeader& header, std::span<const std::byte> data);

/// Times are u32 seconds and u32 nanoseconds, which little-endian is this number.
inline std::uint64_t bag_time(std::int64_t time_ns) {
  return static_cast<std::uint64_t>(time_ns / 1'000'000'000) |
         (static_cast<std::uint64_t>(time_ns % 1'000'000'000) << 32);
}

/// Builds record headers, and the data of connection records, field by field.
class BagHeaderBuilder {
 public:
  BagHeaderBuilder() = default;
  explicit BagHeaderBuilder(BagOp op) { field("op", static_cast<std::uint8_t>(op)); }
  template <class T>
  BagHeaderBuilder& field(std::string_view name, T value) {
    fields_.put(static_cast<std::uint32_t>(name.size() + 1 + sizeof(T)));
    fields_.raw(name), fields_.raw("="), fields_.put(value);
    return *this;
  }
  BagHeaderBuilder& text(std::string_view name, std::string_view value) {
    fields_.put(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    fields_.raw(name), fields_.raw("="), fields_.raw(value);
    return *this;
  }
  BagHeaderBuilder& time(std::string_view name, std::int64_t time_ns) { return field(name, bag_time(time_ns)); }
  std::span<const std::byte> bytes() const { return fields_.bytes(); }

 private:
  ByteBuilder fields_;
};

}  // namespace rayfield::formats
