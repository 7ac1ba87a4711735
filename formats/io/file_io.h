#pragma once

/// io: bytes in and out of files, whatever the format: reading at any offset, files that appear whole or not at all,
/// little-endian numbers, and text made safe to store.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/file.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// A regular file opened for reading at any offset; the size is taken when it is opened.
class InputFile {
 public:
  /// `what` names the job in error messages ("cannot read bag"). Errors: bad_input (missing, not a regular file),
  /// resources (no permission).
  static Result<InputFile> open(const std::string& path, const std::string& what);

  /// Fills `bytes` from `offset` and returns how many came; fewer only at the end of the file.
  Result<std::size_t> read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
    return rayfield::read_at(file_.descriptor, offset, bytes, what_, path_);
  }
  std::uint64_t size() const { return file_.size; }
  const std::string& path() const { return path_; }

 private:
  InputDescriptor file_;
  std::string path_, what_;
};

/// A window that slides over a file: bytes near each other are read once, in blocks. Memory stays at the size of the
/// window and of the largest single request.
class FileWindow {
 public:
  explicit FileWindow(InputFile file, std::size_t window_bytes = std::size_t{1} << 20);
  /// Up to `count` bytes from `offset`, fewer only at the end of the file. Valid until the next call.
  Result<std::span<const std::byte>> view(std::uint64_t offset, std::size_t count);
  const InputFile& file() const { return file_; }

 private:
  InputFile file_;
  std::size_t window_bytes_ = 0;
  std::vector<std::byte> buffer_;
  std::uint64_t start_ = 0;  ///< offset of the buffer's first byte in the file
  std::size_t filled_ = 0;
};

class StagedOutput;

/// A file that appears under its name only when complete: a StagedOutput of one file, written through a buffer. What a
/// killed program leaves is removed by the next one that writes the same file. Every return of the system is checked.
class OutputFile {
 public:
  OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  static Result<OutputFile> create(const std::string& path, const std::string& what);

  Result<void> write(std::span<const std::byte> bytes);
  Result<void> write(std::string_view text);
  /// Replaces bytes that were written before.
  Result<void> overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Bytes written so far, which is where the next write goes.
  std::uint64_t position() const { return flushed_ + buffer_.size(); }
  /// Syncs the file and its folder and renames it to its final name.
  Result<void> commit();
  const std::string& path() const { return path_; }

 private:
  Result<void> write_through(std::uint64_t offset, std::span<const std::byte> bytes);
  Result<void> flush();

  FileDescriptor descriptor_;
  std::uint64_t flushed_ = 0;
  std::vector<std::byte> buffer_;
  std::string path_, what_;
  std::unique_ptr<StagedOutput> staged_;
};

}  // namespace rayfield::formats
