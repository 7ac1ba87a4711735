#include "rayfield/slam/options.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/core/options/option_members.h"

namespace rayfield::slam {
namespace {

template <class Options>
class EveryOptionsStruct : public ::testing::Test {};
using OptionStructs = ::testing::Types<SurfelOptions, MatchOptions, WindowOptions, PoleOptions,
                                       GlobalRegistrationOptions, GpsOptions, SlamOptions>;
TYPED_TEST_SUITE(EveryOptionsStruct, OptionStructs);

TYPED_TEST(EveryOptionsStruct, NamesEachOfItsMembers) {
  EXPECT_EQ(option_count<TypeParam>(), aggregate_size<TypeParam>());
}

TYPED_TEST(EveryOptionsStruct, HasDefaultsWithinTheirRanges) {
  const auto checked = check_option_ranges(TypeParam(), "cannot use");
  EXPECT_TRUE(checked) << checked.error().line();
}

TEST(SlamOptions, AreValidByDefaultAndHaveDifferentKeys) {
  EXPECT_TRUE(SlamOptions().validate());
  std::set<std::string> keys;
  for (const OptionDescription& d : describe_options<SlamOptions>()) EXPECT_TRUE(keys.insert(d.key).second) << d.key;
  EXPECT_TRUE(keys.count("global.sigma_m") == 1 && keys.count("threads") == 1);
}

void expect_refused(const SlamOptions& options, const std::string& key) {
  const auto result = options.validate();
  ASSERT_FALSE(result) << key;
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().line().find(key), std::string::npos) << result.error().line();
}

TEST(SlamOptions, RefuseValuesThatDoNotGoTogether) {
  SlamOptions o;
  o.match.first_radius_voxels = 0.5;
  expect_refused(o, "match.last_radius_voxels");
  o = {}, o.match.first_cauchy = 0.5;
  expect_refused(o, "match.last_cauchy");
  o = {}, o.window.advance_s = 3;
  expect_refused(o, "window.advance_s");
  o = {}, o.window.advance_s = 1.3;
  expect_refused(o, "window.advance_s");
  o = {}, o.poles.reach_m = 0.45;
  expect_refused(o, "poles.reach_m");
  o = {}, o.global.fine_knots = 200;
  expect_refused(o, "global.coarse_knots");
  o = {}, o.global.revisit_gap_s = o.window.length_s;
  expect_refused(o, "global.revisit_gap_s");
  o = {}, o.window.length_s = 10;
  expect_refused(o, "global.revisit_gap_s");
  o.global.revisit_gap_s = 10.5;
  EXPECT_TRUE(o.validate());
}

TEST(SlamOptions, RefuseValuesOutOfRangeInGroupsAndLists) {
  SlamOptions o;
  o.surfels.voxel_size_m = {0.3, 0.01};
  expect_refused(o, "surfels.voxel_size_m");
  o = {}, o.surfels.voxel_size_m.clear();
  expect_refused(o, "surfels.voxel_size_m");
  o = {}, o.gps.max_residual_m = std::numeric_limits<double>::quiet_NaN();
  expect_refused(o, "gps.max_residual_m");
  o = {}, o.threads = -1;
  expect_refused(o, "threads");
}

}  // namespace
}  // namespace rayfield::slam
