#include "sim/world/map_from_enu.h"

#include <fmt/core.h>

#include <Eigen/SVD>

#include "sim/terrain/block_geometry.h"

namespace rayfield::sim {

// Value, Jacobian and Hessian by central differences of the exact map at the origin, then a comparison with the exact
// map at the rim of the site, where a second-order expansion is worst.
Result<MapFromEnu> MapFromEnu::create(const Site& site, double reach_m) {
  RAYFIELD_ASSIGN(const MapFrame frame, MapFrame::create(site.crs_code()));
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  const auto exact = [&](const Eigen::Vector3d& p) { return frame.map_from_geodetic(plane.geodetic_from_enu(p)); };
  constexpr double kStep = 200;  // m; third-order terms of the map over it stay under a micrometre
  MapFromEnu map;
  map.value_ = exact(Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d di = kStep * Eigen::Vector3d::Unit(i);
    map.jacobian_.col(i) = (exact(di) - exact(-di)) / (2 * kStep);
    for (int j = 0; j <= i; ++j) {
      const Eigen::Vector3d dj = kStep * Eigen::Vector3d::Unit(j);
      const Eigen::Vector3d second =
          i == j ? Eigen::Vector3d((exact(di) - 2 * map.value_ + exact(-di)) / (kStep * kStep))
                 : Eigen::Vector3d((exact(di + dj) - exact(di - dj) - exact(dj - di) + exact(-di - dj)) /
                                   (4 * kStep * kStep));
      for (std::size_t axis = 0; axis < 3; ++axis)
        map.hessian_[axis](i, j) = map.hessian_[axis](j, i) = second[static_cast<Eigen::Index>(axis)];
    }
  }
  double worst = 0;
  for (const double e : {-1.0, 0.0, 1.0})
    for (const double n : {-1.0, 0.0, 1.0})
      for (const double u : {-30.0, 30.0}) {
        const Eigen::Vector3d p(e * reach_m, n * reach_m, u);
        worst = std::max(worst, (map(p) - exact(p)).norm());
      }
  if (!(worst <= 1e-4))
    return fail(
        ErrorCode::usage, "cannot simulate in this CRS", site.crs_code(),
        fmt::format("the map bends by {:.2g} m more than a second-order expansion over {:.0f} m", worst, reach_m),
        "choose a CRS made for the place, or a smaller block");
  return map;
}

Rigid3 MapFromEnu::operator()(const Rigid3& enu_from_body) const {
  // The orientation part of the Jacobian: its nearest rotation.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(jacobian_, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Quaterniond map_from_enu(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
  return {(map_from_enu * enu_from_body.rotation).normalized(), (*this)(enu_from_body.translation)};
}

double site_reach_m(const World& world) {
  constexpr double kDriveMargin = 10;  // m beyond the rows and the outer lanes
  return world.block().half_extent().norm() + world.site().rows.spacing_m + kDriveMargin +
         world.site().lidar.max_range_m;
}

}  // namespace rayfield::sim
