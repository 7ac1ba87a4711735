#pragma once

/// files: what a store is made of: checked and durable files, their names and entries, the writer's lock.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "rayfield/core/file.h"
#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"

/// What the store adds to rayfield/core/file.h: a fault point (fault.h) before every call that changes the disk, and
/// errors that say what a store needs. Paths in errors are as given.
namespace rayfield::tile {

/// The failure of a system call on a store that is being written: as fail_errno(), with ENOTDIR counted as
/// `resources` too, and with what to do about a folder that may not be written to.
tl::unexpected<Error> fail_io(int error_number, std::string_view what, const std::filesystem::path& where);

/// Exactly bytes.size() bytes from `offset`; a shorter file is an error (damaged).
Result<void> read_exactly(const FileDescriptor& file, std::uint64_t offset, std::span<std::byte> bytes,
                          const std::filesystem::path& path);
/// A whole regular file.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::string_view what);

/// Writes all bytes from the start of the file, piece by piece.
Result<void> write_in_pieces(const FileDescriptor& file, std::span<const std::byte> bytes,
                             const std::filesystem::path& path);

/// Makes a directory's entries durable.
Result<void> sync_directory(const std::filesystem::path& directory);
/// Creates `relative` below `root`, one level after the other, each made durable in its parent. Errors: damaged, where
/// one of them is a link: what is written through it would lie outside of the store.
Result<void> make_directories(const std::filesystem::path& root, const std::filesystem::path& relative);

/// A new file with an unpredictable name in `directory` (O_EXCL) for reading and writing.
struct TemporaryFile {
  FileDescriptor file;
  std::filesystem::path path;
};
Result<TemporaryFile> create_temporary(const std::filesystem::path& directory);

/// SpillFile::append() with a point at which tests make it fail.
Result<SpillFile::Extent> put_aside(SpillFile& spill, std::span<const std::byte> bytes);

/// Reserves disk space for a file of that size, so that a full disk shows before anything is written. File systems
/// that cannot reserve are taken at their word when they are written to.
Result<void> reserve_space(const FileDescriptor& file, std::uint64_t size, const std::filesystem::path& path);

/// Bytes that this user may still write on the file system of `path`.
Result<std::uint64_t> free_space(const std::filesystem::path& path);

}  // namespace rayfield::tile
