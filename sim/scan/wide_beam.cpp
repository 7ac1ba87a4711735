#include "sim/scan/wide_beam.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/scan/beam_disc.h"
#include "sim/site/site_fields.h"

namespace rayfield::sim {
namespace {

double reflected_share(const SiteReflectance& of, Material material) {
  switch (material) {
    case Material::ground:
      return of.ground;
    case Material::grass:
      return of.grass;
    case Material::leaf:
      return of.leaf;
    case Material::wood:
      return of.wood;
    case Material::post:
      return of.post;
    case Material::wire:
      return of.wire;
    case Material::building:
      return of.building;
  }
  return of.leaf;
}

// Lambert's law, softened.
double angle_response(const SiteReflectance& of, double cosine) { return 1 - of.angle_dependence * (1 - cosine); }

constexpr double kSurfaceGapM = 0.02;

// Light that a surface sends back scatters as a whole, and surfaces behind each other each by itself.
void scatter(std::span<SubEcho> echoes, const std::function<double()>& gain) {
  std::sort(echoes.begin(), echoes.end(), [](const SubEcho& a, const SubEcho& b) { return a.range_m < b.range_m; });
  double of_surface = 1;
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (i == 0 || echoes[i].range_m > echoes[i - 1].range_m + kSurfaceGapM) of_surface = gain();
    echoes[i].energy *= of_surface, echoes[i].strength *= of_surface;
  }
}

}  // namespace

// Of leaves with cosine c to the ray, uniform in 0 … 1, a ray meets c: E[c²]/E[c] = (1/3)/(1/2). The response is linear
// in c, so that its mean is that at the mean.
double mean_leaf_response(const SiteReflectance& reflectance) {
  constexpr double kMeanCosine = 2.0 / 3.0;
  return angle_response(reflectance, kMeanCosine);
}

SubEcho sub_echo(const SiteReflectance& reflectance, Detection detection, const SceneHit& hit, double share) {
  const double reflected = reflected_share(reflectance, hit.material);
  const double response = angle_response(reflectance, hit.cos_incidence);
  const double by_angle = detection == Detection::returned_energy ? response / mean_leaf_response(reflectance) : 1;
  return {hit.range_m, by_angle * share * reflected / reflectance.leaf, share * (255 * reflected * response)};
}

WideBeam::WideBeam(const SiteLidar& lidar, const SiteReflectance& reflectance)
    : lidar_(lidar), reflectance_(reflectance), disc_(beam_disc(lidar.energy_profile, lidar.sub_rays)) {}

void WideBeam::aim(const Shot& shot, double turn_rad, Bundle& bundle) const {
  bundle.rays.resize(disc_.size()), bundle.hits.resize(disc_.size());
  const Eigen::Rotation2Dd turn(turn_rad);
  const double radius = 0.5 * lidar_.beam_diameter_m, slope = 0.5e-3 * lidar_.divergence_mrad;
  const double slope_z = lidar_.divergence_z_mrad > 0 ? 0.5e-3 * lidar_.divergence_z_mrad : slope;
  for (std::size_t i = 0; i < disc_.size(); ++i) {
    const Eigen::Vector2d p = turn * disc_[i];
    bundle.rays[i].origin = shot.origin + radius * (p.x() * shot.across + p.y() * shot.along_z);
    bundle.rays[i].direction =
        (shot.direction + slope * p.x() * shot.across + slope_z * p.y() * shot.along_z).normalized();
  }
}

std::optional<Echo> WideBeam::receive(std::span<const SceneHit> hits, const std::function<double()>& gain,
                                      double dither, const std::function<bool(const Echo&)>& lost,
                                      std::vector<Echo>* behind) const {
  std::array<SubEcho, kMaxSubRays> met;
  std::size_t count = 0;
  const double share = 1 / static_cast<double>(disc_.size());
  for (const SceneHit& hit : hits)
    if (std::isfinite(hit.range_m)) met[count++] = sub_echo(reflectance_, lidar_.detection, hit, share);
  const std::span<SubEcho> echoes(met.data(), count);
  if (lidar_.echo_scatter > 0) scatter(echoes, gain);
  return beam_return(lidar_, echoes, share * dither, lost, behind);
}

}  // namespace rayfield::sim
