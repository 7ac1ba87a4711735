#include "libtile/hdf5/h5_object.h"

#include <fmt/format.h>

#include <algorithm>

#include "rayfield/core/byte_cursor.h"

/// Version 1 of an object's header:
///
///   version u8 = 1   u8   messages u16   references u32   bytes of the messages u32   u32
///   each message: kind u16   bytes u16 (a multiple of 8)   flags u8   3 bytes   body
namespace rayfield::tile {
namespace {

constexpr std::size_t kHeadBytes = 16;
constexpr std::size_t kMessageHeadBytes = 8;
// HDF5 gives a dataset 256 bytes where its messages take less.
constexpr std::uint32_t kMostBytes = 4096;
// 1: the message never changes. What lies elsewhere and is shared has other flags.
constexpr std::uint8_t kMostFlags = 1;

Result<void> read_messages(const H5Bytes& bytes, std::size_t count, std::span<const H5MessageKind> allowed,
                           H5ObjectHeader& header) {
  ByteCursor cursor(header.block);
  for (std::size_t i = 0; i < count; ++i) {
    H5Message message;
    message.offset = header.offset + kHeadBytes + (header.block.size() - cursor.remaining()) + kMessageHeadBytes;
    message.kind = static_cast<H5MessageKind>(cursor.get<std::uint16_t>());
    const std::size_t size = cursor.get<std::uint16_t>();
    const auto flags = cursor.get<std::uint8_t>();
    cursor.skip(3);
    message.body = cursor.take(size);
    if (cursor.failed() || size % 8 != 0 || flags > kMostFlags)
      return bytes.refuse(message.offset, "a message of an object's header is not as rayfield writes it");
    if (message.kind == H5MessageKind::nothing) continue;
    if (std::find(allowed.begin(), allowed.end(), message.kind) == allowed.end())
      return bytes.refuse(message.offset, fmt::format("a message of kind {:#04x} is none that rayfield writes there",
                                                      static_cast<unsigned>(message.kind)));
    if (header.find(message.kind) != nullptr)
      return bytes.refuse(message.offset, "an object's header says the same thing twice");
    header.messages.push_back(message);
  }
  if (cursor.remaining() > 0)
    return bytes.refuse(header.offset, "an object's header has fewer messages than it has room for");
  return {};
}

}  // namespace

const H5Message* H5ObjectHeader::find(H5MessageKind kind) const {
  const auto it = std::find_if(messages.begin(), messages.end(), [&](const H5Message& m) { return m.kind == kind; });
  return it == messages.end() ? nullptr : &*it;
}

Result<H5ObjectHeader> read_object_header(H5Bytes& bytes, std::uint64_t offset,
                                          std::span<const H5MessageKind> allowed) {
  H5ObjectHeader header;
  header.offset = offset;
  RAYFIELD_ASSIGN(const auto head, bytes.view(offset, kHeadBytes));
  ByteCursor cursor(head);
  const auto version = cursor.get<std::uint8_t>();
  cursor.skip(1);
  const std::size_t count = cursor.get<std::uint16_t>();
  cursor.skip(4);
  const auto size = cursor.get<std::uint32_t>();
  if (version != 1 || size > kMostBytes) return bytes.refuse(offset, "it is no object's header as rayfield writes it");
  RAYFIELD_ASSIGN(const auto block, bytes.view(offset + kHeadBytes, size));
  header.block.assign(block.begin(), block.end());
  RAYFIELD_CHECK(read_messages(bytes, count, allowed, header));
  return header;
}

}  // namespace rayfield::tile
