#include "spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "fault.h"

namespace rayfield::tile {

Result<void> SpillFile::open() {
  const std::lock_guard lock(mutex_);
  if (file_.valid()) return {};
  RAYFIELD_ASSIGN(TemporaryFile temporary, create_temporary(directory_));
  if (::unlink(temporary.path.c_str()) != 0) return fail_io(errno, "cannot create file", temporary.path);
  file_ = std::move(temporary.file);
  return {};
}

Result<SpillFile::Extent> SpillFile::append(std::span<const std::byte> bytes) {
  RAYFIELD_CHECK(open());
  const Extent extent{end_.fetch_add(bytes.size()), bytes.size()};
  if (const int error = fault::point("spill")) return fail_io(error, "cannot write", directory_);
  RAYFIELD_CHECK(write_at(file_, extent.offset, bytes, directory_));
  return extent;
}

Result<void> SpillFile::take(const Extent& extent, std::span<std::byte> bytes) {
  RAYFIELD_CHECK(read_at(file_, extent.offset, bytes, directory_));
  // Whole blocks only are freed, and not on every file system: it saves space and nothing depends on it.
  static_cast<void>(::fallocate(file_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                                static_cast<off_t>(extent.offset), static_cast<off_t>(extent.size)));
  return {};
}

}  // namespace rayfield::tile
