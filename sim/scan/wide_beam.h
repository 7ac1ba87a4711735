#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "rayfield/sim/site.h"
#include "rayfield/sim/world.h"
#include "sim/scan/echoes.h"

namespace rayfield::sim {

/// A pulse of the lidar in ENU. `across` and `along_z` span the beam's cross-section: in the lidar's x–y plane, and at
/// right angles to it.
struct Shot {
  Eigen::Vector3d origin, direction, across, along_z;
};

/// What a leaf at a random angle sends back on average, over what it would send back at right angles.
double mean_leaf_response(const SiteReflectance& reflectance);

/// What a surface that takes `share` of the beam adds to its echo. Of intensity what comes back at its angle; of
/// energy, which decides on detection, the same over that of the mean leaf, or without the angle.
SubEcho sub_echo(const SiteReflectance& reflectance, Detection detection, const SceneHit& hit, double share);

/// A beam with a width as a bundle of sub-rays of equal energy.
class WideBeam {
 public:
  WideBeam(const SiteLidar& lidar, const SiteReflectance& reflectance);

  /// Memory of a shot, kept from one to the next.
  struct Bundle {
    std::vector<SceneRay> rays;
    std::vector<SceneHit> hits;  ///< one per ray
    std::vector<Echo> behind;    ///< the return, of lidars that report several echoes
  };
  /// The sub-rays of a shot: they start on the disc of the exit, turned by `turn_rad`, and diverge from there.
  void aim(const Shot& shot, double turn_rad, Bundle& bundle) const;
  /// The return of what the sub-rays met, and what follows it into `behind` (beam_return()). `gain`: how much more than
  /// its surface says comes back, drawn for each surface (what lies closer together along the beam than 2 cm).
  /// `dither`: −½ … ½ of a sub-ray (beam_return()).
  std::optional<Echo> receive(std::span<const SceneHit> hits, const std::function<double()>& gain, double dither,
                              const std::function<bool(const Echo&)>& lost, std::vector<Echo>* behind = nullptr) const;

 private:
  SiteLidar lidar_;
  SiteReflectance reflectance_;
  std::vector<Eigen::Vector2d> disc_;
};

}  // namespace rayfield::sim
