#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "formats/las/las_header.h"

namespace rayfield::formats {

/// A point of a LAS file, as far as rays need it.
struct LasPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in the file's CRS, m
  double gps_time_s = 0;                               ///< adjusted standard GPS time or seconds of the GPS week
  std::uint16_t intensity = 0;
  std::uint8_t return_number = 0;  ///< of its pulse, from 1; 0 where the writer left it out
  std::uint8_t classification = 0;
  bool synthetic = false, withheld = false;

  /// Low points and high noise (ASPRS standard classes 7 and 18).
  bool is_noise() const { return classification == 7 || classification == 18; }
};

/// Decodes the record at `from`, of which header.point_bytes are there (formats 1, 3 to 10).
LasPoint decode_las_point(const std::byte* from, const LasHeader& header);

}  // namespace rayfield::formats
