#include "libdensity/tiles/chunks.h"
#include "rayfield/density/row_segments.h"

namespace rayfield::density {

Result<CanopyProfile> canopy_profile_of_tile(const tile::Store::TileReader& reader, tile::TileIndex index,
                                             double tile_size_m, const RowLayout& layout, const GroundModel& ground,
                                             const RowSegmentOptions& options, int threads) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(
      const CanopyProfileAccumulator sum,
      accumulate_chunks(reader, CanopyProfileAccumulator(index, tile_size_m, layout, ground, options), threads));
  return sum.finish();
}

}  // namespace rayfield::density
