#include "rayfield/density/landmarks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libdensity/layout/polyline.h"
#include "libdensity/learning/block_registry.h"
#include "libdensity/registry/layout_store.h"
#include "libdensity/scan/scan_stages.h"
#include "rayfield/core/median.h"
#include "rayfield/core/parallel.h"

namespace rayfield::density {
namespace {

constexpr double kPathStep = 0.5, kGroundCell = 1.0, kGroundReach = 4.0;  // m
constexpr double kChord = 15;  // m to either side; a row's direction is that of a chord this long

const Row* row_of(const RowLayout& layout, int number) {
  for (const Row& row : layout.rows)
    if (row.number == number) return &row;
  return nullptr;
}

Eigen::Vector2d direction_at(const Row& row, double chainage_m) {
  const double length = row.length_m();
  const Eigen::Vector2d from = point_at(row.centreline, std::max(0.0, chainage_m - kChord)).position;
  const Eigen::Vector2d to = point_at(row.centreline, std::min(length, chainage_m + kChord)).position;
  return (to - from).normalized();
}

// `surveyed`: posts count although no scan has shown them.
std::vector<Upright> uprights_of(const RowLayout& layout, bool surveyed) {
  std::vector<Upright> uprights;
  for (const Post& post : layout.posts)
    if (const Row* row = row_of(layout, post.row); row != nullptr && (post.detected || surveyed))
      uprights.push_back({post.position, direction_at(*row, post.chainage_m), post.radius_m, true});
  for (const Trunk& trunk : layout.trunks)
    if (const Row* row = row_of(layout, trunk.row); row != nullptr)
      uprights.push_back({trunk.position, direction_at(*row, trunk.chainage_m), trunk.radius_m, false});
  return uprights;
}

double usual_post_spacing(const RowLayout& layout) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < layout.posts.size(); ++i)
    if (layout.posts[i].row == layout.posts[i - 1].row)
      gaps.push_back(layout.posts[i].chainage_m - layout.posts[i - 1].chainage_m);
  return median_of(std::move(gaps));
}

std::vector<Eigen::Vector2d> thinned_path(const ScanSurvey& survey) {
  std::vector<Eigen::Vector2d> path;
  for (const PathPoint& point : survey.path())
    if (path.empty() || (point.position.head<2>() - path.back()).norm() >= kPathStep)
      path.emplace_back(point.position.head<2>());
  return path;
}

// The ground in the middle of cells near the track.
Grid2<float> ground_along(const std::vector<Eigen::Vector2d>& path, const GroundModel& ground) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : path) box.extend(p);
  if (box.isEmpty()) return {};
  const Eigen::Vector2d low = ((box.min().array() - kGroundReach) / kGroundCell).floor() * kGroundCell;
  const Eigen::Vector2d cells = ((box.max().array() + kGroundReach - low.array()) / kGroundCell).ceil();
  Grid2<float> grid(low, kGroundCell, static_cast<int>(cells.x()), static_cast<int>(cells.y()),
                    std::numeric_limits<float>::quiet_NaN());
  const int reach = static_cast<int>(std::ceil(kGroundReach / kGroundCell));
  for (const Eigen::Vector2d& p : path) {
    const Eigen::Vector2d at = (p - low) / kGroundCell;
    const int cx = static_cast<int>(std::floor(at.x())), cy = static_cast<int>(std::floor(at.y()));
    for (int iy = std::max(0, cy - reach); iy <= std::min(grid.ny - 1, cy + reach); ++iy)
      for (int ix = std::max(0, cx - reach); ix <= std::min(grid.nx - 1, cx + reach); ++ix) {
        const Eigen::Vector2d middle = grid.center(ix, iy);
        if (std::isfinite(grid.at(ix, iy)) || (middle - p).norm() > kGroundReach) continue;
        if (const auto height = ground.height(middle.x(), middle.y())) grid.at(ix, iy) = static_cast<float>(*height);
      }
  }
  return grid;
}

