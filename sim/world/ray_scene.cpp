#include "sim/world/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace rayfield::sim {
namespace {

constexpr std::size_t kPacket = 8;

tl::unexpected<Error> embree_error(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  const bool memory = code == RTC_ERROR_OUT_OF_MEMORY;
  return fail(memory ? ErrorCode::resources : ErrorCode::internal, "cannot build the simulated scene", "",
              memory ? std::string("out of memory") : fmt::format("Embree error {}", static_cast<int>(code)),
              memory ? "give a smaller site or fewer leaves" : "please report this with the site file");
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Material> materials;  // by geometry id
  std::size_t triangles = 0;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

Result<RayScene> RayScene::create() {
  RayScene result;
  result.impl_ = std::make_shared<Impl>();
  result.impl_->device = rtcNewDevice("hugepages=0");
  if (result.impl_->device == nullptr) return embree_error(nullptr);
  result.impl_->scene = rtcNewScene(result.impl_->device);
  if (result.impl_->scene == nullptr) return embree_error(result.impl_->device);
  return result;
}

Result<void> RayScene::add(const TriangleMesh& mesh, Material material) {
  return add_moving(mesh, {&mesh.vertices, 1}, material);
}

Result<void> RayScene::add_moving(const TriangleMesh& mesh, std::span<const std::vector<Eigen::Vector3f>> vertices,
                                  Material material) {
  if (mesh.triangles.empty()) return {};
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (geometry == nullptr) return embree_error(impl_->device);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(vertices.size()));
  bool failed = false;
  for (unsigned step = 0; step < vertices.size(); ++step) {
    void* buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3,
                                           sizeof(Eigen::Vector3f), mesh.vertices.size());
    failed = failed || buffer == nullptr;
    if (!failed) std::memcpy(buffer, vertices[step].data(), mesh.vertices.size() * sizeof(Eigen::Vector3f));
  }
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(mesh.triangles[0]), mesh.triangles.size());
  if (failed || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    return embree_error(impl_->device);
  }
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  rtcCommitGeometry(geometry);
  const unsigned id = rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  if (id >= impl_->materials.size()) impl_->materials.resize(id + 1);
  impl_->materials[id] = material;
  impl_->triangles += mesh.triangles.size();
  return {};
}

Result<void> RayScene::commit() {
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE) return embree_error(impl_->device);
  return {};
}

std::optional<SceneHit> RayScene::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                       double max_range_m, double time) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  query.ray.org_x = static_cast<float>(origin.x());
  query.ray.org_y = static_cast<float>(origin.y());
  query.ray.org_z = static_cast<float>(origin.z());
  query.ray.dir_x = static_cast<float>(direction.x());
  query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.tnear = 0;
  query.ray.tfar = static_cast<float>(max_range_m);
  query.ray.time = static_cast<float>(time);
  query.ray.mask = ~0U;
  query.ray.id = 0;
  query.ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Eigen::Vector3d normal(static_cast<double>(query.hit.Ng_x), static_cast<double>(query.hit.Ng_y),
                               static_cast<double>(query.hit.Ng_z));
  SceneHit hit;
  hit.range_m = static_cast<double>(query.ray.tfar);
  hit.material = impl_->materials[query.hit.geomID];
  hit.cos_incidence = std::abs(normal.dot(direction)) / normal.norm();
  return hit;
}

void RayScene::cast(std::span<const SceneRay> rays, double max_range_m, double time, std::span<SceneHit> hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    alignas(64) std::array<int, kPacket> valid{};
    RTCRayHit8 query;
    for (std::size_t i = 0; i < kPacket; ++i) {
      valid[i] = i < count ? -1 : 0;
      const SceneRay& ray = rays[first + std::min(i, count - 1)];
      query.ray.org_x[i] = static_cast<float>(ray.origin.x());
      query.ray.org_y[i] = static_cast<float>(ray.origin.y());
      query.ray.org_z[i] = static_cast<float>(ray.origin.z());
      query.ray.dir_x[i] = static_cast<float>(ray.direction.x());
      query.ray.dir_y[i] = static_cast<float>(ray.direction.y());
      query.ray.dir_z[i] = static_cast<float>(ray.direction.z());
      query.ray.tnear[i] = 0;
      query.ray.tfar[i] = static_cast<float>(max_range_m);
      query.ray.time[i] = static_cast<float>(time);
      query.ray.mask[i] = ~0U;
      query.ray.id[i] = 0;
      query.ray.flags[i] = 0;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), impl_->scene, &context, &query);
    for (std::size_t i = 0; i < count; ++i) {
      SceneHit& hit = hits[first + i];
      hit = {std::numeric_limits<double>::infinity(), Material::ground, 0};
      if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const Eigen::Vector3d normal(static_cast<double>(query.hit.Ng_x[i]), static_cast<double>(query.hit.Ng_y[i]),
                                   static_cast<double>(query.hit.Ng_z[i]));
      hit.range_m = static_cast<double>(query.ray.tfar[i]);
      hit.material = impl_->materials[query.hit.geomID[i]];
      hit.cos_incidence = std::abs(normal.dot(rays[first + i].direction)) / normal.norm();
    }
  }
}

std::size_t RayScene::triangle_count() const { return impl_->triangles; }

}  // namespace rayfield::sim
