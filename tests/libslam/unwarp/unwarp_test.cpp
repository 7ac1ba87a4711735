#include "rayfield/slam/unwarp.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/libslam/synthetic_scene.h"

namespace rayfield::slam {
namespace {

using testing::SceneOptions;
using testing::true_trajectory;

TEST(UnwarpedSource, StreamsTheSameRaysAgainAfterRewindAndEndsEarlyWithoutHanging) {
  const SceneOptions scene = testing::short_scene(6, 1);
  const Rig rig = testing::scene_rig();
  const auto truth = std::make_shared<Trajectory>(true_trajectory(1, 6));
  const LogReader read = [&](SensorSink& sink) -> Result<void> {
    testing::feed_scene(sink, rig, scene);
    return {};
  };
  const auto source = open_unwarped(read, rig, truth, {}, "scene");
  const auto total = [&] {
    RayBatch batch;
    std::size_t sum = 0;
    double check = 0;
    while (true) {
      const auto n = source->read(batch, 10007);
      EXPECT_TRUE(n);
      if (!n || *n == 0) return std::pair(sum, check);
      sum += *n;
      for (const Eigen::Vector3d& e : batch.end) check += e.sum();
    }
  };
  const auto first = total();
  EXPECT_GT(first.first, 50000u);
  ASSERT_TRUE(source->rewind());
  EXPECT_EQ(total(), first);
  ASSERT_TRUE(source->rewind());
  RayBatch batch;
  ASSERT_TRUE(source->read(batch, 100));  // and the destructor ends the thread
}

TEST(UnwarpedSource, PassesOnTheErrorOfTheLog) {
  const auto truth = std::make_shared<Trajectory>(true_trajectory(1, 6));
  const LogReader read = [](SensorSink&) -> Result<void> {
    return fail(ErrorCode::bad_input, "cannot read log", "x.bag", "not a bag");
  };
  const auto source = open_unwarped(read, testing::scene_rig(), truth, {}, "x.bag");
  RayBatch batch;
  const auto n = source->read(batch, 100);
  ASSERT_FALSE(n);
  EXPECT_EQ(n.error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield::slam
