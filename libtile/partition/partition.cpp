#include "libtile/partition/partition.h"

#include "libtile/partition/pipeline.h"
#include "libtile/partition/record_arena.h"

namespace rayfield::tile {
namespace {

// Errors where the rays are such that no map can come of them.
Result<void> check_rays(const RayStatistics& statistics, const std::string& name) {
  if (statistics.rays == 0 && statistics.dropped() == 0)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name, "it holds no rays", "give a cloud with rays in it");
  if (statistics.rays == 0)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name,
                "none of its rays is usable (coordinates are not finite, out of range, or rays are over 5 km long)",
                "check the cloud and its CRS");
  if (!statistics.any_length)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name,
                "all rays have zero length: the cloud does not say where rays start",
                "give a ray cloud, in which nx ny nz lead from the point to the sensor");
  if (statistics.rays > 1 && statistics.all_identical)
    return fail(ErrorCode::bad_input, "cannot tile the scan", name, "all rays are identical", "check the cloud");
  return {};
}

}  // namespace

Result<PartitionResult> partition(RaySource& rays, const TileGrid& grid, const PartitionOptions& options,
                                  SpillFile& spill, const TileOutput::WriteFile& write_file, Progress& progress) {
  RAYFIELD_ASSIGN(RecordArena arena, RecordArena::create(MemoryPlan(options).arena_bytes));
  TileOutput output(grid, spill, MemoryPlan(options).chunk_bytes, write_file);
  Pipeline pipeline(rays, grid, options, spill, arena, output, progress);
  progress.stage("tiling", rays.ray_count().value_or(0), "rays");
  RAYFIELD_CHECK(pipeline.run());
  PartitionResult result;
  result.statistics = pipeline.statistics();
  RAYFIELD_CHECK(check_rays(result.statistics, rays.name()));
  RAYFIELD_ASSIGN(result.tiles, pipeline.finish());
  return result;
}

}  // namespace rayfield::tile
