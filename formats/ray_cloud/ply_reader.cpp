#include "rayfield/formats/ply_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/io/file_io.h"
#include "formats/ray_cloud/beam_comment.h"
#include "formats/ray_cloud/ply_header.h"
#include "rayfield/core/byte_cursor.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read ray cloud";
/// No projected coordinate is larger; beyond it int32 tile coordinates could not follow either.
constexpr double kMaxCoordinate_m = 1e8;

struct Dropped {
  std::uint64_t not_finite = 0, too_far = 0, no_length = 0;
};

struct RowRange {
  const std::byte* first = nullptr;
  std::size_t rows = 0;
  std::size_t row_bytes = 0;
};

/// Appends the rays of some rows: end = position, origin = end + start vector.
template <class Position, class Start, class Time>
void decode_rows(const RowRange& range, const RayColumns& columns, RayBatch& batch, Dropped& dropped) {
  std::size_t kept = batch.size();
  batch.origin.resize(kept + range.rows), batch.end.resize(kept + range.rows);
  batch.time_s.resize(kept + range.rows);
  batch.intensity.resize(kept + range.rows), batch.hit.resize(kept + range.rows);
  const std::byte* row = range.first;
  for (std::size_t i = 0; i < range.rows; ++i, row += range.row_bytes) {
    const std::byte* at = row + columns.position;
    const Eigen::Vector3d end(static_cast<double>(load<Position>(at)),
                              static_cast<double>(load<Position>(at + sizeof(Position))),
                              static_cast<double>(load<Position>(at + 2 * sizeof(Position))));
    at = row + columns.start;
    const Eigen::Vector3d back(static_cast<double>(load<Start>(at)),
                               static_cast<double>(load<Start>(at + sizeof(Start))),
                               static_cast<double>(load<Start>(at + 2 * sizeof(Start))));
    const double time_s = static_cast<double>(load<Time>(row + columns.time));
    const Eigen::Vector3d origin = end + back;
    const double reach = std::max(end.cwiseAbs().maxCoeff(), origin.cwiseAbs().maxCoeff());
    // The sum is finite only if every part is.
    if (!std::isfinite(end.sum() + back.sum() + time_s)) {
      ++dropped.not_finite;
      continue;
    }
    if (!(reach <= kMaxCoordinate_m)) {
      ++dropped.too_far;
      continue;
    }
    if (back.x() == 0.0 && back.y() == 0.0 && back.z() == 0.0) {
      ++dropped.no_length;
      continue;
    }
    const std::uint8_t alpha = columns.alpha ? load<std::uint8_t>(row + *columns.alpha) : std::uint8_t{255};
    batch.origin[kept] = origin, batch.end[kept] = end, batch.time_s[kept] = time_s;
    batch.intensity[kept] = alpha, batch.hit[kept] = alpha != 0 ? 1 : 0;
    ++kept;
  }
  batch.origin.resize(kept), batch.end.resize(kept), batch.time_s.resize(kept);
  batch.intensity.resize(kept), batch.hit.resize(kept);
}

using Decoder = void (*)(const RowRange&, const RayColumns&, RayBatch&, Dropped&);

Decoder choose_decoder(const RayColumns& columns) {
  if (columns.position_double) {
    if (columns.start_double) {
      return columns.time_double ? decode_rows<double, double, double> : decode_rows<double, double, float>;
    }
    return columns.time_double ? decode_rows<double, float, double> : decode_rows<double, float, float>;
  }
  if (columns.start_double) {
    return columns.time_double ? decode_rows<float, double, double> : decode_rows<float, double, float>;
  }
  return columns.time_double ? decode_rows<float, float, double> : decode_rows<float, float, float>;
}

void drop_line(std::uint64_t count, const char* what, std::vector<std::string>& lines) {
  if (count > 0) lines.push_back(std::to_string(count) + " rays " + what + " dropped");
}

}  // namespace

struct PlyReader::Impl {
  Impl(FileWindow file, PlyHeader ply_header, const RayColumns& ray_columns)
      : window(std::move(file)),
        header(std::move(ply_header)),
        columns(ray_columns),
        decode(choose_decoder(ray_columns)),
        rays(header.vertex_count) {}

  FileWindow window;
  PlyHeader header;
  RayColumns columns;
  Decoder decode;
  std::uint64_t rays;      // that are really there
  std::uint64_t next = 0;  // row
  Dropped dropped;
  std::vector<std::string> notes;
  std::function<bool()> cancelled;

  Result<void> check_length(const PlyReadOptions& options);
};

