#include "libtile/hdf5/h5_bytes.h"

#include <algorithm>
#include <utility>

#include "libtile/files/file_io.h"

namespace rayfield::tile {
namespace {

// The structures of a tile take three or four reads of this size.
constexpr std::uint64_t kWindowBytes = 8192;

}  // namespace

H5Bytes::H5Bytes(std::span<const std::byte> image, std::string where)
    : image_(image), size_(image.size()), where_(std::move(where)) {}

H5Bytes::H5Bytes(const FileDescriptor& file, std::uint64_t size, std::string where)
    : file_(&file), size_(size), where_(std::move(where)) {}

Result<std::span<const std::byte>> H5Bytes::view(std::uint64_t offset, std::uint64_t count) {
  if (!contains(offset, count)) return refuse(offset, "what should be there does not fit into the file");
  if (file_ == nullptr) return image_.subspan(offset, count);
  const bool at_hand = offset >= window_start_ && offset - window_start_ <= window_.size() &&
                       count <= window_.size() - (offset - window_start_);
  if (!at_hand) {
    window_.resize(std::min(std::max(count, kWindowBytes), size_ - offset));
    window_start_ = offset;
    if (auto read = read_exactly(*file_, offset, window_, where_); !read) {
      window_.clear();
      return tl::make_unexpected(std::move(read).error());
    }
  }
  return std::span<const std::byte>(window_).subspan(offset - window_start_, count);
}

tl::unexpected<Error> H5Bytes::refuse(std::uint64_t offset, std::string_view why) const {
  return fail(ErrorCode::damaged, "cannot read file of the store", where_ + " at byte " + std::to_string(offset), why,
              "run `rayfield verify`");
}

}  // namespace rayfield::tile
