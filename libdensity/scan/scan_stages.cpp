#include "libdensity/scan/scan_stages.h"

#include <fmt/core.h>

#include <cmath>

#include "libdensity/ground/ground.h"
#include "libdensity/ground/ground_arrays.h"
#include "libdensity/ground/survey_arrays.h"
#include "libdensity/posts/posts.h"
#include "libdensity/posts/stem_accumulator.h"
#include "libdensity/rows/canopy_map.h"
#include "libdensity/rows/rows.h"
#include "libdensity/scan/lazy_stage.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/tiles/recently_used.h"
#include "libdensity/tiles/rounding.h"
#include "libdensity/voxels/canopy_profile_arrays.h"
#include "libdensity/voxels/row_segment_arrays.h"
#include "rayfield/core/parallel.h"

namespace rayfield::density {
namespace {

// Tiles within `reach_m` of a tile, itself among them.
std::vector<std::size_t> tiles_near(const tile::ScanEntry& scan, const tile::TileRef& tile, double reach_m) {
  const int reach = ceil_int(reach_m / tile.size_m);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < scan.tiles.size(); ++i) {
    const tile::TileIndex other = scan.tiles[i].index;
    if (std::abs(other.ix - tile.index.ix) <= reach && std::abs(other.iy - tile.index.iy) <= reach) near.push_back(i);
  }
  return near;
}

Result<TileSurvey> survey_one(ScanWork& work, const tile::TileEntry& entry, LazyStage& stage) {
  KeyBuilder key("survey", kSurveyVersion);
  key.add(option_numbers(work.options.survey)).add(entry.content_sha256());
  RAYFIELD_ASSIGN(const tile::ArraySet arrays,
                  work.files.get("survey", tile_name(entry.index), key.hex(), [&]() -> Result<tile::ArraySet> {
                    stage.begin();
                    RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
                    RAYFIELD_ASSIGN(const SurveyAccumulator sum,
                                    accumulate_tile(reader, SurveyAccumulator(work.tile_of(entry), work.options.survey),
                                                    work.threads, work.progress));
                    return survey_to_arrays(sum.finish());
                  }));
  return survey_from_arrays(arrays);
}

// Low histograms of tiles, of which the ground of a tile needs those of its neighbours, too.
using SurveyCache = RecentlyUsed<tile::TileIndex, TileSurvey>;

std::size_t bytes_of(const TileSurvey& survey) {
  return survey.bins.size() * sizeof(LowBin) + survey.bin_begin.size() * sizeof(std::uint32_t) +
         survey.path.size() * sizeof(PathSum) + survey.coverage.values.size();
}

Result<std::shared_ptr<const TileSurvey>> stored_survey(const ScanWork& work, tile::TileIndex index,
                                                        SurveyCache& surveys) {
  const auto load = [&]() -> Result<TileSurvey> {
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.read("survey", tile_name(index)));
    return survey_from_arrays(arrays);
  };
  return surveys.get(index, load, bytes_of);
}

Result<GroundTile> ground_one(ScanWork& work, tile::TileIndex index, SurveyCache& surveys, LazyStage& stage) {
  KeyBuilder key("ground", kGroundVersion);
  key.add(option_numbers(work.options.ground));
  const std::vector<std::size_t> near = tiles_near(work.scan, {index, work.tile_size_m()}, work.options.ground.halo_m);
  for (const std::size_t i : near) key.add(work.files.sha256("survey", tile_name(work.scan.tiles[i].index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    stage.begin();
    std::vector<std::shared_ptr<const TileSurvey>> held;
    std::vector<const TileSurvey*> of_near;
    for (const std::size_t i : near) {
      RAYFIELD_ASSIGN(auto survey, stored_survey(work, work.scan.tiles[i].index, surveys));
      of_near.push_back(held.emplace_back(std::move(survey)).get());
    }
    RAYFIELD_ASSIGN(const GroundTile ground, estimate_ground(index, of_near, work.options.ground));
    return ground_to_arrays(index, ground);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("ground", tile_name(index), key.hex(), make));
  RAYFIELD_ASSIGN(auto ground, ground_from_arrays(arrays));
  return std::move(ground.second);
}

// Surveys tile by tile; of the low histograms only those stay that fit into `surveys`.
Result<ScanSurvey> survey_into(ScanWork& work, SurveyCache& surveys) {
  ScanSurvey all;
  LazyStage stage(work.progress, fmt::format("{}: survey", work.scan.scan_id), work.scan.ray_count, "rays");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(const auto survey, surveys.get(
                                           entry.index, [&] { return survey_one(work, entry, stage); }, bytes_of));
    all.add(*survey);
    stage.advance(entry.start_count);
  }
  return all;
}

}  // namespace

Result<ScanSurvey> survey_tiles(ScanWork& work) {
  SurveyCache none(0);
  return survey_into(work, none);
}

Result<SurveyedScan> survey_scan(ScanWork& work) {
  SurveyCache surveys(work.memory.surveys_bytes);
  SurveyedScan result{{}, GroundModel(work.tile_size_m())};
  RAYFIELD_ASSIGN(result.survey, survey_into(work, surveys));
  LazyStage stage(work.progress, fmt::format("{}: ground", work.scan.scan_id), work.scan.tiles.size(), "tiles");
  std::vector<GroundTile> grounds(work.scan.tiles.size());
  RAYFIELD_CHECK(parallel_for(grounds.size(), work.threads, [&](std::size_t tile, int) -> Result<void> {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(grounds[tile], ground_one(work, work.scan.tiles[tile].index, surveys, stage));
    stage.advance(1);
    return {};
  }));
  for (std::size_t tile = 0; tile < grounds.size(); ++tile)
    result.ground.set(work.scan.tiles[tile].index, std::move(grounds[tile].nodes));
  return result;
}

