#include "sim/world/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <vector>

namespace rayfield::sim {
namespace {

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
  if (mesh.triangles.empty()) return {};
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (geometry == nullptr) return embree_error(impl_->device);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Eigen::Vector3f), mesh.vertices.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(mesh.triangles[0]), mesh.triangles.size());
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    return embree_error(impl_->device);
  }
  std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(Eigen::Vector3f));
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
                                       double max_range_m) const {
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
  query.ray.time = 0;
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

std::size_t RayScene::triangle_count() const { return impl_->triangles; }

}  // namespace rayfield::sim
