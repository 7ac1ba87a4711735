#include "rayfield/formats/rosbag_reader.h"

#include <algorithm>
#include <map>
#include <utility>

#include "formats/io/file_io.h"
#include "formats/rosbag/bag_chunk.h"
#include "formats/rosbag/bag_format.h"
#include "formats/rosbag/bag_records.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read bag";
constexpr std::size_t kMaxListedLosses = 100;
/// Steps of the record time outside these are clock jumps or pauses and say nothing about the rate of the data.
constexpr std::int64_t kLongestStep_ns = 60'000'000'000;
/// The reader never asks for a connection's data longer than this: the longest real definitions have some 50 kB.
constexpr std::uint32_t kMaxConnectionBytes = std::uint32_t{1} << 20;

Result<void> check_magic(FileWindow& window) {
  const std::string& path = window.file().path();
  if (window.file().size() == 0) {
    return fail(ErrorCode::bad_input, kWhat, path, "the file is empty",
                "copy it from the vehicle again, or take another recording");
  }
  RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, window.view(0, 32));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(kBagMagic)) return {};
  if (text.size() < kBagMagic.size() && kBagMagic.starts_with(text)) {
    return fail(ErrorCode::bad_input, kWhat, path, "the file ends within its first line",
                "copy it from the vehicle again, or take another recording");
  }
  if (text.starts_with("#ROSBAG V")) {
    return fail(ErrorCode::bad_input, kWhat, path, "an old bag format, not version 2.0",
                "convert it with `rosbag fix`");
  }
  if (text.starts_with("SQLite format 3") || text.starts_with("\x89MCAP")) {
    return fail(ErrorCode::bad_input, kWhat, path, "a ROS 2 bag",
                "convert it to a ROS 1 bag with `rosbags-convert --dst out.bag`");
  }
  return fail(ErrorCode::bad_input, kWhat, path, "not a ROS bag: it does not begin with #ROSBAG V2.0",
              "give a .bag file recorded with ROS 1");
}

}  // namespace

Result<void> BagReadOptions::validate() const {
  if (max_chunk_bytes < 4096 || max_message_bytes < 4096 || max_connections < 1) {
    return fail(ErrorCode::usage, kWhat, "options", "limits are below 4096 bytes or one connection");
  }
  return {};
}

std::vector<std::string> BagSummary::problems() const {
  std::vector<std::string> lines;
  if (!indexed) lines.push_back("the bag has no index: the recording was not closed, or the file was cut");
  for (const BagLoss& loss : losses) {
    char seconds[64] = "";
    if (loss.seconds > 0 || !loss.seconds_estimated) {
      std::snprintf(seconds, sizeof seconds, " (%s%.3f s)", loss.seconds_estimated ? "about " : "", loss.seconds);
    }
    lines.push_back(std::to_string(loss.bytes) + " bytes" + seconds + " lost at byte " + std::to_string(loss.offset) +
                    ": " + loss.reason);
  }
  if (loss_count > losses.size()) {
    lines.push_back(std::to_string(loss_count - losses.size()) + " more losses, " + std::to_string(lost_bytes) +
                    " bytes lost in all");
  }
  if (orphan_messages > 0) {
    lines.push_back(std::to_string(orphan_messages) + " messages without a connection record left out");
  }
  return lines;
}

struct BagReader::Impl {
  Impl(FileWindow file, const BagReadOptions& read_options) : window(std::move(file)), options(read_options) {
    summary.file_bytes = window.file().size();
  }

  FileWindow window;
  BagReadOptions options;
  BagSummary summary;
  std::map<std::uint32_t, BagConnection> connections;  // nodes do not move: messages point at them
  std::uint64_t position = 0;
  std::uint64_t index_position = 0;  // from the bag header; 0 where the recorder did not get that far
  // The chunk whose records are being read straight from the file.
  std::uint64_t chunk_end = 0;
  bool chunk_damaged = false;
  // The decompressed chunk, its place in the file, and how much of it has been read.
  std::vector<std::byte> chunk;
  std::size_t chunk_at = 0;
  std::uint64_t chunk_offset = 0, chunk_disk_bytes = 0;
  bool in_chunk = false;
  // For the seconds lost: time and bytes that were read well.
  std::int64_t recorded_ns = 0;
  std::uint64_t good_bytes = 0;
  std::optional<std::size_t> open_loss;  // a loss in the middle, which the next message closes
  bool at_end = false;

