#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libtile/hdf5/h5_bytes.h"
#include "rayfield/core/result.h"

namespace rayfield::tile {

/// Kinds of messages in an object's header that rayfield's files have.
enum class H5MessageKind : std::uint16_t {
  nothing = 0x00,  ///< unused space
  dataspace = 0x01,
  datatype = 0x03,
  fill_value = 0x05,
  layout = 0x08,
  filters = 0x0B,
  symbol_table = 0x11,
};

struct H5Message {
  H5MessageKind kind = H5MessageKind::nothing;
  std::uint64_t offset = 0;  ///< of the body, in the file
  std::span<const std::byte> body;
};

/// The header of a group or dataset.
struct H5ObjectHeader {
  std::uint64_t offset = 0;
  std::vector<std::byte> block;     ///< what the messages' bodies point into
  std::vector<H5Message> messages;  ///< each kind once at most
  /// Nothing where there is none.
  const H5Message* find(H5MessageKind kind) const;
};

/// Reads a header in one piece with messages of the kinds in `allowed` alone. Errors: damaged.
Result<H5ObjectHeader> read_object_header(H5Bytes& bytes, std::uint64_t offset, std::span<const H5MessageKind> allowed);

}  // namespace rayfield::tile
