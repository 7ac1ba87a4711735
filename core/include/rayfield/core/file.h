#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "rayfield/core/result.h"

/// files: POSIX files with every return value checked, text files, temporary files. Error messages begin with `what`
/// ("cannot read bag") and name paths as they were given.
namespace rayfield {

/// Owns a file descriptor.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(FileDescriptor&& other) noexcept : descriptor_(other.release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor() { close(); }

  int get() const { return descriptor_; }
  bool valid() const { return descriptor_ >= 0; }
  int release() { return std::exchange(descriptor_, -1); }
  /// close(2) with its result: 0 or errno.
  int close();

 private:
  int descriptor_ = -1;
};

/// A regular file opened for reading, and its size at that moment.
struct InputDescriptor {
  FileDescriptor descriptor;
  std::uint64_t size = 0;
};

/// Opens a regular file. Folders, pipes and devices are refused without waiting for them.
/// Errors: bad_input (missing, not a regular file), resources (no permission).
Result<InputDescriptor> open_regular_file(const std::string& path, std::string_view what, std::string_view next = {});

/// Fills `bytes` from `offset` and returns how many were read; fewer only at the end of the file.
Result<std::size_t> read_at(const FileDescriptor& file, std::uint64_t offset, std::span<std::byte> bytes,
                            std::string_view what, const std::string& path);
/// Writes all bytes. Errors: as fail_errno().
Result<void> write_at(const FileDescriptor& file, std::uint64_t offset, std::span<const std::byte> bytes,
                      std::string_view what, const std::string& path, std::string_view next = {});

/// Writes these bytes to a file, replacing any file of that name. Errors: as fail_errno().
Result<void> write_whole_file(const std::string& path, std::span<const std::byte> bytes, std::string_view what,
                              std::string_view next = {});

/// Size and SHA-256 of what was read.
struct FileDigest {
  std::uint64_t size = 0;
  std::string sha256;
};
/// Reads a regular file in pieces of 1 MiB; asks `cancelled` before each. Errors: as above, interrupted.
Result<FileDigest> digest_file(const std::string& path, std::string_view what,
                               const std::function<bool()>& cancelled = {});

/// Makes a file's content durable. Errors: as fail_errno().
Result<void> sync_file(const FileDescriptor& file, std::string_view what, const std::string& path,
                       std::string_view next = {});
/// Makes the names in a folder durable. A file system that cannot sync folders (EINVAL) is not an error.
Result<void> sync_directory(const std::string& folder, std::string_view what, std::string_view next = {});

}  // namespace rayfield
