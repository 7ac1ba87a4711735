#include "rayfield/formats/rosbag_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <ctime>

#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using namespace bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct ReadBag {
  std::vector<std::string> messages;  // "topic@ns:data"
  BagSummary summary;
};

ReadBag read_all(const std::string& content, const BagReadOptions& options = {}) {
  const TemporaryFile file(content);
  ReadBag out;
  auto bag = BagReader::open(file.path(), options);
  if (!bag) {
    ADD_FAILURE() << bag.error().line();
    return out;
  }
  BagMessage message;
  for (;;) {
    const Result<bool> more = bag->next(message);
    if (!more) ADD_FAILURE() << more.error().line();
    if (!more || !*more) break;
    const std::string data(reinterpret_cast<const char*>(message.data.data()), message.data.size());
    out.messages.push_back(message.connection->topic + "@" + std::to_string(message.record_time_ns) + ":" + data);
  }
  out.summary = bag->summary();
  return out;
}

Error open_error(const std::string& content) {
  const TemporaryFile file(content);
  const auto bag = BagReader::open(file.path());
  if (bag) ADD_FAILURE() << "the bag was opened";
  return bag ? Error{} : bag.error();
}

std::string connection_a() { return connection(0, "/a", "x/A", "*"); }

TEST(RosbagReader, DeliversMessagesOfUncompressedChunksInFileOrder) {
  const ReadBag bag =
      read_all(bag_header() + chunk(connection_a() + message(0, 10, 5, "one")) +
               chunk(connection(1, "/b", "x/B", "*") + message(1, 11, 0, "two") + message(0, 12, 999999999, "")));
  EXPECT_THAT(bag.messages, ElementsAre("/a@10000000005:one", "/b@11000000000:two", "/a@12999999999:"));
  EXPECT_EQ(bag.summary.chunks, 2U);
  EXPECT_EQ(bag.summary.complete_chunks, 2U);
  EXPECT_EQ(bag.summary.loss_count + bag.summary.orphan_messages, 0U);
  EXPECT_FALSE(bag.summary.indexed);
}

TEST(RosbagReader, RefusesWhatIsNotARosOneBag) {
  EXPECT_THAT(open_error("").line(), HasSubstr("the file is empty"));
  EXPECT_THAT(open_error("ply\nformat ascii 1.0\n").line(), HasSubstr("not a ROS bag"));
  EXPECT_THAT(open_error("#ROSBAG V1.2\n# old").line(), HasSubstr("rosbag fix"));
  EXPECT_THAT(open_error("SQLite format 3").line(), HasSubstr("ROS 2 bag"));
  EXPECT_THAT(open_error("\x89MCAP0\r\n").line(), HasSubstr("ROS 2 bag"));
  EXPECT_THAT(open_error(bag_header(0, field("encryptor", "rosbag/AesCbcEncryptor"))).line(), HasSubstr("encrypted"));
  for (const char* content : {"", "#ROSBAG V1.2\n", "x"}) EXPECT_EQ(open_error(content).code, ErrorCode::bad_input);
}

TEST(RosbagReader, RefusesMissingFilesAndFolders) {
  EXPECT_EQ(BagReader::open("/nonexistent/drive.bag").error().code, ErrorCode::bad_input);
  EXPECT_THAT(BagReader::open(std::filesystem::temp_directory_path().string()).error().line(),
              HasSubstr("not a regular file"));
}

TEST(RosbagReader, TakesABagWithoutAnyMessage) {
  const ReadBag bag = read_all(bag_header());
  EXPECT_TRUE(bag.messages.empty());
  EXPECT_EQ(bag.summary.lost_bytes, 0U);
}