Result<std::vector<Stem>> stems_along(ScanWork& work, const GroundModel& ground, const RowLayout& rows) {
  std::vector<Stem> stems;
  for (const tile::TileEntry& entry : work.scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
    RAYFIELD_ASSIGN(const StemAccumulator sum,
                    accumulate_hits(reader, StemAccumulator(work.tile_of(entry), rows, ground, work.options.posts),
                                    work.threads, work.progress));
    const std::vector<Stem> here = sum.finish();
    stems.insert(stems.end(), here.begin(), here.end());
    work.progress.advance(entry.start_count);
  }
  return stems;
}

Result<CanopyMap> empty_canopy_map(const ScanWork& work) {
  const std::size_t bytes = work.scan.tiles.size() * CanopyMap::tile_bytes(work.tile_size_m(), work.options.canopy);
  RAYFIELD_CHECK(check_room(work.memory.canopy_bytes, bytes, work.options, work.scan.scan_id,
                            fmt::format("the maps of canopy in its {} tiles take", work.scan.tiles.size())));
  return CanopyMap(work.tile_size_m());
}

// One pass over the tiles for the canopy map, in which rows are found, and one for the stems along them, which become
// posts, trunks and panels.
Result<FoundLayout> find_layout(ScanWork& work, const SurveyedScan& surveyed) {
  FoundLayout found;
  RAYFIELD_ASSIGN(CanopyMap canopy, empty_canopy_map(work));
  work.progress.stage(fmt::format("{}: rows", work.scan.scan_id), work.scan.ray_count, "rays");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
    RAYFIELD_ASSIGN(
        const CanopyAccumulator sum,
        accumulate_hits(reader, CanopyAccumulator(work.tile_of(entry), surveyed.ground, work.options.canopy),
                        work.threads, work.progress));
    canopy.set(entry.index, sum.finish());
    work.progress.advance(entry.start_count);
  }
  RAYFIELD_ASSIGN(RowFindings findings, find_rows(surveyed.survey.path(), canopy, work.options.rows));
  for (const RejectedRow& rejected : findings.rejected)
    found.notes.push_back(fmt::format("not a row, near {:.1f} {:.1f}: {}", rejected.line.front().x(),
                                      rejected.line.front().y(), rejected.reason));
  found.layout = std::move(findings.layout);
  if (found.layout.rows.empty()) {
    const std::string why =
        found.notes.empty() ? "the vehicle drove along nothing that looks like a row" : found.notes.front();
    return fail(ErrorCode::bad_input, "no rows found", work.scan.scan_id, why,
                "check that the scan is of a vineyard or orchard driven lane by lane");
  }

  work.progress.stage(fmt::format("{}: posts", work.scan.scan_id), work.scan.ray_count, "rays");
  RAYFIELD_ASSIGN(const std::vector<Stem> stems, stems_along(work, surveyed.ground, found.layout));
  RAYFIELD_ASSIGN(const PostReport posts, place_posts(found.layout, stems, work.options.posts));
  found.notes.insert(found.notes.end(), posts.warnings.begin(), posts.warnings.end());
  return found;
}

Result<CanopyProfile> profile_canopy(ScanWork& work, const RowLayout& layout, const GroundModel& ground) {
  KeyBuilder key("profile", kProfileVersion);
  key.add(option_numbers(work.options.segments)).add(work.layout_key);
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    CanopyProfile profile;
    work.progress.stage(fmt::format("{}: canopy extents", work.scan.scan_id), work.scan.ray_count, "rays");
    for (const tile::TileEntry& entry : work.scan.tiles) {
      RAYFIELD_CHECK(check_cancelled(work.progress));
      RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
      RAYFIELD_ASSIGN(
          const CanopyProfileAccumulator sum,
          accumulate_hits(reader, CanopyProfileAccumulator(work.tile_of(entry), layout, ground, work.options.segments),
                          work.threads, work.progress));
      add_profile(profile, sum.finish());
      work.progress.advance(entry.start_count);
    }
    return profile_to_arrays(profile);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("profile", "block", key.hex(), make));
  return profile_from_arrays(arrays);
}

Result<RowSegmentList> cut_row_segments(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                        const CanopyProfile& profile, double voxel_m) {
  const RowSegmentOptions options = with_voxel_size(work.options.segments, voxel_m);
  KeyBuilder key("stretches", kRowSegmentsVersion);
  key.add(option_numbers(options)).add(work.layout_key).add(work.files.sha256("profile", "block"));
  for (const tile::TileEntry& entry : work.scan.tiles) key.add(work.files.sha256("ground", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const RowSegmentList list, make_row_segments(layout, ground, profile, options));
    for (const std::string& warning : list.warnings) work.progress.warn(warning);
    return row_segments_to_arrays(list);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("stretches", "block", key.hex(), make));
  return row_segments_from_arrays(arrays);
}

}  // namespace rayfield::density
