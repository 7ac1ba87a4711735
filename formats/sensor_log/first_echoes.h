#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rayfield/core/rig.h"

/// Of beams with several echoes the first one is taken: what the estimator knows of lost and hidden leaves holds for it
/// (docs/beams.md, "Several echoes").
namespace rayfield::formats {

/// What a raw range means after REP 117 and the rig's limits and convention.
enum class RangeKind { returned, none, too_close, invalid };
RangeKind kind_of_range(float range_m, const Rig::Lidar& lidar);

/// Which of a beam's echoes counts.
struct FirstEcho {
  std::size_t index = 0;  ///< the nearest return; without one the first of what is too close, nothing, or invalid
  std::size_t later = 0;  ///< returns behind it, none of them twice
};
/// `range_m`: of the echoes of one beam, in any order. Nothing where there are none.
std::optional<FirstEcho> first_echo(std::span<const float> range_m, const Rig::Lidar& lidar);

/// A point of a cloud, before it is told what it means.
struct CloudPoint {
  std::uint16_t ring = 0;
  float time_offset_s = 0;
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< unit in the lidar frame; zero where it has no place
  float range_m = 0;                                    ///< as the cloud has it
  float intensity = 0;

  bool placed() const { return direction.x() != 0 || direction.y() != 0 || direction.z() != 0; }
};

/// Leaves of points of one beam (the same ring, time and direction) the first echo in its place. `has_rings`: a point
/// without a place is a missing second echo where its ring has one with a place at the same time. Returns how many
/// later echoes were left out.
std::uint64_t keep_first_echoes(std::vector<CloudPoint>& points, bool has_rings, const Rig::Lidar& lidar);

}  // namespace rayfield::formats
