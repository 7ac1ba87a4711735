#include "sim/vines/vine_wood.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rayfield/sim/random.h"

namespace rayfield::sim {
namespace {

// A bent branch: from `at` in direction `heading`, turning by `bend` at each joint.
struct Branch {
  Eigen::Vector3d at = Eigen::Vector3d::Zero(), heading = Eigen::Vector3d::UnitZ(), bend = Eigen::Vector3d::Zero();
  double length_m = 0, from_diameter_m = 0, to_diameter_m = 0;
  int joints = 3, sides = 5;
};

void add_branch(TriangleMesh& mesh, const Branch& branch) {
  Eigen::Vector3d at = branch.at, heading = branch.heading.normalized();
  for (int i = 0; i < branch.joints; ++i) {
    const double f0 = static_cast<double>(i) / branch.joints, f1 = static_cast<double>(i + 1) / branch.joints;
    Limb limb;
    limb.from = at;
    limb.to = at + branch.length_m / branch.joints * heading;
    limb.from_diameter_m = branch.from_diameter_m + f0 * (branch.to_diameter_m - branch.from_diameter_m);
    limb.to_diameter_m = branch.from_diameter_m + f1 * (branch.to_diameter_m - branch.from_diameter_m);
    limb.sides = branch.sides;
    add_limb(mesh, limb);
    at = limb.to;
    heading = (heading + branch.bend).normalized();
  }
}

void add_trunk(const Ground& ground, const Vine& vine, std::uint64_t vine_id, TriangleMesh& mesh) {
  const SiteStructure& structure = ground.site.structure;
  CounterRandom random(ground.site.seed, Stream::trunk, vine_id);
  const double diameter = structure.trunk_diameter_m * std::clamp(1 + 0.15 * random.normal(), 0.5, 1.6);
  Eigen::Vector3d from = ground.row_point(vine.row, vine.chainage_m, 0.02 * random.normal(), -0.1);
  constexpr int kJoints = 3;
  for (int i = 1; i <= kJoints; ++i) {
    const bool top = i == kJoints;
    const double sway = top ? 0 : 0.025 * random.normal(), lean = top ? 0 : 0.03 * random.normal();
    Limb limb;
    limb.from = from;
    limb.to = ground.row_point(vine.row, vine.chainage_m + lean, sway, structure.cordon_height_m * i / kJoints);
    limb.from_diameter_m = diameter * (1.1 - 0.1 * i), limb.to_diameter_m = diameter * (1 - 0.1 * i);
    limb.sides = 6;
    add_limb(mesh, limb);
    from = limb.to;
  }
}

// Two arms along the wire, each half the distance to the next vine.
void add_cordon(const Ground& ground, const Vine& vine, std::uint64_t vine_id, TriangleMesh& mesh) {
  const SiteStructure& structure = ground.site.structure;
  CounterRandom random(ground.site.seed, Stream::trunk, vine_id + (std::uint64_t{1} << 40));
  const double reach = 0.48 * ground.site.rows.vine_spacing_m;
  const int joints = std::max(2, static_cast<int>(std::ceil(reach / 0.4)));
  for (const double side : {-1.0, 1.0}) {
    Eigen::Vector3d from = ground.row_point(vine.row, vine.chainage_m, 0, structure.cordon_height_m);
    for (int i = 1; i <= joints; ++i) {
      const double along = std::clamp(vine.chainage_m + side * reach * i / joints, 0.0, ground.site.rows.length_m);
      Limb limb;
      limb.from = from;
      limb.to = ground.row_point(vine.row, along, 0.015 * random.normal(),
                                 structure.cordon_height_m + 0.015 * random.normal());
      limb.from_diameter_m = limb.to_diameter_m = structure.cordon_diameter_m;
      limb.sides = 6;
      add_limb(mesh, limb);
      from = limb.to;
    }
  }
}

void add_canes(const Ground& ground, const Vine& vine, std::uint64_t vine_id, TriangleMesh& mesh) {
  const SiteStructure& structure = ground.site.structure;
  const SiteRows& rows = ground.site.rows;
  const CanopyKind kind = ground.site.canopy.kind;
  const int count = static_cast<int>(std::lround(structure.canes_per_m * rows.vine_spacing_m));
  for (int i = 0; i < count; ++i) {
    CounterRandom random(ground.site.seed, Stream::cane, vine_id * 4096 + static_cast<std::uint64_t>(i));
    const double place = kind == CanopyKind::crown ? 0.1 * random.normal() : random.uniform(-0.48, 0.48);
    const double chainage = std::clamp(vine.chainage_m + place * rows.vine_spacing_m, 0.0, rows.length_m);
    const Eigen::Vector2d along = ground.block.row_direction(vine.row, chainage);
    const Eigen::Vector3d forward(along.x(), along.y(), 0), right(along.y(), -along.x(), 0);
    Branch branch;
    branch.at = ground.row_point(vine.row, chainage, 0.01 * random.normal(), structure.cordon_height_m);
    branch.length_m = structure.cane_length_m * random.uniform(0.6, 1.1);
    branch.from_diameter_m = structure.cane_diameter_m * 1.2, branch.to_diameter_m = structure.cane_diameter_m * 0.7;
    const double across = random.normal(), ahead = random.normal();
    if (kind == CanopyKind::vsp) {
      branch.heading = Eigen::Vector3d::UnitZ() + 0.08 * across * right + 0.15 * ahead * forward;
    } else if (kind == CanopyKind::sprawl) {
      // Up and outwards, then over: a joint turns by as much as the shoot leans out.
      branch.heading = Eigen::Vector3d::UnitZ() + 0.6 * across * right + 0.3 * ahead * forward;
      branch.bend = 0.35 * across * right - Eigen::Vector3d(0, 0, 0.3 * std::min(1.5, std::abs(across)));
      branch.joints = 4;
    } else {
      branch.heading = Eigen::Vector3d::UnitZ() + 0.5 * across * right + 0.5 * ahead * forward;
      branch.joints = 4;
    }
    add_branch(mesh, branch);
  }
}

}  // namespace

std::size_t add_vine_wood(const Ground& ground, const Vine& vine, std::uint64_t vine_id, TriangleMesh& mesh) {
  if (vine.missing) return 0;
  const std::size_t first = mesh.triangles.size();
  const SiteStructure& structure = ground.site.structure;
  if (structure.trunk_diameter_m > 0) add_trunk(ground, vine, vine_id, mesh);
  const std::size_t trunk = mesh.triangles.size() - first;
  if (structure.cordon_diameter_m > 0) add_cordon(ground, vine, vine_id, mesh);
  add_canes(ground, vine, vine_id, mesh);
  return trunk;
}

}  // namespace rayfield::sim