TEST(RosbagReader, RecoversCompleteChunksAndMessagesOfACutBagAndTellsTheLossInBytes) {
  const std::string first = chunk(connection_a() + message(0, 1, 0, "one") + message(0, 2, 0, "two"));
  const std::string second = chunk(message(0, 3, 0, "three") + message(0, 4, 0, "four") + message(0, 5, 0, "five"));
  const std::string whole = bag_header() + first + second;
  // The cut goes through the message "four": "three" is complete and sound.
  const std::size_t last_two = message(0, 4, 0, "four").size() + message(0, 5, 0, "five").size();
  const ReadBag bag = read_all(whole.substr(0, whole.size() - last_two + 7));
  EXPECT_THAT(bag.messages, ElementsAre("/a@1000000000:one", "/a@2000000000:two", "/a@3000000000:three"));
  EXPECT_EQ(bag.summary.complete_chunks, 1U);
  ASSERT_EQ(bag.summary.losses.size(), 1U);
  // The chunk's header says how long it was to be, so the bytes behind the end of the file count too.
  EXPECT_EQ(bag.summary.lost_bytes, last_two);
  EXPECT_TRUE(bag.summary.losses[0].seconds_estimated);
  EXPECT_GT(bag.summary.lost_s, 0.5);
  EXPECT_LT(bag.summary.lost_s, 4.0);
}

TEST(RosbagReader, ReadsTheChunkThatAKilledRecorderWasStillFilling) {
  // The recorder writes the sizes of a chunk when it is full; until then they are 0 and the records follow.
  const ReadBag bag = read_all(bag_header() + chunk(connection_a() + message(0, 1, 0, "one")) + chunk("") +
                               message(0, 2, 0, "two") + message(0, 3, 0, "three"));
  EXPECT_THAT(bag.messages, ElementsAre("/a@1000000000:one", "/a@2000000000:two", "/a@3000000000:three"));
  EXPECT_EQ(bag.summary.loss_count + bag.summary.orphan_messages, 0U);
}

TEST(RosbagReader, TellsTheLossOfAClosedBagThatWasCutBetweenTwoChunks) {
  const std::string first = chunk(connection_a() + message(0, 1, 0, "one") + message(0, 3, 0, "two"));
  const std::string second = chunk(message(0, 4, 0, "three"));
  const std::size_t index_pos = bag_header().size() + first.size() + second.size();
  const ReadBag bag = read_all(bag_header(index_pos) + first);
  EXPECT_EQ(bag.messages.size(), 2U);
  EXPECT_EQ(bag.summary.lost_bytes, second.size());
}

TEST(RosbagReader, FindsTheNextRecordBehindADamagedOneAndMeasuresTheSecondsLost) {
  const std::string damaged = message(0, 2, 0, "two");
  std::string garbled = damaged;
  garbled[0] = '\xff';  // the header's length becomes nonsense
  const ReadBag bag =
      read_all(bag_header() + chunk(connection_a() + message(0, 1, 0, "one") + garbled + message(0, 4, 0, "three")) +
               chunk(message(0, 5, 0, "four")));
  EXPECT_THAT(bag.messages, ElementsAre("/a@1000000000:one", "/a@4000000000:three", "/a@5000000000:four"));
  ASSERT_EQ(bag.summary.losses.size(), 1U);
  EXPECT_EQ(bag.summary.lost_bytes, damaged.size());
  EXPECT_DOUBLE_EQ(bag.summary.lost_s, 3.0);  // from the message at 1 s to the one at 4 s
  EXPECT_FALSE(bag.summary.losses[0].seconds_estimated);
}

// Each recovery moves the window a few bytes on; refilling it each time took 7 s for these 4 MB.
TEST(RosbagReader, RecoversFromManySmallDamagesInTheTimeOfOneReading) {
  std::string records;
  std::size_t count = 0;
  for (; records.size() < std::size_t{4} << 20; ++count) records += message(0, 2, 0, "x") + std::string(5, '\xff');
  const std::clock_t started = std::clock();  // CPU time, which does not grow with what else the machine does
  const ReadBag bag = read_all(bag_header() + connection_a() + records);
  const double took_s = static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC;
  EXPECT_EQ(bag.messages.size(), count);
  EXPECT_EQ(bag.summary.loss_count, count);
  EXPECT_LT(took_s, 2.0);
}