  Result<void> read_bag_header();
  void preload_connections();
  void add_connection(const BagHeader& header, std::span<const std::byte> data);
  Result<bool> next_from_file(BagMessage& message);
  bool next_from_chunk(BagMessage& message);
  Result<void> open_chunk(std::uint64_t start, const BagRecord& record);
  bool deliver(const BagHeader& header, std::span<const std::byte> data, std::uint64_t offset, BagMessage& message);
  Result<void> recover(std::uint64_t from, std::uint64_t next, const std::string& reason);
  Result<void> skip_chunk(std::uint64_t start, const BagRecord& record, const std::string& reason);
  void finish_chunk();
  void finish();
  void add_loss(std::uint64_t offset, std::uint64_t bytes, const std::string& reason, bool at_tail);
};

Result<void> BagReader::Impl::read_bag_header() {
  position = kBagMagic.size();
  RAYFIELD_ASSIGN(const RecordProbe probe, read_bag_record(window, position, summary.file_bytes));
  // A damaged bag header costs nothing but the index: the first next() recovers from it like from any damage.
  if (probe.state != RecordState::sound || *probe.record.header.op != BagOp::bag_header) return {};
  if (!probe.record.header.encryptor.empty()) {
    return fail(ErrorCode::bad_input, kWhat, window.file().path(), "the bag is encrypted",
                "decrypt it with `rosbag decrypt`");
  }
  index_position = probe.record.header.index_pos.value_or(0);
  position = probe.record.end();
  return {};
}

/// In a closed bag, the connections stand at the end too: with them a damaged first chunk does not orphan the rest.
void BagReader::Impl::preload_connections() {
  if (index_position < position || index_position >= summary.file_bytes) return;
  summary.indexed = true;
  std::uint64_t at = index_position;
  while (at < summary.file_bytes) {
    const Result<RecordProbe> probe = read_bag_record(window, at, summary.file_bytes);
    if (!probe || probe->state != RecordState::sound) return;
    if (*probe->record.header.op == BagOp::connection && probe->record.data_bytes <= kMaxConnectionBytes) {
      const std::size_t prefix = static_cast<std::size_t>(probe->record.data_offset - at);
      const auto bytes = window.view(at, prefix + probe->record.data_bytes);
      if (!bytes) return;
      const RecordProbe whole = parse_bag_record(*bytes, at, summary.file_bytes);
      add_connection(whole.record.header, bytes->subspan(prefix));
    } else if (*probe->record.header.op != BagOp::chunk_info) {
      return;
    }
    at = probe->record.end();
  }
}

void BagReader::Impl::add_connection(const BagHeader& header, std::span<const std::byte> data) {
  if (connections.size() >= options.max_connections) return;
  std::optional<BagConnection> connection = parse_bag_connection(header, data);
  if (connection) connections.try_emplace(connection->id, std::move(*connection));
}

bool BagReader::Impl::deliver(const BagHeader& header, std::span<const std::byte> data, std::uint64_t offset,
                              BagMessage& message) {
  const auto connection = connections.find(header.conn.value_or(0));
  if (!header.conn || !header.time_ns || connection == connections.end()) {
    ++summary.orphan_messages;
    return false;
  }
  const std::int64_t time = *header.time_ns;
  const std::int64_t step = summary.messages == 0 ? 0 : time - summary.last_record_time_ns;
  if (step > 0 && step < kLongestStep_ns && !open_loss) recorded_ns += step;
  if (open_loss) {
    BagLoss& loss = summary.losses[*open_loss];
    if (summary.messages > 0 && step >= 0 && step < kLongestStep_ns) {
      summary.lost_s += static_cast<double>(step) * 1e-9 - loss.seconds;
      loss.seconds = static_cast<double>(step) * 1e-9;
      loss.seconds_estimated = false;
    }
    open_loss.reset();
  }
  summary.last_record_time_ns = time;
  ++summary.messages;
  message = {&connection->second, time, data, offset};
  return true;
}

void BagReader::Impl::add_loss(std::uint64_t offset, std::uint64_t bytes, const std::string& reason, bool at_tail) {
  const double rate = good_bytes > 0 ? static_cast<double>(recorded_ns) * 1e-9 / static_cast<double>(good_bytes) : 0.0;
  BagLoss loss{offset, bytes, static_cast<double>(bytes) * rate, true, reason};
  ++summary.loss_count;
  summary.lost_bytes += bytes;
  summary.lost_s += loss.seconds;
  open_loss.reset();
  if (summary.losses.size() >= kMaxListedLosses) return;
  summary.losses.push_back(std::move(loss));
  if (!at_tail) open_loss = summary.losses.size() - 1;
}

