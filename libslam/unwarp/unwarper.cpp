#include "libslam/unwarp/unwarper.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libslam/input/lidar_assembler.h"
#include "libslam/unwarp/open_directions.h"

namespace rayfield::slam {

std::vector<std::string> UnwarpCounts::lines() const {
  std::vector<std::string> out;
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) out.push_back(fmt::format("{} {}", count, what));
  };
  add(invalid, "points that are NaN or closer than the lidar's minimum range dropped");
  add(downward_no_return, "downward rays without a return dropped (adding the cloud restores them)");
  add(downward_kept, "downward rays without a return kept: empty down to the ground");
  add(stopped_by_vehicle, "downward rays dropped in directions from which hardly anything returns (the vehicle)");
  add(outside_trajectory, "points measured outside the trajectory dropped");
  add(without_angle, "scans without an encoder angle dropped");
  return out;
}

namespace {

/// A scanner that turns one beam in a plane.
bool scans_a_plane(const LidarScan& scan) {
  constexpr float kPlaneSine = 1e-3F;
  return std::all_of(scan.direction.begin(), scan.direction.end(),
                     [](const Eigen::Vector3f& d) { return std::abs(d.z()) < kPlaneSine; });
}

}  // namespace

struct Unwarper::Impl {
  Rig rig;
  const Trajectory& trajectory;
  LidarAssembler assembler;
  RayTaker take;
  std::size_t batch_rays;
  RayBatch batch;
  UnwarpCounts counts;
  OpenDirections directions;
  bool several_beams = false;
  Result<void> state;
  std::size_t cursor = 0;

  Impl(const Rig& r, const Trajectory& t, const SensorOffsets& offsets, RayTaker taker, std::size_t rays)
      : rig(r),
        trajectory(t),
        assembler(r, r.lidar_offset_s + offsets.lidar_s, offsets.spinner_rad),
        take(std::move(taker)),
        batch_rays(rays) {
    batch.reserve(rays + 4096);
  }

  void flush() {
    if (state && !batch.empty()) state = take(batch);
    batch.clear();
  }

  // A beam that pointed down and came back with nothing.
  bool keep_downward(const Eigen::Vector3d& direction) {
    if (!several_beams) return ++counts.downward_no_return, false;
    if (!directions.open(direction)) return ++counts.stopped_by_vehicle, false;
    return ++counts.downward_kept, true;
  }

  // Makes rays of one scan; directions and lever arms become lengths on the grid.
  void place(const BodyScan& scan) {
    const Eigen::Array3d scale(trajectory.horizontal_scale, trajectory.horizontal_scale, 1);
    for (std::size_t k = 0; k < scan.time_s.size(); ++k) {
      Rigid3 pose;
      if (!trajectory.at(scan.time_s[k], pose, cursor)) {
        ++counts.outside_trajectory;
        continue;
      }
      const bool hit = std::isfinite(scan.range_m[k]);
      const Eigen::Vector3d direction = pose.rotation * scan.direction[k];
      directions.add(scan.direction[k], hit);
      if (!hit && direction.z() <= 0 && !keep_downward(scan.direction[k])) continue;
      const double range = hit ? static_cast<double>(scan.range_m[k]) : rig.lidar.max_range_m;
      const Eigen::Vector3d arm = pose.rotation * scan.origin[k];
      const Eigen::Vector3d origin = pose.translation + (scale * arm.array()).matrix();
      const Eigen::Vector3d end = origin + (scale * (range * direction).array()).matrix();
      const float intensity = std::clamp(std::isfinite(scan.intensity[k]) ? scan.intensity[k] : 0.0f, 0.0f, 65535.0f);
      batch.push(origin, end, scan.time_s[k],
                 hit ? static_cast<std::uint16_t>(std::lround(intensity)) : std::uint16_t{0}, hit);
      ++counts.rays;
      counts.hits += hit;
    }
    if (batch.size() >= batch_rays) flush();
  }

  void drain(bool last) {
    assembler.drain([this](const BodyScan& scan) { place(scan); }, last);
    counts.invalid = assembler.counts().invalid_points;
    counts.without_angle = assembler.counts().scans_without_angle;
  }
};

Unwarper::Unwarper(const Rig& rig, const Trajectory& trajectory, const SensorOffsets& offsets, RayTaker take,
                   std::size_t batch_rays)
    : impl_(std::make_unique<Impl>(rig, trajectory, offsets, std::move(take), batch_rays)) {}
Unwarper::~Unwarper() = default;

void Unwarper::spinner(const SpinnerAngle& angle) {
  if (impl_->state) impl_->assembler.add(angle);
}

void Unwarper::lidar(const LidarScan& scan) {
  if (!impl_->state) return;
  if (!scans_a_plane(scan)) impl_->several_beams = true;
  impl_->assembler.add(scan);
  impl_->drain(false);
}

Result<void> Unwarper::finish() {
  if (impl_->state) impl_->drain(true);
  impl_->flush();
  return impl_->state;
}

const UnwarpCounts& Unwarper::counts() const { return impl_->counts; }

}  // namespace rayfield::slam
