#include "rayfield/formats/rosbag_writer.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "formats/io/file_io.h"
#include "formats/rosbag/bag_chunk.h"
#include "formats/rosbag/bag_format.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot write bag";
constexpr std::int64_t kEndOfTime_ns = std::int64_t{1} << 32;  // seconds; times are u32 seconds and u32 nanoseconds

void put_record(ByteBuilder& out, const BagHeaderBuilder& header, std::span<const std::byte> data) {
  out.put(static_cast<std::uint32_t>(header.bytes().size()));
  out.raw(header.bytes());
  out.put(static_cast<std::uint32_t>(data.size()));
  out.raw(data);
}

struct ChunkInfo {
  std::uint64_t position = 0;
  std::int64_t start_ns = 0, end_ns = 0;
  std::map<std::uint32_t, std::uint32_t> counts;  // by connection
};

/// The bag header record always takes the same room, so that it can be replaced when the file is closed.
std::vector<std::byte> bag_header_record(std::uint64_t index_pos, std::uint32_t connections, std::uint32_t chunks) {
  BagHeaderBuilder header(BagOp::bag_header);
  header.field("index_pos", index_pos).field("conn_count", connections).field("chunk_count", chunks);
  const std::string padding(kBagHeaderBytes - header.bytes().size(), ' ');
  ByteBuilder out;
  put_record(out, header, std::as_bytes(std::span<const char>(padding.data(), padding.size())));
  return {out.bytes().begin(), out.bytes().end()};
}

}  // namespace

Result<void> BagWriteOptions::validate() const {
  if (chunk_bytes < 4096 || chunk_bytes > (std::size_t{64} << 20)) {
    return fail(ErrorCode::usage, kWhat, "chunk_bytes", "must be from 4096 to 67108864");
  }
  return {};
}

struct BagWriter::Impl {
  OutputFile file;
  BagWriteOptions options;
  std::vector<BagConnection> connections;
  std::vector<bool> connection_written;
  std::vector<ChunkInfo> chunks;
  // The chunk being filled, and where in it each connection has its messages.
  ByteBuilder chunk;
  ChunkInfo info;
  std::map<std::uint32_t, ByteBuilder> index;
  std::vector<std::byte> packed;

  void put_connection(ByteBuilder& out, const BagConnection& connection) const;
  Result<void> flush_chunk();
  Result<std::uint64_t> write_index();
};

void BagWriter::Impl::put_connection(ByteBuilder& out, const BagConnection& connection) const {
  BagHeaderBuilder header(BagOp::connection);
  header.field("conn", connection.id).text("topic", connection.topic);
  BagHeaderBuilder data;
  data.text("topic", connection.topic).text("type", connection.type).text("md5sum", connection.md5sum);
  data.text("message_definition", connection.definition);
  put_record(out, header, data.bytes());
}

Result<void> BagWriter::Impl::flush_chunk() {
  if (index.empty()) return {};
  RAYFIELD_CHECK(compress_bag_chunk(options.compression, chunk.bytes(), packed));
  info.position = file.position();
  BagHeaderBuilder header(BagOp::chunk);
  header.text("compression", bag_compression_name(options.compression));
  header.field("size", static_cast<std::uint32_t>(chunk.size()));
  ByteBuilder out;
  put_record(out, header, packed);
  for (const auto& [connection, entries] : index) {
    BagHeaderBuilder entry(BagOp::index);
    entry.field("ver", std::uint32_t{1}).field("conn", connection).field("count", info.counts[connection]);
    put_record(out, entry, entries.bytes());
  }
  RAYFIELD_CHECK(file.write(out.bytes()));
  chunks.push_back(std::exchange(info, ChunkInfo()));
  chunk.clear();
  index.clear();
  return {};
}

