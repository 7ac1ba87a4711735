#include "libdensity/voxels/voxel_arrays.h"

#include <gtest/gtest.h>

#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

/// `wide`: of beams that are not thin.
TileVoxels some_voxels(bool wide = false) {
  const auto view = wide ? std::make_shared<const BeamView>(BeamView{{0.01, 0.01, {}}, 0.12, SensorTrack()}) : nullptr;
  // One tile of 25 m, so that some columns belong to others.
  auto accumulator = VoxelAccumulator::create({{10, 20}, 25.0}, std::vector{testing::make_row_segment()}, {},
                                              testing::count_every_ray(), view);
  if (!accumulator || !accumulator->add(testing::random_rays(testing::make_row_segment(), 2000, 9))) return {};
  return std::move(*accumulator).finish();
}

TEST(VoxelArrays, WhatIsStoredComesBack) {
  const TileVoxels before = some_voxels();
  ASSERT_FALSE(before.row_segments.empty());
  const auto after = voxels_from_arrays(arrays_from_voxels(before));
  ASSERT_TRUE(after.has_value()) << after.error().line();
  EXPECT_EQ(after->tile, before.tile);
  EXPECT_EQ(after->pairs, before.pairs);
  ASSERT_EQ(after->row_segments.size(), before.row_segments.size());
  const RowSegmentVoxels &a = before.row_segments[0], &b = after->row_segments[0];
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.entries, b.entries);
  EXPECT_EQ(a.row_segment.origin, b.row_segment.origin);
  EXPECT_EQ(a.row_segment.slope_across, b.row_segment.slope_across);
  EXPECT_EQ(a.row_segment.first_along, b.row_segment.first_along);
  ASSERT_EQ(a.voxels.size(), b.voxels.size());
  EXPECT_EQ(a.voxels, b.voxels);
  EXPECT_EQ(arrays_from_voxels(*after).columns, arrays_from_voxels(before).columns);
}

TEST(VoxelArrays, EchoCountersComeBack) {
  const TileVoxels before = some_voxels(true);
  const auto after = voxels_from_arrays(arrays_from_voxels(before));
  ASSERT_TRUE(after.has_value()) << after.error().line();
  EXPECT_EQ(after->row_segments[0].voxels, before.row_segments[0].voxels);
  ASSERT_FALSE(before.row_segments[0].echoes.empty());
  EXPECT_EQ(after->row_segments[0].echoes, before.row_segments[0].echoes);
}

class VoxelArraysDamage : public ::testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(ThinAndWide, VoxelArraysDamage, ::testing::Bool());

TEST_P(VoxelArraysDamage, IsRecognised) {
  const tile::ArraySet good = arrays_from_voxels(some_voxels(GetParam()));
  const auto expect_damaged = [](const tile::ArraySet& set) {
    const auto result = voxels_from_arrays(set);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, ErrorCode::damaged);
  };
  for (const auto& [name, values] : good.columns) {
    tile::ArraySet missing = good;
    missing.columns.erase(name);
    expect_damaged(missing);
    if (std::visit([](const auto& v) { return v.empty(); }, values)) continue;
    tile::ArraySet shorter = good;
    std::visit([](auto& v) { v.pop_back(); }, shorter.columns[name]);
    expect_damaged(shorter);
  }
  tile::ArraySet kind = good;
  kind.kind = "ground";
  expect_damaged(kind);
  tile::ArraySet version = good;
  version.version = 99;
  expect_damaged(version);
  tile::ArraySet huge = good;
  std::get<std::vector<std::int32_t>>(huge.columns["stretch_ints"])[5] = 2000000000;
  expect_damaged(huge);
  tile::ArraySet hits = good;
  std::get<std::vector<std::uint32_t>>(hits.columns["rays"])
      .assign(std::get<std::vector<std::uint32_t>>(good.columns.at("rays")).size(), 0);
  expect_damaged(hits);
}

}  // namespace
}  // namespace rayfield::density
