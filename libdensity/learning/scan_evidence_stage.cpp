#include "libdensity/learning/scan_evidence_stage.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libdensity/layout/polyline.h"
#include "libdensity/posts/posts.h"
#include "libdensity/posts/stem_accumulator.h"
#include "libdensity/rows/canopy_map.h"
#include "libdensity/rows/rows.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"

namespace rayfield::density {
namespace {

constexpr double kBeside = 0.7;  // m; lines closer to each other are one row
constexpr double kSameDirection = 15 * M_PI / 180;

// Canopy and stems of a tile in one reading.
class LookAgain {
 public:
  LookAgain(const tile::TileRef& tile, const RowLayout& rows, const GroundModel& ground, const ProcessOptions& options)
      : canopy_(tile, ground, options.canopy), stems_(tile, rows, ground, options.posts) {}
  void add(const tile::HitBatch& hits) { canopy_.add(hits), stems_.add(hits); }
  void merge(const LookAgain& other) { canopy_.merge(other.canopy_), stems_.merge(other.stems_); }
  const CanopyTile& canopy() const { return canopy_.finish(); }
  std::vector<Stem> stems() const { return stems_.finish(); }

 private:
  CanopyAccumulator canopy_;
  StemAccumulator stems_;
};

// A row that was found stands beside known ones as they stand beside each other: the same way, a row spacing or two
// off.
bool belongs_to_block(const Row& row, const RowLayout& known) {
  const double reach = std::isfinite(known.spacing_m) ? 2.3 * known.spacing_m : 8.0;
  const Eigen::Vector2d u = (row.centreline.back() - row.centreline.front()).normalized();
  const Eigen::Vector2d middle = row.centreline[row.centreline.size() / 2];
  return std::any_of(known.rows.begin(), known.rows.end(), [&](const Row& other) {
    const Eigen::Vector2d v = (other.centreline.back() - other.centreline.front()).normalized();
    const LineProjection on_line = project_onto_line(other.centreline, middle);
    return std::abs(u.dot(v)) > std::cos(kSameDirection) && on_line.inside && std::abs(on_line.across_m) < reach;
  });
}

// Rows that were found and are none of the known ones, nor cross or touch them anywhere.
RowLayout unknown_rows(const RowLayout& found, const RowLayout& known) {
  RowLayout out;
  for (const Row& row : found.rows) {
    const bool touches = std::any_of(known.rows.begin(), known.rows.end(), [&](const Row& other) {
      return share_beside(row.centreline, other.centreline, kBeside) > 0;
    });
    if (touches || !belongs_to_block(row, known)) continue;
    out.rows.push_back(row);
    out.rows.back().number = static_cast<int>(out.rows.size());
  }
  out.spacing_m = known.spacing_m;
  return out;
}

// Posts, trunks and panels of new rows; those with too few stems are left out: a strip of weeds has canopy, too.
Result<RowLayout> with_posts(ScanWork& work, const SurveyedScan& surveyed, const RowLayout& rows) {
  work.progress.stage(fmt::format("{}: posts of new rows", work.scan.scan_id), work.scan.ray_count, "rays");
  RAYFIELD_ASSIGN(std::vector<Stem> stems, stems_along(work, surveyed.ground, rows));
  RowLayout kept;
  for (const Row& row : rows.rows) {
    if (stems_of_row(row, stems).size() < static_cast<std::size_t>(work.options.registry.min_row_stems)) continue;
    kept.rows.push_back(row);
    kept.rows.back().number = static_cast<int>(kept.rows.size());
    for (Stem& stem : stems)
      if (stem.row == row.number) stem.row = -kept.rows.back().number;  // negative: renumbered already
  }
  for (Stem& stem : stems) stem.row = stem.row < 0 ? -stem.row : 0;
  if (kept.rows.empty()) return kept;
  RAYFIELD_CHECK(place_posts(kept, stems, work.options.posts));
  kept.spacing_m = rows.spacing_m;
  return kept;
}

// One pass over the tiles finds stems along the known rows and the canopy map; rows in the map that are not known get
// their posts in a second one.
Result<ScanEvidence> look(ScanWork& work, const SurveyedScan& surveyed, const RowLayout& known) {
  ScanEvidence evidence;
  RAYFIELD_ASSIGN(CanopyMap canopy, empty_canopy_map(work));
  work.progress.stage(fmt::format("{}: rows and posts", work.scan.scan_id), work.scan.ray_count, "rays");
  for (const tile::TileEntry& entry : work.scan.tiles) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(const auto reader, work.store.open_tile(entry));
    RAYFIELD_ASSIGN(const LookAgain sum,
                    accumulate_hits(reader, LookAgain(work.tile_of(entry), known, surveyed.ground, work.options),
                                    work.threads, work.progress));
    canopy.set(entry.index, sum.canopy());
    const std::vector<Stem> here = sum.stems();
    evidence.stems.insert(evidence.stems.end(), here.begin(), here.end());
    work.progress.advance(entry.start_count);
  }
  const std::vector<PathPoint> path = surveyed.survey.path();
  const std::vector<Pass> passes = find_passes(path, work.options.rows.passes);
  for (const Pass& pass : passes) evidence.passes.push_back(pass.line);
  RAYFIELD_ASSIGN(const RowFindings findings, find_rows(path, canopy, work.options.rows));
  for (const Row& row : known.rows) {
    const bool seen = std::any_of(findings.layout.rows.begin(), findings.layout.rows.end(), [&](const Row& found) {
      return share_beside(found.centreline, row.centreline, kBeside) > 0.3;
    });
    const auto [left, right] = driven_shares(row.centreline, passes, work.options.rows);
    evidence.rows.push_back({row.number, seen, std::max(left, right)});
  }
  const RowLayout rows = unknown_rows(findings.layout, known);
  if (!rows.rows.empty()) {
    RAYFIELD_ASSIGN(evidence.new_rows, with_posts(work, surveyed, rows));
  }
  return evidence;
}

}  // namespace

void add_lines(KeyBuilder& key, const RowLayout& known) {
  key.add(known.spacing_m);
  for (const Row& row : known.rows) {
    key.add(static_cast<std::int64_t>(row.number));
    for (const Eigen::Vector2d& p : row.centreline) key.add(p.x()).add(p.y());
  }
}

Result<ScanEvidence> gather_evidence(ScanWork& work, const SurveyedScan& surveyed, const RowLayout& known) {
  KeyBuilder key("stems", kEvidenceVersion);
  key.add(option_numbers(work.options.canopy));
  key.add(option_numbers(work.options.rows));
  key.add(option_numbers(work.options.posts)).add(static_cast<std::int64_t>(work.options.registry.min_row_stems));
  add_lines(key, known);
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256())
        .add(work.files.sha256("ground", tile_name(entry.index)))
        .add(work.files.sha256("survey", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const ScanEvidence evidence, look(work, surveyed, known));
    return evidence_to_arrays(evidence);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("stems", "block", key.hex(), make));
  return evidence_from_arrays(arrays);
}

}  // namespace rayfield::density
