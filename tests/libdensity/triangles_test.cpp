#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "rayfield/density/element_size.h"
#include "rayfield/density/estimator.h"

/// Equilateral triangles of known size strewn at random about one voxel, seen by twenty rays.
namespace rayfield::density {
namespace {

using Eigen::Vector3d;
constexpr double kVoxel = 0.12;

struct Triangle {
  Vector3d a, e1, e2;
};

Vector3d direction(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
}

/// Triangles with their centroid anywhere in a cube that reaches `margin` beyond the voxel [0, kVoxel)³.
std::vector<Triangle> strew(double density, double side, double margin, std::mt19937_64& rng) {
  const double area = std::sqrt(3.0) / 4 * side * side, edge = kVoxel + 2 * margin;
  std::poisson_distribution<int> number(density * edge * edge * edge / area);
  std::uniform_real_distribution<double> uniform(-margin, kVoxel + margin);
  std::vector<Triangle> out(static_cast<std::size_t>(number(rng)));
  for (Triangle& t : out) {
    const Vector3d normal = direction(rng), u = normal.cross(direction(rng)).normalized(), v = normal.cross(u);
    const Vector3d centroid(uniform(rng), uniform(rng), uniform(rng));
    t.e1 = side * u, t.e2 = side * (0.5 * u + std::sqrt(0.75) * v);
    t.a = centroid - (t.e1 + t.e2) / 3;
  }
  return out;
}

double first_hit(const std::vector<Triangle>& triangles, const Vector3d& o, const Vector3d& d) {
  double best = 1e9;
  for (const Triangle& t : triangles) {  // Möller & Trumbore
    const Vector3d p = d.cross(t.e2);
    const double det = t.e1.dot(p);
    if (std::abs(det) < 1e-15) continue;
    const Vector3d s = o - t.a;
    const double u = s.dot(p) / det;
    if (u < 0 || u > 1) continue;
    const Vector3d q = s.cross(t.e1);
    const double v = d.dot(q) / det;
    if (v < 0 || u + v > 1) continue;
    const double x = t.e2.dot(q) / det;
    if (x > 0) best = std::min(best, x);
  }
  return best;
}

/// Twenty isotropic rays that reach the voxel through the medium about it.
VoxelCounters observe(const std::vector<Triangle>& triangles, double reach, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  VoxelCounters c;
  const auto fixed = [](double u) { return std::llround(u / VoxelCounters::kUnit); };
  for (int attempt = 0; c.rays < 20 && attempt < 4000; ++attempt) {
    const Vector3d d = direction(rng), u = d.unitOrthogonal(), v = d.cross(u);
    const double r = kVoxel * 0.9;  // lines through a disc that covers the voxel
    Vector3d o = Vector3d::Constant(kVoxel / 2) + r * (uniform(rng) * u + uniform(rng) * v);
    double in = -1e9, out = 1e9;
    for (int k = 0; k < 3; ++k) {
      const double a = -o[k] / d[k], b = (kVoxel - o[k]) / d[k];
      in = std::max(in, std::min(a, b)), out = std::min(out, std::max(a, b));
    }
    if (in >= out) continue;
    const double x = first_hit(triangles, o + (in - reach) * d, d) - reach;
    if (x <= 0) continue;  // stopped before the voxel
    const bool hit = x < out - in;
    const double path = std::min(x, out - in) / kVoxel;
    ++c.rays;
    c.path += fixed(path), c.path2 += fixed(path * path), c.path3 += fixed(path * path * path);
    c.potential += fixed((out - in) / kVoxel);
    if (!hit) continue;
    ++c.hits;
    c.hit_path += fixed(path), c.hit_path2 += fixed(path * path), c.hit_path3 += fixed(path * path * path);
  }
  return c;
}

TEST(Triangles, AreaDensityOfTrianglesIsFoundWithinTwoPercentWithTheFiniteLeafCorrection) {
  for (const double side : {0.025, 0.05, 0.075, 0.10})
    for (const double density : {4.0, 10.0}) {
      std::mt19937_64 rng(static_cast<std::uint64_t>(side * 1e4 + density));
      const LeafCorrection leaf = LeafCorrection::of(std::sqrt(3.0) / 4 * side * side, kVoxel);
      double sum = 0, square = 0, plain = 0;
      const int trials = 2500;
      for (int t = 0; t < trials; ++t) {
        const auto triangles = strew(density, side, 0.18, rng);
        const VoxelCounters c = observe(triangles, 0.12, rng);
        const double e = estimate_voxel(c, kVoxel, leaf).density;
        sum += e, square += e * e, plain += estimate_voxel(c, kVoxel, {}).density;
      }
      const double mean = sum / trials, se = std::sqrt((square / trials - mean * mean) / trials);
      EXPECT_NEAR(mean / density, 1.0, 0.02 + 2 * se / density)
          << "side " << side << " density " << density << " se " << se / density << " uncorrected "
          << plain / trials / density;
    }
}

TEST(Triangles, SmallElementsNeedNoCorrection) {
  EXPECT_NEAR(effective_element_area(1e-8, kVoxel) / 1e-8, 1.0, 0.02);
  EXPECT_EQ(effective_element_area(0, kVoxel), 0);
}

TEST(Triangles, LargeElementsCountLessThanTheirAreaSinceTheyReachOutOfTheVoxel) {
  double last = 0;
  for (const double area : {0.001, 0.0035, 0.0065, 0.01}) {
    const double effective = effective_element_area(area, 0.08);
    EXPECT_LT(effective, area);
    EXPECT_GT(effective, last);
    last = effective;
  }
}

}  // namespace
}  // namespace rayfield::density
