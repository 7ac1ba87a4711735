#include "rayfield/density/voxel_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "libdensity/tiles/derive.h"
#include "libdensity/voxels/row_segment_arrays.h"
#include "libdensity/voxels/voxel_arrays.h"
#include "tests/libdensity/simulated_block.h"

namespace rayfield::density {
namespace {

using testing::Block;
using testing::drive_with;
using testing::take;

constexpr const char* kDate = "2019-11-20";

void done(const Result<void>& result) { EXPECT_TRUE(result) << result.error().line(); }

VoxelCloudOptions options_of(int threads, std::uint64_t memory_bytes = std::uint64_t{1} << 30) {
  return {threads, memory_bytes, std::filesystem::temp_directory_path()};
}

// A scan of two rows in leaf, processed.
class VoxelCloudTest : public ::testing::Test {
 protected:
  void SetUp() override {
    block_.add(kDate, drive_with(0.5, 1));
    ProcessOptions options;
    options.wood.enabled = false;  // leaf areas are of all that is not masked, as the densities are
    block_.process({}, options);
    snapshot_ = block_.snapshot();
  }
  const tile::ScanEntry& scan() const { return *snapshot_.find_scan(kDate); }
  VoxelCloud open(const VoxelCloudOptions& options) {
    Progress progress;
    return take(VoxelCloud::open(block_.store(), scan(), options, progress));
  }
  static DensityPoints all_hits(const VoxelCloud& cloud) {
    DensityPoints all;
    Progress progress;
    done(cloud.for_hits(progress, [&](const DensityPoints& points) -> Result<void> {
      all.position.insert(all.position.end(), points.position.begin(), points.position.end());
      all.time_s.insert(all.time_s.end(), points.time_s.begin(), points.time_s.end());
      all.intensity.insert(all.intensity.end(), points.intensity.begin(), points.intensity.end());
      all.density.insert(all.density.end(), points.density.begin(), points.density.end());
      all.kind.insert(all.kind.end(), points.kind.begin(), points.kind.end());
      return {};
    }));
    return all;
  }

