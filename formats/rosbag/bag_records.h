#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "formats/io/file_io.h"
#include "formats/rosbag/bag_format.h"

namespace rayfield::formats {

/// A record as found: its header's fields and where its data lies. Views live as long as the bytes they came from.
struct BagRecord {
  BagHeader header;
  std::uint64_t data_offset = 0;
  std::uint32_t data_bytes = 0;
  std::uint64_t end() const { return data_offset + data_bytes; }
};

enum class RecordState {
  sound,
  damaged,     ///< its lengths or fields make no sense
  past_limit,  ///< well formed, but it goes on behind the limit
};

struct RecordProbe {
  RecordState state = RecordState::damaged;
  BagRecord record;
};

/// Parses the record at the beginning of `bytes` (of which `offset` is the position); `limit` is where the enclosing
/// chunk or file ends.
RecordProbe parse_bag_record(std::span<const std::byte> bytes, std::uint64_t offset, std::uint64_t limit);

/// Reads the record at `offset` of a file; its views are valid until the window is used again.
Result<RecordProbe> read_bag_record(FileWindow& window, std::uint64_t offset, std::uint64_t limit);

/// Finds the next place at or after `from` where a chunk, connection or message record can begin: its whole header
/// parses, it has the fields of its kind and its data fit into the file. Reads the file once, in blocks.
/// Nothing when there is none.
Result<std::optional<std::uint64_t>> find_bag_record(FileWindow& window, std::uint64_t from);

}  // namespace rayfield::formats
