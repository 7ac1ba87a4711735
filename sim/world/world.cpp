#include "rayfield/sim/world.h"

#include <fmt/core.h>

#include "rayfield/core/parallel.h"
#include "sim/terrain/block_geometry.h"
#include "sim/terrain/terrain.h"
#include "sim/vines/area_sums.h"
#include "sim/vines/canopy.h"
#include "sim/vines/canopy_sums.h"
#include "sim/vines/leaf_angles.h"
#include "sim/vines/trellis.h"
#include "sim/vines/vine_wood.h"
#include "sim/vines/wind.h"
#include "sim/world/ray_scene.h"
#include "sim/world/surroundings.h"

namespace rayfield::sim {
namespace {

// Triangles of one row, made apart so that rows can be made in parallel.
struct RowMeshes {
  TriangleMesh posts, wires, wood, leaves;
  std::vector<Post> post_list;
  std::uint64_t leaf_count = 0;
  std::vector<TriangleRange> thin_wood;  // of `wood`: cordons and canes
};

RowMeshes build_row(const Ground& ground, int row, const std::vector<Vine>& vines, double leaf_fraction,
                    const LeafNormals& normals) {
  RowMeshes meshes;
  add_posts(ground, row, meshes.post_list, meshes.posts);
  add_wires(ground, row, meshes.wires);
  for (std::size_t id = 0; id < vines.size(); ++id) {
    if (vines[id].row != row) continue;
    const std::size_t first = meshes.wood.triangles.size();
    const std::size_t trunk = add_vine_wood(ground, vines[id], id, meshes.wood);
    meshes.thin_wood.push_back({first + trunk, meshes.wood.triangles.size()});
    meshes.leaf_count += add_vine_leaves(ground, vines[id], id, leaf_fraction, normals, meshes.leaves);
  }
  return meshes;
}

RowCanopy canopy_of(const Ground& ground, int row, const RowMeshes& meshes) {
  CanopySums sums(ground, row);
  sums.add_leaves(meshes.leaves);
  sums.add_wood(meshes.wires, {0, meshes.wires.triangles.size()});
  for (const TriangleRange& range : meshes.thin_wood) sums.add_wood(meshes.wood, range);
  return sums.finish();
}

// Leaves stand still, or move with the wind of the date.
Result<void> add_leaves(const Site& site, const SiteDate& date, const BlockGeometry& block, int row,
                        const TriangleMesh& leaves, RayScene& scene) {
  if (site.wind.rms_m == 0) return scene.add(leaves, Material::leaf);
  return scene.add_moving(leaves, blown_leaves(site, date.seed, block, row, leaves), Material::leaf);
}

}  // namespace

struct World::Impl {
  Site site;
  std::size_t date_index;
  BlockGeometry block;
  Terrain terrain;
  std::vector<Vine> vines;
  std::vector<Post> posts;
  std::vector<RowAreas> areas;
  std::vector<RowCanopy> canopy;
  std::uint64_t leaf_count = 0;
  RayScene scene;

