#pragma once

#include <memory>
#include <vector>

#include "sim/terrain/block_geometry.h"

namespace rayfield::sim {

struct TriangleMesh;

/// The bare ground: a plane with slope, a smooth undulation, banks under the vines and roughness. Heights are m above
/// the ENU origin.
class Terrain {
 public:
  explicit Terrain(const Site& site);

  /// The triangulated surface that rays hit, interpolated exactly; this is the ground truth. Beyond the mesh (further
  /// than the lidar reaches from any lane) it is smooth_height().
  double height(const Eigen::Vector2d& p) const;
  /// Slope and undulation with banks, without roughness: what trellis and wheels stand on.
  double smooth_height(const Eigen::Vector2d& p) const;
  /// The surface as triangles.
  const TriangleMesh& mesh() const { return *mesh_; }

 private:
  Site site_;
  BlockGeometry block_;
  std::vector<double> u_, v_;  ///< grid lines in the block frame, dense in the block and coarse around it
  std::shared_ptr<const TriangleMesh> mesh_;
};

}  // namespace rayfield::sim
