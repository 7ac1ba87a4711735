#include "libtile/files/durable_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_layout.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

Result<void> write_and_flush(TemporaryFile& temporary, std::span<const std::byte> bytes) {
  RAYFIELD_CHECK(reserve_space(temporary.file, bytes.size(), temporary.path));
  RAYFIELD_CHECK(write_in_pieces(temporary.file, bytes, temporary.path));
  if (const int error = fault::point("fsync")) return fail_io(error, "cannot write", temporary.path);
  if (::fsync(temporary.file.get()) != 0) return fail_io(errno, "cannot write", temporary.path);
  if (const int error = fault::point("close")) return fail_io(error, "cannot write", temporary.path);
  if (const int error = temporary.file.close()) return fail_io(error, "cannot write", temporary.path);
  return {};
}

// What the file system gives back must be what it was given.
Result<void> compare(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  if (const int error = fault::point("reopen")) return fail_io(error, "cannot write", path);
  RAYFIELD_ASSIGN(const InputDescriptor file, open_regular_file(path.string(), "cannot read back what was written"));
  bool same = file.size == bytes.size();
  std::vector<std::byte> piece(std::min<std::size_t>(bytes.size(), std::size_t{1} << 20));
  for (std::size_t offset = 0; same && offset < bytes.size(); offset += piece.size()) {
    const auto part = std::span(piece).first(std::min(piece.size(), bytes.size() - offset));
    RAYFIELD_CHECK(read_exactly(file.descriptor, offset, part, path));
    same = std::equal(part.begin(), part.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  if (!same)
    return fail(ErrorCode::resources, "cannot write", path.string(),
                "the disk gives back other bytes than were written", "check the disk");
  return {};
}

}  // namespace

Result<std::filesystem::path> write_temporary(const std::filesystem::path& directory,
                                              std::span<const std::byte> bytes) {
  RAYFIELD_ASSIGN(TemporaryFile temporary, create_temporary(directory));
  Result<void> written = write_and_flush(temporary, bytes);
  if (written) written = compare(temporary.path, bytes);
  if (!written) {
    ::unlink(temporary.path.c_str());
    return tl::make_unexpected(std::move(written).error());
  }
  return temporary.path;
}

Result<FileEntry> DurableWriter::write(std::span<const std::byte> bytes, const std::string& directory,
                                       const std::function<std::string(const std::string& sha256)>& file_name) {
  FileEntry entry;
  entry.size = bytes.size();
  entry.sha256 = sha256_hex(bytes);
  entry.path = directory + "/" + file_name(entry.sha256);
  RAYFIELD_CHECK(make_directories(root_, directory));
  RAYFIELD_ASSIGN(const std::filesystem::path temporary, write_temporary(root_ / layout::kTemporary, bytes));
  const std::filesystem::path final_path = root_ / entry.path;
  // A file that was there before may be named by an older snapshot.
  const bool is_new = ::access(final_path.c_str(), F_OK) != 0;
  int error = fault::point("rename");
  if (error == 0 && std::rename(temporary.c_str(), final_path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    if (error == EISDIR)
      return fail(ErrorCode::damaged, "cannot write", final_path.string(), "a folder stands in place of this file",
                  "move it away and run the same command again");
    return fail_io(error, "cannot write", final_path);
  }
  touch(directory);
  if (is_new) {
    const std::lock_guard lock(mutex_);
    new_files_.insert(entry.path);
  }
  return entry;
}

void DurableWriter::discard_new_files() {
  const std::lock_guard lock(mutex_);
  // Folders once, after their files: to find out whether it is empty takes long in a folder of many removed files.
  std::set<std::filesystem::path> folders;
  for (const std::string& path : new_files_) {
    ::unlink((root_ / path).c_str());
    folders.insert(std::filesystem::path(path).parent_path());
  }
  // Those that are empty now go too; what cannot be removed is found by gc.
  for (std::filesystem::path folder : folders)
    for (; folder.has_parent_path() && ::rmdir((root_ / folder).c_str()) == 0; folder = folder.parent_path()) {
    }
  new_files_.clear();
  directories_.clear();
}

void DurableWriter::touch(const std::string& directory) {
  const std::lock_guard lock(mutex_);
  directories_.insert(directory);
}

Result<void> DurableWriter::sync_directories() {
  std::set<std::string> directories;
  {
    const std::lock_guard lock(mutex_);
    directories.swap(directories_);
  }
  for (const std::string& directory : directories) {
    // Parents too: a run that was killed may have created them without making them durable.
    for (std::filesystem::path path = directory; !path.empty(); path = path.parent_path())
      RAYFIELD_CHECK(sync_directory(root_ / path));
  }
  if (!directories.empty()) RAYFIELD_CHECK(sync_directory(root_));
  return {};
}

}  // namespace rayfield::tile
