#include "rayfield/core/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>

namespace rayfield {
namespace {

tl::unexpected<Error> failed(int error_number, std::string_view what, const std::filesystem::path& directory) {
  auto error = fail_errno(error_number, what, directory.string(),
                          error_number == ENOSPC || error_number == EDQUOT
                              ? "free some disk space and run the same command again"
                              : "check that files can be made there");
  error.value().code = ErrorCode::resources;
  return error;
}

}  // namespace

SpillFile::~SpillFile() {
  if (file_ >= 0) ::close(file_);
}

Result<void> SpillFile::open() {
  const std::lock_guard lock(mutex_);
  if (file_ >= 0) return {};
  std::string path = (directory_ / "rayfield-XXXXXX").string();
  file_ = ::mkostemp(path.data(), O_CLOEXEC);
  if (file_ < 0 || ::unlink(path.c_str()) != 0) return failed(errno, "cannot create a temporary file", directory_);
  return {};
}

Result<SpillFile::Extent> SpillFile::append(std::span<const std::byte> bytes) {
  RAYFIELD_CHECK(open());
  const Extent extent{end_.fetch_add(bytes.size()), bytes.size()};
  for (std::uint64_t at = extent.offset; !bytes.empty();) {
    const ssize_t n = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failed(errno, "cannot write a temporary file", directory_);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    at += static_cast<std::uint64_t>(n);
  }
  return extent;
}

Result<void> SpillFile::read(const Extent& extent, std::span<std::byte> bytes) const {
  for (std::uint64_t at = extent.offset; !bytes.empty();) {
    const ssize_t n = ::pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return failed(n < 0 ? errno : EIO, "cannot read a temporary file", directory_);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    at += static_cast<std::uint64_t>(n);
  }
  return {};
}

Result<void> SpillFile::take(const Extent& extent, std::span<std::byte> bytes) {
  RAYFIELD_CHECK(read(extent, bytes));
  // Whole blocks only are freed, and not on every file system: it saves space and nothing depends on it.
  static_cast<void>(::fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(extent.offset),
                                static_cast<off_t>(extent.size)));
  return {};
}

Result<void> SpillFile::clear() {
  end_ = 0;
  if (file_ >= 0 && ::ftruncate(file_, 0) != 0) return failed(errno, "cannot shorten a temporary file", directory_);
  return {};
}

}  // namespace rayfield
