#include "rayfield/sim/leaf_box.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "rayfield/sim/random.h"
#include "sim/scan/wide_beam.h"
#include "sim/terrain/triangle_mesh.h"
#include "sim/vines/leaf_angles.h"
#include "sim/vines/leaf_shapes.h"
#include "sim/world/ray_scene.h"

namespace rayfield::sim {
namespace {

TriangleMesh random_leaves(const LeafBoxOptions& options, std::size_t count) {
  const LeafNormals normals(LeafAngles::spherical);
  TriangleMesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    CounterRandom random(options.seed, Stream::leaf, i);
    Eigen::Vector3d middle;
    for (double& coordinate : middle) coordinate = random.uniform();
    const Eigen::Vector3d normal = normals.draw(random);
    const Eigen::Vector3d long_axis =
        Eigen::AngleAxisd(random.uniform(0, 2 * std::numbers::pi), normal) * normal.unitOrthogonal();
    add_leaf(mesh, LeafShape::rhombus, middle.cwiseProduct(options.size_m), long_axis, normal.cross(long_axis),
             options.leaf_size_m2);
  }
  return mesh;
}

std::uint16_t intensity_of(const Echo& echo) {
  return static_cast<std::uint16_t>(std::clamp(std::round(echo.strength), 1.0, 65535.0));
}

}  // namespace

struct LeafBox::Impl {
  RayScene scene;
  std::size_t leaves = 0;
  double leaf_area_m2 = 0;
};

Result<void> LeafBoxOptions::validate() const {
  const auto refuse = [](std::string_view key, std::string_view range) {
    return fail(ErrorCode::usage, "cannot grow leaves", key, "it is out of its range", range);
  };
  if (!(size_m.minCoeff() >= 0.01 && size_m.maxCoeff() <= 100)) return refuse("size_m", "give 0.01 to 100 m");
  if (!(density_m2_m3 >= 0 && density_m2_m3 <= 100)) return refuse("density_m2_m3", "give 0 to 100 m²/m³");
  if (!(leaf_size_m2 >= 1e-5 && leaf_size_m2 <= 1)) return refuse("leaf_size_m2", "give 0.00001 to 1 m²");
  if (size_m.prod() * density_m2_m3 / leaf_size_m2 > 1e7) return refuse("density_m2_m3", "give at most 10⁷ leaves");
  return {};
}

Result<LeafBox> LeafBox::create(const LeafBoxOptions& options) {
  RAYFIELD_CHECK(options.validate());
  auto impl = std::make_shared<Impl>();
  impl->leaves =
      static_cast<std::size_t>(std::lround(options.size_m.prod() * options.density_m2_m3 / options.leaf_size_m2));
  impl->leaf_area_m2 = static_cast<double>(impl->leaves) * options.leaf_size_m2;
  RAYFIELD_ASSIGN(impl->scene, RayScene::create());
  RAYFIELD_CHECK(impl->scene.add(random_leaves(options, impl->leaves), Material::leaf));
  RAYFIELD_CHECK(impl->scene.commit());
  return LeafBox(std::move(impl));
}

std::size_t LeafBox::leaf_count() const { return impl_->leaves; }
double LeafBox::leaf_area_m2() const { return impl_->leaf_area_m2; }

RayBatch LeafBox::scan(std::span<const Pulse> pulses, const SiteLidar& lidar, std::uint64_t seed) const {
  const SiteReflectance reflectance;
  const WideBeam beam(lidar, reflectance);
  WideBeam::Bundle bundle;
  RayBatch rays;
  rays.reserve(pulses.size());
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    const Pulse& pulse = pulses[i];
    std::optional<Echo> echo;
    if (lidar.wide()) {
      CounterRandom random(seed, Stream::lidar, i);
      const Eigen::Vector3d across = pulse.direction.unitOrthogonal();
      beam.aim({pulse.origin, pulse.direction, across, pulse.direction.cross(across)},
               random.uniform(0, 2 * std::numbers::pi), bundle);
      impl_->scene.cast(bundle.rays, lidar.max_range_m, 0, bundle.hits);
      echo = beam.receive(
          bundle.hits, [] { return 1.0; }, random.uniform(-0.5, 0.5), [](const Echo&) { return false; });
    } else if (const auto hit = impl_->scene.cast(pulse.origin, pulse.direction, lidar.max_range_m)) {
      const SubEcho met = sub_echo(reflectance, lidar.detection, *hit, 1);
      echo = Echo{met.range_m, met.energy, met.strength};
    }
    const double range_m = echo ? echo->range_m : lidar.max_range_m;
    rays.push(pulse.origin, pulse.origin + range_m * pulse.direction, pulse.time_s, echo ? intensity_of(*echo) : 0,
              echo.has_value());
  }
  return rays;
}

double full_echo_of_random_leaves() {
  const SiteReflectance reflectance;
  return 255 * reflectance.leaf * mean_leaf_response(reflectance);
}

}  // namespace rayfield::sim
