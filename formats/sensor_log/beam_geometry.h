#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rayfield::formats {

/// Where the beams of a rotating lidar point, learned from its returns: in a point cloud a shot without a return keeps
/// its ring and its time but not its direction. A ring has an elevation and an azimuth of its own; the head that all
/// share turns about z.
class BeamGeometry {
 public:
  /// One shot of a sweep in the lidar frame.
  struct Shot {
    std::uint16_t ring = 0;
    float time_s = 0;  ///< in any order between rings; within a ring ascending
    Eigen::Vector3f direction = Eigen::Vector3f::UnitX();
  };

  /// Learns from the returns of a sweep: rings over all sweeps so far, the turn of the head from this one alone.
  void learn(std::span<const Shot> returns);

  /// Unit vector of a shot of the sweep that was learned last. Nothing where it would be a guess: the lidar is not of
  /// this kind (rings that are no cones, clouds corrected for motion), the ring has hardly returned anything yet, or no
  /// beam returned anything while the head passed there (a covered sensor, lost packets).
  std::optional<Eigen::Vector3f> direction(std::uint16_t ring, float time_s) const;

 private:
  struct Ring {
    std::uint64_t count = 0;
    double elevation = 0, squares = 0;  // mean and sum of squared deviations, rad
    double azimuth = 0;                 // against the head, rad
    double cosine = 1, sine = 0;        // of the elevation
    bool known() const;
  };
  struct Sample {
    std::uint16_t ring;
    float time_s;
    double azimuth;
  };
  struct Bin {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    double head = 0;  // azimuth of the head less the mean turn, rad
  };

  void learn_elevations(std::span<const Shot> returns);
  bool measure_rate();
  double follow_head();
  double turned(double azimuth, float time_s) const;
  std::size_t bin_of(float time_s) const;

  std::vector<Ring> rings_;
  // Of the sweep that was learned last.
  bool understood_ = false;
  double rate_rad_s_ = 0;
  float first_s_ = 0, last_s_ = 0;
  std::vector<Sample> samples_;
  std::vector<Bin> bins_;
};

}  // namespace rayfield::formats
