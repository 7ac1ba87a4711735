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

// Undoes the differences of decompressed rays, one after the other.
class RayDecoder {
 public:
  explicit RayDecoder(const Scratch& scratch) {
    for (std::size_t k = 0; k < 6; ++k) columns_[k] = scratch.geometry[k].data();
  }
  LocalRay next() {
    LocalRay ray;
    for (std::size_t k = 0; k < 3; ++k) {
      origin_[k] += unzigzag(*columns_[k]++);
      step_[k] += unzigzag(*columns_[k + 3]++);
      ray_[k] += step_[k];
      ray.origin[k] = static_cast<std::int32_t>(origin_[k]), ray.ray[k] = static_cast<std::int32_t>(ray_[k]);
    }
    return ray;
  }

 private:
  std::array<const std::uint32_t*, 6> columns_;
  std::array<std::uint32_t, 3> origin_{}, ray_{}, step_{};
};

template <class T>
bool decompress_into(std::span<const std::byte> blob, std::size_t elements, std::vector<T>& out) {
  out.resize(elements);
  return decompress(blob, std::as_writable_bytes(std::span(out)));
}

bool decompress_geometry(const EncodedColumns& columns, std::size_t elements, Scratch& scratch) {
  for (std::size_t k = 0; k < 6; ++k) {
    if (!decompress_into(columns[k], elements, scratch.geometry[k])) return false;
  }
  return decompress_into(columns[8], elements, scratch.flags);
}

tl::unexpected<Error> cannot_decompress(const std::string& where) {
  return fail(ErrorCode::damaged, "cannot read tile", where, "a chunk cannot be decompressed", "run `rayfield verify`");
}

bool are_sizes_of_chunk(std::size_t count, std::size_t chunk_elements) {
  return count <= chunk_elements && chunk_elements <= kChunkSegments;
}

// The end of a ray, in the tile's units.
std::array<std::int64_t, 3> end_of(const LocalRay& ray) {
  std::array<std::int64_t, 3> end;
  for (std::size_t k = 0; k < 3; ++k) end[k] = std::int64_t{ray.origin[k]} + ray.ray[k];
  return end;
}

// Map metres of a place in a tile. One division by the units per metre of an exact integer gives the same double in
// every tile that holds the point.
class MapPlaces {
 public:
  MapPlaces(TileIndex tile, const TileGrid& grid) : x0_(tile.ix * grid.size), y0_(tile.iy * grid.size) {}
  Eigen::Vector3d at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return {whole(x0_ + x), whole(y0_ + y), whole(z)};
  }
  Eigen::Vector3d along(const LocalRay& ray, double t) const {
    return {(static_cast<double>(x0_ + ray.origin[0]) + t * ray.ray[0]) / kUnitsPerMetre,
            (static_cast<double>(y0_ + ray.origin[1]) + t * ray.ray[1]) / kUnitsPerMetre,
            (static_cast<double>(ray.origin[2]) + t * ray.ray[2]) / kUnitsPerMetre};
  }

 private:
  static double whole(std::int64_t units) { return static_cast<double>(units) / kUnitsPerMetre; }
  std::int64_t x0_, y0_;
};

// Turns decoded integers into clipped segments.
void to_segments(const Scratch& scratch, std::size_t count, TileIndex tile, const TileGrid& grid, SegmentBatch& out) {
  const MapPlaces places(tile, grid);
  const std::int32_t low = grid.low(), high = grid.high();
  RayDecoder rays(scratch);
  for (std::size_t i = 0; i < count; ++i) {
    const LocalRay ray = rays.next();
    const auto [ox, oy, oz] = ray.origin;
    const auto [ex, ey, ez] = end_of(ray);
    const bool starts = inside(ox, oy, low, high), ends = inside(ex, ey, low, high);
    ClipRange range;
    if (!(starts && ends)) clip(ray, low, high, range);
    out.entry[i] = starts ? places.at(ox, oy, oz) : places.along(ray, range.begin);
    out.exit[i] = ends ? places.at(ex, ey, ez) : places.along(ray, range.end);
  }
}

}  // namespace

void ChunkSummary::add(const ChunkSummary& other) {
  segments += other.segments, starts += other.starts, hits += other.hits;
  bounds.extend(other.bounds);
}

EncodedColumns EncodedChunk::columns() const {
  EncodedColumns columns;
  std::size_t offset = 0;
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    columns[k] = std::span(bytes).subspan(offset, sizes[k]);
    offset += sizes[k];
  }
  return columns;
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

Result<void> decode_chunk(const EncodedColumns& columns, std::size_t count, std::size_t chunk_elements, TileIndex tile,
                          const TileGrid& grid, SegmentBatch& segments, const std::string& where) {
  static thread_local Scratch scratch;
  if (!are_sizes_of_chunk(count, chunk_elements) || !decompress_geometry(columns, chunk_elements, scratch) ||
      !decompress_into(columns[6], chunk_elements, scratch.time) ||
      !decompress_into(columns[7], chunk_elements, scratch.intensity))
    return cannot_decompress(where);
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

Result<void> decode_hits(const EncodedColumns& columns, std::size_t count, std::size_t chunk_elements, TileIndex tile,
                         const TileGrid& grid, HitBatch& hits, const std::string& where) {
  static thread_local Scratch scratch;
  if (!are_sizes_of_chunk(count, chunk_elements) || !decompress_geometry(columns, chunk_elements, scratch))
    return cannot_decompress(where);
  const MapPlaces places(tile, grid);
  RayDecoder rays(scratch);
  hits.end.clear(), hits.flags.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const LocalRay ray = rays.next();
    if ((scratch.flags[i] & kHit) == 0) continue;
    const auto [x, y, z] = end_of(ray);
    hits.end.push_back(places.at(x, y, z)), hits.flags.push_back(scratch.flags[i]);
  }
  return {};
}

}  // namespace rayfield::tile
