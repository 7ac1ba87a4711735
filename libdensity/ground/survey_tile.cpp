#include "libdensity/tiles/chunks.h"
#include "rayfield/density/survey.h"

namespace rayfield::density {

Result<TileSurvey> survey_tile(const tile::Store::TileReader& reader, tile::TileIndex index, double tile_size_m,
                               const SurveyOptions& options, int threads) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(const SurveyAccumulator sum,
                  accumulate_chunks(reader, SurveyAccumulator(index, tile_size_m, options), threads));
  return sum.finish();
}

}  // namespace rayfield::density
