#include "libtile/store/garbage.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <set>
#include <string>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_folder.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_chain.h"

namespace rayfield::tile {
namespace {

namespace fs = std::filesystem;
using Kind = FolderEntry::Kind;

struct Leftovers {
  std::vector<GarbageFile> files;      // in scans/ and registry/
  std::vector<fs::path> folders;       // there, parents before their children
  std::vector<std::string> scratch;    // folders in tmp/ that nobody holds
  std::vector<std::string> temporary;  // files in tmp/
  std::vector<std::string> foreign;
  std::uint64_t temporary_bytes = 0, trash_bytes = 0;
};

// A scratch folder in tmp/ that a running program holds by a lock on the folder itself; the kernel drops the lock when
// the program ends, however it ends.
bool is_held(const FileDescriptor& folder) {
  return ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

// Derived data of a scan comes back with `process`; rays, files kept with a scan and the registry do not.
bool is_derived(const fs::path& directory) {
  return *directory.begin() == layout::kScans && directory.filename() != layout::kRays &&
         directory.filename() != layout::kAttachments;
}

// The store's folder, and what is looked for in it.
class Search {
 public:
  Search(const FileDescriptor& store, fs::path path, const std::set<std::string>& named)
      : store_(store), path_(std::move(path)), named_(named) {}

  Result<Leftovers> run() {
    RAYFIELD_CHECK(look_into(layout::kScans, 2));
    RAYFIELD_CHECK(look_into(layout::kRegistry, 1));
    RAYFIELD_CHECK(look_into_temporary());
    RAYFIELD_ASSIGN(found_.trash_bytes, bytes_below(layout::kTrash));
    return std::move(found_);
  }

 private:
  Result<std::vector<FolderEntry>> list(const fs::path& relative) {
    RAYFIELD_ASSIGN(const FileDescriptor folder, open_folder_below(store_, relative, path_));
    if (!folder.valid()) return std::vector<FolderEntry>();
    return list_folder(folder, path_ / relative);
  }

  // `levels` of folders, and in the last of them files.
  Result<void> look_into(const fs::path& relative, int levels) {
    RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list(relative));
    for (const FolderEntry& entry : entries) {
      const fs::path path = relative / entry.name;
      if (levels > 0 && entry.kind == Kind::link) return not_a_folder(path_ / path);
      if (levels > 0 && entry.kind == Kind::folder && layout::is_plain_name(entry.name)) {
        found_.folders.push_back(path);
        RAYFIELD_CHECK(look_into(path, levels - 1));
      } else if (levels > 0 || entry.kind != Kind::file || !layout::is_own_file(relative, entry.name)) {
        if (!named_.contains(path.generic_string())) found_.foreign.push_back(path.generic_string());
      } else if (!named_.contains(path.generic_string())) {
        found_.files.push_back({path.generic_string(), entry.size, !is_derived(relative)});
      }
    }
    return {};
  }

  Result<void> look_into_temporary() {
    RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list(layout::kTemporary));
    for (const FolderEntry& entry : entries) {
      const fs::path path = fs::path(layout::kTemporary) / entry.name;
      if (entry.kind == Kind::file && layout::is_own_temporary_file(entry.name)) {
        found_.temporary.push_back(entry.name);
        found_.temporary_bytes += entry.size;
      } else if (entry.kind == Kind::folder && layout::is_own_scratch_folder(entry.name)) {
        RAYFIELD_ASSIGN(const FileDescriptor folder, open_folder_below(store_, path, path_));
        if (!folder.valid() || is_held(folder)) continue;
        found_.scratch.push_back(entry.name);
        RAYFIELD_ASSIGN(const std::uint64_t bytes, bytes_below(path));
        found_.temporary_bytes += bytes;
      } else {
        found_.foreign.push_back(path.generic_string());
      }
    }
    return {};
  }

  Result<std::uint64_t> bytes_below(const fs::path& relative) {
    std::uint64_t bytes = 0;
    RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list(relative));
    for (const FolderEntry& entry : entries) {
      bytes += entry.size;
      if (entry.kind != Kind::folder) continue;
      RAYFIELD_ASSIGN(const std::uint64_t inner, bytes_below(relative / entry.name));
      bytes += inner;
    }
    return bytes;
  }

  const FileDescriptor& store_;
  fs::path path_;
  const std::set<std::string>& named_;
  Leftovers found_;
};

std::set<std::string> named_files(const SnapshotChain& chain) {
  std::set<std::string> named;
  for (const auto& [number, snapshot] : chain.intact)
    for (const FileEntry* file : snapshot.files()) named.insert(file->path);
  return named;
}

// Where snapshots are gone, what they named looks like garbage.
Result<void> check_history(const SnapshotChain& chain, const Leftovers& leftovers, const fs::path& folder) {
  if (chain.whole() || (leftovers.files.empty() && chain.unreadable.empty())) return {};
  const Damage& first = chain.damage.front();
  return fail(ErrorCode::damaged, "cannot clean the store", (folder / first.path).string(),
              fmt::format("{}; {} files that no snapshot names may be those of the missing ones", first.reason,
                          leftovers.files.size()),
              "bring it back from a copy, or run `rayfield repair`");
}