TEST(RosbagReader, LosesOnlyTheChunkThatDoesNotDecompress) {
  for (const char* compression : {"bz2", "lz4", "zip"}) {
    const std::string bad = chunk("this is not compressed data", compression, 1000);
    const ReadBag bag =
        read_all(bag_header() + chunk(connection_a() + message(0, 1, 0, "one")) + bad + chunk(message(0, 2, 0, "two")));
    EXPECT_EQ(bag.messages.size(), 2U) << compression;
    EXPECT_EQ(bag.summary.lost_bytes, bad.size()) << compression;
    EXPECT_DOUBLE_EQ(bag.summary.lost_s, 1.0) << compression;
  }
}

TEST(RosbagReader, DoesNotTakeMemoryOnTheWordOfAHeader) {
  // A chunk of 4 GB, a message of 4 GB and a header of 4 GB in a file of some hundred bytes.
  const std::string chunk_lie = chunk("BZh91AY", "bz2", 0xfffffff0U);
  const std::string message_lie =
      counted(field("conn", u32(0)) + field("op", u8(2)) + field("time", time(1, 0))) + u32(0xfffffff0U) + "abc";
  const std::string header_lie = u32(0xfffffff0U) + "abc";
  for (const std::string& lie : {chunk_lie, message_lie, header_lie}) {
    const ReadBag bag = read_all(bag_header() + connection_a() + lie + chunk(message(0, 2, 0, "two")));
    EXPECT_THAT(bag.messages, ElementsAre("/a@2000000000:two"));
    EXPECT_EQ(bag.summary.loss_count, 1U);
  }
}

TEST(RosbagReader, CountsMessagesOverTheSizeLimitAsLost) {
  BagReadOptions options;
  options.max_message_bytes = 4096;
  const ReadBag bag = read_all(
      bag_header() + connection_a() + message(0, 1, 0, std::string(5000, 'x')) + message(0, 2, 0, "two"), options);
  EXPECT_THAT(bag.messages, ElementsAre("/a@2000000000:two"));
  EXPECT_EQ(bag.summary.loss_count, 1U);
}

TEST(RosbagReader, CountsMessagesWhoseConnectionIsUnknown) {
  const ReadBag bag = read_all(bag_header() + chunk(message(7, 1, 0, "lost") + connection_a() + message(0, 2, 0, "x")));
  EXPECT_EQ(bag.messages.size(), 1U);
  EXPECT_EQ(bag.summary.orphan_messages, 1U);
  EXPECT_GT(bag.summary.loss_count + bag.summary.orphan_messages, 0U);
}

TEST(RosbagReader, TakesConnectionsFromTheEndOfAClosedBagWhenTheFirstChunkIsDamaged) {
  const std::string first = chunk("damaged", "bz2", 500);
  const std::string second = chunk(message(0, 2, 0, "two"));
  const std::size_t index_pos = bag_header().size() + first.size() + second.size();
  const ReadBag bag = read_all(bag_header(index_pos) + first + second + connection_a());
  EXPECT_THAT(bag.messages, ElementsAre("/a@2000000000:two"));
  EXPECT_TRUE(bag.summary.indexed);
  EXPECT_EQ(bag.summary.orphan_messages, 0U);
}

TEST(RosbagReader, TakesADamagedIndexAsNoLoss) {
  const std::string only = chunk(connection_a() + message(0, 2, 0, "two"));
  const std::size_t index_pos = bag_header().size() + only.size();
  const ReadBag bag = read_all(bag_header(index_pos) + only + connection_a() + "\x40\x01garbage");
  EXPECT_EQ(bag.messages.size(), 1U);
  EXPECT_EQ(bag.summary.lost_bytes, 0U);
}

TEST(RosbagReader, RefusesLimitsThatMakeNoSense) {
  BagReadOptions options;
  options.max_message_bytes = 0;
  const TemporaryFile file(bag_header());
  EXPECT_EQ(BagReader::open(file.path(), options).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::formats
