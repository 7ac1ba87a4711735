#include "libdensity/voxels/canopy_profile_arrays.h"

#include <gtest/gtest.h>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::BlockShape;
using testing::exact_ground;
using testing::Scene;
using testing::two_rows;

TEST(CanopyProfile, SurvivesStorage) {
  Scene scene(45);
  BlockShape block;
  const RowLayout layout = two_rows(block, 3.0);
  const GroundModel ground = exact_ground([](double, double) { return 100.0; });
  scene.add_canopy(block, 0, 0, 1, 50);
  const CanopyProfile profile = testing::profile_of(scene.tiles(), layout, ground, {});
  const auto back = profile_from_arrays(profile_to_arrays(profile));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->across, profile.across);
  EXPECT_EQ(back->up, profile.up);
}

}  // namespace
}  // namespace rayfield::density
