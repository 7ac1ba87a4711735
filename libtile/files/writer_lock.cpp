#include "libtile/files/writer_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <string>
#include <string_view>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_folder.h"
#include "libtile/files/store_layout.h"

namespace rayfield::tile {
namespace {

// "00000042\n"; more digits where a number has more.
constexpr std::size_t kLeastDigits = 8, kMostDigits = 19;

Result<FileDescriptor> open_lock(const FileDescriptor& store, const std::filesystem::path& path) {
  FileDescriptor file(
      ::openat(store.get(), layout::kLock, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666));
  struct stat status {};
  if (file.valid() && ::fstat(file.get(), &status) != 0) return fail_io(errno, "cannot lock the store", path);
  if (file.valid() && S_ISREG(status.st_mode)) return file;
  if (file.valid() || errno == ELOOP || errno == EISDIR || errno == ENXIO)
    return fail(ErrorCode::damaged, "cannot lock the store", path.string(),
                "it is a link or something else than a file", "remove it, the next command makes it anew");
  return fail_io(errno, "cannot lock the store", path);
}

// What cannot be removed now is found by gc.
Result<void> clear_temporary_files(const FileDescriptor& store, const std::filesystem::path& path) {
  const std::filesystem::path folder = path / layout::kTemporary;
  RAYFIELD_ASSIGN(const FileDescriptor temporary, open_folder_in(store, layout::kTemporary, folder));
  RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list_folder(temporary, folder));
  for (const FolderEntry& entry : entries)
    if (entry.kind == FolderEntry::Kind::file && layout::is_own_temporary_file(entry.name))
      ::unlinkat(temporary.get(), entry.name.c_str(), 0);
  return {};
}

}  // namespace

Result<WriterLock> WriterLock::take(const std::filesystem::path& store) {
  const std::filesystem::path path = store / layout::kLock;
  if (const int error = fault::point("lock")) return fail_io(error, "cannot lock the store", path);
  RAYFIELD_ASSIGN(const FileDescriptor folder, open_store_folder(store));
  RAYFIELD_CHECK(check_top_folders(folder, store));
  RAYFIELD_ASSIGN(FileDescriptor file, open_lock(folder, path));
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK)
      return fail(ErrorCode::locked, "cannot change the store", store.string(), "another rayfield is writing to it",
                  "wait until it has finished");
    return fail_io(errno, "cannot lock the store", path);
  }
  RAYFIELD_CHECK(make_directories(store, layout::kTemporary));
  RAYFIELD_CHECK(clear_temporary_files(folder, store));
  return WriterLock(std::move(file));
}

std::optional<std::uint64_t> last_published(const std::filesystem::path& store) {
  const auto file = open_regular_file((store / layout::kLock).string(), "cannot read the store");
  if (!file) return std::nullopt;
  std::array<std::byte, kMostDigits + 1> bytes{};
  const auto got = read_at(file->descriptor, 0, bytes, "cannot read the store", {});
  if (!got) return std::nullopt;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), *got);
  const std::size_t end = text.find('\n');
  std::uint64_t number = 0;
  if (end == std::string_view::npos || end < kLeastDigits) return std::nullopt;
  const auto [stop, bad] = std::from_chars(text.data(), text.data() + end, number);
  if (bad != std::errc() || stop != text.data() + end) return std::nullopt;
  return number;
}

void note_published(const std::filesystem::path& store, std::uint64_t number) {
  const auto folder = open_store_folder(store);
  if (!folder) return;
  const auto file = open_lock(*folder, store / layout::kLock);
  if (!file) return;
  std::string text = std::to_string(number);
  if (text.size() < kLeastDigits) text.insert(0, kLeastDigits - text.size(), '0');
  text += '\n';
  static_cast<void>(::pwrite(file->get(), text.data(), text.size(), 0));
}

}  // namespace rayfield::tile
