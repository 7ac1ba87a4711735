#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// What a LAS file holds, read once without a trajectory.
struct LasInfo {
  int minor_version = 0;  ///< of LAS 1
  int point_format = 0;
  bool adjusted_gps_time = false;   ///< by the header; false: seconds of the GPS week
  std::optional<std::string> crs;   ///< as LasReader::crs()
  std::string crs_name;             ///< as LasReader::crs_name()
  std::uint64_t points = 0;         ///< in the file
  std::uint64_t first_returns = 0;  ///< that would become rays, whatever the trajectory says
  std::uint64_t later_returns = 0, withheld = 0, synthetic = 0, noise = 0, not_finite = 0;
  double first_s = 0, last_s = 0;                  ///< of the first returns, in the file's own clock; 0 without any
  std::optional<double> start_unix_s, end_unix_s;  ///< the same as Unix time, where the header says which clock
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  ///< their extent, m
  std::vector<std::string> problems;
};

/// Reads all points of a file, truncated or with bytes behind them too. `advance` is told of points that were read;
/// both functions may be empty. Errors: as LasReader::open(), interrupted.
Result<LasInfo> inspect_las(const std::string& path, const std::function<bool()>& cancelled,
                            const std::function<void(std::uint64_t)>& advance);

}  // namespace rayfield::formats
