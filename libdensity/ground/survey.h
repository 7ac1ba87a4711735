#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"
#include "rayfield/density/horizon_misses.h"
#include "rayfield/density/layout_options.h"
#include "rayfield/tile/segments.h"

namespace rayfield::density {

/// Ray origins within one time step, as sums, so that the shares of several tiles add up exactly.
struct PathSum {
  std::int64_t step = 0;  ///< floor(time / path_step_s)
  std::int64_t count = 0;
  std::int64_t east = 0, north = 0, up = 0;  ///< sums of coordinates, 0.1 mm
  PathSum& operator+=(const PathSum& more);
};

/// One bin of a cell's low histogram.
struct LowBin {
  std::int32_t key = 0;     ///< floor(height / ground_bin_m)
  std::uint32_t count = 0;  ///< hits
  std::int64_t sum = 0;     ///< of heights above the bin's floor, 0.1 mm
};

/// Bits of TileSurvey::coverage.
enum CoverageFlag : std::uint8_t {
  kCoverageHit = 1,     ///< a hit in this cell at any height
  kCoveragePassed = 2,  ///< a downward ray passed over (of a systematic sample of one ray in eight)
};

/// One tile after one pass: everything that ground, trajectory and coverage need, of a size that does not depend on the
/// number of rays. All sums are integers: equal input gives equal content at any thread count and any chunking.
struct TileSurvey {
  tile::TileIndex index;
  double tile_size_m = 0;
  double path_step_s = 0.1;
  double bin_m = 0.02;
  int cells = 0;                         ///< low-histogram cells per side; cell = tile_size_m / cells
  std::vector<std::uint32_t> bin_begin;  ///< cells²+1 offsets into `bins`, cell index iy·cells + ix
  std::vector<LowBin> bins;              ///< per cell the lowest occupied bins, ascending
  std::vector<PathSum> path;             ///< ascending step
  Grid2<std::uint8_t> coverage;          ///< CoverageFlag bits
  std::int64_t segments = 0, starts = 0, ends = 0, hits = 0;  ///< hits: in the tile proper
  double first_time_s = 0, last_time_s = 0;                   ///< of the segments; 0 without any
  HorizonMisses misses;                                       ///< of the rays that end in the tile proper
  double lowest_hit_m = 0, highest_hit_m = 0;                 ///< NaN without hits

  double cell_m() const { return tile_size_m / cells; }
  /// The bins of one cell.
  std::span<const LowBin> cell_bins(int ix, int iy) const;
};

/// Collects a TileSurvey; about 16 B × cells² × ground_bins (8 MB). add() any batches in any order, merge() others of
/// the same tile, then finish().
class SurveyAccumulator {
 public:
  SurveyAccumulator(const tile::TileRef& tile, const SurveyOptions& options);
  void add(const tile::SegmentBatch& segments);
  void merge(const SurveyAccumulator& other);
  TileSurvey finish() const;

 private:
  void add_hit(const Eigen::Vector3d& end);
  void add_start(const Eigen::Vector3d& origin, double time_s);
  void add_passage(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  void add_bin(std::size_t cell, const LowBin& bin);

  tile::TileRef tile_;
  SurveyOptions options_;
  int cells_ = 0;
  Eigen::Vector2d corner_;
  std::int64_t bin_units_ = 200;
  std::vector<LowBin> bins_;  // cells² × ground_bins, each cell's first used_ entries ascending
  std::vector<std::uint16_t> used_;
  std::vector<PathSum> path_;  // ascending
  Grid2<std::uint8_t> coverage_;
  std::int64_t segments_ = 0, starts_ = 0, ends_ = 0, hits_ = 0;
  HorizonMisses misses_;
  double first_time_s_, last_time_s_, lowest_, highest_;
};

/// The vehicle's position at one moment.
struct PathPoint {
  double time_s = 0;  ///< middle of the time step
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

}  // namespace rayfield::density