Result<void> remove_name(const FileDescriptor& folder, const std::string& name, int flags, const fs::path& path) {
  if (const int error = fault::point("unlink")) return fail_io(error, "cannot remove", path);
  if (::unlinkat(folder.get(), name.c_str(), flags) == 0 || errno == ENOENT) return {};
  // Only empty folders go: the others are in use.
  if (flags == AT_REMOVEDIR && (errno == ENOTEMPTY || errno == EEXIST)) return {};
  return fail_io(errno, "cannot remove", path);
}

// Out of scans/ or registry/: into the same place below trash/, or away.
Result<void> clear_away(const FileDescriptor& store, const fs::path& path, const GarbageFile& file) {
  const fs::path relative(file.path);
  RAYFIELD_ASSIGN(const FileDescriptor folder, open_folder_below(store, relative.parent_path(), path));
  if (!folder.valid()) return {};
  const std::string name = relative.filename().string();
  if (!file.to_trash) return remove_name(folder, name, 0, path / relative);
  const fs::path place = layout::kTrash / relative.parent_path();
  RAYFIELD_CHECK(make_directories(path, place));
  RAYFIELD_ASSIGN(const FileDescriptor trash, open_folder_below(store, place, path));
  if (const int error = fault::point("rename")) return fail_io(error, "cannot move to the trash", path / relative);
  if (::renameat(folder.get(), name.c_str(), trash.get(), name.c_str()) != 0 && errno != ENOENT)
    return fail_io(errno, "cannot move to the trash", path / relative);
  return {};
}

Result<void> clear_scratch(const FileDescriptor& store, const fs::path& path, const Leftovers& leftovers) {
  const fs::path folder = path / layout::kTemporary;
  RAYFIELD_ASSIGN(const FileDescriptor temporary, open_folder_in(store, layout::kTemporary, folder));
  if (!temporary.valid()) return {};
  for (const std::string& name : leftovers.temporary) RAYFIELD_CHECK(remove_name(temporary, name, 0, folder / name));
  for (const std::string& name : leftovers.scratch) {
    RAYFIELD_ASSIGN(const FileDescriptor scratch, open_folder_in(temporary, name, folder / name));
    if (!scratch.valid()) continue;
    RAYFIELD_CHECK(clear_folder(scratch, folder / name));
    RAYFIELD_CHECK(remove_name(temporary, name, AT_REMOVEDIR, folder / name));
  }
  return {};
}

Result<void> clear_trash(const FileDescriptor& store, const fs::path& path) {
  RAYFIELD_ASSIGN(const FileDescriptor trash, open_folder_in(store, layout::kTrash, path / layout::kTrash));
  if (!trash.valid()) return {};
  RAYFIELD_CHECK(clear_folder(trash, path / layout::kTrash));
  return remove_name(store, layout::kTrash, AT_REMOVEDIR, path / layout::kTrash);
}

// The trash of earlier runs goes before anything is moved there.
Result<void> carry_out(const FileDescriptor& store, const fs::path& path, const Leftovers& leftovers,
                       const GarbageOptions& options) {
  if (options.empty_trash) RAYFIELD_CHECK(clear_trash(store, path));
  RAYFIELD_CHECK(clear_scratch(store, path, leftovers));
  for (const GarbageFile& file : leftovers.files) RAYFIELD_CHECK(clear_away(store, path, file));
  for (auto it = leftovers.folders.rbegin(); it != leftovers.folders.rend(); ++it) {
    RAYFIELD_ASSIGN(const FileDescriptor parent, open_folder_below(store, it->parent_path(), path));
    if (parent.valid()) RAYFIELD_CHECK(remove_name(parent, it->filename().string(), AT_REMOVEDIR, path / *it));
  }
  return {};
}

GarbageReport report_of(const Leftovers& leftovers, const GarbageOptions& options) {
  GarbageReport report;
  report.bytes_removed = leftovers.temporary_bytes + (options.empty_trash ? leftovers.trash_bytes : 0);
  for (const GarbageFile& file : leftovers.files)
    (file.to_trash ? report.bytes_moved : report.bytes_removed) += file.size;
  report.files = leftovers.files;
  report.foreign = leftovers.foreign;
  return report;
}

}  // namespace

Result<GarbageReport> collect_garbage(const fs::path& folder, const GarbageOptions& options) {
  RAYFIELD_ASSIGN(const FileDescriptor store, open_store_folder(folder));
  RAYFIELD_CHECK(check_top_folders(store, folder));
  // The lock first: a writer's new files are named by no snapshot yet. Taking it clears tmp/ of files.
  std::optional<WriterLock> lock;
  std::uint64_t cleared_by_lock = 0;
  if (!options.dry_run) {
    RAYFIELD_ASSIGN(const Leftovers before, Search(store, folder, {}).run());
    RAYFIELD_ASSIGN(lock, WriterLock::take(folder));
    cleared_by_lock = before.temporary_bytes;
  }
  RAYFIELD_ASSIGN(const SnapshotChain chain, read_chain(folder));
  const std::set<std::string> named = named_files(chain);
  RAYFIELD_ASSIGN(const Leftovers leftovers, Search(store, folder, named).run());
  RAYFIELD_CHECK(check_history(chain, leftovers, folder));
  GarbageReport report = report_of(leftovers, options);
  if (options.dry_run) return report;
  RAYFIELD_CHECK(carry_out(store, folder, leftovers, options));
  if (cleared_by_lock > leftovers.temporary_bytes) report.bytes_removed += cleared_by_lock - leftovers.temporary_bytes;
  return report;
}

}  // namespace rayfield::tile
