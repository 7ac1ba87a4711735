#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/segments.h"

namespace rayfield::density {

/// Hits of one scan across and above each row.
struct CanopyProfile {
  double bin_m = 0.02;
  double half_width_m = 1.5, up_min_m = 0.3;
  std::map<int, std::vector<std::int64_t>> across, up;  ///< by Row::number; bins from −half_width_m and from up_min_m
};

/// Collects a CanopyProfile over one tile after another; order does not matter.
class CanopyProfileAccumulator {
 public:
  /// `layout` and `ground` must outlive the accumulator.
  CanopyProfileAccumulator(const tile::TileRef& tile, const RowLayout& layout, const GroundModel& ground,
                           const RowSegmentOptions& options);
  ~CanopyProfileAccumulator();
  CanopyProfileAccumulator(const CanopyProfileAccumulator&);
  CanopyProfileAccumulator& operator=(const CanopyProfileAccumulator&) = delete;
  CanopyProfileAccumulator(CanopyProfileAccumulator&&) noexcept;
  CanopyProfileAccumulator& operator=(CanopyProfileAccumulator&&) noexcept;
  void add(const tile::HitBatch& hits);
  void merge(const CanopyProfileAccumulator& other);
  /// No row runs through the tile.
  bool empty() const;
  const CanopyProfile& finish() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Adds the profile of another tile of the same scan.
void add_profile(CanopyProfile& total, const CanopyProfile& tile);

}  // namespace rayfield::density