  Impl(const Site& s, std::size_t index)
      : site(s), date_index(index), block(s.rows), terrain(s), vines(plan_vines(s)) {}
};

// Rows are made in parallel and added to the scene in their order, which makes the result independent of the threads;
// what is not of a row (ground, grass, surroundings) comes last.
Result<World> build_world(const Site& site, std::size_t date_index, int threads, Progress& progress) {
  RAYFIELD_CHECK(site.validate());
  if (date_index >= site.dates.size())
    return fail(ErrorCode::usage, "cannot build the simulated scene", site.name,
                fmt::format("it has {} dates, number {} was asked for", site.dates.size(), date_index));
  const int workers = thread_count(threads);
  progress.stage("scene", static_cast<std::uint64_t>(site.rows.count), "rows");
  auto impl = std::make_shared<World::Impl>(site, date_index);
  const Ground ground{impl->site, impl->block, impl->terrain};
  const LeafNormals normals(site.canopy.leaf_angles, site.canopy.ellipsoid_ratio);
  const double leaf_fraction = site.dates[date_index].leaf_fraction;
  RAYFIELD_ASSIGN(impl->scene, RayScene::create());
  RayScene& scene = impl->scene;
  AreaSums sums(impl->site, impl->block, impl->terrain);

  const auto rows = static_cast<std::size_t>(site.rows.count);
  std::vector<RowMeshes> made(rows);
  impl->canopy.resize(rows);
  const auto produce = [&](std::size_t row, int) -> Result<void> {
    if (progress.cancelled()) return fail(ErrorCode::interrupted, "simulation stopped", site.name, "asked to stop");
    RowMeshes& meshes = made[row];
    const int number = static_cast<int>(row);
    meshes = build_row(ground, number, impl->vines, leaf_fraction, normals);
    // Rows have their own sums, so that rows may be added up at the same time.
    for (const TriangleMesh* wood : {&meshes.posts, &meshes.wires, &meshes.wood})
      sums.add_wood(number, *wood, 0, wood->triangles.size());
    sums.add_leaves(number, meshes.leaves, 0, meshes.leaves.triangles.size());
    impl->canopy[row] = canopy_of(ground, number, meshes);
    return {};
  };
  const auto consume = [&](std::size_t row) -> Result<void> {
    RowMeshes& meshes = made[row];
    RAYFIELD_CHECK(scene.add(meshes.posts, Material::post));
    RAYFIELD_CHECK(scene.add(meshes.wires, Material::wire));
    RAYFIELD_CHECK(scene.add(meshes.wood, Material::wood));
    RAYFIELD_CHECK(add_leaves(site, site.dates[date_index], impl->block, static_cast<int>(row), meshes.leaves, scene));
    impl->posts.insert(impl->posts.end(), meshes.post_list.begin(), meshes.post_list.end());
    impl->leaf_count += meshes.leaf_count;
    meshes = RowMeshes();
    progress.advance(1);
    return {};
  };
  RAYFIELD_CHECK(parallel_ordered(rows, workers, static_cast<std::size_t>(2 * workers), produce, consume));
  impl->areas = sums.rows();

  TriangleMesh grass;
  add_grass(ground, grass);
  SurroundingMeshes around;
  add_surroundings(ground, around);
  RAYFIELD_CHECK(scene.add(impl->terrain.mesh(), Material::ground));
  RAYFIELD_CHECK(scene.add(grass, Material::grass));
  RAYFIELD_CHECK(scene.add(around.leaves, Material::leaf));
  RAYFIELD_CHECK(scene.add(around.wood, Material::wood));
  RAYFIELD_CHECK(scene.add(around.buildings, Material::building));
  RAYFIELD_CHECK(scene.commit());

  World world;
  world.impl_ = std::move(impl);
  return world;
}

const Site& World::site() const { return impl_->site; }
const SiteDate& World::date() const { return impl_->site.dates[impl_->date_index]; }
std::size_t World::date_index() const { return impl_->date_index; }
const BlockGeometry& World::block() const { return impl_->block; }
const Terrain& World::terrain() const { return impl_->terrain; }
const std::vector<Vine>& World::vines() const { return impl_->vines; }
const std::vector<Post>& World::posts() const { return impl_->posts; }
const std::vector<RowAreas>& World::areas() const { return impl_->areas; }
const std::vector<RowCanopy>& World::canopy() const { return impl_->canopy; }
std::uint64_t World::leaf_count() const { return impl_->leaf_count; }
std::uint64_t World::triangle_count() const { return impl_->scene.triangle_count(); }

std::optional<SceneHit> World::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                                    double time_s) const {
  return impl_->scene.cast(origin, direction, max_range_m, wind_phase(time_s));
}

void World::cast(std::span<const SceneRay> rays, double max_range_m, double time_s, std::span<SceneHit> hits) const {
  impl_->scene.cast(rays, max_range_m, wind_phase(time_s), hits);
}

}  // namespace rayfield::sim
