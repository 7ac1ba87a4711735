#include "libdensity/tiles/chunks.h"
#include "rayfield/density/posts.h"

namespace rayfield::density {

Result<std::vector<Stem>> stems_of_tile(const tile::Store::TileReader& reader, tile::TileIndex index,
                                        double tile_size_m, const RowLayout& layout, const GroundModel& ground,
                                        const PostOptions& options, int threads) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(const StemAccumulator sum,
                  accumulate_chunks(reader, StemAccumulator(index, tile_size_m, layout, ground, options), threads));
  return sum.finish();
}

}  // namespace rayfield::density
