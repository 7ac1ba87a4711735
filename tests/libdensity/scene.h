#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "libdensity/ground/ground.h"
#include "libdensity/ground/scan_survey.h"
#include "libdensity/layout/row_order.h"
#include "libdensity/posts/posts.h"
#include "libdensity/posts/stem_accumulator.h"
#include "libdensity/rows/canopy_map.h"
#include "libdensity/rows/rows.h"
#include "libdensity/voxels/canopy_profile.h"
#include "libdensity/voxels/row_segments.h"

/// Analytic scenes: points on surfaces of known place, and a drive, handed out as the segments of tiles.
namespace rayfield::density::testing {

inline constexpr double kTile = 25.0;
using Height = std::function<double(double, double)>;
using Tiles = std::map<tile::TileIndex, tile::SegmentBatch>;

/// Rows of a block as offsets of one line, straight or an arc. across = 0 is the first row, positive to the left.
struct BlockShape {
  Eigen::Vector2d start{500030, 6100040};
  double azimuth_deg = 20;  ///< of the first row at its start, clockwise from north
  double radius_m = 0;      ///< 0 = straight; else the centre lies that far to the left
  double length_m = 30;     ///< of the first row
  /// Map point at a share 0…1 of the length (or beyond), shifted across.
  Eigen::Vector2d at(double share, double across_m) const;
};

class Scene {
 public:
  explicit Scene(
      std::uint64_t seed, Height ground = [](double, double) { return 100.0; });

  double ground(const Eigen::Vector2d& p) const { return ground_(p.x(), p.y()); }
  /// Ground hits with gaussian noise, `per_m2` of them.
  void add_ground(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double per_m2, double noise_m);
  /// Hits on leaves: uniform along, gaussian across, uniform in height.
  void add_canopy(const BlockShape& block, double across_m, double from_share, double to_share, double per_m,
                  double sigma_across_m = 0.12, double bottom_m = 0.8, double top_m = 1.7);
  /// Hits on a cylinder's surface from the ground to its top.
  void add_cylinder(const Eigen::Vector2d& foot, double radius_m, double top_m, double per_m,
                    const Eigen::Vector2d& lean = Eigen::Vector2d::Zero());
  void add_point(const Eigen::Vector3d& p) { points_.push_back(p); }
  /// The vehicle drives along a line at 1.25 m/s.
  void add_drive(const std::vector<Eigen::Vector2d>& line);
  /// Drives every lane once, back and forth, with turns beyond the ends.
  void drive_lanes(const BlockShape& block, const std::vector<double>& lanes_across_m);

  std::mt19937_64& random() { return random_; }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }

  Tiles tiles() const;

 private:
  std::mt19937_64 random_;
  Height ground_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> origins_;
  std::vector<double> times_;
  double clock_s_ = 1.55e9;
};

/// The stages one after the other, as a caller would run them.
std::vector<TileSurvey> survey_all(const Tiles& tiles);
std::vector<const TileSurvey*> pointers(const std::vector<TileSurvey>& surveys);
ScanSurvey scan_survey_of(const std::vector<TileSurvey>& surveys);
GroundModel ground_of(const std::vector<TileSurvey>& surveys);
tile::HitBatch hits_of(const tile::SegmentBatch& segments);
CanopyMap canopy_of(const Tiles& tiles, const GroundModel& ground);
std::vector<Stem> stems_of(const Tiles& tiles, const RowLayout& layout, const GroundModel& ground);
CanopyProfile profile_of(const Tiles& tiles, const RowLayout& layout, const GroundModel& ground,
                         const RowSegmentOptions& options);

/// Rows at 0 and −spacing_m across the block.
RowLayout two_rows(const BlockShape& block, double spacing_m);
/// Ground nodes of a height function over the tiles around the block.
GroundModel exact_ground(const Height& height);

/// Rows found in a scene, with everything before them.
struct Found {
  Tiles tiles;
  GroundModel ground;
  RowFindings rows;
};
Found find_rows_in(const Scene& scene);

}  // namespace rayfield::density::testing
