#include "libdensity/tiles/chunks.h"
#include "rayfield/density/canopy_map.h"

namespace rayfield::density {

Result<CanopyTile> canopy_of_tile(const tile::Store::TileReader& reader, tile::TileIndex index, double tile_size_m,
                                  const GroundModel& ground, const CanopyMapOptions& options, int threads) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(const CanopyAccumulator sum,
                  accumulate_chunks(reader, CanopyAccumulator(index, tile_size_m, ground, options), threads));
  return sum.finish();
}

}  // namespace rayfield::density
