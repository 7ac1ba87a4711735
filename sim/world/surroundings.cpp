#include "sim/world/surroundings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "rayfield/sim/random.h"
#include "sim/vines/leaf_angles.h"
#include "sim/vines/leaf_shapes.h"

namespace rayfield::sim {
namespace {

constexpr double kFenceMargin = 10.0;  // m around the rows: outside the headlands
constexpr double kTreeMargin = 13.0;
constexpr double kBuildingMargin = 19.0;  // the longest half diagonal of a building is under 6 m

Eigen::Vector3d on_ground(const Ground& ground, const Eigen::Vector2d& p, double height) {
  return {p.x(), p.y(), ground.terrain.smooth_height(p) + height};
}

// A place around the block, `margin` … `margin` + `depth` m outside the rows' bounding box, in the block frame.
Eigen::Vector2d place_around(const Ground& ground, double margin, double depth, CounterRandom& random) {
  const Eigen::Vector2d half = ground.block.half_extent().array() + margin + depth * random.uniform();
  // A point on the rectangle's outline, by arc length.
  double s = 4 * (half.x() + half.y()) * random.uniform();
  const double side_u = 2 * half.x(), side_v = 2 * half.y();
  if (s < side_u) return {s - half.x(), -half.y()};
  s -= side_u;
  if (s < side_v) return {half.x(), s - half.y()};
  s -= side_v;
  if (s < side_u) return {half.x() - s, half.y()};
  return {-half.x(), half.y() - (s - side_u)};
}

void add_tree(const Ground& ground, std::uint64_t index, const LeafNormals& normals, SurroundingMeshes& meshes) {
  CounterRandom random(ground.site.seed, Stream::tree, index);
  const Eigen::Vector2d at = ground.block.enu_from_block(place_around(ground, kTreeMargin, 12, random));
  const double height = random.uniform(5, 11), radius = random.uniform(1.4, 2.6);
  Limb trunk;
  trunk.from = on_ground(ground, at, -0.3), trunk.to = on_ground(ground, at, 0.6 * height);
  trunk.from_diameter_m = random.uniform(0.25, 0.5), trunk.to_diameter_m = 0.5 * trunk.from_diameter_m;
  add_limb(meshes.wood, trunk);
  for (int i = 0; i < 700; ++i) {
    Eigen::Vector3d p;
    do {
      p.x() = random.uniform(-1, 1), p.y() = random.uniform(-1, 1), p.z() = random.uniform(-1, 1);
    } while (p.squaredNorm() > 1);
    const Eigen::Vector3d center =
        on_ground(ground, at, 0.65 * height) + Eigen::Vector3d(radius * p.x(), radius * p.y(), 0.35 * height * p.z());
    const Eigen::Vector3d normal = normals.draw(random);
    const Eigen::Vector3d helper = std::abs(normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d axis = helper.cross(normal).normalized();
    add_leaf(meshes.leaves, LeafShape::rhombus, center, axis, normal.cross(axis), random.uniform(0.02, 0.06));
  }
}

// A shed with a gabled roof.
void add_building(const Ground& ground, std::uint64_t index, SurroundingMeshes& meshes) {
  CounterRandom random(ground.site.seed, Stream::building, index);
  const Eigen::Vector2d at = ground.block.enu_from_block(place_around(ground, kBuildingMargin, 8, random));
  const double turn = random.uniform(0, std::numbers::pi);
  const double length = random.uniform(3, 5), width = random.uniform(2, 3);  // halves
  const double wall = random.uniform(2.5, 4), ridge = wall + random.uniform(0.8, 1.8);
  const double base = ground.terrain.smooth_height(at);
  const auto corner = [&](double x, double y, double z) -> Eigen::Vector3d {
    return {at.x() + std::cos(turn) * x - std::sin(turn) * y, at.y() + std::sin(turn) * x + std::cos(turn) * y,
            base + z};
  };
  constexpr double kBase = -2;  // below the lowest ground under the shed
  TriangleMesh& mesh = meshes.buildings;
  for (const double side : {-1.0, 1.0}) {
    mesh.add_quad(corner(-length, side * width, kBase), corner(length, side * width, kBase),
                  corner(length, side * width, wall), corner(-length, side * width, wall));
    mesh.add_quad(corner(side * length, -width, kBase), corner(side * length, width, kBase),
                  corner(side * length, width, wall), corner(side * length, -width, wall));
    mesh.add_triangle(corner(side * length, -width, wall), corner(side * length, width, wall),
                      corner(side * length, 0, ridge));
    mesh.add_quad(corner(-length, side * width, wall), corner(length, side * width, wall), corner(length, 0, ridge),
                  corner(-length, 0, ridge));
  }
}

void add_fence(const Ground& ground, TriangleMesh& mesh) {
  constexpr double kPostDistance = 4.0;
  const Eigen::Vector2d half = ground.block.half_extent().array() + kFenceMargin;
  const std::array<Eigen::Vector2d, 4> corners{
      Eigen::Vector2d(-half.x(), -half.y()), Eigen::Vector2d(half.x(), -half.y()), Eigen::Vector2d(half.x(), half.y()),
      Eigen::Vector2d(-half.x(), half.y())};
  for (std::size_t side = 0; side < 4; ++side) {
    const Eigen::Vector2d &from = corners[side], &to = corners[(side + 1) % 4];
    const int spans = std::max(1, static_cast<int>(std::lround((to - from).norm() / kPostDistance)));
    for (int i = 0; i < spans; ++i) {
      const Eigen::Vector2d a = ground.block.enu_from_block(from + (to - from) * (static_cast<double>(i) / spans));
      const Eigen::Vector2d b = ground.block.enu_from_block(from + (to - from) * (static_cast<double>(i + 1) / spans));
      Limb limb;
      limb.from = on_ground(ground, a, -0.3), limb.to = on_ground(ground, a, 1.25);
      limb.from_diameter_m = limb.to_diameter_m = 0.1;
      limb.cap_end = true;
      add_limb(mesh, limb);
      for (const double rail : {0.45, 0.8, 1.15}) {
        limb.from = on_ground(ground, a, rail), limb.to = on_ground(ground, b, rail);
        limb.from_diameter_m = limb.to_diameter_m = 0.04;
        limb.sides = 4;
        limb.cap_end = false;
        add_limb(mesh, limb);
      }
    }
  }
}

}  // namespace

void add_surroundings(const Ground& ground, SurroundingMeshes& meshes) {
  const SiteSurroundings& options = ground.site.surroundings;
  const LeafNormals normals(LeafAngles::spherical);
  for (int i = 0; i < options.trees; ++i) add_tree(ground, static_cast<std::uint64_t>(i), normals, meshes);
  for (int i = 0; i < options.buildings; ++i) add_building(ground, static_cast<std::uint64_t>(i), meshes);
  if (options.fence) add_fence(ground, meshes.wood);
}

void add_grass(const Ground& ground, TriangleMesh& mesh) {
  constexpr double kBareStrip = 0.35;  // m either side of a row, kept free of weeds
  constexpr double kBladeWidth = 0.008;
  const SiteTerrain& terrain = ground.site.terrain;
  const Eigen::Vector2d half = ground.block.half_extent() + Eigen::Vector2d(1.0, 0.75 * ground.site.rows.spacing_m);
  const auto count = static_cast<std::uint64_t>(terrain.grass_per_m2 * 4 * half.x() * half.y());
  for (std::uint64_t i = 0; i < count; ++i) {
    CounterRandom random(ground.site.seed, Stream::grass, i);
    const double u = random.uniform(-half.x(), half.x()), v = random.uniform(-half.y(), half.y());
    const Eigen::Vector2d p = ground.block.enu_from_block({u, v});
    if (std::abs(ground.block.row_position(ground.block.nearest_row(p), p).offset) < kBareStrip) continue;
    const double height = terrain.grass_height_m * random.uniform(0.4, 1.6);
    const double turn = 2 * std::numbers::pi * random.uniform();
    const Eigen::Vector3d root(p.x(), p.y(), ground.terrain.height(p));
    const Eigen::Vector3d width(0.5 * kBladeWidth * std::cos(turn), 0.5 * kBladeWidth * std::sin(turn), 0);
    const Eigen::Vector3d lean(0.3 * height * random.normal(), 0.3 * height * random.normal(), height);
    mesh.add_triangle(root - width, root + width, root + lean);
  }
}

}  // namespace rayfield::sim
