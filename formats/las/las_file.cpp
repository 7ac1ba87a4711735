#include "formats/las/las_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rayfield::formats {
namespace {

constexpr std::uint64_t kBlockBytes = std::uint64_t{1} << 20;

tl::unexpected<Error> became_shorter(const std::string& path, std::uint64_t offset) {
  return fail(ErrorCode::bad_input, kLasWhat, fmt::format("{} at byte {}", path, offset),
              "the file became shorter while it was read");
}

}  // namespace

Result<LasFile> LasFile::open(const std::string& path, const Options& options) {
  RAYFIELD_ASSIGN(InputFile input, InputFile::open(path, kLasWhat));
  if (input.size() == 0) return fail(ErrorCode::bad_input, kLasWhat, path, "the file is empty");
  LasFile file{FileWindow(std::move(input))};
  RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, file.window_.view(0, kLasHeaderBytes));
  Result<LasHeader> header = parse_las_header(bytes);
  if (!header) {
    Error error = std::move(header).error();
    error.where = error.where.empty() ? path : path + ", " + error.where;
    return tl::make_unexpected(std::move(error));
  }
  file.header_ = *header;
  RAYFIELD_CHECK(file.check_length(options));
  RAYFIELD_ASSIGN(file.crs_, read_las_crs(file.window_, file.header_));
  if (!file.crs_.note.empty()) file.notes_.push_back(file.crs_.note);
  return file;
}

/// Compares the header's count with the size of the file. Behind the points there may be waveforms and extended
/// records, where the header says so.
Result<void> LasFile::check_length(const Options& options) {
  const std::uint64_t size = window_.file().size();
  const std::uint64_t body = size - std::min<std::uint64_t>(size, header_.points_offset);
  const std::uint64_t complete = body / header_.point_bytes;
  points_ = std::min(complete, header_.point_count);
  if (complete < header_.point_count) {
    const std::string why = fmt::format("the file is truncated: its header announces {} points, {} are complete",
                                        header_.point_count, complete);
    if (!options.allow_truncated)
      return fail(ErrorCode::bad_input, kLasWhat, fmt::format("{} at byte {}", path(), size), why,
                  "get the whole file, or allow truncated files to read those");
    notes_.push_back(why);
    return {};
  }
  const std::uint64_t end = header_.points_end();
  const bool has_more = header_.extended_count > 0 || header_.waveform_offset > 0;
  if (header_.extended_count > 0 && (header_.extended_offset < end || header_.extended_offset > size))
    return fail(ErrorCode::bad_input, kLasWhat, fmt::format("{}, header at byte 235", path()),
                fmt::format("the extended records begin at byte {}, the points end at byte {}, the file at byte {}",
                            header_.extended_offset, end, size),
                "get the whole file, or export the cloud again");
  if (size > end && !has_more) {
    const std::string why =
        fmt::format("{} bytes follow the {} points that the header announces", size - end, header_.point_count);
    if (!options.allow_trailing)
      return fail(ErrorCode::bad_input, kLasWhat, fmt::format("{} at byte {}", path(), end), why,
                  "the count in the header is wrong or the file was written over; write it again");
    notes_.push_back(why);
  }
  return {};
}

Result<std::span<const std::byte>> LasFile::records(std::uint64_t first, std::uint64_t most) {
  const std::uint64_t bytes = header_.point_bytes;
  const std::uint64_t count =
      std::min({most, points_ - std::min(first, points_), std::max<std::uint64_t>(1, kBlockBytes / bytes)});
  const std::uint64_t offset = header_.points_offset + first * bytes;
  RAYFIELD_ASSIGN(const std::span<const std::byte> view, window_.view(offset, static_cast<std::size_t>(count * bytes)));
  if (view.size() < count * bytes) return became_shorter(path(), offset);
  return view;
}

Result<LasPoint> LasFile::point(std::uint64_t index) const {
  std::array<std::byte, 32> record{};  // class, flags and time lie in the first 30 bytes
  const std::uint64_t offset = header_.points_offset + index * header_.point_bytes;
  const std::size_t needed = header_.time_offset() + sizeof(double);
  RAYFIELD_ASSIGN(const std::size_t got, window_.file().read_at(offset, std::span(record).first(needed)));
  if (got < needed) return became_shorter(path(), offset);
  return decode_las_point(record.data(), header_);
}

}  // namespace rayfield::formats
