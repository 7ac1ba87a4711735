#include "libtile/hdf5/h5_object.h"

#include <gmock/gmock.h>

#include <array>

#include "rayfield/core/byte_cursor.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;

constexpr std::array kAllowed = {H5MessageKind::dataspace, H5MessageKind::datatype};

struct Header {
  unsigned version = 1, flags = 0;
  std::vector<std::uint16_t> kinds = {1, 3, 0};
  std::uint16_t messages = 3;
  std::uint16_t body = 8;            ///< as stated by the second message
  std::uint32_t size = 3 * (8 + 8);  ///< of all messages, as stated

  Result<H5ObjectHeader> read() const {
    ByteBuilder bytes;
    bytes.put(static_cast<std::uint8_t>(version));
    bytes.put(std::uint8_t{0});
    bytes.put(messages);
    bytes.put(1U);
    bytes.put(size);
    bytes.put(0U);
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      bytes.put(kinds[i]);
      bytes.put(i == 1 ? body : std::uint16_t{8});
      bytes.put(flags);
      bytes.put(std::uint64_t{i});
    }
    H5Bytes source(bytes.bytes(), "file");
    return read_object_header(source, 0, kAllowed);
  }
};

void expect_refused(const Header& header, const char* why) {
  const auto read = header.read();
  ASSERT_FALSE(read) << why;
  EXPECT_EQ(read.error().code, ErrorCode::damaged);
  EXPECT_THAT(read.error().line(), HasSubstr(why));
}

TEST(H5Object, MessagesAreFoundByTheirKind) {
  const auto header = Header().read();
  ASSERT_TRUE(header) << header.error().line();
  EXPECT_EQ(header->messages.size(), 2U);
  const H5Message* message = header->find(H5MessageKind::datatype);
  ASSERT_NE(message, nullptr);
  EXPECT_EQ(message->offset, 16U + 16U + 8U);
  EXPECT_EQ(message->body.front(), std::byte{1});
  EXPECT_EQ(header->find(H5MessageKind::layout), nullptr);
}

TEST(H5Object, HeadersThatRayfieldDoesNotWriteAreRefused) {
  expect_refused({.version = 2}, "no object's header");
  expect_refused({.size = 4097}, "no object's header");
  expect_refused({.size = 4096}, "does not fit into the file");
  expect_refused({.flags = 2}, "not as rayfield writes it");
  expect_refused({.kinds = {1, 0x10, 0}}, "kind 0x10");
  expect_refused({.kinds = {1, 1, 0}}, "twice");
}

TEST(H5Object, NumbersThatDoNotFitTogetherAreRefused) {
  expect_refused({.messages = 2}, "fewer messages");
  for (const std::uint16_t messages : {std::uint16_t{4}, std::uint16_t{65535}})
    expect_refused({.messages = messages}, "not as rayfield writes it");
  for (const std::uint16_t body : {std::uint16_t{4}, std::uint16_t{200}, std::uint16_t{65528}})
    expect_refused({.body = body}, "not as rayfield writes it");
}

}  // namespace
}  // namespace rayfield::tile::testing
