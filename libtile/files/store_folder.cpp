#include "libtile/files/store_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <string_view>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_layout.h"

namespace rayfield::tile {
namespace {

constexpr int kFolder = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
constexpr std::string_view kWhat = "cannot change the store";

struct CloseFolder {
  void operator()(DIR* folder) const { ::closedir(folder); }
};

FolderEntry::Kind kind_of(mode_t mode) {
  if (S_ISREG(mode)) return FolderEntry::Kind::file;
  if (S_ISDIR(mode)) return FolderEntry::Kind::folder;
  return S_ISLNK(mode) ? FolderEntry::Kind::link : FolderEntry::Kind::other;
}

}  // namespace

tl::unexpected<Error> not_a_folder(const std::filesystem::path& path) {
  return fail(ErrorCode::damaged, kWhat, path.string(),
              "it is a link or a file where a folder of the store belongs; what lies behind it is not touched",
              "put the folder itself in its place");
}

Result<FileDescriptor> open_store_folder(const std::filesystem::path& store) {
  FileDescriptor folder(::open(store.c_str(), kFolder));
  if (!folder.valid()) return fail_io(errno, kWhat, store);
  return folder;
}

Result<FileDescriptor> open_folder_in(const FileDescriptor& parent, const std::string& name,
                                      const std::filesystem::path& path) {
  FileDescriptor folder(::openat(parent.get(), name.c_str(), kFolder | O_NOFOLLOW));
  if (folder.valid() || errno == ENOENT) return folder;
  if (errno == ELOOP || errno == ENOTDIR) return not_a_folder(path);
  return fail_io(errno, kWhat, path);
}

Result<FileDescriptor> open_folder_below(const FileDescriptor& store, const std::filesystem::path& relative,
                                         const std::filesystem::path& store_path) {
  std::filesystem::path path = store_path;
  FileDescriptor folder(::fcntl(store.get(), F_DUPFD_CLOEXEC, 0));
  for (const std::filesystem::path& part : relative) {
    if (!folder.valid()) break;
    path /= part;
    RAYFIELD_ASSIGN(folder, open_folder_in(folder, part.string(), path));
  }
  return folder;
}

Result<std::vector<FolderEntry>> list_folder(const FileDescriptor& folder, const std::filesystem::path& path) {
  // fdopendir() takes its descriptor, and readdir() moves in what it refers to: one of its own, from the start.
  FileDescriptor own(::openat(folder.get(), ".", kFolder));
  if (!own.valid()) return fail_io(errno, "cannot read folder", path);
  const std::unique_ptr<DIR, CloseFolder> stream(::fdopendir(own.get()));
  if (!stream) return fail_io(errno, "cannot read folder", path);
  own.release();
  std::vector<FolderEntry> entries;
  while (true) {
    errno = 0;
    const dirent* found = ::readdir(stream.get());
    if (found == nullptr && errno != 0) return fail_io(errno, "cannot read folder", path);
    if (found == nullptr) break;
    FolderEntry entry{found->d_name};
    if (entry.name == "." || entry.name == "..") continue;
    struct stat status {};
    if (::fstatat(folder.get(), entry.name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) {
      if (errno == ENOENT) continue;  // gone since
      return fail_io(errno, "cannot read folder", path / entry.name);
    }
    entry.kind = kind_of(status.st_mode);
    if (entry.kind == FolderEntry::Kind::file) entry.size = static_cast<std::uint64_t>(status.st_size);
    entries.push_back(std::move(entry));
  }
  std::sort(entries.begin(), entries.end(), [](const FolderEntry& a, const FolderEntry& b) { return a.name < b.name; });
  return entries;
}

Result<void> clear_folder(const FileDescriptor& folder, const std::filesystem::path& path) {
  RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list_folder(folder, path));
  for (const FolderEntry& entry : entries) {
    const bool is_folder = entry.kind == FolderEntry::Kind::folder;
    if (is_folder) {
      RAYFIELD_ASSIGN(const FileDescriptor inner, open_folder_in(folder, entry.name, path / entry.name));
      if (!inner.valid()) continue;
      RAYFIELD_CHECK(clear_folder(inner, path / entry.name));
    }
    if (const int error = fault::point("unlink")) return fail_io(error, "cannot remove", path / entry.name);
    if (::unlinkat(folder.get(), entry.name.c_str(), is_folder ? AT_REMOVEDIR : 0) != 0 && errno != ENOENT)
      return fail_io(errno, "cannot remove", path / entry.name);
  }
  return {};
}

Result<void> check_top_folders(const FileDescriptor& store, const std::filesystem::path& path) {
  for (const char* name : {layout::kSnapshots, layout::kScans, layout::kRegistry, layout::kTemporary, layout::kTrash}) {
    struct stat status {};
    if (::fstatat(store.get(), name, &status, AT_SYMLINK_NOFOLLOW) != 0) {
      if (errno == ENOENT) continue;
      return fail_io(errno, kWhat, path / name);
    }
    if (!S_ISDIR(status.st_mode)) return not_a_folder(path / name);
  }
  return {};
}

}  // namespace rayfield::tile
