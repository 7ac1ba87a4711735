#include "libtile/files/file_io.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>

#include "libtile/files/fault.h"

namespace rayfield::tile {
namespace {

// Small enough that a kill between two pieces leaves a torn file for the crash tests to find.
constexpr std::size_t kWritePiece = std::size_t{256} << 10;
// Of a raster of the most cells, 2^31, as float.
constexpr std::uint64_t kMostFileBytes = std::uint64_t{9} << 30;

// Whatever keeps the disk from taking what is written is a matter of resources, not of input.
Error as_write_failure(Error error) {
  if (error.code == ErrorCode::bad_input) error.code = ErrorCode::resources;
  return error;
}

std::string_view next_step(int error_number) {
  const bool forbidden = error_number == EACCES || error_number == EPERM || error_number == EROFS;
  return forbidden ? "make the store's folder writable and run the same command again" : "";
}

}  // namespace

tl::unexpected<Error> fail_io(int error_number, std::string_view what, const std::filesystem::path& where) {
  auto failure = fail_errno(error_number, what, where.string(), next_step(error_number));
  if (error_number == ENOTDIR) failure.value().code = ErrorCode::resources;
  return failure;
}

Result<void> read_exactly(const FileDescriptor& file, std::uint64_t offset, std::span<std::byte> bytes,
                          const std::filesystem::path& path) {
  RAYFIELD_ASSIGN(const std::size_t got, read_at(file, offset, bytes, "cannot read file", path.string()));
  if (got == bytes.size()) return {};
  return fail(ErrorCode::damaged, "cannot read file", path.string() + ", offset " + std::to_string(offset + got),
              "the file is shorter than it should be", "run `rayfield verify`");
}

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::string_view what) {
  RAYFIELD_ASSIGN(const InputDescriptor file, open_regular_file(path.string(), what));
  if (file.size > kMostFileBytes)
    return fail(ErrorCode::damaged, what, path.string(), "it is larger than any file of a store",
                "run `rayfield verify`");
  std::vector<std::byte> bytes(file.size);
  RAYFIELD_CHECK(read_exactly(file.descriptor, 0, bytes, path));
  return bytes;
}

Result<void> write_in_pieces(const FileDescriptor& file, std::span<const std::byte> bytes,
                             const std::filesystem::path& path) {
  for (std::uint64_t offset = 0; !bytes.empty();) {
    if (const int error = fault::point("write")) return fail_io(error, "cannot write", path);
    const auto piece = bytes.first(std::min(bytes.size(), kWritePiece));
    if (auto written = write_at(file, offset, piece, "cannot write", path.string()); !written)
      return tl::make_unexpected(as_write_failure(std::move(written).error()));
    bytes = bytes.subspan(piece.size());
    offset += piece.size();
  }
  return {};
}

Result<void> sync_directory(const std::filesystem::path& directory) {
  if (const int error = fault::point("fsync-directory")) return fail_io(error, "cannot write", directory);
  // Stricter than core's: a store promises durable names, so a file system that cannot sync folders is an error.
  const FileDescriptor folder(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.valid()) return fail_io(errno, "cannot write", directory);
  if (auto synced = sync_file(folder, "cannot write", directory.string()); !synced)
    return tl::make_unexpected(as_write_failure(std::move(synced).error()));
  return {};
}

Result<void> make_directories(const std::filesystem::path& root, const std::filesystem::path& relative) {
  std::filesystem::path path = root;
  for (const std::filesystem::path& part : relative) {
    const std::filesystem::path parent = path;
    path /= part;
    struct stat status {};
    if (::lstat(path.c_str(), &status) == 0) {
      if (S_ISDIR(status.st_mode)) continue;
      return fail(ErrorCode::damaged, "cannot create folder", path.string(), "a link or a file stands in its place",
                  "remove it");
    }
    if (const int error = fault::point("mkdir")) return fail_io(error, "cannot create folder", path);
    if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST) return fail_io(errno, "cannot create folder", path);
    RAYFIELD_CHECK(sync_directory(parent));
  }
  return {};
}

Result<TemporaryFile> create_temporary(const std::filesystem::path& directory) {
  std::array<unsigned char, 16> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return fail_io(errno, "cannot get random bytes for a file name", directory);
  std::string name;
  for (const unsigned char byte : random) {
    name += "0123456789abcdef"[byte >> 4U];
    name += "0123456789abcdef"[byte & 15U];
  }
  TemporaryFile temporary;
  temporary.path = directory / (name + ".tmp");
  if (const int error = fault::point("create")) return fail_io(error, "cannot create file", temporary.path);
  temporary.file =
      FileDescriptor(::open(temporary.path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!temporary.file.valid()) return fail_io(errno, "cannot create file", temporary.path);
  return temporary;
}

Result<SpillFile::Extent> put_aside(SpillFile& spill, std::span<const std::byte> bytes) {
  if (const int error = fault::point("spill")) return fail_io(error, "cannot write", "tmp");
  return spill.append(bytes);
}

Result<void> reserve_space(const FileDescriptor& file, std::uint64_t size, const std::filesystem::path& path) {
  if (size == 0) return {};
  if (const int error = fault::point("allocate")) return fail_io(error, "cannot write", path);
  // fallocate(2) and not posix_fallocate(3): the latter writes zeros where the file system cannot reserve.
  while (::fallocate(file.get(), 0, 0, static_cast<off_t>(size)) != 0) {
    if (errno == EINTR) continue;
    if (errno == EOPNOTSUPP || errno == ENOSYS) return {};
    return fail_io(errno, "cannot write", path);
  }
  return {};
}

Result<std::uint64_t> free_space(const std::filesystem::path& path) {
  struct statvfs status {};
  if (::statvfs(path.c_str(), &status) != 0) return fail_io(errno, "cannot ask for free disk space", path);
  return static_cast<std::uint64_t>(status.f_bavail) * static_cast<std::uint64_t>(status.f_frsize);
}

}  // namespace rayfield::tile
