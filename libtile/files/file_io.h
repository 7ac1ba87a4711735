#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"

/// POSIX file operations in which every return value is checked. Paths in errors are as given.
namespace rayfield::tile {

/// Owns a file descriptor.
class Fd {
 public:
  Fd() = default;
  explicit Fd(int fd) : fd_(fd) {}
  Fd(Fd&& other) noexcept : fd_(other.release()) {}
  Fd& operator=(Fd&& other) noexcept;
  ~Fd();
  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  int release();
  /// close(2) with its result: 0 or errno.
  int close();

 private:
  int fd_ = -1;
};

/// As fail_errno(), with EIO and ENOTDIR on writing counted as `resources` too.
tl::unexpected<Error> fail_io(int error_number, std::string_view what, const std::filesystem::path& where);

Result<Fd> open_for_reading(const std::filesystem::path& path, std::string_view what);
Result<std::uint64_t> file_size(const Fd& file, const std::filesystem::path& path);
/// Exactly bytes.size() bytes from `offset`; a shorter file is an error (damaged).
Result<void> read_at(const Fd& file, std::uint64_t offset, std::span<std::byte> bytes,
                     const std::filesystem::path& path);
Result<void> write_at(const Fd& file, std::uint64_t offset, std::span<const std::byte> bytes,
                      const std::filesystem::path& path);
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::string_view what);

struct FileDigest {
  std::uint64_t size = 0;
  std::string sha256;
};
/// Size and SHA-256 of a file, read in pieces.
Result<FileDigest> digest_file(const std::filesystem::path& path, std::string_view what);

/// Makes a directory's entries durable.
Result<void> sync_directory(const std::filesystem::path& directory);
/// Creates `relative` below `root`, one level after the other, each made durable in its parent.
Result<void> make_directories(const std::filesystem::path& root, const std::filesystem::path& relative);

/// Creates a file with an unpredictable name in `directory` (O_EXCL) for reading and writing.
struct TemporaryFile {
  Fd file;
  std::filesystem::path path;
};
Result<TemporaryFile> create_temporary(const std::filesystem::path& directory);

/// SpillFile::append() with a point at which tests make it fail.
Result<SpillFile::Extent> put_aside(SpillFile& spill, std::span<const std::byte> bytes);

/// Reserves disk space for a file of that size, so that a full disk shows before anything is written. File systems
/// that cannot reserve are taken at their word when they are written to.
Result<void> reserve_space(const Fd& file, std::uint64_t size, const std::filesystem::path& path);

/// Bytes that this user may still write on the file system of `path`.
Result<std::uint64_t> free_space(const std::filesystem::path& path);

}  // namespace rayfield::tile