/// Moves on to the next sound record behind damage at `from`, looking for it from `next`.
Result<void> BagReader::Impl::recover(std::uint64_t from, std::uint64_t next, const std::string& reason) {
  chunk_damaged = true;
  if (index_position > kBagMagic.size() && from >= index_position && index_position < summary.file_bytes) {
    position = summary.file_bytes;  // only the index is damaged, and nobody needs it
    return {};
  }
  RAYFIELD_ASSIGN(const std::optional<std::uint64_t> found, find_bag_record(window, next));
  if (found) {
    add_loss(from, *found - from, reason, false);
    position = *found;
    chunk_end = 0;
    return {};
  }
  std::uint64_t end = std::max(summary.file_bytes, chunk_end);
  const bool cut = end > summary.file_bytes || index_position > summary.file_bytes || index_position == 0;
  if (index_position > kBagMagic.size()) end = std::max(end, index_position);
  add_loss(from, end - from, cut ? "the file ends in the middle of its data" : reason, true);
  position = summary.file_bytes;
  at_end = true;
  return {};
}

void BagReader::Impl::finish_chunk() {
  if (chunk_end == 0) return;
  if (!chunk_damaged && position == chunk_end) ++summary.complete_chunks;
  chunk_end = 0;
  chunk_damaged = false;
}

/// Called once, when the file has been read to its end.
void BagReader::Impl::finish() {
  if (!at_end) {
    const std::uint64_t expected = std::max(chunk_end, index_position);
    if (expected > summary.file_bytes) {
      add_loss(summary.file_bytes, expected - summary.file_bytes, "the file ends before its data do", true);
    }
  }
  at_end = true;
}

/// Leaves out a chunk that cannot be used: to its end where a record follows there, else to whatever follows.
Result<void> BagReader::Impl::skip_chunk(std::uint64_t start, const BagRecord& record, const std::string& reason) {
  if (record.data_bytes > 0 && record.end() < summary.file_bytes) {
    RAYFIELD_ASSIGN(const RecordProbe next, read_bag_record(window, record.end(), summary.file_bytes));
    if (next.state == RecordState::sound) {
      add_loss(start, record.end() - start, reason, false);
      position = record.end();
      return {};
    }
  }
  if (record.end() > summary.file_bytes) chunk_end = record.end();
  return recover(start, record.data_offset, reason);
}

/// Begins with a chunk: an uncompressed one is read record by record where it lies, so that its size does not matter; a
/// compressed one is decompressed whole, within the limits, or left out.
Result<void> BagReader::Impl::open_chunk(std::uint64_t start, const BagRecord& record) {
  ++summary.chunks;
  const std::string compression(record.header.compression);
  chunk_damaged = false;
  if (compression == "none") {
    // A recorder that was killed leaves size 0 in the chunk it was filling; its records follow all the same.
    position = record.data_offset;
    chunk_end = record.data_bytes > 0 ? record.end() : 0;
    return {};
  }
  if (compression != "bz2" && compression != "lz4") {
    return skip_chunk(start, record, "unknown compression '" + compression.substr(0, 16) + "'");
  }
  const std::uint64_t size = record.header.size.value_or(0);
  const std::uint64_t left = summary.file_bytes - record.data_offset;
  if (record.data_bytes > left || record.data_bytes == 0) {
    return skip_chunk(start, record, "a " + compression + " chunk is incomplete");
  }
  if (size > options.max_chunk_bytes || record.data_bytes > options.max_chunk_bytes) {
    return skip_chunk(start, record, "a chunk of " + std::to_string(size) + " bytes is over the limit");
  }
  RAYFIELD_ASSIGN(const std::span<const std::byte> data, window.view(record.data_offset, record.data_bytes));
  Result<void> decompressed = decompress_bag_chunk(compression, data, static_cast<std::size_t>(size), chunk);
  if (!decompressed) {
    if (decompressed.error().code == ErrorCode::resources) return decompressed;
    return skip_chunk(start, record, decompressed.error().why);
  }
  in_chunk = true;
  chunk_at = 0;
  chunk_offset = record.data_offset;
  chunk_disk_bytes = record.data_bytes;
  good_bytes += record.data_bytes;
  position = record.end();
  return {};
}