/// Compares the header's count with the size of the file.
Result<void> PlyReader::Impl::check_length(const PlyReadOptions& options) {
  const std::string& path = window.file().path();
  const std::uint64_t body = window.file().size() - header.header_bytes;
  const std::uint64_t complete = body / header.row_bytes;
  if (complete < header.vertex_count) {
    const std::string why = "the file is truncated: its header announces " + std::to_string(header.vertex_count) +
                            " rays, " + std::to_string(complete) + " are complete";
    if (!options.allow_truncated) {
      return fail(ErrorCode::bad_input, kWhat, path, why, "get the whole file, or allow truncated files to read those");
    }
    rays = complete;
    notes.push_back(why);
    return {};
  }
  const std::uint64_t excess = body - header.vertex_count * header.row_bytes;
  if (excess > 0 && !header.more_elements) {
    const std::string why = std::to_string(excess) + " bytes follow the " + std::to_string(header.vertex_count) +
                            " rays that the header announces";
    if (!options.allow_trailing) {
      return fail(ErrorCode::bad_input, kWhat, path, why,
                  "the count in the header is wrong or the file was written over; write it again");
    }
    notes.push_back(why);
  }
  if (header.more_elements) notes.push_back("elements behind the rays are left out");
  return {};
}

PlyReader::PlyReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PlyReader::~PlyReader() = default;

Result<std::unique_ptr<PlyReader>> PlyReader::open(const std::string& path, const PlyReadOptions& options) {
  const auto located = [&path](Error error) {
    error.where = error.where.empty() ? path : path + ", " + error.where;
    return tl::make_unexpected(std::move(error));
  };
  RAYFIELD_ASSIGN(InputFile file, InputFile::open(path, kWhat));
  if (file.size() == 0) return fail(ErrorCode::bad_input, kWhat, path, "the file is empty");
  FileWindow window(std::move(file));
  RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, window.view(0, kMaxPlyHeader));
  Result<PlyHeader> header = parse_ply_header({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!header) return located(header.error());
  const Result<RayColumns> columns = find_ray_columns(*header);
  if (!columns) return located(columns.error());
  auto impl = std::make_unique<Impl>(std::move(window), std::move(*header), *columns);
  RAYFIELD_CHECK(impl->check_length(options));
  impl->cancelled = options.cancelled;
  if (!columns->alpha) impl->notes.push_back("no alpha in the file: every ray counts as a hit");
  if (!columns->time_double) impl->notes.push_back("times are float: 128 s apart if they count from 1970");
  return std::unique_ptr<PlyReader>(new PlyReader(std::move(impl)));
}

Result<std::size_t> PlyReader::read(RayBatch& batch, std::size_t max_rays) {
  constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  batch.clear();
  const std::size_t row_bytes = impl_->header.row_bytes;
  const std::size_t block_rows = std::max<std::size_t>(1, kBlockBytes / row_bytes);
  try {
    batch.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(max_rays, impl_->rays - impl_->next)));
    while (batch.size() < max_rays && impl_->next < impl_->rays) {
      if (impl_->cancelled && impl_->cancelled())
        return fail(ErrorCode::interrupted, "interrupted", name(), "", "run the same command again");
      const std::uint64_t left = std::min<std::uint64_t>(impl_->rays - impl_->next, max_rays - batch.size());
      const std::size_t rows = static_cast<std::size_t>(std::min<std::uint64_t>(block_rows, left));
      const std::uint64_t offset = impl_->header.header_bytes + impl_->next * row_bytes;
      RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, impl_->window.view(offset, rows * row_bytes));
      if (bytes.size() < rows * row_bytes) {
        return fail(ErrorCode::bad_input, kWhat, name() + " at byte " + std::to_string(offset),
                    "the file became shorter while it was read");
      }
      impl_->decode({bytes.data(), rows, row_bytes}, impl_->columns, batch, impl_->dropped);
      impl_->next += rows;
    }
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::resources, kWhat, name(), "out of memory", "read fewer rays at a time");
  }
  return batch.size();
}

Result<bool> PlyReader::rewind() {
  impl_->next = 0;
  impl_->dropped = {};
  return true;
}

std::optional<std::uint64_t> PlyReader::ray_count() const { return impl_->rays; }

std::string PlyReader::name() const { return impl_->window.file().path(); }

std::vector<std::string> PlyReader::warnings() const {
  std::vector<std::string> lines = impl_->notes;
  drop_line(impl_->dropped.not_finite, "with NaN or infinite values", lines);
  drop_line(impl_->dropped.too_far, "with coordinates beyond 100000 km", lines);
  drop_line(impl_->dropped.no_length, "of zero length", lines);
  return lines;
}

std::optional<std::string> PlyReader::crs() const {
  for (const std::string& comment : impl_->header.comments) {
    if (comment.starts_with("crs ")) return comment.substr(4);
  }
  return std::nullopt;
}

std::optional<LidarBeam> PlyReader::beam() const {
  for (const std::string& comment : impl_->header.comments) {
    if (const std::optional<LidarBeam> beam = parse_beam_comment(comment)) return beam;
  }
  return std::nullopt;
}

}  // namespace rayfield::formats
