#include "libdensity/scan/scan_range_resolution.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/echoes/ground_spots.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"

namespace rayfield::density {
namespace {

constexpr const char* kKind = "spots";
constexpr const char* kColumn = "range_resolution_m";  // no value: not known
constexpr double kWideM = 0.02, kWideRangeM = 5;       // as SLAM looks for it (docs/slam.md, "Wide beams")
constexpr std::size_t kTiles = 8;                      // are enough
constexpr double kDeepSpotM = 0.1;
constexpr std::ptrdiff_t kLeastDeep = 200;
// Fitted to 48 scans whose b was known: 0.09 to 0.25 m come out right to 1 cm where sections of the scan agree, to 3 cm
// where they differ by up to as much as b, which no section of a narrow beam's tells well.
constexpr double kUnnoticedM = 0.012, kMostRelativeSigma = 1, kGroundErrorM = 0.012;
constexpr double kKnownM = 0.02;

// Of the tiles with hits, as many as are enough, from all over the scan.
std::vector<tile::TileEntry> some_tiles(const std::vector<tile::TileEntry>& tiles) {
  std::vector<tile::TileEntry> with_hits, out;
  for (const tile::TileEntry& entry : tiles)
    if (entry.hit_count > 0) with_hits.push_back(entry);
  const std::size_t count = std::min(kTiles, with_hits.size());
  for (std::size_t i = 0; i < count; ++i) out.push_back(with_hits[i * with_hits.size() / count]);
  return out;
}

Result<std::vector<SpotLift>> lifts_of(ScanWork& work, const SurveyedScan& surveyed,
                                       const std::vector<tile::TileEntry>& tiles) {
  const auto track = std::make_shared<const SensorTrack>(surveyed.survey.path());
  std::vector<SpotLift> lifts;
  work.progress.stage(fmt::format("{}: range resolution", work.scan.scan_id), tiles.size(), "tiles");
  for (const tile::TileEntry& entry : tiles) {
    RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
    GroundSpots empty(*work.scan.beam, track, surveyed.ground, work.tile_of(entry));
    const auto add = [](GroundSpots& sum, const tile::SegmentBatch& segments) { sum.add(segments); };
    RAYFIELD_ASSIGN(const GroundSpots spots,
                    accumulate_tile(reader, std::move(empty), work.threads, work.progress, add));
    const std::vector<SpotLift> of_tile = spots.lifts();
    lifts.insert(lifts.end(), of_tile.begin(), of_tile.end());
    work.progress.advance(1);
  }
  return lifts;
}

std::optional<double> resolution_from(const std::vector<SpotLift>& lifts) {
  if (std::count_if(lifts.begin(), lifts.end(), [](const SpotLift& l) { return l.spot_depth_m > kDeepSpotM; }) <
      kLeastDeep)
    return std::nullopt;
  const std::optional<RangeResolution> resolution =
      believed(fit_range_resolution(lifts), kUnnoticedM, kMostRelativeSigma);
  return resolution ? std::optional(resolution->value_m) : std::nullopt;
}

Result<std::optional<double>> measure_on_ground(ScanWork& work, const SurveyedScan& surveyed) {
  const std::vector<tile::TileEntry> tiles = some_tiles(work.scan.tiles);
  KeyBuilder key(kKind, kSpotsVersion);
  add_beam(key, *work.scan.beam);
  for (const tile::TileEntry& entry : tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const std::vector<SpotLift> lifts, lifts_of(work, surveyed, tiles));
    const std::optional<double> resolution_m = resolution_from(lifts);
    tile::ArraySet arrays{.kind = kKind, .attributes = "{}"};
    arrays.columns[kColumn] = resolution_m ? std::vector{*resolution_m} : std::vector<double>{};
    return arrays;
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get(kKind, "block", key.hex(), make));
  RAYFIELD_ASSIGN(const auto column, arrays.column<double>(kColumn));
  if (column.empty()) return std::nullopt;
  if (column.size() != 1 || !(column[0] >= kFinestRange_m && column[0] <= kCoarsestRange_m))
    return fail(ErrorCode::damaged, "cannot read derived data", kKind, "it holds no range resolution",
                "run `rayfield verify`");
  return column[0];
}

}  // namespace

bool ground_tells_resolution(const LidarBeam& beam, bool one_beam) {
  return one_beam && beam.diameter_at(kWideRangeM) >= kWideM &&
         beam.returns.value_or(ReturnMode::first) == ReturnMode::first;
}

bool is_known(const BelievedResolution& resolution) { return resolution.error_m <= kKnownM; }

Result<BelievedResolution> range_resolution_of_scan(ScanWork& work, const SurveyedScan& surveyed,
                                                    const EchoStatistics& statistics) {
  if (work.options.beam.range_resolution_m > 0) return BelievedResolution{work.options.beam.range_resolution_m};
  if (work.scan.beam->range_resolution_m) return BelievedResolution{*work.scan.beam->range_resolution_m};
  const BelievedResolution of_leaves = range_resolution_of(statistics.mixed());
  if (is_known(of_leaves) || !ground_tells_resolution(*work.scan.beam, sends_one_beam(statistics))) return of_leaves;
  RAYFIELD_ASSIGN(const std::optional<double> of_ground_m, measure_on_ground(work, surveyed));
  return of_ground_m ? BelievedResolution{*of_ground_m, kGroundErrorM} : of_leaves;
}

}  // namespace rayfield::density
