#include "cli/scans/scan_place.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/console/text.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::cli {
namespace {

// Scans of one block lie on each other: what is farther away is another block, or in other coordinates.
constexpr double kMostApart_m = 5000;
// The store leaves out what lies farther from the origin of the grid, and says so.
constexpr double kMostCoordinate_m = 1e8;

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

// In plan, where the scans of the block began their rays, but for the one that is replaced.
std::vector<Eigen::AlignedBox2d> places_of(const tile::Snapshot& latest, const std::string& replaced) {
  std::vector<Eigen::AlignedBox2d> places;
  for (const tile::ScanEntry& scan : latest.scans) {
    if (scan.scan_id == replaced || scan.origin_bounds.isEmpty()) continue;
    places.emplace_back(Eigen::Vector2d(scan.origin_bounds.min().head<2>()),
                        Eigen::Vector2d(scan.origin_bounds.max().head<2>()));
  }
  return places;
}

// Infinite where there are no places.
double distance_m(const std::vector<Eigen::AlignedBox2d>& places, const Eigen::Vector2d& p) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Eigen::AlignedBox2d& box : places) nearest_m = std::min(nearest_m, box.exteriorDistance(p));
  return nearest_m;
}

Result<void> check_distance(const Eigen::Vector3d& place, const std::string& cloud, const tile::Snapshot& latest,
                            const std::string& replaced) {
  const Eigen::Vector2d p = place.head<2>();
  const double nearest_m = distance_m(places_of(latest, replaced), p);
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

PlacedSource::PlacedSource(RaySource& source, const tile::Snapshot& latest, const std::string& replaced)
    : source_(source), block_(places_of(latest, replaced)), has_scans_(!block_.empty()) {}

Result<std::size_t> PlacedSource::read(RayBatch& batch, std::size_t max_rays) {
  RAYFIELD_ASSIGN(const std::size_t count, source_.read(batch, max_rays));
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d place = batch.origin[i].head<2>();
    if (!(place.lpNorm<Eigen::Infinity>() <= kMostCoordinate_m)) continue;
    if (block_.empty()) block_.emplace_back(place);
    const double away_m = distance_m(block_, place);
    ++rays_;
    if (away_m > kMostApart_m) ++far_rays_, farthest_m_ = std::max(farthest_m_, away_m);
  }
  return count;
}

Result<bool> PlacedSource::rewind() {
  rays_ = far_rays_ = 0, farthest_m_ = 0;
  return source_.rewind();
}

std::vector<std::string> PlacedSource::warnings() const {
  std::vector<std::string> warnings = source_.warnings();
  if (far_rays_ == 0) return warnings;
  const double share = static_cast<double>(far_rays_) / static_cast<double>(rays_);
  warnings.push_back(
      fmt::format("{} of {} rays ({:.2g} %) begin up to {:.0f} km from {}: check that they are of this "
                  "block, or remove the scan with `rayfield remove`",
                  grouped(far_rays_), grouped(rays_), 100 * share, farthest_m_ / 1000,
                  has_scans_ ? "the other scans of the block" : "where the scan begins"));
  return warnings;
}

}  // namespace rayfield::cli
