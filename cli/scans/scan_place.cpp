#include "cli/scans/scan_place.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rayfield/core/map_frame.h"

namespace rayfield::cli {
namespace {

// Scans of one block lie on each other: what is farther away is another block, or in other coordinates.
constexpr double kMostApart_m = 5000;

// Where the first ray begins that says so; the stream is at its start again. Nothing where it cannot be read twice.
Result<std::optional<Eigen::Vector3d>> first_origin(RaySource& cloud) {
  constexpr std::size_t kRaysLookedAt = 4096;
  RayBatch batch;
  RAYFIELD_ASSIGN(const bool can_rewind, cloud.rewind());
  if (!can_rewind) return std::optional<Eigen::Vector3d>();
  RAYFIELD_CHECK(cloud.read(batch, kRaysLookedAt));
  RAYFIELD_CHECK(cloud.rewind());
  for (const Eigen::Vector3d& origin : batch.origin)
    if (origin.allFinite()) return std::optional(origin);
  return std::optional<Eigen::Vector3d>();
}

Result<void> check_distance(const Eigen::Vector3d& place, const std::string& cloud, const tile::Snapshot& latest,
                            const std::string& replaced) {
  const Eigen::Vector2d p = place.head<2>();
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const tile::ScanEntry& scan : latest.scans) {
    if (scan.scan_id == replaced || scan.origin_bounds.isEmpty()) continue;
    const Eigen::AlignedBox2d box(Eigen::Vector2d(scan.origin_bounds.min().head<2>()),
                                  Eigen::Vector2d(scan.origin_bounds.max().head<2>()));
    nearest_m = std::min(nearest_m, box.exteriorDistance(p));
  }
  if (!(nearest_m > kMostApart_m) || std::isinf(nearest_m)) return {};
  return fail(ErrorCode::bad_input, "cannot add ray cloud", cloud,
              fmt::format("it begins at easting {:.1f}, northing {:.1f}, {:.0f} km from the scans of the block", p.x(),
                          p.y(), nearest_m / 1000),
              "check that it is of this block and in the store's CRS, or make a store of its own for it");
}

}  // namespace

Result<std::optional<std::string>> check_scan_place(RaySource& cloud, const std::string& crs,
                                                    const tile::Snapshot& latest, const std::string& replaced) {
  RAYFIELD_ASSIGN(const auto place, first_origin(cloud));
  if (!place) return std::optional<std::string>();
  auto warning = check_map_place(crs, *place);
  if (!warning) {
    const Error& error = warning.error();
    return fail(ErrorCode::bad_input, "cannot add ray cloud", cloud.name(),
                error.where == crs ? error.why : error.where + ": " + error.why, error.next);
  }
  RAYFIELD_CHECK(check_distance(*place, cloud.name(), latest, replaced));
  return warning;
}

}  // namespace rayfield::cli
