#include "libtile/store/garbage.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_log.h"

namespace rayfield::tile {
namespace {

namespace fs = std::filesystem;

struct Leftovers {
  std::vector<fs::path> files;
  std::vector<fs::path> folders;  // below scans/ and registry/, parents before their children
  std::uint64_t bytes = 0;
};

// A scratch folder in tmp/ that a running program holds by a lock on the folder itself; the kernel drops the lock when
// the program ends, however it ends.
bool is_held(const fs::path& folder) {
  const FileDescriptor held(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return held.valid() && ::flock(held.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

Result<Leftovers> find_leftovers(const fs::path& store, const std::set<std::string>& named) {
  Leftovers leftovers;
  for (const char* top : {layout::kScans, layout::kRegistry, layout::kTemporary}) {
    std::error_code error;
    fs::recursive_directory_iterator entry(store / top, error);
    if (error == std::errc::no_such_file_or_directory) continue;
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
      const fs::file_status status = entry->symlink_status(error);
      if (error) break;
      if (fs::is_directory(status) && entry.depth() == 0 && std::string_view(top) == layout::kTemporary &&
          is_held(entry->path())) {
        entry.disable_recursion_pending();
      } else if (fs::is_directory(status)) {
        leftovers.folders.push_back(entry->path());
      } else if (!named.contains(entry->path().lexically_relative(store).generic_string())) {
        leftovers.files.push_back(entry->path());
        if (fs::is_regular_file(status)) leftovers.bytes += entry->file_size(error);
        if (error) break;
      }
    }
    if (error) return fail_io(error.value(), "cannot clean the store", store / top);
  }
  return leftovers;
}

// Bytes of the temporary files that taking the writer's lock will remove.
Result<std::uint64_t> temporary_bytes(const fs::path& folder) {
  RAYFIELD_ASSIGN(const Leftovers temporary, find_leftovers(folder, {}));
  std::uint64_t bytes = 0;
  for (const fs::path& path : temporary.files) {
    std::error_code error;
    if (path.parent_path() == folder / layout::kTemporary && path.extension() == ".tmp")
      bytes += fs::file_size(path, error);
  }
  return bytes;
}

Result<std::set<std::string>> named_files(const fs::path& folder) {
  RAYFIELD_ASSIGN(const std::vector<Snapshot> snapshots, all_snapshots(folder));
  std::set<std::string> named;
  for (const Snapshot& snapshot : snapshots) {
    for (const FileEntry* file : snapshot.files()) named.insert(file->path);
  }
  return named;
}

Result<void> remove(const Leftovers& leftovers) {
  for (const fs::path& path : leftovers.files) {
    if (const int error = fault::point("unlink")) return fail_io(error, "cannot remove file", path);
    if (::unlink(path.c_str()) != 0 && errno != ENOENT) return fail_io(errno, "cannot remove file", path);
  }
  for (auto it = leftovers.folders.rbegin(); it != leftovers.folders.rend(); ++it) {
    // Only empty folders go: the others are in use.
    if (::rmdir(it->c_str()) != 0 && errno != ENOTEMPTY && errno != EEXIST && errno != ENOENT)
      return fail_io(errno, "cannot remove folder", *it);
  }
  return {};
}

}  // namespace

Result<std::uint64_t> collect_garbage(const fs::path& folder, bool dry_run) {
  // The lock first: a writer's new files are named by no snapshot yet.
  std::optional<WriterLock> lock;
  std::uint64_t cleared_by_lock = 0;
  if (!dry_run) {
    RAYFIELD_ASSIGN(cleared_by_lock, temporary_bytes(folder));
    RAYFIELD_ASSIGN(lock, WriterLock::take(folder));
  }
  RAYFIELD_ASSIGN(const std::set<std::string> named, named_files(folder));
  RAYFIELD_ASSIGN(const Leftovers leftovers, find_leftovers(folder, named));
  if (dry_run) return leftovers.bytes;
  RAYFIELD_CHECK(remove(leftovers));
  return leftovers.bytes + cleared_by_lock;
}

}  // namespace rayfield::tile
