#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/file.h"
#include "rayfield/core/result.h"

namespace rayfield::tile {

/// The bytes of an HDF5 file without its seal, in memory or read from disk as they are asked for. Whatever offsets and
/// lengths a file claims, nothing outside of it is read.
class H5Bytes {
 public:
  /// `where` is named in errors; image and file outlive this.
  H5Bytes(std::span<const std::byte> image, std::string where);
  H5Bytes(const FileDescriptor& file, std::uint64_t size, std::string where);

  std::uint64_t size() const { return size_; }
  bool contains(std::uint64_t offset, std::uint64_t count) const { return offset <= size_ && count <= size_ - offset; }
  /// Exactly `count` bytes from `offset`, valid until the next call. Errors: damaged (not within the file), what
  /// reading gives.
  Result<std::span<const std::byte>> view(std::uint64_t offset, std::uint64_t count);

  /// The error (damaged) of something at `offset` that rayfield does not write.
  tl::unexpected<Error> refuse(std::uint64_t offset, std::string_view why) const;

 private:
  const FileDescriptor* file_ = nullptr;  // none: all bytes are in the image
  std::span<const std::byte> image_;
  std::uint64_t size_ = 0;
  std::string where_;
  std::vector<std::byte> window_;  // what was read last
  std::uint64_t window_start_ = 0;
};

}  // namespace rayfield::tile