/// Next message of the decompressed chunk; false when it is used up.
bool BagReader::Impl::next_from_chunk(BagMessage& message) {
  while (chunk_at < chunk.size()) {
    const std::span<const std::byte> bytes = std::span<const std::byte>(chunk).subspan(chunk_at);
    const RecordProbe probe = parse_bag_record(bytes, chunk_at, chunk.size());
    if (probe.state != RecordState::sound) {
      // Its checksum was right, so it was written like this; the share that cannot be read counts as lost.
      const double share = static_cast<double>(chunk.size() - chunk_at) / static_cast<double>(chunk.size());
      add_loss(chunk_offset, static_cast<std::uint64_t>(share * static_cast<double>(chunk_disk_bytes)),
               "a chunk holds something that is not a record", false);
      in_chunk = false;
      return false;
    }
    const std::span<const std::byte> data =
        bytes.subspan(static_cast<std::size_t>(probe.record.data_offset) - chunk_at, probe.record.data_bytes);
    chunk_at = static_cast<std::size_t>(probe.record.end());
    if (*probe.record.header.op == BagOp::connection) add_connection(probe.record.header, data);
    if (*probe.record.header.op == BagOp::message && deliver(probe.record.header, data, chunk_offset, message)) {
      return true;
    }
  }
  ++summary.complete_chunks;
  in_chunk = false;
  return false;
}

/// Handles one record of the file; true when that was a message to deliver.
Result<bool> BagReader::Impl::next_from_file(BagMessage& message) {
  if (chunk_end != 0 && position >= chunk_end) finish_chunk();
  const bool inside = chunk_end > position;
  const std::uint64_t limit = inside ? std::min(chunk_end, summary.file_bytes) : summary.file_bytes;
  const std::uint64_t start = position;
  const auto damaged = [&](const char* reason) -> Result<bool> {
    RAYFIELD_CHECK(recover(start, start + 1, reason));
    return false;
  };
  RAYFIELD_ASSIGN(RecordProbe probe, read_bag_record(window, start, limit));
  const bool is_chunk = probe.record.header.op == BagOp::chunk;
  if (probe.state == RecordState::damaged) return damaged("a record header makes no sense");
  if (probe.state == RecordState::past_limit && !is_chunk) return damaged("a record goes on behind its chunk");
  const BagOp op = *probe.record.header.op;
  if (is_chunk) {
    RAYFIELD_CHECK(open_chunk(start, probe.record));
    return false;
  }
  if (op != BagOp::message && op != BagOp::connection) {
    if (op != BagOp::index && op != BagOp::chunk_info && op != BagOp::bag_header) return damaged("unknown record kind");
    position = probe.record.end();
    return false;
  }
  const std::uint32_t data_bytes = probe.record.data_bytes;
  if (data_bytes > options.max_message_bytes || (op == BagOp::connection && data_bytes > kMaxConnectionBytes)) {
    return damaged("a record is over the size limit");
  }
  const std::size_t prefix = static_cast<std::size_t>(probe.record.data_offset - start);
  RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, window.view(start, prefix + data_bytes));
  if (bytes.size() < prefix + data_bytes) return damaged("the file became shorter while it was read");
  probe = parse_bag_record(bytes, start, limit);
  position = probe.record.end();
  good_bytes += prefix + data_bytes;
  if (op == BagOp::message) return deliver(probe.record.header, bytes.subspan(prefix), start, message);
  add_connection(probe.record.header, bytes.subspan(prefix));
  return false;
}

BagReader::BagReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
BagReader::BagReader(BagReader&&) noexcept = default;
BagReader& BagReader::operator=(BagReader&&) noexcept = default;
BagReader::~BagReader() = default;

Result<BagReader> BagReader::open(const std::string& path, const BagReadOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(InputFile file, InputFile::open(path, kWhat));
  FileWindow window(std::move(file));
  RAYFIELD_CHECK(check_magic(window));
  auto impl = std::make_unique<Impl>(std::move(window), options);
  RAYFIELD_CHECK(impl->read_bag_header());
  impl->preload_connections();
  return BagReader(std::move(impl));
}

Result<bool> BagReader::next(BagMessage& message) {
  try {
    for (;;) {
      if (impl_->in_chunk && impl_->next_from_chunk(message)) return true;
      if (impl_->in_chunk) continue;
      if (impl_->at_end || impl_->position >= impl_->summary.file_bytes) break;
      RAYFIELD_ASSIGN(const bool found, impl_->next_from_file(message));
      if (found) return true;
    }
    if (impl_->chunk_end != 0 && impl_->position >= impl_->chunk_end) impl_->finish_chunk();
    impl_->finish();
    return false;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::resources, kWhat, impl_->window.file().path(), "out of memory");
  }
}

const BagSummary& BagReader::summary() const { return impl_->summary; }

std::vector<BagConnection> BagReader::connections() const {
  std::vector<BagConnection> list;
  for (const auto& [id, connection] : impl_->connections) list.push_back(connection);
  return list;
}

std::uint64_t BagReader::position() const { return std::min(impl_->position, impl_->summary.file_bytes); }

}  // namespace rayfield::formats
