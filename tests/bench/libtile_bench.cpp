// Rates of the tile store on rays like those of a drive: partition (rays/s and bytes per ray), encoding and decoding of
// chunks (segments/s of one core), reading a published tile back.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <random>

#include "libtile/hdf5/array_image.h"
#include "libtile/partition/clip_batch.h"
#include "libtile/tile_file/chunk_codec.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/tile/tile.h"

namespace {

using namespace rayfield;
namespace fs = std::filesystem;

// A spinning 2D lidar on a vehicle at 1.2 m/s, 28 600 rays/s; a bit more than half of the rays hit.
const RayBatch& drive() {
  static const RayBatch kRays = [] {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::normal_distribution<double> noise(0.0, 0.01);
    RayBatch batch;
    for (std::size_t i = 0; i < 1000000; ++i) {
      const double t = static_cast<double>(i) / 28600.0;
      const double spin = std::numbers::pi * t, beam = 2 * std::numbers::pi * static_cast<double>(i % 286) / 286.0;
      const Eigen::Vector3d direction(std::cos(beam) * std::cos(spin), std::cos(beam) * std::sin(spin), std::sin(beam));
      const Eigen::Vector3d origin(276196.0 + 1.2 * t, 6099944.0 + 0.3 * t, 82.0 + 0.02 * std::sin(7 * t));
      const bool hit = direction.z() <= 0 || uniform(random) < 0.1;
      const double range = hit ? 1.0 + 8.0 * uniform(random) * uniform(random) + noise(random) : 40.0;
      const auto intensity = hit ? static_cast<std::uint16_t>(100 + 155 * uniform(random)) : std::uint16_t{0};
      batch.push(origin, origin + range * direction, 1549843200.0 + t, intensity, hit);
    }
    return batch;
  }();
  return kRays;
}

// The drive several times over, later each time; random: the rays in no order.
class Repeated : public RaySource {
 public:
  Repeated(int times, bool random) : times_(times), random_(random) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    const RayBatch& rays = drive();
    const std::size_t total = rays.size() * static_cast<std::size_t>(times_);
    for (; batch.size() < max_rays && next_ < total; ++next_) {
      // 387 420 489 = 3^18 has no factor in common with the number of rays: a permutation.
      const std::size_t i = random_ ? next_ * 387420489 % rays.size() : next_ % rays.size();
      const double later = 100.0 * static_cast<double>(next_ / rays.size());
      batch.push(rays.origin[i], rays.end[i], rays.time_s[i] + later, rays.intensity[i], rays.hit[i] != 0);
    }
    return batch.size();
  }
  Result<bool> rewind() override { return false; }
  std::string name() const override { return "drive"; }

 private:
  int times_;
  bool random_;
  std::size_t next_ = 0;
};

class BenchFolder {
 public:
  BenchFolder() {
    std::string name = (fs::temp_directory_path() / "rayfield-bench-XXXXXX").string();
    path_ = ::mkdtemp(name.data()) == nullptr ? fs::path() : fs::path(name);
  }
  BenchFolder(const BenchFolder&) = delete;
  BenchFolder& operator=(const BenchFolder&) = delete;
  ~BenchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Result<tile::AddReport> add_drive(const fs::path& folder, int threads, bool random, std::uint64_t memory_bytes) {
  tile::StoreConfig config;
  config.crs = "EPSG:7854";
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::create(folder, config));
  Repeated rays(4, random);
  tile::AddOptions options;
  options.date = "2019-02-11";
  options.threads = threads;
  options.memory_bytes = memory_bytes;
  Progress progress;
  return store.add(rays, options, progress);
}

void partition_drive(benchmark::State& state) {
  drive();
  double rays = 0, bytes_per_ray = 0;
  for (auto _ : state) {
    const BenchFolder folder;
    const auto report = add_drive(folder.path() / "block", static_cast<int>(state.range(0)), state.range(1) != 0,
                                  static_cast<std::uint64_t>(state.range(2)) << 20U);
    if (!report) return state.SkipWithError(report.error().line().c_str());
    rays += static_cast<double>(report->ray_count);
    bytes_per_ray = static_cast<double>(report->bytes_written) / static_cast<double>(report->ray_count);
  }
  state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
  state.counters["bytes/ray"] = bytes_per_ray;
}
BENCHMARK(partition_drive)
    ->ArgNames({"threads", "random", "MB"})
    ->Args({1, 0, 1024})
    ->Args({2, 0, 1024})
    ->Args({2, 1, 1024})
    ->Args({2, 1, 128})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// The first full chunk of the tile that gets most of the drive.
struct FullChunk {
  tile::TileGrid grid{tile::StoreConfig{}};
  tile::TileIndex tile;
  std::vector<tile::RayRecord> records;

  FullChunk() {
    tile::BatchClipper clipper(grid);
    tile::ClippedBatch clipped;
    clipper.clip(drive(), 0, {std::size_t{1} << 22, 1000}, clipped);
    tile::ClippedGroup largest;
    for (const tile::ClippedGroup& group : clipped.groups) {
      if (group.count > largest.count) largest = group;
    }
    tile = largest.tile;
    const auto first = clipped.records.begin() + static_cast<std::ptrdiff_t>(largest.begin);
    records.assign(first, first + static_cast<std::ptrdiff_t>(std::min(largest.count, tile::kChunkSegments)));
  }
};

