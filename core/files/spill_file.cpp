#include "rayfield/core/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "rayfield/core/nameless_file.h"

namespace rayfield {
namespace {

constexpr std::string_view kFreeSpace = "free some disk space and run the same command again";

/// The same error, whatever the system called it, as one of resources.
tl::unexpected<Error> of_resources(Error error) {
  error.code = ErrorCode::resources;
  return tl::make_unexpected(std::move(error));
}

tl::unexpected<Error> failed(int error_number, std::string_view what, const std::filesystem::path& directory,
                             std::string_view next) {
  return of_resources(fail_errno(error_number, what, directory.string(), next).value());
}

}  // namespace

Result<void> SpillFile::open() {
  const std::lock_guard lock(mutex_);
  if (file_.valid()) return {};
  file_ = make_nameless_file(directory_);
  if (!file_.valid())
    return failed(errno, "cannot create a temporary file", directory_,
                  errno == ENOSPC || errno == EDQUOT ? kFreeSpace : "check that files can be made there");
  return {};
}

Result<SpillFile::Extent> SpillFile::append(std::span<const std::byte> bytes) {
  RAYFIELD_CHECK(open());
  const Extent extent{end_.fetch_add(bytes.size()), bytes.size()};
  RAYFIELD_CHECK(overwrite(extent, bytes));
  return extent;
}

Result<void> SpillFile::overwrite(const Extent& extent, std::span<const std::byte> bytes) {
  Result<void> written =
      write_at(file_, extent.offset, bytes, "cannot write a temporary file", directory_.string(), kFreeSpace);
  if (!written) return of_resources(std::move(written).error());
  return {};
}

Result<void> SpillFile::read(const Extent& extent, std::span<std::byte> bytes) const {
  constexpr std::string_view kWhat = "cannot read a temporary file";
  Result<std::size_t> got = read_at(file_, extent.offset, bytes, kWhat, directory_.string());
  if (!got) return of_resources(std::move(got).error());
  if (*got < bytes.size()) return fail(ErrorCode::resources, kWhat, directory_.string(), "it is shorter than written");
  return {};
}

Result<void> SpillFile::take(const Extent& extent, std::span<std::byte> bytes) {
  RAYFIELD_CHECK(read(extent, bytes));
  // Whole blocks only are freed, and not on every file system: it saves space and nothing depends on it.
  static_cast<void>(::fallocate(file_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                                static_cast<off_t>(extent.offset), static_cast<off_t>(extent.size)));
  return {};
}

Result<void> SpillFile::clear() {
  end_ = 0;
  if (file_.valid() && ::ftruncate(file_.get(), 0) != 0)
    return failed(errno, "cannot shorten a temporary file", directory_, kFreeSpace);
  return {};
}

}  // namespace rayfield
