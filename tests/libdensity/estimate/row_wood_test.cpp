#include "libdensity/estimate/row_wood.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "libdensity/voxels/voxel_index.h"
#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density {
namespace {

/// A row of equal pieces, each turned against the one before.
RowDensity bent_row(int pieces, double turn_rad) {
  RowDensity r;
  RowSegment s = testing::make_row_segment();
  r.row = s.row, r.voxel_m = s.voxel_m, r.n_across = s.n_across, r.n_up = s.n_up;
  r.across_min_m = s.across_min_m, r.up_min_m = s.up_min_m;
  for (int i = 0; i < pieces; ++i) {
    s.index = i, s.first_along = i * s.n_along, s.chainage_m = s.first_along * s.voxel_m;
    r.row_segments.push_back(s);
    for (int a = 0; a < s.n_along; ++a) {
      r.segment_of.push_back(i);
      r.chainage_m.push_back(s.chainage_m + a * s.voxel_m);
    }
    s.origin += s.n_along * s.voxel_m * s.direction;
    s.direction = Eigen::Rotation2Dd(turn_rad) * s.direction;
  }
  r.n_along = static_cast<int>(r.segment_of.size());
  r.density.assign(r.shape().size(), 0);
  return r;
}

std::vector<WoodCylinder> wood_along(const RowDensity& row, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<WoodCylinder> wood;
  for (int i = 0; i < count; ++i) {
    const auto& s = row.row_segments[static_cast<std::size_t>(i) % row.row_segments.size()];
    const Eigen::Vector2d left(-s.direction.y(), s.direction.x());
    const Eigen::Vector2d at =
        s.origin + (uniform(random) + 1) * 0.6 * s.n_along * s.voxel_m * s.direction + 0.1 * uniform(random) * left;
    const Eigen::Vector3d axis(0.1 * uniform(random), 0.1 * uniform(random), 1);
    wood.push_back({row.row, {at.x(), at.y(), s.ground_m}, axis.normalized(), 0.04 + 0.02 * uniform(random), 1.5, 0});
  }
  return wood;
}

/// The definition, with every piece asked for every point of the surface: the piece in which a point lies, or the
/// first of those that it lies least beyond the ends of.
std::vector<float> wood_area_by_definition(const RowDensity& row, const std::vector<WoodCylinder>& wood) {
  std::vector<float> area(row.shape().size(), 0);
  for (const WoodCylinder& w : wood) {
    const Eigen::Vector3d e1 = w.axis.unitOrthogonal(), e2 = w.axis.cross(e1);
    const int rings = static_cast<int>(std::ceil(w.length_m / 0.01));
    const double part = std::numbers::pi * w.radius_m * w.length_m / (rings * 32);
    for (int ring = 0; ring < rings; ++ring)
      for (int k = 0; k < 32; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.5) / 32;
        const Eigen::Vector3d p = w.base + w.axis * (w.length_m * (ring + 0.5) / rings) +
                                  w.radius_m * (std::cos(angle) * e1 + std::sin(angle) * e2);
        double best = 1e30;
        int along = 0, first = 0;
        Eigen::Vector3d grid = Eigen::Vector3d::Zero();
        for (const RowSegment& s : row.row_segments) {
          const Eigen::Vector3d g = GridFrame(s).grid_from_map(p);
          const double beyond = std::max({0.0, -g.x(), g.x() - s.n_along});
          if (beyond < best) {
            best = beyond, grid = g;
            along = first + std::clamp(static_cast<int>(std::floor(g.x())), 0, s.n_along - 1);
          }
          first += s.n_along;
        }
        if (grid.z() < 0) continue;
        const int across = std::clamp(static_cast<int>(std::floor(grid.y())), 0, row.n_across - 1);
        const int up = std::clamp(static_cast<int>(std::floor(grid.z())), 0, row.n_up - 1);
        area[row.index(along, across, up)] += static_cast<float>(part);
      }
  }
  return area;
}

std::vector<float> free_share_by_definition(const RowDensity& row, const std::vector<WoodCylinder>& wood) {
  std::vector<float> free(row.shape().columns(), 1);
  for (const WoodCylinder& w : wood) {
    const Eigen::Vector2d base = w.base.head<2>() + 0.5 * w.length_m * w.axis.head<2>();
    for (int a = 0; a < row.n_along; ++a)
      for (int c = 0; c < row.n_across; ++c) {
        const Eigen::Vector2d u = row.row_segment(a).direction, v(-u.y(), u.x());
        int inside = 0;
        for (int i = 0; i < 8; ++i)
          for (int j = 0; j < 8; ++j) {
            const Eigen::Vector2d q =
                row.center(a, c) - base + row.voxel_m * (((i + 0.5) / 8 - 0.5) * u + ((j + 0.5) / 8 - 0.5) * v);
            if (q.norm() < w.radius_m) ++inside;
          }
        float& share = free[row.column_index(a, c)];
        share = std::max(0.0F, share - static_cast<float>(inside) / 64);
      }
  }
  return free;
}

TEST(RowWood, IsWhatTheDefinitionSaysToTheLastBitInStraightAndBentRows) {
  // Straight; as rows bend; and so sharply that pieces lie beside others of the same row.
  for (const double turn_rad : {0.0, 0.05, -0.4, 1.2}) {
    RowDensity row = bent_row(7, turn_rad);
    const std::vector<WoodCylinder> wood = wood_along(row, 40, 17);
    const std::vector<float> area = wood_area_by_definition(row, wood), free = free_share_by_definition(row, wood);
    add_wood(row, wood);
    EXPECT_EQ(row.wood_area, area) << turn_rad;
    EXPECT_EQ(row.free_share, free) << turn_rad;
  }
}

TEST(RowWood, HalfTheSurfaceOfEveryCylinderInTheCanopyIsThereOnce) {
  RowDensity row = bent_row(5, 0.02);
  for (RowSegment& s : row.row_segments) s.slope_along = s.slope_across = 0;
  const std::vector<WoodCylinder> wood = wood_along(row, 30, 4);
  add_wood(row, wood);
  double expected = 0;
  for (const WoodCylinder& w : wood)
    expected += std::numbers::pi * w.radius_m * (w.length_m - std::max(0.0, row.up_min_m) / w.axis.z());
  const double sum = std::accumulate(row.wood_area.begin(), row.wood_area.end(), 0.0);
  EXPECT_NEAR(sum, expected, 0.02 * expected);
}

TEST(RowWood, ARowWithoutWoodHasNone) {
  RowDensity row = bent_row(2, 0);
  add_wood(row, {});
  EXPECT_TRUE(row.wood_area.empty());
  EXPECT_TRUE(row.free_share.empty());
}

}  // namespace
}  // namespace rayfield::density
