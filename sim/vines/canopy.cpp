#include "sim/vines/canopy.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "rayfield/sim/random.h"
#include "sim/terrain/smooth_noise.h"
#include "sim/vines/leaf_shapes.h"

namespace rayfield::sim {
namespace {

constexpr double kSquareMetre = 1e-4;  // per cm²

// Place of a leaf relative to its vine: along the row, across it, and height over the smooth ground under the row.
struct LeafPlace {
  double along = 0, across = 0, height = 0;
};

double truncated_normal(CounterRandom& random, double sigma, double limit) {
  double x = sigma * random.normal();
  while (std::abs(x) > limit) x = sigma * random.normal();
  return x;
}

// A wall: nearly even in height with soft upper and lower edges, normal across.
LeafPlace place_in_wall(const SiteCanopy& canopy, double top, double vine_spacing, CounterRandom& random) {
  LeafPlace place;
  place.along = vine_spacing * (random.uniform(-0.5, 0.5) + 0.05 * random.normal());
  place.across = truncated_normal(random, canopy.width_m / 4, canopy.width_m / 2);
  const double soft = 0.06 * (top - canopy.bottom_m);
  place.height = random.uniform(canopy.bottom_m + soft, top - soft) + truncated_normal(random, soft / 2, soft);
  return place;
}

// Shoots hang over: the further out, the lower.
LeafPlace place_in_sprawl(const SiteCanopy& canopy, double top, double vine_spacing, CounterRandom& random) {
  LeafPlace place;
  place.along = vine_spacing * (random.uniform(-0.5, 0.5) + 0.08 * random.normal());
  place.across = truncated_normal(random, canopy.width_m / 4, canopy.width_m / 2);
  const double out = 2 * std::abs(place.across) / canopy.width_m;
  const double depth = top - canopy.bottom_m;
  do {
    place.height = canopy.bottom_m + depth * (0.68 - 0.4 * out * out + 0.2 * random.normal());
  } while (place.height < canopy.bottom_m || place.height > top);
  return place;
}

// An ellipsoid per plant, evenly filled.
LeafPlace place_in_crown(const SiteCanopy& canopy, double top, double vine_spacing, CounterRandom& random) {
  Eigen::Vector3d p;
  do {
    p.x() = random.uniform(-1, 1), p.y() = random.uniform(-1, 1), p.z() = random.uniform(-1, 1);
  } while (p.squaredNorm() > 1);
  return {0.55 * vine_spacing * p.x(), 0.5 * canopy.width_m * p.y(),
          canopy.bottom_m + 0.5 * (top - canopy.bottom_m) * (1 + p.z())};
}

LeafPlace place_leaf(const SiteCanopy& canopy, double top, double vine_spacing, CounterRandom& random) {
  switch (canopy.kind) {
    case CanopyKind::vsp:
      return place_in_wall(canopy, top, vine_spacing, random);
    case CanopyKind::sprawl:
      return place_in_sprawl(canopy, top, vine_spacing, random);
    case CanopyKind::crown:
      return place_in_crown(canopy, top, vine_spacing, random);
  }
  return {};
}

// Leaf sizes of one vine: drawn until they fill its area, then scaled by a common factor (near 1) to fill it exactly.
std::vector<double> leaf_sizes(const Site& site, const Vine& vine, std::uint64_t vine_id) {
  CounterRandom random(site.seed, Stream::leaf, vine_id);
  std::vector<double> sizes;
  double sum = 0;
  while (sum < vine.leaf_area_m2) {
    sizes.push_back(kSquareMetre * random.uniform(site.canopy.leaf_size_min_cm2, site.canopy.leaf_size_max_cm2));
    sum += sizes.back();
  }
  for (double& size : sizes) size *= vine.leaf_area_m2 / sum;
  return sizes;
}

}  // namespace

std::vector<Vine> plan_vines(const Site& site) {
  const SiteRows& rows = site.rows;
  const int per_row = std::max(1, static_cast<int>(std::lround(rows.length_m / rows.vine_spacing_m)));
  std::vector<Vine> vines;
  double vigour_sum = 0, planted = 0;
  for (int row = 0; row < rows.count; ++row)
    for (int k = 0; k < per_row; ++k) {
      CounterRandom random(site.seed, Stream::vine, vines.size());
      Vine vine;
      vine.row = row;
      vine.chainage_m = rows.length_m * (k + 0.5) / per_row;
      vine.missing = random.uniform() < rows.missing_fraction;
      const double smooth = smooth_noise(site.seed, Stream::row_vigour, static_cast<std::uint64_t>(row),
                                         2 * vine.chainage_m / site.canopy.vigour_wavelength_m);
      vine.vigour = std::clamp(1 + site.canopy.vigour_variation * smooth + site.canopy.vine_variation * random.normal(),
                               0.1, 2.5);
      if (!vine.missing) vigour_sum += vine.vigour, planted += 1;
      vines.push_back(vine);
    }
  const double area_per_vine = site.canopy.leaf_area_m2_per_m * rows.length_m / per_row;
  for (Vine& vine : vines)
    if (!vine.missing) vine.leaf_area_m2 = area_per_vine * vine.vigour * planted / vigour_sum;
  return vines;
}

std::uint64_t add_vine_leaves(const Ground& ground, const Vine& vine, std::uint64_t vine_id, double leaf_fraction,
                              const LeafNormals& normals, TriangleMesh& mesh) {
  const SiteCanopy& canopy = ground.site.canopy;
  const double row_length = ground.site.rows.length_m;
  // Weak vines are lower as well as thinner.
  const double top =
      canopy.bottom_m + (canopy.top_m - canopy.bottom_m) * std::clamp(0.8 + 0.2 * vine.vigour, 0.6, 1.05);
  const std::vector<double> sizes = leaf_sizes(ground.site, vine, vine_id);
  std::uint64_t present = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    CounterRandom random(ground.site.seed, Stream::leaf, (vine_id + 1) * (std::uint64_t{1} << 24) + i);
    if (random.uniform() >= leaf_fraction) continue;
    const LeafPlace place = place_leaf(canopy, top, ground.site.rows.vine_spacing_m, random);
    double chainage = vine.chainage_m + place.along;
    // Leaves that would hang beyond the end posts are folded back.
    if (chainage < 0) chainage = -chainage;
    if (chainage > row_length) chainage = 2 * row_length - chainage;
    const Eigen::Vector3d center = ground.row_point(vine.row, chainage, place.across, place.height);
    const Eigen::Vector3d normal = normals.draw(random);
    const double turn = 2 * std::numbers::pi * random.uniform();
    const Eigen::Vector3d helper = std::abs(normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d a = helper.cross(normal).normalized(), b = normal.cross(a);
    const Eigen::Vector3d long_axis = std::cos(turn) * a + std::sin(turn) * b;
    add_leaf(mesh, canopy.leaf_shape, center, long_axis, normal.cross(long_axis), sizes[i]);
    ++present;
  }
  return present;
}

}  // namespace rayfield::sim
