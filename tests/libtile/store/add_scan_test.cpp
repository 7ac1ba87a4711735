#include <gmock/gmock.h>

#include <limits>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Add : public ::testing::Test {
 protected:
  ScratchFolder folder_;
  Store store_ = make_store(folder_.path() / "block");
};

TEST_F(Add, AScanIsPublishedWithItsCountsTimesAndBounds) {
  const RayBatch rays = simulated_drive(5000);
  const auto report = add(store_, rays);
  ASSERT_TRUE(report) << report.error().line();
  const auto hits = static_cast<std::uint64_t>(std::count(rays.hit.begin(), rays.hit.end(), 1));
  EXPECT_EQ(report->scan_id, "2019-02-11");
  EXPECT_EQ(report->ray_count, 5000U);
  EXPECT_EQ(report->hit_count, hits);
  EXPECT_FALSE(report->already_there);

  const Snapshot snapshot = *store_.latest();
  EXPECT_EQ(snapshot.number, 1U);
  EXPECT_EQ(snapshot.parent, 0U);
  EXPECT_EQ(snapshot.command, "rayfield add");
  const ScanEntry& scan = snapshot.scans.at(0);
  EXPECT_EQ(scan.ray_count, 5000U);
  EXPECT_NEAR(scan.start_time_s, rays.time_s.front(), 1e-6);
  EXPECT_NEAR(scan.end_time_s, rays.time_s.back(), 1e-6);
  Eigen::AlignedBox3d origins;
  for (const auto& origin : rays.origin) origins.extend(origin);
  EXPECT_TRUE(scan.origin_bounds.min().isApprox(origins.min(), 1e-9));
  EXPECT_TRUE(scan.origin_bounds.max().isApprox(origins.max(), 1e-9));

  std::uint64_t starts = 0, tile_hits = 0, segments = 0, bytes = 0;
  for (const TileEntry& tile : scan.tiles) {
    starts += tile.start_count, tile_hits += tile.hit_count, segments += tile.segment_count, bytes += tile.file.size;
    EXPECT_EQ(fs::file_size(store_.folder() / tile.file.path), tile.file.size);
    Eigen::AlignedBox3d bounds;
    const SegmentBatch batch = read_tile(store_, tile);
    for (std::size_t i = 0; i < batch.size(); ++i) bounds.extend(batch.entry[i]), bounds.extend(batch.exit[i]);
    EXPECT_EQ(batch.size(), tile.segment_count);
    EXPECT_TRUE(bounds.min().isApprox(tile.bounds.min(), 1e-9) && bounds.max().isApprox(tile.bounds.max(), 1e-9));
  }
  EXPECT_EQ(starts, 5000U);
  EXPECT_EQ(tile_hits, hits);
  EXPECT_EQ(segments, report->segment_count);
  EXPECT_EQ(bytes, report->bytes_written);
  EXPECT_TRUE(std::is_sorted(scan.tiles.begin(), scan.tiles.end(),
                             [](const TileEntry& a, const TileEntry& b) { return a.index < b.index; }));
}

TEST_F(Add, SegmentsOfATileStandInTheOrderOfTheScan) {
  ASSERT_TRUE(add(store_, simulated_drive(300000)));
  const Snapshot snapshot = *store_.latest();
  for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
    const SegmentBatch batch = read_tile(store_, tile);
    EXPECT_TRUE(std::is_sorted(batch.time_s.begin(), batch.time_s.end()));
  }
}

TEST_F(Add, TimesComeBackToTheMicrosecond) {
  const RayBatch rays = simulated_drive(2000);
  ASSERT_TRUE(add(store_, rays));
  const Snapshot snapshot = *store_.latest();
  std::vector<double> starts;
  for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
    const SegmentBatch batch = read_tile(store_, tile);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if ((batch.flags[i] & kStartsHere) != 0) starts.push_back(batch.time_s[i]);
    }
  }
  std::sort(starts.begin(), starts.end());
  ASSERT_EQ(starts.size(), rays.size());
  for (std::size_t i = 0; i < starts.size(); ++i) EXPECT_NEAR(starts[i], rays.time_s[i], 0.75e-6);
}

TEST_F(Add, RaysThatCannotBeAreDroppedAndCounted) {
  RayBatch rays = simulated_drive(100);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  rays.origin[3].x() = nan;
  rays.end[4].z() = inf;
  rays.time_s[5] = nan;
  rays.end[6].x() = 2e8;
  rays.origin[7].y() = -1e300;
  rays.origin[8].z() = 2e5;
  rays.end[9].x() += 6000;
  const auto report = add(store_, rays);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->ray_count, 93U);
  EXPECT_EQ(report->dropped, 7U);
  EXPECT_THAT(report->warnings,
              ElementsAre(HasSubstr("3 rays dropped"), HasSubstr("3 rays dropped"), HasSubstr("1 rays dropped")));
  EXPECT_EQ(store_.latest()->scans.at(0).warnings, report->warnings);
}