BlockLandmarks landmarks_of(const RowLayout& layout, const SurveyedScan& surveyed) {
  BlockLandmarks landmarks;
  landmarks.uprights = uprights_of(layout, false);
  for (const Row& row : layout.rows) landmarks.rows.push_back(resampled(row.centreline, kPathStep));
  landmarks.path = thinned_path(surveyed.survey);
  landmarks.ground = ground_along(landmarks.path, surveyed.ground);
  landmarks.row_spacing_m = layout.spacing_m;
  landmarks.post_spacing_m = usual_post_spacing(layout);
  return landmarks;
}

// A survey as if it had been seen from lanes on both sides of its rows. Where it has no posts, its rows' ends stand for
// them.
BlockLandmarks landmarks_of(const RowLayout& survey) {
  constexpr double kLane = 1.25;  // m; half a narrow lane, so that rows beyond the outer ones are missed
  BlockLandmarks landmarks;
  landmarks.uprights = uprights_of(survey, true);
  landmarks.row_spacing_m = survey.spacing_m;
  landmarks.post_spacing_m = usual_post_spacing(survey);
  for (const Row& row : survey.rows) {
    const double length = row.length_m();
    landmarks.rows.push_back(resampled(row.centreline, kPathStep));
    for (const double chainage : {0.0, length})
      if (survey.posts.empty())
        landmarks.uprights.push_back(
            {point_at(row.centreline, chainage).position, direction_at(row, chainage), 0.05, true});
    for (const double across : {-kLane, kLane})
      for (int k = 0; k * kPathStep <= length + 2 * kGroundReach; ++k) {
        const LinePoint at = point_at(row.centreline, k * kPathStep - kGroundReach);
        landmarks.path.emplace_back(at.position + across * Eigen::Vector2d(-at.direction.y(), at.direction.x()));
      }
  }
  return landmarks;
}

// The reference itself, or where it was removed a scan that was laid on it: all but those left where their GPS put
// them.
const tile::ScanEntry& reference_scan(const tile::Snapshot& snapshot) {
  using tile::AlignmentVerdict;
  for (const AlignmentVerdict wanted : {AlignmentVerdict::reference, AlignmentVerdict::aligned})
    for (const tile::ScanEntry& scan : snapshot.scans)
      if (scan.alignment && scan.alignment->verdict == wanted) return scan;
  return snapshot.scans.front();
}

}  // namespace

Result<BlockLandmarks> find_landmarks(tile::Store& store, const std::string& scan_id, const ProcessOptions& options,
                                      Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  const tile::ScanEntry* scan = snapshot.find_scan(scan_id);
  if (scan == nullptr) return fail(ErrorCode::usage, "unknown scan", scan_id, "the store does not hold it");
  Derivation files(store, writer, scan_id, false);
  ScanWork work{store, *scan, options, files, progress};
  RAYFIELD_ASSIGN(const SurveyedScan surveyed, survey_scan(work));
  RAYFIELD_ASSIGN(const FoundLayout found, find_layout(work, surveyed));
  return landmarks_of(found.layout, surveyed);
}

Result<std::optional<BlockLandmarks>> reference_landmarks(tile::Store& store, const ProcessOptions& options,
                                                          const std::string& command, Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  if (snapshot.scans.empty()) {
    RAYFIELD_ASSIGN(const BlockLayout survey, read_survey(store, snapshot));
    return survey.known ? std::optional(landmarks_of(survey.layout)) : std::nullopt;
  }
  const tile::ScanEntry& scan = reference_scan(snapshot);
  Derivation files(store, writer, scan.scan_id, false);
  ScanWork work{store, scan, options, files, progress};
  RAYFIELD_ASSIGN(const SurveyedScan surveyed, survey_scan(work));
  RAYFIELD_ASSIGN(const BlockLayout today, read_layout(store, snapshot));
  if (today.known) return landmarks_of(today.layout, surveyed);
  RAYFIELD_ASSIGN(BlockRegistry registry, BlockRegistry::open(store, snapshot, options));
  RAYFIELD_CHECK(registry.adopt(work, surveyed, writer));
  RAYFIELD_ASSIGN(const RowLayout layout, registry.finish(writer));
  // What the scan has beside survey and ground would be dropped here.
  if (scan.derived.empty()) RAYFIELD_CHECK(files.finish());
  RAYFIELD_CHECK(writer.commit(command));
  return landmarks_of(layout, surveyed);
}

}  // namespace rayfield::density
