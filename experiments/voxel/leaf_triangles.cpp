#include "experiments/voxel/leaf_triangles.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace rayfield::experiments {
namespace {

/// A triangle has 3 corners, and each of the 6 planes of a cube adds one at most.
struct Polygon {
  std::array<Eigen::Vector3d, 9> corners;
  std::size_t size = 0;
  void push(const Eigen::Vector3d& p) { corners[size++] = p; }
};

/// The part where sign·p[axis] ≤ limit.
Polygon cut(const Polygon& polygon, int axis, double sign, double limit) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Eigen::Vector3d &p = polygon.corners[i], &q = polygon.corners[(i + 1) % polygon.size];
    const double beyond_p = sign * p[axis] - limit, beyond_q = sign * q[axis] - limit;
    if (beyond_p <= 0) out.push(p);
    if ((beyond_p <= 0) != (beyond_q <= 0)) out.push(p + beyond_p / (beyond_p - beyond_q) * (q - p));
  }
  return out;
}

double area_of(const Polygon& polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size; ++i)
    sum += (polygon.corners[i - 1] - polygon.corners[0]).cross(polygon.corners[i] - polygon.corners[0]);
  return 0.5 * sum.norm();
}

/// Poisson number: events of a process of rate 1 before `mean`.
int draw_poisson(double mean, sim::CounterRandom& random) {
  double at = -std::log(random.uniform());
  int count = 0;
  while (at < mean) {
    ++count;
    at -= std::log(random.uniform());
  }
  return count;
}

bool outside(const Triangle& t, double voxel_m) {
  const Eigen::Vector3d low = t[0].cwiseMin(t[1]).cwiseMin(t[2]), high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
  return (high.array() <= 0).any() || (low.array() >= voxel_m).any();
}

}  // namespace

double area_inside(const Triangle& triangle, double voxel_m) {
  Polygon polygon;
  for (const Eigen::Vector3d& corner : triangle) polygon.push(corner);
  for (int axis = 0; axis < 3 && polygon.size > 0; ++axis) polygon = cut(cut(polygon, axis, 1, voxel_m), axis, -1, 0);
  return area_of(polygon);
}

double distance_to(const Triangle& triangle, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d e1 = triangle[1] - triangle[0], e2 = triangle[2] - triangle[0];
  const Eigen::Vector3d p = direction.cross(e2);
  const double determinant = e1.dot(p);
  if (determinant == 0) return kNever;
  const Eigen::Vector3d from_corner = origin - triangle[0];
  const double u = from_corner.dot(p) / determinant;
  if (!(u >= 0 && u <= 1)) return kNever;
  const Eigen::Vector3d q = from_corner.cross(e1);
  const double v = direction.dot(q) / determinant;
  if (!(v >= 0 && u + v <= 1)) return kNever;
  return e2.dot(q) / determinant;
}

double equilateral_area(double side_m) { return std::numbers::sqrt3 / 4 * side_m * side_m; }

Eigen::Vector3d draw_normal(const LeafNormals& normals, sim::CounterRandom& random) {
  Eigen::Vector3d point;
  if (normals.body == NormalBody::cube) {
    for (double& x : point) x = random.uniform(-1, 1);
  } else {
    const double z = random.uniform(-1, 1), turn = random.uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    point = {r * std::cos(turn), r * std::sin(turn), z};
  }
  return point.cwiseProduct(normals.eccentricity).normalized();
}

void grow_leaves(const LeafPopulation& population, sim::CounterRandom& random, std::vector<Triangle>& leaves) {
  const double w = population.voxel_m, radius = population.side_m / std::numbers::sqrt3;  // of the circumscribed circle
  const double per_m3 = population.area_m2 / (equilateral_area(population.side_m) * w * w * w);
  const int count = draw_poisson(per_m3 * std::pow(w + 2 * radius, 3), random);
  leaves.clear();
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d middle;
    for (double& x : middle) x = random.uniform(-radius, w + radius);
    const Eigen::Vector3d normal = draw_normal(population.normals, random);
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    const double turn = random.uniform(0, 2 * std::numbers::pi);
    Triangle leaf;
    for (int k = 0; k < 3; ++k) {
      const double angle = turn + k * 2 * std::numbers::pi / 3;
      leaf[static_cast<std::size_t>(k)] = middle + radius * (std::cos(angle) * u + std::sin(angle) * v);
    }
    if (!outside(leaf, w)) leaves.push_back(leaf);
  }
}

}  // namespace rayfield::experiments