TEST_F(Add, WarningsOfTheSourceAreKept) {
  MemorySource source(simulated_drive(100));
  source.source_warnings = {"2 rays without a time left out"};
  Progress progress;
  const auto report = store_.add(source, add_options(), progress);
  ASSERT_TRUE(report);
  EXPECT_THAT(report->warnings, ElementsAre("2 rays without a time left out"));
}

TEST_F(Add, RaysFromWhichNoMapCanComeAreRefusedAndNothingIsPublished) {
  const auto expect_refused = [&](const RayBatch& rays, const std::string& why) {
    const auto report = add(store_, rays);
    ASSERT_FALSE(report) << why;
    EXPECT_EQ(report.error().code, ErrorCode::bad_input);
    EXPECT_THAT(report.error().line(), HasSubstr(why));
    EXPECT_EQ(store_.latest()->number, 0U);
  };
  RayBatch rays;
  expect_refused(rays, "no rays");
  const Eigen::Vector3d here(kEast, kNorth, 80), there(kEast + 3, kNorth, 81);
  for (int i = 0; i < 50; ++i) rays.push(here, there, i, 1, true);
  expect_refused(rays, "all rays are identical");
  rays.clear();
  for (int i = 0; i < 50; ++i) rays.push(here + i * there.normalized(), here + i * there.normalized(), i, 1, true);
  expect_refused(rays, "zero length");
  rays.clear();
  for (int i = 0; i < 50; ++i) rays.push(here, Eigen::Vector3d::Constant(std::nan("")), i, 1, true);
  expect_refused(rays, "none of its rays is usable");
}

TEST_F(Add, ASingleRayIsAScan) {
  RayBatch rays;
  rays.push({kEast, kNorth, 80}, {kEast + 1, kNorth, 80}, kTime, 1, true);
  const auto report = add(store_, rays);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->ray_count, 1U);
}

TEST_F(Add, RaysAllOverTheMapAreRefusedBeforeTheyExhaustMemory) {
  RayBatch rays;
  for (int i = 0; i < 230000; ++i) {
    const Eigen::Vector3d origin(1e3 * i, 1e3, 0);
    rays.push(origin, origin + Eigen::Vector3d(1, 1, 1), i, 0, false);
    if (i >= 99000)
      rays.origin.back() = Eigen::Vector3d(1e3 * (i - 99000), 9e7, 0),
      rays.end.back() = rays.origin.back() + Eigen::Vector3d::Ones();
  }
  const auto report = add(store_, rays);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::bad_input);
  EXPECT_THAT(report.error().line(), HasSubstr("spread"));
}

TEST_F(Add, TheSameInputsAgainChangeNothing) {
  ASSERT_TRUE(add(store_, simulated_drive(1000)));
  const auto before = contents(store_.folder());
  const auto again = add(store_, simulated_drive(1000));
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_TRUE(again->already_there);
  EXPECT_EQ(again->ray_count, 1000U);
  EXPECT_EQ(contents(store_.folder()), before);
}

TEST_F(Add, AnotherScanOfTheSameDateNeedsANameOrOverwrite) {
  ASSERT_TRUE(add(store_, simulated_drive(1000)));
  AddOptions options = add_options();
  options.inputs[0].sha256 = std::string(64, 'b');
  const auto refused = add(store_, simulated_drive(1000, 2), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().line(), HasSubstr("--overwrite"));

  options.name = "after rain/2";
  const auto named = add(store_, simulated_drive(1000, 2), options);
  ASSERT_TRUE(named) << named.error().line();
  EXPECT_EQ(named->scan_id, "2019-02-11_after-rain-2");

  options.name.clear();
  options.overwrite = true;
  const auto overwritten = add(store_, simulated_drive(900, 3), options);
  ASSERT_TRUE(overwritten) << overwritten.error().line();
  const Snapshot snapshot = *store_.latest();
  EXPECT_EQ(snapshot.number, 3U);
  ASSERT_EQ(snapshot.scans.size(), 2U);
  EXPECT_EQ(snapshot.find_scan("2019-02-11")->ray_count, 900U);
  EXPECT_TRUE(damage_of(store_).empty()) << "the older snapshots keep their own files";
}

TEST_F(Add, ScansAreOrderedByDate) {
  for (const char* date : {"2019-02-11", "2018-12-12", "2019-01-07"})
    ASSERT_TRUE(add(store_, simulated_drive(500), add_options(date)));
  std::vector<std::string> dates;
  const Snapshot snapshot = *store_.latest();
  for (const ScanEntry& scan : snapshot.scans) dates.push_back(scan.date);
  EXPECT_THAT(dates, ElementsAre("2018-12-12", "2019-01-07", "2019-02-11"));
  EXPECT_EQ(store_.history()->size(), 3U);
}

TEST_F(Add, WrongOptionsAreUsageErrors) {
  for (const char* date : {"", "11.2.2019", "2019-02-30", "../2019"}) {
    const auto report = add(store_, simulated_drive(10), add_options(date));
    ASSERT_FALSE(report) << date;
    EXPECT_EQ(report.error().code, ErrorCode::usage) << date;
  }
  AddOptions options = add_options();
  options.name = "...";
  EXPECT_EQ(add(store_, simulated_drive(10), options).error().code, ErrorCode::usage);
  options = add_options();
  options.memory_bytes = 1000;
  EXPECT_EQ(add(store_, simulated_drive(10), options).error().code, ErrorCode::usage);
}

