#include "libtile/store/checked_files.h"

#include <sys/stat.h>

#include <cerrno>

#include "libtile/files/file_io.h"
#include "rayfield/core/file.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {

tl::unexpected<Error> file_damaged(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read file of the store", path.string(), why, "run `rayfield verify`");
}

Error as_damage(Error error) {
  if (error.code == ErrorCode::bad_input) error.code = ErrorCode::damaged, error.next = "run `rayfield verify`";
  return error;
}

Result<void> CheckedFiles::check(const FileEntry& file) const {
  const std::filesystem::path path = folder_ / file.path;
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return file_damaged(path, "the file is missing");
    if (errno == ENOTDIR) return file_damaged(path, "something else stands in place of its folder");
    return fail_errno(errno, "cannot read file of the store", path.string());
  }
  if (!S_ISREG(status.st_mode)) return file_damaged(path, "it is a folder, or something else than a file");
  const Seen found{file.sha256, static_cast<std::uint64_t>(status.st_ino), static_cast<std::uint64_t>(status.st_size),
                   static_cast<std::int64_t>(status.st_mtim.tv_sec), static_cast<std::int64_t>(status.st_mtim.tv_nsec)};
  if (found.size != file.size) return file_damaged(path, "the file is not as long as it was written");
  {
    const std::lock_guard lock(mutex_);
    const auto it = seen_.find(file.path);
    if (it != seen_.end() && it->second == found) return {};
  }
  const auto digest = digest_file(path.string(), "cannot read file of the store");
  if (!digest) return tl::make_unexpected(as_damage(digest.error()));
  if (digest->sha256 != file.sha256) return file_damaged(path, "its SHA-256 is not that of the snapshot");
  const std::lock_guard lock(mutex_);
  seen_[file.path] = found;
  return {};
}

Result<std::vector<std::byte>> CheckedFiles::read(const FileEntry& file) const {
  const std::filesystem::path path = folder_ / file.path;
  std::error_code ignored;  // reading will report it
  const std::uint64_t size = std::filesystem::file_size(path, ignored);
  if (!ignored && size != file.size) return file_damaged(path, "the file is not as long as it was written");
  auto bytes = read_file(path, "cannot read file of the store");
  if (!bytes) return tl::make_unexpected(as_damage(bytes.error()));
  if (bytes->size() != file.size || sha256_hex(*bytes) != file.sha256)
    return file_damaged(path, "its SHA-256 is not that of the snapshot");
  return bytes;
}

}  // namespace rayfield::tile
