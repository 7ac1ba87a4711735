#include "rayfield/density/options.h"

#include <gtest/gtest.h>

#include "rayfield/density/comparison.h"
#include "rayfield/density/findings.h"
#include "rayfield/density/missing_rays.h"
#include "rayfield/density/zones.h"
#include "tests/core/options/option_members.h"

namespace rayfield::density {
namespace {

template <class Options>
class EveryOptionOf : public ::testing::Test {};
using AllOptions =
    ::testing::Types<SurveyOptions, GroundOptions, CanopyMapOptions, PassOptions, RowOptions, PostOptions,
                     RegistryOptions, RowSegmentOptions, VoxelFitOptions, LeafAngles, VoxelOptions, EstimatorOptions,
                     IntegrationOptions, PlanRasterOptions, LeafOptions, DescriptorOptions, WoodPriorOptions,
                     MissingRayOptions, GapOptions, ComparisonOptions, ZoneOptions>;
TYPED_TEST_SUITE(EveryOptionOf, AllOptions);

TYPED_TEST(EveryOptionOf, TheStructIsVisitedAndItsDefaultIsValid) {
  EXPECT_EQ(option_count<TypeParam>(), aggregate_size<TypeParam>());
  EXPECT_TRUE(TypeParam{}.validate().has_value());
  for (const OptionDescription& option : describe_options<TypeParam>())
    EXPECT_FALSE(option.meaning.empty()) << option.key;
}

TEST(ProcessOptions, VisitAllGroupsButNotWhatChangesNoResult) {
  EXPECT_EQ(option_count<ProcessOptions>() + 4,
            aggregate_size<ProcessOptions>());  // dates, redo, threads, memory_bytes
  EXPECT_TRUE(ProcessOptions{}.validate().has_value());
}

TEST(ProcessOptions, RefuseValuesOutOfRangeInAnyGroup) {
  ProcessOptions options;
  options.rows.passes.spacing_m = 0;
  ASSERT_FALSE(options.validate().has_value());
  EXPECT_EQ(options.validate().error().code, ErrorCode::usage);
  EXPECT_EQ(options.validate().error().where, "rows.passes.spacing_m");
  for (const char* key : {"survey.ground_cell_m", "ground.halo_m", "canopy.cell_m", "posts.cell_m", "segments.voxel_m",
                          "voxel_fit.leaf_sides", "voxels.leaf_angles.ellipsoid_ratio", "estimator.paper_min_rays",
                          "integration.metre_step_m", "plan.cell_m"}) {
    ProcessOptions fresh;
    EXPECT_EQ(set_option(fresh, key, 0.0, "test").error().code, ErrorCode::usage) << key;
  }
  EXPECT_EQ(set_option(options, "integration.height_share", 1.2, "test").error().code, ErrorCode::usage);
  EXPECT_EQ(set_option(options, "estimator.leaf_size_m2", 0.06, "test").error().code, ErrorCode::usage);
}

TEST(ProcessOptions, RefuseValuesThatDoNotFitTogether) {
  ProcessOptions heights, posts, panels, tops, sizes, zone;
  heights.canopy.tall_min_m = 2;
  posts.posts.low_max_m = 0.35;
  panels.posts.max_panel_m = 2;
  tops.segments.max_height_m = 0.8;
  sizes.voxel_fit.min_m = 0.13;
  zone.descriptors.fruit_zone_low_m = 1.3;
  for (const ProcessOptions& options : {heights, posts, panels, tops, sizes, zone})
    EXPECT_EQ(options.validate().error().code, ErrorCode::usage);
}

TEST(OptionNumbers, KeepTheOrderThatNamesStoredFiles) {
  EXPECT_EQ(option_numbers(RowOptions{}),
            (std::vector<double>{0.5, 6, 12, 3, 0.5, 2.6, 0.3, 6, 5, 0.5, 0.25, 0.3, 0.5, 12}));
  EXPECT_EQ(option_numbers(VoxelOptions{}), (std::vector<double>{7, 1, 0.045, 30, 0.02}));
  EXPECT_EQ(option_numbers(IntegrationOptions{}), (std::vector<double>{0.97, 0.96, 0.5, 0.025, 0.5}));
  EXPECT_EQ(option_numbers(RowSegmentOptions{}),
            (std::vector<double>{0.08, 38, 0.3, 0.02, 0.98, 0.97, 2, 0.24, 0.6, 4, 1.5}));
}

TEST(Choices, AreParsedByNameAndUnknownNamesAreRefused) {
  for (const auto& [name, type] : kLeafAngleTypes) EXPECT_EQ(parse_leaf_angle_type(name).value(), type);
  for (const auto& [name, estimator] : kEstimators) EXPECT_EQ(parse_estimator(name).value(), estimator);
  EXPECT_EQ(parse_leaf_angle_type("flat").error().code, ErrorCode::usage);
  EXPECT_EQ(parse_estimator("best").error().code, ErrorCode::usage);
}

TEST(VoxelSize, ChangesWithAboutTheSameLengthOfRowSegments) {
  const RowSegmentOptions options = with_voxel_size({}, 0.12);
  EXPECT_EQ(options.voxel_m, 0.12);
  EXPECT_NEAR(options.voxels_per_segment * 0.12, 38 * 0.08, 0.06);
}

}  // namespace
}  // namespace rayfield::density