/// Connections and chunk positions at the end of the file; returns where they begin.
Result<std::uint64_t> BagWriter::Impl::write_index() {
  const std::uint64_t position = file.position();
  ByteBuilder out;
  for (const BagConnection& connection : connections) put_connection(out, connection);
  for (const ChunkInfo& entry : chunks) {
    BagHeaderBuilder header(BagOp::chunk_info);
    header.field("ver", std::uint32_t{1}).field("chunk_pos", entry.position);
    header.time("start_time", entry.start_ns).time("end_time", entry.end_ns);
    header.field("count", static_cast<std::uint32_t>(entry.counts.size()));
    ByteBuilder data;
    for (const auto& [connection, count] : entry.counts) data.put(connection), data.put(count);
    put_record(out, header, data.bytes());
  }
  RAYFIELD_CHECK(file.write(out.bytes()));
  return position;
}

BagWriter::BagWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
BagWriter::BagWriter(BagWriter&&) noexcept = default;
BagWriter& BagWriter::operator=(BagWriter&&) noexcept = default;
BagWriter::~BagWriter() = default;

Result<BagWriter> BagWriter::create(const std::string& path, const BagWriteOptions& options) {
  RAYFIELD_CHECK(options.validate());
  auto impl = std::make_unique<Impl>();
  RAYFIELD_ASSIGN(impl->file, OutputFile::create(path, kWhat));
  impl->options = options;
  RAYFIELD_CHECK(impl->file.write(kBagMagic));
  RAYFIELD_CHECK(impl->file.write(bag_header_record(0, 0, 0)));
  return BagWriter(std::move(impl));
}

std::uint32_t BagWriter::add_connection(const std::string& topic, const std::string& type, const std::string& md5sum,
                                        const std::string& definition) {
  const auto id = static_cast<std::uint32_t>(impl_->connections.size());
  impl_->connections.push_back({id, topic, type, md5sum, definition});
  impl_->connection_written.push_back(false);
  return id;
}

/// Appends to the chunk in memory and to its index, and writes both out once the chunk is full.
Result<void> BagWriter::write(std::uint32_t connection, std::int64_t record_time_ns, std::span<const std::byte> data) {
  const std::string& path = impl_->file.path();
  if (connection >= impl_->connections.size()) {
    return fail(ErrorCode::internal, kWhat, path, "a message for a connection that was not added");
  }
  if (record_time_ns < 0 || record_time_ns / 1'000'000'000 >= kEndOfTime_ns) {
    return fail(ErrorCode::usage, kWhat, path, "a message's time is outside 1970 to 2106");
  }
  if (data.size() > (std::size_t{1} << 30)) return fail(ErrorCode::usage, kWhat, path, "a message is over 1 GiB");
  if (!impl_->connection_written[connection]) {
    impl_->put_connection(impl_->chunk, impl_->connections[connection]);
    impl_->connection_written[connection] = true;
  }
  ChunkInfo& info = impl_->info;
  const bool first = info.counts.empty();
  info.start_ns = first ? record_time_ns : std::min(info.start_ns, record_time_ns);
  info.end_ns = first ? record_time_ns : std::max(info.end_ns, record_time_ns);
  ++info.counts[connection];
  ByteBuilder& entries = impl_->index[connection];
  entries.put(bag_time(record_time_ns));
  entries.put(static_cast<std::uint32_t>(impl_->chunk.size()));
  BagHeaderBuilder header(BagOp::message);
  header.field("conn", connection).time("time", record_time_ns);
  put_record(impl_->chunk, header, data);
  return impl_->chunk.size() >= impl_->options.chunk_bytes ? impl_->flush_chunk() : Result<void>();
}

Result<void> BagWriter::close() {
  RAYFIELD_CHECK(impl_->flush_chunk());
  RAYFIELD_ASSIGN(const std::uint64_t index_pos, impl_->write_index());
  RAYFIELD_CHECK(impl_->file.overwrite(
      kBagMagic.size(), bag_header_record(index_pos, static_cast<std::uint32_t>(impl_->connections.size()),
                                          static_cast<std::uint32_t>(impl_->chunks.size()))));
  return impl_->file.commit();
}

}  // namespace rayfield::formats
