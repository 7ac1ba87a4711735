#include "libtile/tile_file/chunk_codec.h"

#include <algorithm>

#include "libtile/hdf5/column_codec.h"

namespace rayfield::tile {
namespace {

std::uint64_t time_of(const RayRecord& record) {
  return (static_cast<std::uint64_t>(record.time_high) << 32U) | record.time_low;
}

// Differences to the value before: neighbouring rays start almost at the same place.
template <class T, class Get>
void first_differences(std::span<const RayRecord> records, const Get& get, std::vector<T>& out) {
  T before = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const T value = get(records[i]);
    out[i] = zigzag(static_cast<T>(value - before));
    before = value;
  }
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(records.size()), out.end(), T{0});
}

// Differences of differences: the beam turns at an almost constant rate, so ray vectors change almost linearly.
template <class Get>
void second_differences(std::span<const RayRecord> records, const Get& get, std::vector<std::uint32_t>& out) {
  std::uint32_t before = 0, step_before = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::uint32_t value = get(records[i]);
    const std::uint32_t step = value - before;
    out[i] = zigzag(step - step_before);
    before = value;
    step_before = step;
  }
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(records.size()), out.end(), 0U);
}

template <class T>
void append(const std::vector<T>& column, std::size_t k, EncodedChunk& chunk) {
  chunk.sizes[k] = static_cast<std::uint32_t>(compress(std::as_bytes(std::span(column)), sizeof(T), chunk.bytes));
}

// Decompressed columns of one chunk. Kept per thread: fresh pages for 5 MB would cost more than decompressing them.
struct Scratch {
  std::array<std::vector<std::uint32_t>, 6> geometry;
  std::vector<std::uint64_t> time;
  std::vector<std::uint16_t> intensity;
  std::vector<std::uint8_t> flags;
};

void undo_first_differences(std::span<std::uint32_t> values) {
  std::uint32_t value = 0;
  for (std::uint32_t& v : values) v = value += unzigzag(v);
}

void undo_second_differences(std::span<std::uint32_t> values) {
  std::uint32_t value = 0, step = 0;
  for (std::uint32_t& v : values) {
    step += unzigzag(v);
    v = value += step;
  }
}

template <class T>
bool decompress_into(std::span<const std::byte> blob, std::size_t elements, std::vector<T>& out) {
  out.resize(elements);
  return decompress(blob, std::as_writable_bytes(std::span(out)));
}

bool decompress_columns(const std::array<std::span<const std::byte>, kColumnCount>& columns, std::size_t elements,
                        Scratch& scratch) {
  for (std::size_t k = 0; k < 6; ++k) {
    if (!decompress_into(columns[k], elements, scratch.geometry[k])) return false;
  }
  return decompress_into(columns[6], elements, scratch.time) &&
         decompress_into(columns[7], elements, scratch.intensity) &&
         decompress_into(columns[8], elements, scratch.flags);
}

// Turns decoded integers into clipped segments in map metres. One division by the units per metre of an exact integer
// gives the same double in every tile that holds the point.
void to_segments(const Scratch& scratch, std::size_t count, TileIndex tile, const TileGrid& grid, SegmentBatch& out) {
  const std::int64_t x0 = tile.ix * grid.size, y0 = tile.iy * grid.size;
  const std::int32_t low = grid.low(), high = grid.high();
  const auto whole = [](std::int64_t units) { return static_cast<double>(units) / kUnitsPerMetre; };
  for (std::size_t i = 0; i < count; ++i) {
    LocalRay ray;
    for (std::size_t k = 0; k < 3; ++k) {
      ray.origin[k] = static_cast<std::int32_t>(scratch.geometry[k][i]);
      ray.ray[k] = static_cast<std::int32_t>(scratch.geometry[k + 3][i]);
    }
    const std::int64_t ox = ray.origin[0], oy = ray.origin[1], oz = ray.origin[2];
    const std::int64_t ex = ox + ray.ray[0], ey = oy + ray.ray[1], ez = oz + ray.ray[2];
    const bool starts = inside(ox, oy, low, high), ends = inside(ex, ey, low, high);
    ClipRange range;
    if (!(starts && ends)) clip(ray, low, high, range);
    const auto along = [&](double t) {
      return Eigen::Vector3d((static_cast<double>(x0 + ox) + t * ray.ray[0]) / kUnitsPerMetre,
                             (static_cast<double>(y0 + oy) + t * ray.ray[1]) / kUnitsPerMetre,
                             (static_cast<double>(oz) + t * ray.ray[2]) / kUnitsPerMetre);
    };
    out.entry[i] = starts ? Eigen::Vector3d(whole(x0 + ox), whole(y0 + oy), whole(oz)) : along(range.begin);
    out.exit[i] = ends ? Eigen::Vector3d(whole(x0 + ex), whole(y0 + ey), whole(ez)) : along(range.end);
  }
}

}  // namespace

