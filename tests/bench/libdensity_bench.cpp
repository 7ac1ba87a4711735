/// On the rays of a simulated drive past a hedge: voxel traversal, rays per second and core, by voxel size; estimates,
/// voxels per second.

#include <benchmark/benchmark.h>

#include "libdensity/estimate/row_density.h"
#include "libdensity/voxels/voxel_accumulator.h"
#include "tests/libdensity/hedge_scene.h"

namespace {

using namespace rayfield;
using density::testing::Hedge;
using density::testing::HedgeOptions;

struct World {
  Hedge hedge{HedgeOptions{.length_m = 20, .leaf_area_per_m = 3}};
  tile::SegmentBatch rays = hedge.scan({.everything = true});
};

const World& world() {
  static const World kWorld;
  return kWorld;
}

void count_rays(benchmark::State& state) {
  const double voxel_m = static_cast<double>(state.range(0)) / 100;
  auto accumulator =
      density::VoxelAccumulator::create({{0, -1}, 1000}, world().hedge.row_segments(voxel_m, 0.6, 2.2), {}, {});
  if (!accumulator) {
    state.SkipWithError("no voxels");
    return;
  }
  for (auto _ : state) {
    auto fresh = *accumulator;
    benchmark::DoNotOptimize(fresh.add(world().rays));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(world().rays.size()));
}
BENCHMARK(count_rays)->Arg(6)->Arg(8)->Arg(12)->Arg(24)->Unit(benchmark::kMillisecond);

void estimate(benchmark::State& state) {
  const double voxel_m = 0.08;
  const auto row_segments = world().hedge.row_segments(voxel_m, 0.6, 2.2);
  auto accumulator = density::VoxelAccumulator::create({{0, -1}, 1000}, row_segments, {}, {});
  if (!accumulator || !accumulator->add(world().rays)) {
    state.SkipWithError("no voxels");
    return;
  }
  const density::TileVoxels voxels = std::move(*accumulator).finish();
  std::int64_t count = 0;
  for (auto _ : state) {
    auto builder = density::RowDensityBuilder::create(row_segments.front().row, row_segments, {}, voxels.pairs, {});
    if (!builder || !builder->add(voxels)) state.SkipWithError("no row");
    count = static_cast<std::int64_t>(std::move(*builder).finish().density.size());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * count);
}
BENCHMARK(estimate)->Unit(benchmark::kMillisecond);

}  // namespace
