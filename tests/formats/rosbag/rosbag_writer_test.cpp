#include "rayfield/formats/rosbag_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "rayfield/formats/rosbag_reader.h"
#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using namespace bytes;

std::span<const std::byte> as_bytes(const std::string& text) {
  return std::as_bytes(std::span<const char>(text.data(), text.size()));
}

/// 300 messages of two topics, a second apart, in chunks of 4 KiB.
void write_numbers(const std::string& path, BagCompression compression) {
  BagWriteOptions options;
  options.compression = compression;
  options.chunk_bytes = 4096;
  auto writer = BagWriter::create(path, options);
  ASSERT_TRUE(writer) << writer.error().line();
  const std::uint32_t a =
      writer->add_connection("/a", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n");
  const std::uint32_t b =
      writer->add_connection("/b", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n");
  for (int i = 0; i < 300; ++i) {
    const std::string data = counted("message number " + std::to_string(i));
    ASSERT_TRUE(writer->write(i % 3 == 0 ? b : a, std::int64_t{i} * 1'000'000'000 + 7, as_bytes(data)));
  }
  const auto closed = writer->close();
  ASSERT_TRUE(closed) << closed.error().line();
}

class RosbagWriter : public ::testing::TestWithParam<BagCompression> {};

TEST_P(RosbagWriter, WritesWhatTheReaderGetsBack) {
  const TemporaryFile file("");
  write_numbers(file.path(), GetParam());
  auto bag = BagReader::open(file.path());
  ASSERT_TRUE(bag) << bag.error().line();
  EXPECT_EQ(bag->connections().size(), 2U);
  BagMessage message;
  int i = 0;
  for (; *bag->next(message); ++i) {
    const std::string data(reinterpret_cast<const char*>(message.data.data()), message.data.size());
    EXPECT_EQ(data, counted("message number " + std::to_string(i)));
    EXPECT_EQ(message.connection->topic, i % 3 == 0 ? "/b" : "/a");
    EXPECT_EQ(message.record_time_ns, std::int64_t{i} * 1'000'000'000 + 7);
  }
  EXPECT_EQ(i, 300);
  EXPECT_EQ(bag->summary().loss_count + bag->summary().orphan_messages, 0U);
  EXPECT_TRUE(bag->summary().indexed);
  EXPECT_GT(bag->summary().chunks, 4U);
  EXPECT_EQ(bag->summary().chunks, bag->summary().complete_chunks);
}

TEST_P(RosbagWriter, WritesTheSameBytesForTheSameCalls) {
  const TemporaryFile first(""), second("");
  write_numbers(first.path(), GetParam());
  write_numbers(second.path(), GetParam());
  EXPECT_EQ(read_file(first.path()), read_file(second.path()));
}

std::string compression_name(const ::testing::TestParamInfo<BagCompression>& compression) {
  return compression.param == BagCompression::none ? "none" : compression.param == BagCompression::bz2 ? "bz2" : "lz4";
}

INSTANTIATE_TEST_SUITE_P(Compression, RosbagWriter,
                         ::testing::Values(BagCompression::none, BagCompression::bz2, BagCompression::lz4),
                         compression_name);

TEST(RosbagWriterFile, HasTheLayoutOfTheFormatByteForByte) {
  const TemporaryFile file("");
  auto writer = BagWriter::create(file.path());
  const std::uint32_t a = writer->add_connection("/a", "x/A", "0123", "int8 v\n");
  ASSERT_TRUE(writer->write(a, 3'000'000'004, as_bytes("xyz")));
  ASSERT_TRUE(writer->close());
  const std::string connection_record = record(
      field("op", u8(7)) + field("conn", u32(0)) + field("topic", "/a"),
      field("topic", "/a") + field("type", "x/A") + field("md5sum", "0123") + field("message_definition", "int8 v\n"));
  const std::string records =
      connection_record + record(field("op", u8(2)) + field("conn", u32(0)) + field("time", time(3, 4)), "xyz");
  const std::string chunk_record =
      record(field("op", u8(5)) + field("compression", "none") + field("size", u32(records.size())), records);
  const std::string index =
      record(field("op", u8(4)) + field("ver", u32(1)) + field("conn", u32(0)) + field("count", u32(1)),
             time(3, 4) + u32(connection_record.size()));
  const std::size_t chunk_pos = 13 + 8 + 4096;
  const std::size_t index_pos = chunk_pos + chunk_record.size() + index.size();
  const std::string header = field("op", u8(3)) + field("index_pos", le(std::uint64_t{index_pos})) +
                             field("conn_count", u32(1)) + field("chunk_count", u32(1));
  const std::string chunk_info =
      record(field("op", u8(6)) + field("ver", u32(1)) + field("chunk_pos", le(std::uint64_t{chunk_pos})) +
                 field("start_time", time(3, 4)) + field("end_time", time(3, 4)) + field("count", u32(1)),
             u32(0) + u32(1));
  EXPECT_EQ(read_file(file.path()), "#ROSBAG V2.0\n" + record(header, std::string(4096 - header.size(), ' ')) +
                                        chunk_record + index + connection_record + chunk_info);
}

TEST(RosbagWriterFile, AppearsOnlyWhenItIsClosed) {
  const TemporaryFile file("before");
  {
    auto writer = BagWriter::create(file.path());
    ASSERT_TRUE(writer);
    const std::uint32_t a = writer->add_connection("/a", "x/A", "*", "");
    ASSERT_TRUE(writer->write(a, 0, as_bytes("x")));
  }
  EXPECT_EQ(read_file(file.path()), "before");
  const std::filesystem::path folder = std::filesystem::path(file.path()).parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    EXPECT_FALSE(entry.path().string().starts_with(file.path() + ".partial"));
  }
}

TEST(RosbagWriterFile, RefusesWhatItCannotWrite) {
  EXPECT_FALSE(BagWriter::create("/nonexistent/folder/x.bag"));
  BagWriteOptions options;
  options.chunk_bytes = 1;
  const TemporaryFile file("");
  EXPECT_EQ(BagWriter::create(file.path(), options).error().code, ErrorCode::usage);
  auto writer = BagWriter::create(file.path());
  EXPECT_EQ(writer->write(0, 0, {}).error().code, ErrorCode::internal);
  const std::uint32_t a = writer->add_connection("/a", "x/A", "*", "");
  EXPECT_EQ(writer->write(a, -1, {}).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::formats
