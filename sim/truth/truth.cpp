#include "rayfield/sim/truth.h"

#include <cmath>

#include "sim/terrain/block_geometry.h"
#include "sim/terrain/terrain.h"
#include "sim/world/map_from_enu.h"

namespace rayfield::sim {
namespace {

constexpr double kGroundStep = 0.5;  // m

void add_row(const World& world, int row, Truth& truth) {
  const BlockGeometry& block = world.block();
  const RowAreas& areas = world.areas()[static_cast<std::size_t>(row)];
  const RowCanopy& canopy = world.canopy()[static_cast<std::size_t>(row)];
  truth.rows.push_back({row, block.row_point(row, 0), block.row_point(row, block.row_length())});
  const IntervalAreas& panels = areas.panels;
  for (std::size_t i = 0; i + 1 < panels.edges_m.size(); ++i) {
    const double from = panels.edges_m[i], to = panels.edges_m[i + 1];
    truth.panels.push_back({row, static_cast<int>(i), block.row_point(row, from), block.row_point(row, to), to - from,
                            panels.leaf_m2[i], panels.wood_m2[i], canopy.panels[i], canopy.profiles[i]});
    truth.leaf_area_m2 += panels.leaf_m2[i];
    truth.wood_area_m2 += panels.wood_m2[i];
  }
  const IntervalAreas& metres = areas.metres;
  for (std::size_t i = 0; i + 1 < metres.edges_m.size(); ++i) {
    const double from = metres.edges_m[i], to = metres.edges_m[i + 1], middle = 0.5 * (from + to);
    truth.metres.push_back({row, middle, block.row_point(row, middle), metres.leaf_m2[i] / (to - from),
                            metres.wood_m2[i] / (to - from), canopy.metres[i]});
  }
}

void add_ground(const World& world, Truth& truth) {
  const Eigen::Vector2d half = world.block().half_extent().array() + world.site().rows.spacing_m;
  const int nu = static_cast<int>(std::floor(half.x() / kGroundStep)),
            nv = static_cast<int>(std::floor(half.y() / kGroundStep));
  for (int j = -nv; j <= nv; ++j)
    for (int i = -nu; i <= nu; ++i) {
      const Eigen::Vector2d p = world.block().enu_from_block({i * kGroundStep, j * kGroundStep});
      truth.ground.emplace_back(p.x(), p.y(), world.terrain().height(p));
    }
}

}  // namespace

Result<Truth> truth(const World& world, const Drive& drive) {
  RAYFIELD_ASSIGN(const MapFromEnu map, MapFromEnu::create(world.site(), site_reach_m(world)));
  Truth result;
  result.site = world.site();
  result.date_index = world.date_index();
  for (int row = 0; row < world.block().row_count(); ++row) add_row(world, row, result);
  result.posts = world.posts();
  add_ground(world, result);
  result.trajectory = drive.poses(world.site().imu.rate_hz);
  for (const TimedPose& pose : result.trajectory)
    result.trajectory_in_map.push_back({pose.time_s, map(pose.map_from_body)});
  result.leaf_count = world.leaf_count();
  result.duration_s = drive.duration_s();
  result.path_m = drive.path_m;
  result.start_time_s = drive.start_time_s;
  return result;
}

}  // namespace rayfield::sim