void ChunkSummary::add(const ChunkSummary& other) {
  segments += other.segments, starts += other.starts, hits += other.hits;
  bounds.extend(other.bounds);
}

// Columns in the order of kTileColumns: differences of origins and times, differences of differences of ray vectors.
EncodedChunk encode_chunk(std::span<const RayRecord> records, std::size_t chunk_elements) {
  EncodedChunk chunk;
  chunk.count = static_cast<std::uint32_t>(records.size());
  chunk.chunk_elements = static_cast<std::uint32_t>(chunk_elements);
  chunk.bytes.reserve(chunk_elements * 8);
  std::vector<std::uint32_t> values(chunk_elements);
  for (std::size_t k = 0; k < 3; ++k) {
    first_differences(
        records, [k](const RayRecord& r) { return static_cast<std::uint32_t>(r.geometry.origin[k]); }, values);
    append(values, k, chunk);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    second_differences(
        records, [k](const RayRecord& r) { return static_cast<std::uint32_t>(r.geometry.ray[k]); }, values);
    append(values, k + 3, chunk);
  }
  std::vector<std::uint64_t> times(chunk_elements);
  first_differences(records, time_of, times);
  append(times, 6, chunk);
  std::vector<std::uint16_t> intensity(chunk_elements);
  std::vector<std::uint8_t> flags(chunk_elements);
  for (std::size_t i = 0; i < records.size(); ++i) {
    intensity[i] = records[i].intensity;
    flags[i] = records[i].flags;
  }
  append(intensity, 7, chunk);
  append(flags, 8, chunk);
  chunk.bytes.shrink_to_fit();
  return chunk;
}

ChunkSummary summarize(std::span<const RayRecord> records, TileIndex tile, const TileGrid& grid) {
  ChunkSummary summary;
  summary.segments = records.size();
  const Eigen::Array3d corner(static_cast<double>(tile.ix * grid.size), static_cast<double>(tile.iy * grid.size), 0.0);
  for (const RayRecord& record : records) {
    if ((record.flags & kStartsHere) != 0) ++summary.starts;
    if ((record.flags & (kHit | kEndsHere)) == (kHit | kEndsHere)) ++summary.hits;
    ClipRange range;
    clip(record.geometry, grid.low(), grid.high(), range);
    const Eigen::Array3d origin(record.geometry.origin[0], record.geometry.origin[1], record.geometry.origin[2]);
    const Eigen::Array3d ray(record.geometry.ray[0], record.geometry.ray[1], record.geometry.ray[2]);
    for (const double t : {range.begin, range.end})
      summary.bounds.extend(((corner + origin + t * ray) / kUnitsPerMetre).matrix());
  }
  return summary;
}

Result<void> decode_chunk(const std::array<std::span<const std::byte>, kColumnCount>& columns, std::size_t count,
                          std::size_t chunk_elements, TileIndex tile, const TileGrid& grid, SegmentBatch& segments,
                          const std::string& where) {
  static thread_local Scratch scratch;
  if (count > chunk_elements || chunk_elements > kChunkSegments ||
      !decompress_columns(columns, chunk_elements, scratch))
    return fail(ErrorCode::damaged, "cannot read tile", where, "a chunk cannot be decompressed",
                "run `rayfield verify`");
  for (std::size_t k = 0; k < 3; ++k) {
    undo_first_differences(std::span(scratch.geometry[k]).first(count));
    undo_second_differences(std::span(scratch.geometry[k + 3]).first(count));
  }
  segments.entry.resize(count);
  segments.exit.resize(count);
  segments.time_s.resize(count);
  to_segments(scratch, count, tile, grid, segments);
  std::uint64_t time_us = 0;
  for (std::size_t i = 0; i < count; ++i) {
    time_us += unzigzag(scratch.time[i]);
    segments.time_s[i] = static_cast<double>(static_cast<std::int64_t>(time_us)) / 1e6;
  }
  segments.intensity.assign(scratch.intensity.begin(), scratch.intensity.begin() + static_cast<std::ptrdiff_t>(count));
  segments.flags.assign(scratch.flags.begin(), scratch.flags.begin() + static_cast<std::ptrdiff_t>(count));
  return {};
}

}  // namespace rayfield::tile
