#include "libslam/surfels/surfel_regions.h"

#include <algorithm>
#include <cmath>

#include "libslam/surfels/surfel_match.h"
#include "libslam/trajectory/so3.h"

namespace rayfield::slam {
namespace {

constexpr int kPoseStep = 50;                // of the grid of the track: corrections bend it no faster than in a second
constexpr double kLever_m = 30;              // from the vehicle to most surfels
constexpr double kSpeed_m_s = 5;             // of the vehicle, at most
constexpr std::size_t kWrite = 2048;         // records of a region written at a time
constexpr std::size_t kMaxWaiting = 400000;  // records that wait in all regions

}  // namespace

void apply_offsets(const SurfelOffsets& offsets, double end_s, Surfel& s) {
  const auto [lidar_s, spinner_rad] = offsets.sensors;
  if (lidar_s == 0 && spinner_rad == 0) return;
  s.time_s = std::clamp(s.time_s + lidar_s, 0.0, end_s);
  const double angle = spinner_rad + lidar_s * static_cast<double>(s.spin_rate_rad_s);
  const Eigen::Quaterniond turn = exp_so3(angle * offsets.spin_axis);
  s.center = (turn * (s.center.cast<double>() - offsets.spin_origin) + offsets.spin_origin).cast<float>();
  s.normal = (turn * s.normal.cast<double>()).cast<float>();
}

void SurfelRegions::remember(const PoseTrack& track, const SurfelOffsets& offsets) {
  poses_.clear();
  for (int k = 0; k < track.size(); k += kPoseStep)
    poses_.push_back({track.rotation[static_cast<std::size_t>(k)], track.position[static_cast<std::size_t>(k)]});
  laid_out_with_ = offsets.sensors;
}

bool SurfelRegions::moved_too_far(const PoseTrack& track, const SurfelOffsets& offsets) const {
  if (poses_.empty()) return true;
  const double later = std::abs(offsets.sensors.lidar_s - laid_out_with_.lidar_s);
  const double turned = std::abs(offsets.sensors.spinner_rad - laid_out_with_.spinner_rad) + later * spin_rate_rad_s_;
  const double allowed = options_.slack_m - turned * kLever_m - later * kSpeed_m_s;
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    const std::size_t at = k * kPoseStep;
    const double moved = (track.position[at] - poses_[k].translation).norm();
    if (moved + kLever_m * track.rotation[at].angularDistance(poses_[k].rotation) > allowed) return true;
  }
  return false;
}

Result<void> SurfelRegions::flush(Region& region) {
  if (region.waiting.empty()) return {};
  RAYFIELD_ASSIGN(const SpillFile::Extent extent, spill_.append(std::as_bytes(std::span(region.waiting))));
  region.extents.push_back(extent);
  waiting_ -= region.waiting.size();
  region.waiting = {};
  return {};
}

// Adds a surfel to its own region and to those within its reach.
Result<void> SurfelRegions::put(SurfelRecord record, const Eigen::Vector3f& place) {
  const double around = 2 * (options_.reach_m[record.level] + options_.slack_m);
  const auto cell = [&](double at) { return static_cast<std::int64_t>(std::floor(at / options_.edge_m)); };
  const double x = static_cast<double>(place.x()), y = static_cast<double>(place.y());
  const std::int64_t own_x = cell(x), own_y = cell(y);
  for (std::int64_t cy = cell(y - around); cy <= cell(y + around); ++cy)
    for (std::int64_t cx = cell(x - around); cx <= cell(x + around); ++cx) {
      Region& region = filling_[{cy, cx}];
      record.own = cx == own_x && cy == own_y;
      region.waiting.push_back(record);
      ++waiting_;
      if (region.waiting.size() >= kWrite) RAYFIELD_CHECK(flush(region));
    }
  if (waiting_ > kMaxWaiting)
    for (auto& [key, region] : filling_) RAYFIELD_CHECK(flush(region));
  return {};
}

Result<bool> SurfelRegions::update_layout(const SurfelFile& file, const PoseTrack& track, const SurfelOffsets& offsets,
                                          int threads) {
  offsets_ = offsets, end_s_ = track.end_s();
  if (!moved_too_far(track, offsets)) return false;
  remember(track, offsets);
  RAYFIELD_CHECK(spill_.clear());
  std::vector<Surfel> moved;
  RAYFIELD_CHECK(file.for_each([&](std::span<const Surfel> surfels) -> Result<void> {
    moved.assign(surfels.begin(), surfels.end());
    for (Surfel& s : moved) {
      spin_rate_rad_s_ = std::max(spin_rate_rad_s_, std::abs(static_cast<double>(s.spin_rate_rad_s)));
      apply_offsets(offsets, end_s_, s);
    }
    const std::vector<PlacedSurfel> placed = place_surfels(moved, track, Eigen::Vector3d::Zero(), threads);
    for (std::size_t k = 0; k < surfels.size(); ++k) RAYFIELD_CHECK(put(record_of(surfels[k]), placed[k].center));
    return {};
  }));
  regions_.clear();
  for (auto& [key, region] : filling_) {
    RAYFIELD_CHECK(flush(region));
    regions_.emplace_back(key, std::move(region));
  }
  filling_.clear();
  return true;
}

Result<void> SurfelRegions::load(std::size_t at, SurfelRegion& out) const {
  const auto& [key, region] = regions_[at];
  out.center =
      options_.edge_m * Eigen::Vector3d(static_cast<double>(key.second) + 0.5, static_cast<double>(key.first) + 0.5, 0);
  out.surfels.clear(), out.own.clear();
  std::vector<SurfelRecord> records;
  for (const SpillFile::Extent& extent : region.extents) {
    records.resize(extent.size / sizeof(SurfelRecord));
    RAYFIELD_CHECK(spill_.read(extent, std::as_writable_bytes(std::span(records))));
    for (const SurfelRecord& r : records) {
      out.surfels.push_back(surfel_of(r));
      apply_offsets(offsets_, end_s_, out.surfels.back());
      out.own.push_back(r.own);
    }
  }
  return {};
}

}  // namespace rayfield::slam
