#pragma once

/// truth: the numbers that an estimator should find, and the files they are written to.

#include <Eigen/Core>
#include <vector>

#include "rayfield/sim/drive.h"
#include "rayfield/sim/world.h"

namespace rayfield::sim {

/// What an estimator should find. Plan coordinates are ENU metres at the site's origin; rows, panels and posts count
/// from 0. Areas: see IntervalAreas.
struct Truth {
  struct Row {
    int row = 0;
    Eigen::Vector2d from, to;
  };
  struct Panel {
    int row = 0, panel = 0;
    Eigen::Vector2d from, to;  ///< ends on the row's centreline
    double length_m = 0, leaf_area_m2 = 0, wood_area_m2 = 0;
    CanopyTruth canopy = {};
    std::vector<CanopyBand> profile = {};
  };
  struct Metre {
    int row = 0;
    double along_m = 0;  ///< chainage of its middle
    Eigen::Vector2d position;
    double leaf_area_per_m = 0, wood_area_per_m = 0;
    CanopyTruth canopy = {};
  };

  Site site;
  std::size_t date_index = 0;
  std::vector<Row> rows;
  std::vector<Panel> panels;
  std::vector<Metre> metres;
  std::vector<Post> posts;
  std::vector<Eigen::Vector3d> ground;        ///< bare ground on a 0.5 m grid along the block's axes
  std::vector<TimedPose> trajectory;          ///< enu_from_imu at the IMU's rate
  std::vector<TimedPose> trajectory_in_map;   ///< the same in the map CRS, relative to grid east, north, up
  double leaf_area_m2 = 0, wood_area_m2 = 0;  ///< of all rows
  std::uint64_t leaf_count = 0;
  double duration_s = 0, path_m = 0, start_time_s = 0;
};

/// Errors: usage (the CRS cannot be used at the site).
Result<Truth> truth(const World& world, const Drive& drive);

}  // namespace rayfield::sim