const FullChunk& full_chunk() {
  static const FullChunk kChunk;
  return kChunk;
}

void clip_rays(benchmark::State& state) {
  tile::BatchClipper clipper{tile::TileGrid(tile::StoreConfig{})};
  tile::ClippedBatch clipped;
  for (auto _ : state) {
    clipper.clip(drive(), 0, {std::size_t{1} << 17, 1000}, clipped);
    benchmark::DoNotOptimize(clipped.records.data());
    state.counters["rays/s"] =
        benchmark::Counter(static_cast<double>(clipped.next_ray), benchmark::Counter::kIsIterationInvariantRate);
  }
}
BENCHMARK(clip_rays)->Unit(benchmark::kMillisecond);

void encode_segments(benchmark::State& state) {
  const FullChunk& chunk = full_chunk();
  double bytes = 0;
  for (auto _ : state)
    bytes = static_cast<double>(tile::encode_chunk(chunk.records, chunk.records.size()).bytes.size());
  const double count = static_cast<double>(chunk.records.size());
  state.counters["segments/s"] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["bytes/segment"] = bytes / count;
}
BENCHMARK(encode_segments)->Unit(benchmark::kMillisecond);

/// Of a full chunk; `decode` takes its columns, count, elements and the rest as decode_chunk() and decode_hits() do.
template <typename Batch, typename Decode>
void decode_full_chunk(benchmark::State& state, Decode decode) {
  const FullChunk& chunk = full_chunk();
  const tile::EncodedChunk encoded = tile::encode_chunk(chunk.records, chunk.records.size());
  const tile::EncodedColumns columns = encoded.columns();
  Batch batch;
  for (auto _ : state) {
    const auto decoded = decode(columns, encoded.count, encoded.chunk_elements, chunk.tile, chunk.grid, batch, "chunk");
    if (!decoded) return state.SkipWithError("cannot decode");
    benchmark::ClobberMemory();
  }
  state.counters["segments/s"] =
      benchmark::Counter(static_cast<double>(chunk.records.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void decode_segments(benchmark::State& state) {
  decode_full_chunk<tile::SegmentBatch>(state, [](auto&&... of) { return tile::decode_chunk(of...); });
}
BENCHMARK(decode_segments)->Unit(benchmark::kMillisecond);

void decode_hits_alone(benchmark::State& state) {
  decode_full_chunk<tile::HitBatch>(state, [](auto&&... of) { return tile::decode_hits(of...); });
}
BENCHMARK(decode_hits_alone)->Unit(benchmark::kMillisecond);

// A published store with the drive in it, and its tile of most segments.
struct PublishedTile {
  BenchFolder folder;
  std::optional<tile::Store> store;
  tile::TileEntry tile;

  PublishedTile() {
    const fs::path path = folder.path() / "block";
    if (!add_drive(path, 2, false, std::uint64_t{1} << 30U)) std::abort();
    store = *tile::Store::open(path);
    const tile::Snapshot snapshot = *store->latest();
    for (const tile::TileEntry& entry : snapshot.scans.front().tiles) {
      if (entry.segment_count > tile.segment_count) tile = entry;
    }
  }
};

const PublishedTile& published_tile() {
  static const PublishedTile kTile;
  return kTile;
}

// The structure of the tile's files; their bytes have been checked before.
void open_tile(benchmark::State& state) {
  const PublishedTile& published = published_tile();
  for (auto _ : state) {
    const auto reader = published.store->open_tile(published.tile);
    if (!reader) return state.SkipWithError(reader.error().line().c_str());
    benchmark::DoNotOptimize(reader->chunk_count());
  }
}
BENCHMARK(open_tile)->Unit(benchmark::kMicrosecond);

void read_tile(benchmark::State& state) {
  const PublishedTile& published = published_tile();
  tile::SegmentBatch segments;
  for (auto _ : state) {
    const auto reader = published.store->open_tile(published.tile);
    if (!reader) return state.SkipWithError(reader.error().line().c_str());
    for (std::size_t chunk = 0; chunk < reader->chunk_count(); ++chunk) {
      if (!reader->read_chunk(chunk, segments)) return state.SkipWithError("cannot read");
      benchmark::DoNotOptimize(segments.exit.data());
    }
  }
  state.counters["segments/s"] = benchmark::Counter(static_cast<double>(published.tile.segment_count),
                                                    benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(read_tile)->Unit(benchmark::kMillisecond);

// A raster of derived data, of a million cells.
void decode_raster(benchmark::State& state) {
  tile::ArraySet arrays;
  arrays.kind = "raster";
  std::vector<double> cells(1000000);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = std::floor(100 * std::sin(0.001 * static_cast<double>(i)));
  arrays.columns["cells"] = cells;
  const auto image = tile::encode_arrays(arrays);
  if (!image) return state.SkipWithError(image.error().line().c_str());
  for (auto _ : state) {
    const auto decoded = tile::decode_arrays(*image, "raster");
    if (!decoded) return state.SkipWithError(decoded.error().line().c_str());
    benchmark::DoNotOptimize(decoded->columns.size());
  }
}
BENCHMARK(decode_raster)->Unit(benchmark::kMillisecond);

}  // namespace
