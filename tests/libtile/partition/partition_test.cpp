#include <unistd.h>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

/// Tile files of a scan by name, with their bytes.
std::map<std::string, std::string> tile_files(const Store& store) {
  std::map<std::string, std::string> files;
  const Snapshot snapshot = *store.latest();
  for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
    files[tile.file.path] = file_text(store.folder() / tile.file.path);
    for (const FileEntry& file : tile.more_files) files[file.path] = file_text(store.folder() / file.path);
  }
  return files;
}

TEST(Partition, TileFilesAreTheSameAtAnyNumberOfThreads) {
  ScratchFolder folder;
  const RayBatch rays = simulated_drive(400000);
  std::map<std::string, std::string> first;
  for (const int threads : {1, 2, 4}) {
    Store store = make_store(folder.path() / std::to_string(threads));
    AddOptions options = add_options();
    options.threads = threads;
    ASSERT_TRUE(add(store, rays, options));
    if (threads == 1) first = tile_files(store);
    EXPECT_EQ(tile_files(store), first) << threads << " threads";
  }
}

TEST(Partition, TileFilesDependNeitherOnMemoryNorOnHowTheSourceCutsItsBatches) {
  ScratchFolder folder;
  const RayBatch rays = scattered_rays(1200000, 200);  // more records than the smallest buffers hold
  Store small = make_store(folder.path() / "small"), large = make_store(folder.path() / "large");
  ASSERT_TRUE(add(small, rays));
  MemorySource source(rays);
  source.most_at_once = 1777;
  source.knows_count = false;
  AddOptions options = add_options();
  options.memory_bytes = std::uint64_t{2} << 30;
  Progress progress;
  ASSERT_TRUE(large.add(source, options, progress));
  EXPECT_EQ(source.rewinds, 0) << "one reading is enough";
  EXPECT_EQ(tile_files(small), tile_files(large));
}

TEST(Partition, RaysInRandomOrderKeepTheirOrderWithinEachTile) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  ASSERT_TRUE(add(store, scattered_rays(1200000, 200)));
  const Snapshot snapshot = *store.latest();
  std::uint64_t starts = 0;
  for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
    const SegmentBatch batch = read_tile(store, tile);
    EXPECT_TRUE(std::is_sorted(batch.time_s.begin(), batch.time_s.end()));
    starts += static_cast<std::uint64_t>(
        std::count_if(batch.flags.begin(), batch.flags.end(), [](std::uint8_t f) { return (f & kStartsHere) != 0; }));
  }
  EXPECT_EQ(starts, 1200000U);
}

TEST(Partition, ADenseTileIsSpreadOverSeveralFilesAndReadsAsOne) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  const std::size_t count = 1048576 + 131072 + 5;  // one full file, one full chunk and a rest
  RayBatch rays;
  rays.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d origin(kEast + 5, kNorth + 10, 80);
    rays.push(origin,
              origin + Eigen::Vector3d(1e-3 * static_cast<double>(i % 1000), 0.5, 1e-3 * static_cast<double>(i / 1000)),
              1e-4 * static_cast<double>(i), 0, false);
  }
  ASSERT_TRUE(add(store, rays));
  const Snapshot snapshot = *store.latest();
  ASSERT_EQ(snapshot.scans.at(0).tiles.size(), 1U);
  const TileEntry& tile = snapshot.scans[0].tiles[0];
  EXPECT_EQ(tile.more_files.size(), 1U);
  EXPECT_EQ(tile.segment_count, count);
  const SegmentBatch batch = read_tile(store, tile);
  ASSERT_EQ(batch.size(), count);
  for (std::size_t i = 0; i < count; i += 997) {
    EXPECT_NEAR(batch.time_s[i], rays.time_s[i], 1e-6);
    EXPECT_NEAR((batch.exit[i] - rays.end[i]).norm(), 0, 2e-4);
  }
  EXPECT_TRUE(damage_of(store).empty());
}

// Rays made as they are asked for, so that the test itself holds none.
class EndlessDrive : public RaySource {
 public:
  explicit EndlessDrive(std::size_t count) : count_(count) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    for (; batch.size() < max_rays && next_ < count_; ++next_) {
      state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
      const double a = static_cast<double>(state_ >> 40U) / 16777216.0,
                   b = static_cast<double>((state_ >> 16U) & 0xFFFFFFU) / 16777216.0;
      const Eigen::Vector3d origin(kEast + 300 * a, kNorth + 300 * b, 80);
      batch.push(origin, origin + Eigen::Vector3d(8 * b - 4, 8 * a - 4, a), 1e-4 * static_cast<double>(next_), 0, true);
    }
    return batch.size();
  }
  Result<bool> rewind() override { return false; }
  std::string name() const override { return "drive"; }

 private:
  std::size_t count_, next_ = 0;
  std::uint64_t state_ = 1;
};

std::uint64_t status_kilobytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(key + ":", 0) == 0) return std::stoull(line.substr(key.size() + 1));
  }
  return 0;
}

TEST(Partition, MemoryStaysWithinTheBoundWhateverTheNumberOfRays) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep memory of their own";
#endif
  ScratchFolder folder;
  const std::uint64_t bound = std::uint64_t{128} << 20;
  for (const std::size_t count : {std::size_t{1500000}, std::size_t{4500000}}) {
    Store store = make_store(folder.path() / std::to_string(count));
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak starts anew
    const std::uint64_t before = status_kilobytes("VmRSS");
    if (status_kilobytes("VmHWM") > before + 4096) GTEST_SKIP() << "this kernel does not reset the peak of memory";
    EndlessDrive drive(count);
    AddOptions options = add_options();
    options.memory_bytes = bound;
    Progress progress;
    ASSERT_TRUE(store.add(drive, options, progress));
    EXPECT_LE((status_kilobytes("VmHWM") - before) << 10U, bound) << count << " rays";
    fs::remove_all(store.folder());
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
