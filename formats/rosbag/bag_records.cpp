#include "formats/rosbag/bag_records.h"

#include <algorithm>

namespace rayfield::formats {
namespace {

constexpr std::size_t kScanBlock = std::size_t{1} << 20;
/// How far in front of the field `op` a header may begin: the other fields of the records we look for are short.
constexpr std::size_t kFieldsBefore = 64;

bool has_fields_of_its_kind(const BagHeader& header) {
  switch (*header.op) {
    case BagOp::chunk:
      return !header.compression.empty() && header.size.has_value();
    case BagOp::connection:
      return header.conn.has_value() && !header.topic.empty();
    case BagOp::message:
      return header.conn.has_value() && header.time_ns.has_value();
    default:
      return false;
  }
}

}  // namespace

RecordProbe parse_bag_record(std::span<const std::byte> bytes, std::uint64_t offset, std::uint64_t limit) {
  RecordProbe probe;
  const std::uint64_t room = limit - offset;
  if (room < 4 || bytes.size() < 4) return {RecordState::past_limit, {}};
  const std::uint32_t header_bytes = load<std::uint32_t>(bytes.data());
  if (header_bytes == 0 || header_bytes > kMaxRecordHeader) return probe;
  const std::size_t prefix = std::size_t{header_bytes} + 8;
  if (prefix > room || prefix > bytes.size()) return {RecordState::past_limit, {}};
  const std::optional<BagHeader> header = parse_bag_header(bytes.subspan(4, header_bytes));
  if (!header) return probe;
  probe.record.header = *header;
  probe.record.data_bytes = load<std::uint32_t>(bytes.data() + 4 + header_bytes);
  probe.record.data_offset = offset + prefix;
  probe.state = probe.record.data_bytes > room - prefix ? RecordState::past_limit : RecordState::sound;
  return probe;
}

Result<RecordProbe> read_bag_record(FileWindow& window, std::uint64_t offset, std::uint64_t limit) {
  RAYFIELD_ASSIGN(std::span<const std::byte> bytes, window.view(offset, 4));
  if (bytes.size() < 4) return RecordProbe{RecordState::past_limit, {}};
  const std::uint32_t header_bytes = load<std::uint32_t>(bytes.data());
  if (header_bytes > kMaxRecordHeader) return RecordProbe{};
  RAYFIELD_ASSIGN(bytes, window.view(offset, std::size_t{header_bytes} + 8));
  return parse_bag_record(bytes, offset, limit);
}

Result<std::optional<std::uint64_t>> find_bag_record(FileWindow& window, std::uint64_t from) {
  // Every record has a field op of one byte: its length 4, then "op=", then the number.
  constexpr std::string_view kPattern("\x04\0\0\0op=", 7);
  const std::uint64_t file_bytes = window.file().size();
  for (std::uint64_t block = from; block < file_bytes; block += kScanBlock) {
    // Blocks overlap so that no header is cut in two.
    const std::uint64_t start = block - std::min<std::uint64_t>(block - from, kFieldsBefore);
    RAYFIELD_ASSIGN(const std::span<const std::byte> bytes,
                    window.view(start, kScanBlock + kFieldsBefore + kMaxRecordHeader + 8));
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (std::size_t hit = text.find(kPattern); hit != std::string_view::npos; hit = text.find(kPattern, hit + 1)) {
      if (start + hit >= block + kScanBlock + kFieldsBefore) break;
      const std::size_t first = hit < kFieldsBefore + 4 ? 0 : hit - kFieldsBefore - 4;
      for (std::size_t begin = first; begin + 4 <= hit; ++begin) {
        const RecordProbe probe = parse_bag_record(bytes.subspan(begin), start + begin, file_bytes);
        const bool parsed = probe.record.header.op.has_value() && has_fields_of_its_kind(probe.record.header);
        // A chunk that goes on behind the end is the cut one at the end of an unfinished file.
        const bool fits = probe.state == RecordState::sound || probe.record.header.op == BagOp::chunk;
        if (parsed && fits) return std::optional<std::uint64_t>(start + begin);
      }
    }
  }
  return std::optional<std::uint64_t>();
}

}  // namespace rayfield::formats
