#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace rayfield {

/// A batch of lidar rays in map coordinates (projected CRS: easting, northing, height; metres), stored by column.
/// method: a ray = (origin, end, time, intensity, hit flag). Rays that hit nothing end at the sensor's maximum range
/// and have hit == 0: the space up to there is free, and nothing is known of what lies beyond.
struct RayBatch {
  std::vector<Eigen::Vector3d> origin;   ///< sensor position when the ray was sent, m
  std::vector<Eigen::Vector3d> end;      ///< where the ray ended, m
  std::vector<double> time_s;            ///< Unix time, s (UTC)
  std::vector<std::uint16_t> intensity;  ///< as the source gives it; 0 for a ray without a hit
  std::vector<std::uint8_t> hit;         ///< 1: a surface at `end`; 0: nothing up to `end`

  std::size_t size() const { return origin.size(); }
  bool empty() const { return origin.empty(); }
  void clear();
  void reserve(std::size_t n);
  void push(const Eigen::Vector3d& ray_origin, const Eigen::Vector3d& ray_end, double ray_time_s,
            std::uint16_t ray_intensity, bool ray_hit);
};

inline void RayBatch::clear() { origin.clear(), end.clear(), time_s.clear(), intensity.clear(), hit.clear(); }
inline void RayBatch::reserve(std::size_t n) {
  origin.reserve(n), end.reserve(n), time_s.reserve(n), intensity.reserve(n), hit.reserve(n);
}
inline void RayBatch::push(const Eigen::Vector3d& ray_origin, const Eigen::Vector3d& ray_end, double ray_time_s,
                           std::uint16_t ray_intensity, bool ray_hit) {
  origin.push_back(ray_origin), end.push_back(ray_end), time_s.push_back(ray_time_s);
  intensity.push_back(ray_intensity), hit.push_back(ray_hit ? 1 : 0);
}

}  // namespace rayfield
