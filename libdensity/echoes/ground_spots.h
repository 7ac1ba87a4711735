#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/ground/sensor_track.h"
#include "rayfield/core/beam_spot.h"
#include "rayfield/core/lidar_beam.h"
#include "rayfield/tile/segments.h"

namespace rayfield::density {

/// Where a scan's beams met the ground of a tile: steeply, and aslant, in deep spots, of which lidars that report the
/// first echo see the near edge (docs/beams-fits.md, "The range resolution"). Integers: any split of the rays gives the
/// same sums.
class GroundSpots {
 public:
  /// `ground` of the scan. `tile` m, map coordinates.
  GroundSpots(const LidarBeam& beam, std::shared_ptr<const SensorTrack> track, const GroundModel& ground,
              const tile::TileRef& tile);
  void add(const tile::SegmentBatch& segments);
  void merge(const GroundSpots& other);
  /// Of each place that was met steeply, by how much it was lifted where it was met aslant, by the depth of the spot.
  std::vector<SpotLift> lifts() const;

 private:
  static constexpr int kDepths = 23;  ///< classes of spot depth, the first for what is steep
  struct Sum {
    std::int64_t count = 0, lift = 0, depth = 0, cosine = 0;  ///< in units of kUnit
  };
  struct Geometry;
  std::shared_ptr<const Geometry> geometry_;
  std::vector<Sum> sums_;  // [place·kDepths + class of depth]
};

}  // namespace rayfield::density
