/// Voxel traversal on the rays of a simulated drive past a hedge: rays per second and core, by voxel size.

#include <benchmark/benchmark.h>

#include "libdensity/hedge_scene.h"
#include "rayfield/density/estimator.h"
#include "rayfield/density/voxel_grid.h"

namespace {

using namespace rayfield;
using density::testing::Hedge;
using density::testing::HedgeOptions;

struct World {
  Hedge hedge{HedgeOptions{.length_m = 20, .leaf_area_per_m = 3}};
  tile::SegmentBatch rays = hedge.scan({.everything = true});
};

const World& world() {
  static const World w;
  return w;
}

void count_rays(benchmark::State& state) {
  const double voxel_m = static_cast<double>(state.range(0)) / 100;
  auto accumulator =
      density::VoxelAccumulator::create({0, -1}, 1000, world().hedge.stretches(voxel_m, 0.6, 2.2), {}, {});
  if (!accumulator) {
    state.SkipWithError("no voxels");
    return;
  }
  for (auto _ : state) {
    auto fresh = accumulator->fork();
    benchmark::DoNotOptimize(fresh.add(world().rays));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(world().rays.size()));
}
BENCHMARK(count_rays)->Arg(6)->Arg(8)->Arg(12)->Arg(24)->Unit(benchmark::kMillisecond);

void estimate(benchmark::State& state) {
  density::VoxelCounters v;
  v.rays = 40, v.hits = 12;
  v.path = 20 << 25, v.path2 = 16 << 25, v.path3 = 14 << 25, v.hit_path = 5 << 25, v.hit_path2 = 3 << 25,
  v.hit_path3 = 2 << 25;
  const auto leaf = density::LeafCorrection::of(0.006, 0.08);
  for (auto _ : state) benchmark::DoNotOptimize(density::estimate_voxel(v, 0.08, leaf));
}
BENCHMARK(estimate);

}  // namespace
