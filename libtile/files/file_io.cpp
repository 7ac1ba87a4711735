#include "libtile/files/file_io.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "libtile/files/fault.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

// Small enough that a kill between two pieces leaves a torn file for the crash tests to find.
constexpr std::size_t kWritePiece = std::size_t{256} << 10;
constexpr std::size_t kReadPiece = std::size_t{1} << 20;

std::string next_step(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "free some disk space and run the same command again";
    case EACCES:
    case EPERM:
    case EROFS:
      return "make the store's folder writable and run the same command again";
    default:
      return {};
  }
}

}  // namespace

Fd& Fd::operator=(Fd&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = other.release();
  }
  return *this;
}

Fd::~Fd() { close(); }

int Fd::release() {
  const int fd = fd_;
  fd_ = -1;
  return fd;
}

int Fd::close() {
  if (fd_ < 0) return 0;
  // Linux frees the descriptor even when close() fails, EINTR included: it must not be repeated.
  return ::close(release()) == 0 || errno == EINTR ? 0 : errno;
}

tl::unexpected<Error> fail_io(int error_number, std::string_view what, const std::filesystem::path& where) {
  auto failure = fail_errno(error_number, what, where.string(), next_step(error_number));
  if (error_number == EIO || error_number == ENOTDIR) failure.value().code = ErrorCode::resources;
  return failure;
}

Result<Fd> open_for_reading(const std::filesystem::path& path, std::string_view what) {
  Fd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) return fail_errno(errno, what, path.string());
  return file;
}

Result<std::uint64_t> file_size(const Fd& file, const std::filesystem::path& path) {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return fail_errno(errno, "cannot read file", path.string());
  if (!S_ISREG(status.st_mode))
    return fail(ErrorCode::bad_input, "cannot read file", path.string(), "not a regular file");
  return static_cast<std::uint64_t>(status.st_size);
}

Result<void> read_at(const Fd& file, std::uint64_t offset, std::span<std::byte> bytes,
                     const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::pread(file.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return fail_errno(errno, "cannot read file", path.string());
    if (n == 0)
      return fail(ErrorCode::damaged, "cannot read file", path.string() + ", offset " + std::to_string(offset),
                  "the file is shorter than it should be", "run `rayfield verify`");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return {};
}

Result<void> write_at(const Fd& file, std::uint64_t offset, std::span<const std::byte> bytes,
                      const std::filesystem::path& path) {
  while (!bytes.empty()) {
    if (const int error = fault::point("write")) return fail_io(error, "cannot write", path);
    const ssize_t n =
        ::pwrite(file.get(), bytes.data(), std::min(bytes.size(), kWritePiece), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return fail_io(errno, "cannot write", path);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return {};
}

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::string_view what) {
  RAYFIELD_ASSIGN(const Fd file, open_for_reading(path, what));
  RAYFIELD_ASSIGN(const std::uint64_t size, file_size(file, path));
  std::vector<std::byte> bytes(size);
  RAYFIELD_CHECK(read_at(file, 0, bytes, path));
  return bytes;
}

Result<FileDigest> digest_file(const std::filesystem::path& path, std::string_view what) {
  RAYFIELD_ASSIGN(const Fd file, open_for_reading(path, what));
  RAYFIELD_ASSIGN(const std::uint64_t size, file_size(file, path));
  Sha256 hash;
  std::vector<std::byte> piece(static_cast<std::size_t>(std::min<std::uint64_t>(size, kReadPiece)));
  for (std::uint64_t offset = 0; offset < size; offset += piece.size()) {
    const std::span<std::byte> part =
        std::span(piece).first(static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), size - offset)));
    RAYFIELD_CHECK(read_at(file, offset, part, path));
    hash.update(std::span<const std::byte>(part));
  }
  return FileDigest{size, hash.hex()};
}

Result<void> sync_directory(const std::filesystem::path& directory) {
  if (const int error = fault::point("fsync-directory")) return fail_io(error, "cannot write", directory);
  Fd fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.valid() || ::fsync(fd.get()) != 0) return fail_io(errno, "cannot write", directory);
  return {};
}

Result<void> make_directories(const std::filesystem::path& root, const std::filesystem::path& relative) {
  std::filesystem::path path = root;
  for (const std::filesystem::path& part : relative) {
    const std::filesystem::path parent = path;
    path /= part;
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) continue;
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
  temporary.file = Fd(::open(temporary.path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!temporary.file.valid()) return fail_io(errno, "cannot create file", temporary.path);
  return temporary;
}

Result<SpillFile::Extent> put_aside(SpillFile& spill, std::span<const std::byte> bytes) {
  if (const int error = fault::point("spill")) return fail_io(error, "cannot write", "tmp");
  return spill.append(bytes);
}

Result<void> reserve_space(const Fd& file, std::uint64_t size, const std::filesystem::path& path) {
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
