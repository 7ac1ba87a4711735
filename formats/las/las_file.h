#pragma once

#include <functional>
#include <string>
#include <vector>

#include "formats/io/file_io.h"
#include "formats/las/las_crs.h"
#include "formats/las/las_header.h"
#include "formats/las/las_point.h"

namespace rayfield::formats {

/// A LAS file that was opened: its header, its CRS, and its points in blocks of a megabyte.
class LasFile {
 public:
  struct Options {
    bool allow_truncated = false;  ///< false refuses a file that ends before its last point
    bool allow_trailing = false;   ///< false refuses bytes behind the points that no field of the header announces
  };
  /// Reads and checks the header and the records of variable length, and compares the size of the file with them.
  /// Errors: bad_input, with path and offset; resources.
  static Result<LasFile> open(const std::string& path, const Options& options);

  /// Up to `most` records from that of index `first`; fewer at the end of a block. Valid until the next call.
  /// Errors: bad_input (the file became shorter), resources.
  Result<std::span<const std::byte>> records(std::uint64_t first, std::uint64_t most);
  /// One point by its index, past the blocks: what looks at few points of a large file reads nothing else.
  Result<LasPoint> point(std::uint64_t index) const;

  const LasHeader& header() const { return header_; }
  const LasCrs& crs() const { return crs_; }
  /// Points that are really there.
  std::uint64_t point_count() const { return points_; }
  const std::string& path() const { return window_.file().path(); }
  /// What is unusual about the file, a line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  explicit LasFile(FileWindow window) : window_(std::move(window)) {}
  Result<void> check_length(const Options& options);

  FileWindow window_;
  LasHeader header_;
  LasCrs crs_;
  std::uint64_t points_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace rayfield::formats