TEST_F(Add, AnErrorOfTheSourceComesThroughAndNothingIsPublished) {
  const auto before = contents(store_.folder());
  MemorySource source(simulated_drive(1000));
  source.most_at_once = 100;
  source.fail_after = 500;
  Progress progress;
  const auto report = store_.add(source, add_options(), progress);
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().line(), HasSubstr("made to fail"));
  EXPECT_EQ(contents(store_.folder()), before);
}

TEST_F(Add, AnInterruptedScanLeavesTheStoreAsItWasAndRunsAgain) {
  class Impatient : public Progress {
   public:
    bool cancelled() const override { return true; }
  } impatient;
  MemorySource source(simulated_drive(1000));
  const auto report = store_.add(source, add_options(), impatient);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::interrupted);
  EXPECT_EQ(store_.latest()->number, 0U);
  EXPECT_TRUE(add(store_, simulated_drive(1000)));
}

TEST_F(Add, ADriveTakesAtMostTwentyBytesPerRay) {
  const auto report = add(store_, simulated_drive(400000));
  ASSERT_TRUE(report);
  EXPECT_LE(static_cast<double>(report->bytes_written) / static_cast<double>(report->ray_count), 20.0);
}

TEST_F(Add, FilesAreKeptWithTheScanAndReadBack) {
  AddOptions options = add_options();
  const std::string report(3000, 'r');
  options.attachments = {{"trajectory.tum.bz2", std::string("t\0x", 3)}, {"slam.json", report}};
  const auto added = add(store_, simulated_drive(1000), options);
  ASSERT_TRUE(added) << added.error().line();
  const Snapshot snapshot = *store_.latest();
  const auto& attachments = snapshot.scans.at(0).attachments;
  ASSERT_EQ(attachments.size(), 2U);
  EXPECT_EQ(attachments[0].name, "slam.json") << "ordered by name";
  EXPECT_EQ(*store_.read_attachment(attachments[0]), report);
  EXPECT_EQ(*store_.read_attachment(attachments[1]), std::string("t\0x", 3));
  EXPECT_TRUE(attachments[1].file.path.starts_with("scans/2019-02-11/files/trajectory.")) << attachments[1].file.path;
  EXPECT_TRUE(attachments[1].file.path.ends_with(".tum.bz2"));
  std::uint64_t bytes = 0;
  for (const FileEntry* file : snapshot.files()) bytes += file->size;
  EXPECT_EQ(added->bytes_written, bytes) << "they count";

  EXPECT_TRUE(store_.gc({})->files.empty()) << "they are named";
  flip_bit(store_.folder() / attachments[0].file.path, 5);
  const auto damage = damage_of(store_);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_EQ(damage[0].path, attachments[0].file.path);
  EXPECT_EQ(store_.read_attachment(attachments[0]).error().code, ErrorCode::damaged);
}

TEST_F(Add, FilesWithNamesThatLeaveTheFolderOrOccurTwiceAreRefused) {
  for (const auto& names : std::vector<std::vector<std::string>>{{"../a"}, {"a/b"}, {""}, {".a"}, {"a", "a"}}) {
    AddOptions options = add_options();
    for (const std::string& name : names) options.attachments.push_back({name, "x"});
    EXPECT_FALSE(add(store_, simulated_drive(10), options)) << names[0];
  }
  EXPECT_EQ(store_.latest()->number, 0U);
}

TEST(AddScan, AScanThatCannotFitIsRefusedBeforeAnyWork) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  class Huge : public MemorySource {
   public:
    Huge() : MemorySource(simulated_drive(10)) {}
    std::optional<std::uint64_t> ray_count() const override { return std::uint64_t{1} << 60U; }
    Result<std::size_t> read(RayBatch& batch, std::size_t most) override {
      was_read = true;
      return MemorySource::read(batch, most);
    }
    bool was_read = false;
  } huge;
  Progress progress;
  const auto report = store.add(huge, add_options(), progress);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::resources);
  EXPECT_FALSE(huge.was_read);
}

// As a drive in other units does; a block of 100 ha has 1600 tiles.
TEST(AddScan, AScanAllOverTheMapIsWarnedOf) {
  ScratchFolder folder(fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path());
  StoreConfig config = test_config();
  config.tile_size_m = 5;
  Store store = make_store(folder.path() / "block", config);
  RayBatch rays;
  for (int tile = 0; tile < 101 * 101; ++tile) {
    const Eigen::Vector3d origin(276202 + 5.0 * (tile % 101), 6099942 + 5.0 * (tile / 101), 80);
    rays.push(origin, origin + Eigen::Vector3d(0.5, 0.5, -1), kTime, 1, true);
  }
  const auto report = add(store, rays);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->tile_count, 10201U);
  EXPECT_THAT(report->warnings, ::testing::ElementsAre(::testing::HasSubstr("10201 tiles of 5 m, 0.3 km²")));
}

}  // namespace
}  // namespace rayfield::tile::testing