  Block block_;
  tile::Snapshot snapshot_;
};

TEST_F(VoxelCloudTest, TheDensitiesSumToTheAreasOfThePanels) {
  const VoxelCloud cloud = open(options_of(2));
  double plant_m2 = 0, canopy_m2 = 0;
  for (const PanelValue& panel : block_.results(kDate).panel_values)
    plant_m2 += panel.plant_area_m2, canopy_m2 += panel.leaf_area_m2;
  EXPECT_NEAR(cloud.plant_area_m2(), plant_m2, 1e-6 * plant_m2) << "the same estimator on the same counters";
  EXPECT_NEAR(cloud.canopy_area_m2(), canopy_m2, 1e-6 * canopy_m2);
  // What colours are made of. It also fills the part of a column that a post takes, which does not count to the area.
  double sum = 0;
  done(cloud.for_voxels([&sum](std::span<const float> densities) {
    for (const float density : densities)
      if (std::isfinite(density)) sum += static_cast<double>(density);
  }));
  const double voxel_m = block_.process().scans.at(0).voxel_m;
  EXPECT_GE(sum * std::pow(voxel_m, 3), canopy_m2);
}

TEST_F(VoxelCloudTest, EveryHitInTheRowsIsThereOnce) {
  const DensityPoints points = all_hits(open(options_of(2)));
  // Straight from the rays: hits within the grid of any row segment.
  tile::ArraySet arrays;
  for (const tile::DerivedEntry& entry : scan().derived)
    if (entry.kind == "stretches") arrays = take(block_.store().read_derived(entry));
  const RowSegmentList list = take(row_segments_from_arrays(arrays));
  using Hit = std::tuple<double, double, double, double>;
  std::multiset<Hit> expected, found;
  for (const tile::TileEntry& entry : scan().tiles) {
    const auto reader = take(block_.store().open_tile(entry));
    for (std::size_t chunk = 0; chunk < reader.chunk_count(); ++chunk) {
      tile::SegmentBatch rays;
      done(reader.read_chunk(chunk, rays));
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if ((rays.flags[i] & tile::kHit) == 0 || (rays.flags[i] & tile::kEndsHere) == 0) continue;
        const Eigen::Vector3d& p = rays.exit[i];
        for (const RowSegment& s : list.row_segments) {
          const Eigen::Vector2d from = p.head<2>() - s.origin;
          const double along = from.dot(s.direction), across = s.direction.x() * from.y() - s.direction.y() * from.x();
          const double up = p.z() - s.ground_m - s.slope_along * along - s.slope_across * across;
          if (along < 0 || along > s.n_along * s.voxel_m || across < s.across_min_m || up < s.up_min_m ||
              across > s.across_min_m + s.n_across * s.voxel_m || up > s.up_min_m + s.n_up * s.voxel_m)
            continue;
          expected.emplace(p.x(), p.y(), p.z(), rays.time_s[i]);
          break;
        }
      }
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    found.emplace(points.position[i].x(), points.position[i].y(), points.position[i].z(), points.time_s[i]);
  ASSERT_GT(found.size(), 10000U);
  EXPECT_TRUE(found == expected) << found.size() << " found, " << expected.size() << " expected";
}

TEST_F(VoxelCloudTest, HitsOnPostsAndTrunksHaveNoDensityAndAllOthersNoneBelowNothing) {
  const DensityPoints points = all_hits(open(options_of(2)));
  std::size_t wood = 0, known = 0, canopy = 0;
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.kind[i] == PointKind::wood) {
      ++wood;
      EXPECT_TRUE(std::isnan(points.density[i]));
      continue;
    }
    ++canopy;
    if (!std::isfinite(points.density[i])) continue;
    ++known;
    sum += static_cast<double>(points.density[i]);
  }
  EXPECT_GT(wood, 100U);
  EXPECT_GT(static_cast<double>(known), 0.99 * static_cast<double>(canopy));
  EXPECT_GT(sum / static_cast<double>(known), 1) << "hits lie where leaves are";
}

TEST_F(VoxelCloudTest, IsTheSameAtAnyNumberOfThreadsAndInLittleMemory) {
  const DensityPoints one = all_hits(open(options_of(1, std::uint64_t{256} << 20))),
                      three = all_hits(open(options_of(3)));
  ASSERT_EQ(one.size(), three.size());
  EXPECT_EQ(one.position, three.position);
  EXPECT_EQ(one.time_s, three.time_s);
  for (std::size_t i = 0; i < one.size(); ++i)
    ASSERT_TRUE(one.density[i] == three.density[i] || (std::isnan(one.density[i]) && std::isnan(three.density[i])));
}

TEST_F(VoxelCloudTest, TakesTheOptionsThatTheScanWasProcessedWith) {
  ProcessOptions paper;
  paper.estimator.estimator = Estimator::paper;
  block_.process({}, paper);
  snapshot_ = block_.snapshot();
  double plant_m2 = 0;
  for (const PanelValue& panel : block_.results(kDate).panel_values) plant_m2 += panel.plant_area_m2;
  EXPECT_NEAR(open(options_of(2)).plant_area_m2(), plant_m2, 1e-6 * plant_m2);
}

class Cancelled : public Progress {
 public:
  bool cancelled() const override { return true; }
};

TEST_F(VoxelCloudTest, StopsWhenAskedToAndPassesOnErrors) {
  Cancelled cancelled;
  const auto stopped = VoxelCloud::open(block_.store(), scan(), options_of(2), cancelled);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::interrupted);
  const VoxelCloud cloud = open(options_of(2));
  const auto nothing = [](const DensityPoints&) -> Result<void> { return {}; };
  EXPECT_EQ(cloud.for_hits(cancelled, nothing).error().code, ErrorCode::interrupted);
  Progress progress;
  const auto full = [](const DensityPoints&) -> Result<void> { return fail(ErrorCode::resources, "full", "", ""); };
  EXPECT_EQ(cloud.for_hits(progress, full).error().code, ErrorCode::resources);
}

TEST_F(VoxelCloudTest, AScanThatWasNotProcessedIsRefused) {
  block_.add("2019-12-20", drive_with(0.5, 1));
  snapshot_ = block_.snapshot();
  Progress progress;
  const auto cloud = VoxelCloud::open(block_.store(), *snapshot_.find_scan("2019-12-20"), options_of(1), progress);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::density
